//! Choices on the page: models, options, specimens, targets; all from the tables of the library.

use hysid::options::ModelName;
use hysid::options::network::Trainer;
use hysid::options::table::{FitOption, OPTIONS, OptionValues};
use hysid::plan::Protocol;
use hysid::specimens::Specimen;
use hysid_app::BAND;
use hysid_app::models::Listed;
use hysid_document::object;
use hysid_document::shell::flag;
use hysid_export::Target;
use hysid_records::READING_OPTIONS;
use serde_json::{Value, json};

/// Largest file that is taken, in bytes.
pub const MOST_FILE_BYTES: u64 = 1_000_000_000;

pub fn all() -> Value {
    let models = std::iter::once(ModelName::AUTO).chain(ModelName::all());
    let specimen = |specimen: &&Specimen| json!({"name": specimen.name, "what": specimen.summary});
    let target = |target: Target| json!({"name": target.name(), "what": target.what(), "has_inverse": target.has_inverse()});
    let options = OPTIONS.iter().filter(|option| option.name != "model");
    json!({
        "program": format!("hysid {}", env!("CARGO_PKG_VERSION")),
        "file_bytes_limit": MOST_FILE_BYTES,
        // Share of new rows that the prediction band is made for.
        "band": BAND,
        "models": models.map(model).collect::<Vec<_>>(),
        "options": options.map(option).collect::<Vec<_>>(),
        "reading": READING_OPTIONS.map(|option| object! { flag: flag(option.name), #[serde(flatten)] option: option }),
        "specimens": Specimen::all().iter().map(specimen).collect::<Vec<_>>(),
        // Kinds of specimens for a first test.
        "kinds": Protocol::ALL.map(Protocol::name),
        "targets": Target::ALL.map(target),
    })
}

/// A model with every option that it uses.
fn model(model: ModelName) -> Listed {
    let is_used = |option: &&FitOption| {
        option.name != "model" && Trainer::ALL.iter().any(|trainer| option.is_used_by(model, *trainer))
    };
    let options = OPTIONS.iter().filter(is_used).map(|option| option.name).collect();
    Listed { options, ..Listed::of(model) }
}

fn option(option: &FitOption) -> Value {
    let values = match option.values {
        OptionValues::Count(from, to) => json!({"kind": "count", "from": from, "to": to}),
        OptionValues::Whole => json!({"kind": "whole"}),
        OptionValues::Fraction => json!({"kind": "fraction"}),
        OptionValues::ZeroOr(from, to) => json!({"kind": "zero-or", "from": from, "to": to}),
        OptionValues::Number(from, to) => json!({"kind": "number", "from": from, "to": to}),
        OptionValues::Positive => json!({"kind": "positive"}),
        OptionValues::Flag => json!({"kind": "flag"}),
        OptionValues::Truth => json!({"kind": "truth"}),
        OptionValues::Span => json!({"kind": "span"}),
        OptionValues::Names(names) => json!({"kind": "names", "names": names()}),
    };
    json!({
        "name": option.name,
        "flag": flag(option.name),
        "heading": option.group.heading(),
        "meaning": option.meaning,
        "default": option.default_in_words(),
        "values": values,
    })
}

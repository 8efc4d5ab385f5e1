//! Choices on the page: models, options, specimens, targets; all from the tables of the library.

use hysid::diagnosis::cycles::Field;
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
use serde_json::{Map, Value, json};

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
        "fields": Field::ALL.map(Field::name),
        "targets": Target::ALL.map(target),
    })
}

/// A model with the defaults of every option that it uses.
fn model(model: ModelName) -> Value {
    let options = OPTIONS.iter().filter(|option| option.name != "model");
    let defaults =
        options.filter_map(|option| Some((option.name.to_string(), default_of(option, model)?.into())));
    json!(
        object! { defaults: defaults.collect::<Map<String, Value>>(), #[serde(flatten)] model: Listed::of(model) }
    )
}

/// The default of an option for a model in words, with the trainers where they differ; `None` if the model ignores it.
fn default_of(option: &FitOption, model: ModelName) -> Option<String> {
    let trainers = Trainer::ALL.iter().filter(|trainer| option.is_used_by(model, **trainer));
    let texts: Vec<(&str, String)> =
        trainers.map(|trainer| (trainer.name(), option.default(model, *trainer).to_string())).collect();
    let (_, first) = texts.first()?;
    if texts.iter().all(|(_, text)| text == first) {
        return Some(first.clone());
    }
    let named = texts.iter().map(|(trainer, text)| format!("{text} for {trainer}"));
    Some(named.collect::<Vec<_>>().join(", "))
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
        "values": values,
    })
}

//! What can be chosen on the page: models, options, specimens, targets; all from the tables of the library.

use hysid::options::ModelName;
use hysid::options::network::Trainer;
use hysid::options::table::{FitOption, OPTIONS, Values};
use hysid::specimens::Specimen;
use hysid_document::shell::flag;
use hysid_export::Target;
use hysid_records::{READING_OPTIONS, ReadingOption};
use hysid_report::BAND;
use hysid_report::models::Listed;
use serde::Serialize;
use serde_json::{Value, json};

/// Largest file that is taken, in bytes.
pub const MOST_FILE_BYTES: u64 = 1_000_000_000;

#[derive(Debug, Serialize)]
pub struct Choices {
    program: String,
    file_bytes_limit: u64,
    /// Share of new rows that the prediction band is made for.
    band: f64,
    models: Vec<Listed>,
    options: Vec<OptionChoice>,
    reading: Vec<ReadingChoice>,
    specimens: Vec<Described>,
    targets: Vec<Described>,
}

#[derive(Debug, Serialize)]
struct OptionChoice {
    name: &'static str,
    flag: String,
    heading: &'static str,
    meaning: &'static str,
    default: String,
    values: Value,
}

#[derive(Debug, Serialize)]
struct ReadingChoice {
    flag: String,
    #[serde(flatten)]
    option: ReadingOption,
}

#[derive(Debug, Serialize)]
struct Described {
    name: &'static str,
    what: &'static str,
}

impl Choices {
    pub fn all() -> Self {
        let models = std::iter::once(ModelName::AUTO).chain(ModelName::all());
        let specimen = |specimen: &&Specimen| Described { name: specimen.name, what: specimen.summary };
        let target = |target: Target| Described { name: target.name(), what: target.what() };
        Self {
            program: format!("hysid {}", env!("CARGO_PKG_VERSION")),
            file_bytes_limit: MOST_FILE_BYTES,
            band: BAND,
            models: models.map(model).collect(),
            options: OPTIONS.iter().filter(|option| option.name != "model").map(OptionChoice::of).collect(),
            reading: READING_OPTIONS
                .into_iter()
                .map(|option| ReadingChoice { flag: flag(option.name), option })
                .collect(),
            specimens: Specimen::all().iter().map(specimen).collect(),
            targets: Target::ALL.into_iter().map(target).collect(),
        }
    }
}

/// A model with every option that it uses.
fn model(model: ModelName) -> Listed {
    let is_used = |option: &&FitOption| {
        option.name != "model" && Trainer::ALL.iter().any(|trainer| option.is_used_by(model, *trainer))
    };
    let options = OPTIONS.iter().filter(is_used).map(|option| option.name).collect();
    Listed { options, ..Listed::of(model) }
}

impl OptionChoice {
    fn of(option: &FitOption) -> Self {
        Self {
            name: option.name,
            flag: flag(option.name),
            heading: option.group.heading(),
            meaning: option.meaning,
            default: option.default_in_words(),
            values: match option.values {
                Values::Count(from, to) => json!({"kind": "count", "from": from, "to": to}),
                Values::Whole => json!({"kind": "whole"}),
                Values::Fraction => json!({"kind": "fraction"}),
                Values::ZeroOr(from, to) => json!({"kind": "zero-or", "from": from, "to": to}),
                Values::Number(from, to) => json!({"kind": "number", "from": from, "to": to}),
                Values::Positive => json!({"kind": "positive"}),
                Values::Flag => json!({"kind": "flag"}),
                Values::Truth => json!({"kind": "truth"}),
                Values::Names(names) => json!({"kind": "names", "names": names()}),
            },
        }
    }
}

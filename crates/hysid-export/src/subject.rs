//! A model with all that targets write of it.

use hysid_core::data::record::ColumnNames;
use hysid_core::model::{BandLevel, Model};
use hysid_core::significant::Significant;

use crate::description::{Argument, Description, HALF_WIDTH};
use crate::error::Error;
use crate::inverse::ExportedInverse;
use crate::options::{FmiVersion, Options};
use crate::program::interpreter::Machine;
use crate::program::tangent::with_tangent;
use crate::program::unused::without_unused;
use crate::program::{Precision, Program};
use crate::text::{harmless, harmless_names};
use crate::vectors::{Action, Vector, vectors};

/// Path and content of an exported file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportFile {
    /// Its path in the folder of the export.
    pub path: String,
    /// Its content.
    pub content: Vec<u8>,
}

impl ExportFile {
    pub(crate) fn new(path: impl Into<String>, content: impl Into<Vec<u8>>) -> Self {
        Self { path: path.into(), content: content.into() }
    }
}

/// A model with all that targets write of it.
pub(crate) struct ExportSubject<'m> {
    model: &'m Model,
    options: &'m Options,
    /// Names of the columns, as they may stand in every file.
    names: ColumnNames,
    description: Description,
    tangent: Program,
    vectors: Vec<Vector>,
    inverse: Option<ExportedInverse>,
}

impl<'m> ExportSubject<'m> {
    pub fn of(model: &'m Model, options: &'m Options) -> Result<Self, Error> {
        let band = match options.band {
            None => None,
            Some(level) => {
                let band = model.band().ok_or(Error::NoBand)?;
                Some(band.terms(level).map_err(|error| Error::Band(error.to_string()))?)
            }
        };
        let described = Description::with_band(model, options.rate, options.precision, band);
        let tangent = without_unused(&with_tangent(&described.program));
        let description = Description { program: without_unused(&described.program), ..described };
        let ranges = model.trained_ranges();
        let rate = ranges.rate.map_or(0.0, |(low, high)| low.abs().max(high.abs()));
        let vectors = vectors(&description, &tangent, &ranges.inputs, rate);
        let inverse =
            options.inverse.map(|asked| ExportedInverse::of(model, asked, &description, options.precision));
        let inverse = inverse.transpose()?;
        let names = harmless_names(model.names());
        Ok(Self { model, options, names, description, tangent, vectors, inverse })
    }

    pub fn model(&self) -> &Model {
        self.model
    }

    pub fn name(&self) -> &str {
        &self.options.name
    }

    /// Names of the columns, as they may stand in every file.
    pub fn names(&self) -> &ColumnNames {
        &self.names
    }

    pub fn precision(&self) -> Precision {
        self.options.precision
    }

    pub fn fmi(&self) -> FmiVersion {
        self.options.fmi
    }

    pub fn description(&self) -> &Description {
        &self.description
    }

    pub fn program(&self) -> &Program {
        &self.description.program
    }

    pub fn tangent(&self) -> &Program {
        &self.tangent
    }

    pub fn vectors(&self) -> &[Vector] {
        &self.vectors
    }

    pub fn inverse(&self) -> Option<&ExportedInverse> {
        self.inverse.as_ref()
    }

    pub fn argument_names(&self) -> Vec<String> {
        self.description.arguments.iter().map(|argument| argument.name()).collect()
    }

    /// The place among the numbers of the state that has half the width of the band, if the export has one.
    pub fn half_width(&self) -> Option<usize> {
        let mut place = 0;
        for (_, name, values) in self.program().states() {
            if name == HALF_WIDTH {
                return Some(place);
            }
            place += values.len();
        }
        None
    }

    pub fn bytes(&self) -> usize {
        match self.precision() {
            Precision::Double => 8,
            Precision::Single => 4,
        }
    }

    /// Largest difference of the outputs in single precision from those in double precision over the test vectors, as a
    /// share of the range of the trained output; `None` in double precision.
    pub fn rounding(&self) -> Option<f64> {
        if self.precision() == Precision::Double {
            return None;
        }
        let double = Description::of(self.model, self.options.rate, Precision::Double);
        let mut machine = Machine::new(&double.program);
        let mut single = Machine::new(self.program());
        let (low, high) = self.model.trained_ranges().output;
        let steps = self.vectors.iter().filter(|vector| vector.action == Action::Step);
        let difference = |vector: &Vector| {
            (single.step(&vector.arguments)[0] - machine.step(&vector.arguments)[0]).abs() / (high - low)
        };
        Some(steps.map(difference).fold(0.0, f64::max))
    }

    /// Facts about the model, for the head of a file: each a name and a text. Both are [harmless](crate::text) in every
    /// target.
    pub fn facts(&self) -> Vec<(String, String)> {
        let mut facts = vec![("model".to_string(), self.model.name().name().to_string())];
        facts.extend(self.options.source.iter().map(|(fact, text)| (harmless(fact), harmless(text))));
        facts.push(("model's checksum".into(), checksum_of(self.model)));
        let names = &self.names;
        let ranges = self.model.trained_ranges();
        for (index, argument) in self.description.arguments.iter().enumerate() {
            let text = match *argument {
                Argument::Input(input) => {
                    let range = shown(ranges.inputs[input]);
                    format!("{}, trained from {range}", names.inputs[input])
                }
                Argument::TimeStep => {
                    let time = names.time.as_deref().unwrap_or("time");
                    format!(
                        "time since the step before, in the unit of {time}; in the first step any finite number"
                    )
                }
                Argument::Rate => {
                    let of = &names.inputs[0];
                    let range =
                        ranges.rate.map_or(String::new(), |range| format!(", trained from {}", shown(range)));
                    format!("rate of {of} per unit of time{range}")
                }
            };
            facts.push((format!("argument {}", index + 1), text));
        }
        facts.push(("output".into(), format!("{}, {} in training", names.output, shown(ranges.output))));
        let provenance = self.model.provenance();
        let percent = |errors: &hysid_core::data::metrics::Errors| {
            let relative = errors.nrmse_std_percent.map_or(String::new(), |percent| {
                format!(", {:.3} % of the output's standard deviation", Significant(percent))
            });
            format!("RMSE {:.4}{relative}", Significant(errors.rmse))
        };
        facts.push(("error in training".into(), percent(provenance.trained_error())));
        facts.push((
            "error on held-out data".into(),
            provenance.validation.as_ref().map_or("not measured".into(), percent),
        ));
        if let Some(BandLevel { probability, of_ten }) = self.options.band {
            let share = 100.0 * probability;
            facts.push((
                "prediction band".into(),
                format!(
                    "y ± half the width contains {share} % of the rows, or more, in {of_ten} of 10 data sets"
                ),
            ));
        }
        facts.push(("precision".into(), self.precision().name().into()));
        if let Some(rounding) = self.rounding() {
            let text = format!(
                "at most {rounding:.1e} of the range of the output, over the steps of the test vectors"
            );
            facts.push(("difference from f64".into(), text));
        }
        facts
    }

    pub fn vectors_csv(&self) -> String {
        let names = self.argument_names();
        let mut text = format!("action,{},output,tangent\n", names.join(","));
        for vector in &self.vectors {
            let arguments: Vec<String> = match vector.arguments.is_empty() {
                true => vec![String::new(); names.len()],
                false => vector.arguments.iter().map(|value| format!("{value:?}")).collect(),
            };
            let (output, tangent) = match vector.action {
                Action::Trial => (format!("{:?}", vector.output), format!("{:?}", vector.tangent)),
                Action::Step => (format!("{:?}", vector.output), String::new()),
                _ => (String::new(), String::new()),
            };
            text += &format!("{},{},{output},{tangent}\n", vector.action.name(), arguments.join(","));
        }
        text
    }
}

/// The checksum that stands in the model's file.
fn checksum_of(model: &Model) -> String {
    let text = model.to_json();
    let behind = text.rsplit("\"checksum\"").next().unwrap_or_default();
    behind.chars().filter(char::is_ascii_hexdigit).collect()
}

fn shown((low, high): (f64, f64)) -> String {
    format!("{:.6} to {:.6}", Significant(low), Significant(high))
}

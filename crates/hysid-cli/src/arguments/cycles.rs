//! Arguments of `hysid cycles`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{ArgAction, Args};
use hysid::data::unit;
use hysid::diagnosis::cycles::{Correction, CycleOptions, Division, Field};
use hysid::diagnosis::reversal_curves::{SMOOTHING_FACTORS, SMOOTHING_GROWTHS};
use hysid_app::quantities::number_and_unit;
use hysid_document::Problem;
use hysid_document::visible::clipped;

use super::{ColumnOptions, Overwriting, RUN, fraction, number_within};

const CYCLES_EXAMPLES: &str = concat!(
    "\
Examples:
  hysid cycles data.csv                  data.cycles.csv, page data.cycles.html
  hysid cycles data.csv --field magnet -o loops.csv
  hysid cycles model.json                cycles of the model, driven by Hysid

Definitions: ",
    page!("cycles.md")
);

#[derive(Debug, Args)]
#[command(after_help = CYCLES_EXAMPLES)]
pub struct Cycles {
    /// Tables of measured data (text, spreadsheets, MATLAB files), or one model file
    #[arg(value_name = "DATA.csv|MODEL.json", required = true)]
    pub files: Vec<PathBuf>,
    /// Table to write [default: name of the file with `.cycles.csv`; `-` is stdout]
    ///
    /// The default is in the current folder and named after the first file. The page has the same name with `.html`;
    /// further tables, if the data have them, have it with `.figures.csv`, `.levels.csv`, `.forc.csv`, `.forc-margins.csv` and `.curves.csv`.
    #[arg(short, long, value_name = "TABLE.csv")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub overwriting: Overwriting,
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// Figures of: structure, magnet, actuator, thermal, battery, hydrology or general
    ///
    /// By default the names and units of the columns tell the field. `general` has the figures of structures, magnets and
    /// actuators.
    #[arg(long, value_name = "FIELD", value_parser = named::<Field>, help_heading = "Method")]
    pub field: Option<Field>,
    /// Where cycles begin: zero, mean, reversals or start
    ///
    /// By default as suits the data. Where the input passes zero, its centre (mean), or the value with which the record starts,
    /// always in the same direction; or at every other turning point.
    #[arg(long, value_name = "WHERE", value_parser = named::<Division>, help_heading = "Method")]
    pub divide: Option<Division>,
    /// Remove from the output first: slope, drift
    ///
    /// `slope` subtracts a straight line from each record, with the slope of the outer 30 % of the input. `drift` subtracts
    /// the change of the output between the first and the last row of each record; the input must return to its first value.
    #[arg(long, value_name = "WHAT", value_delimiter = ',', value_parser = named::<Correction>, help_heading = "Method")]
    pub subtract: Vec<Correction>,
    /// Remove the offset of the output first
    ///
    /// The offset is the middle of the output's values at both ends of the input.
    #[arg(long, help_heading = "Method")]
    pub center: bool,
    /// Mass density in kg/m3, for losses per kg
    #[arg(long, value_name = "NUMBER", value_parser = positive, help_heading = "Method")]
    pub density: Option<f64>,
    /// Height of a structure, for drift ratios: 2.4m
    ///
    /// With a unit, where the input has one.
    #[arg(long, value_name = "HEIGHT", value_parser = height, help_heading = "Method")]
    pub height: Option<(f64, String)>,
    /// Ignore reversals of the input below this share of its range [default: the noise of the input decides]
    #[arg(long, value_name = "FRACTION", value_parser = fraction, help_heading = "Method", hide_short_help = true)]
    pub smallest_reversal: Option<f64>,
    /// Smooth branches before the figures are computed
    #[arg(long, value_name = "BOOL", default_value_t = CycleOptions::default().smoothing, action = ArgAction::Set, help_heading = "Method", hide_short_help = true)]
    pub smoothing: bool,
    /// Smoothing factor of first-order reversal curves, 1 to 10 [default: chosen by the noise]
    #[arg(long, value_name = "N", value_parser = smoothing_factor, help_heading = "Method", hide_short_help = true)]
    pub smoothing_factor: Option<usize>,
    /// Growth of the smoothing factor away from the ridges of a FORC diagram, 0 to 1
    ///
    /// The smoothing factor of a node grows by this number in each step of the reversal fields that the node is away from
    /// both H_c = 0 and H_u = 0, up to 10.
    #[arg(long, value_name = "NUMBER", default_value_t = 0.0, value_parser = growth, help_heading = "Method", hide_short_help = true)]
    pub smoothing_growth: f64,
    /// Print the result as one JSON object
    #[arg(long, help_heading = RUN)]
    pub json: bool,
    /// Write no report page
    #[arg(long, help_heading = RUN)]
    pub no_report: bool,
}

impl Cycles {
    /// Options of the library, for data or a model with this input.
    pub fn options(&self, input: &str) -> Result<CycleOptions, Problem> {
        let in_unit_of_input = |(height, unit): &(f64, String)| {
            let own = unit::of_column(input);
            let factor = match own {
                None if unit.is_empty() => Some(1.0),
                own => own.and_then(|own| unit::factor(unit, &own)),
            };
            let words = || match unit.as_str() {
                "" => format!(
                    "the input \"{}\" has a unit: give that of the height too, such as 2.4m",
                    clipped(input)
                ),
                unit => {
                    format!("\"{unit}\" cannot be converted to the unit of the input \"{}\"", clipped(input))
                }
            };
            factor.map(|factor| factor * height).ok_or_else(|| Problem::option("height", words()))
        };
        Ok(CycleOptions {
            smallest_reversal: self.smallest_reversal,
            smoothing: self.smoothing,
            division: self.divide,
            field: self.field,
            density: self.density,
            height: self.height.as_ref().map(in_unit_of_input).transpose()?,
        })
    }

    /// Corrections of the outputs before the division into cycles.
    pub fn corrections(&self) -> Vec<Correction> {
        self.subtract.iter().copied().chain(self.center.then_some(Correction::Offset)).collect()
    }
}

/// A choice by its name.
pub(super) fn named<T: FromStr<Err = hysid::Error>>(name: &str) -> Result<T, String> {
    name.parse().map_err(|error: hysid::Error| error.to_string())
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| "a number above 0 is needed".into())
}

fn height(text: &str) -> Result<(f64, String), String> {
    let found = number_and_unit(text).filter(|(number, _)| *number > 0.0 && number.is_finite());
    let (number, unit) = found.ok_or("a number above 0 is needed, with or without a unit, such as 2.4m")?;
    Ok((number, unit.to_string()))
}

fn growth(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| SMOOTHING_GROWTHS.contains(number));
    number.ok_or_else(|| "a number from 0 to 1 is needed".into())
}

fn smoothing_factor(text: &str) -> Result<usize, String> {
    number_within(text, &SMOOTHING_FACTORS)
}

//! The command line.

mod model_options;

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgAction, Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use hysid::diagnosis::DiagnosisOptions;
use hysid::model::BAND_PROBABILITIES;
use hysid::options::ModelName;
use hysid::options::chosen::RateChoice;
use hysid::options::network::SEED;
use hysid::specimens::Specimen;

use crate::reproduction::Experiment;
pub use model_options::{ModelOptions, flag};

/// Identify hysteresis from measured input and output, simulate it and judge the model.
#[derive(Debug, Parser)]
#[command(name = "hysid", version, arg_required_else_help = true)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What stands for a number in the usage of an option.
const NUMBERS: [&str; 7] = ["N", "SHARE", "ROWS", "SECONDS", "FRACTION", "PROBABILITY", "PERCENT"];

impl Arguments {
    /// What was typed.
    ///
    /// # Errors
    /// A command line that cannot be obeyed, and requests for help.
    pub fn typed() -> Result<Self, clap::Error> {
        // What begins with a minus sign is the value of an option that takes a number, so that it is the option that
        // says what is wrong with it. Of other options, only a plain number is: a column may have that name.
        let takes_numbers = |option: clap::Arg| {
            let takes_value = matches!(option.get_action(), ArgAction::Set | ArgAction::Append);
            let names = option.get_value_names().unwrap_or_default();
            let is_number = names.iter().any(|name| NUMBERS.contains(&name.as_str()));
            match option.get_long() {
                Some(_) if is_number => option.allow_hyphen_values(true),
                Some(_) if takes_value => option.allow_negative_numbers(true),
                _ => option,
            }
        };
        let command = Self::command().mut_subcommands(|command| command.mut_args(takes_numbers));
        Self::from_arg_matches(&command.try_get_matches()?)
    }
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Identify a synthetic ferromagnet: data, model, report and what to type next
    Demo(Demo),
    /// Identify a model from measured data
    Fit(Box<Fit>),
    /// Simulate a model: writes the columns of the data and `<output>_model`
    Simulate(Simulate),
    /// Errors of a model's free run against measured data
    Evaluate(Evaluate),
    /// Cross-validate a model: its error on data that it was not fitted to, fold by fold
    Validate(Box<Validate>),
    /// Fit every model to the same data and compare them on data that none has seen
    Compare(Compare),
    /// What kind of hysteresis is this? Properties of measured data or of a model, each with its evidence
    Diagnose(Diagnose),
    /// Run the paper's experiments and compare the results with the paper's
    Reproduce(Reproduce),
    /// Write the data of a synthetic specimen, to train and to test on
    Generate(Generate),
    /// Measure the speed on this machine
    Bench(Bench),
}

/// Arguments of `demo`.
#[derive(Debug, Args)]
pub struct Demo {
    /// Folder for the data, the model and the report
    #[arg(short, long, value_name = "DIR", default_value = "hysid-demo")]
    pub out: PathBuf,
    /// Which files may be replaced.
    #[command(flatten)]
    pub overwriting: Overwriting,
}

/// Which files may be replaced.
#[derive(Debug, Clone, Args)]
pub struct Overwriting {
    /// Replace a file even if Hysid did not write it
    #[arg(long)]
    pub force: bool,
}

/// Which column is what.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Columns")]
pub struct ColumnOptions {
    /// Column that tells the records apart [default: `record` or `segment`, if there is one]
    #[arg(long, value_name = "COLUMN")]
    pub record: Option<String>,
    /// Time stamps [default: `t` or `time`, also with a unit as in `t_ms` or `Time (s)`]
    #[arg(long, value_name = "COLUMN")]
    pub time: Option<String>,
    /// An input; repeat for several [default: all columns that are nothing else]
    #[arg(long, value_name = "COLUMN")]
    pub input: Vec<String>,
    /// The output [default: the last column]
    #[arg(long, value_name = "COLUMN")]
    pub output: Option<String>,
    /// Rate of the first input: auto, none, central, backward, savitzky-golay or a column that holds it
    #[arg(long, value_name = "METHOD|COLUMN", default_value = "auto", value_parser = rate)]
    pub rate: RateOption,
}

/// How the units of a table and of a model are taken.
#[derive(Debug, Clone, Args)]
pub struct UnitOptions {
    /// Use the numbers unchanged, whatever units the column names state. Otherwise known units are
    /// converted to those of the model, and others that differ are refused
    #[arg(long, help_heading = "Columns")]
    pub same_units: bool,
}

/// What `--rate` asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RateOption {
    /// None, computed from the time stamps, or as suits the model.
    Choice(RateChoice),
    /// A column of this name.
    Column(String),
}

fn rate(text: &str) -> Result<RateOption, String> {
    Ok(match text {
        "auto" | "none" | "central" | "backward" | "savitzky-golay" => {
            RateOption::Choice(text.parse().map_err(|error: hysid::Error| error.to_string())?)
        }
        "" => return Err("a method or the name of a column is needed".into()),
        column => RateOption::Column(column.into()),
    })
}

const FIT_EXAMPLES: &str = "\
Examples:
  hysid fit data.csv                            model data.json and report data.html
  hysid fit data.csv --members 1                one small model in place of an ensemble
  hysid fit data.csv --model bouc-wen           one named model
  hysid fit a.csv b.csv --input i --output flux -o core.json
  hysid fit --help                              all options; docs/options.md lists them with their ranges";

/// The heading of options of a run, which do not change the model.
const RUN: &str = "Run";

/// Arguments of `fit`.
#[derive(Debug, Args)]
#[command(after_help = FIT_EXAMPLES)]
pub struct Fit {
    /// Tables of measured data: CSV with a header line
    #[arg(value_name = "TRAIN.csv", required = true)]
    pub train: Vec<PathBuf>,
    /// The model file; the report gets its name with `.html` [default: first TRAIN with `.json`, in this folder]
    #[arg(short, long, value_name = "MODEL.json")]
    pub out: Option<PathBuf>,
    /// Which files may be replaced.
    #[command(flatten)]
    pub overwriting: Overwriting,
    /// Which columns are what.
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// The model and its training.
    #[command(flatten)]
    pub model: ModelOptions,
    /// Stop the search after this time and keep the best model so far; reading and writing files is not counted
    #[arg(long, value_name = "SECONDS", value_parser = seconds, help_heading = RUN)]
    pub time_limit: Option<f64>,
    /// Store the state of the fit in this file, every few seconds and at the end; for a single network, such as
    /// --model xpnn+
    #[arg(long, value_name = "FILE", help_heading = RUN, hide_short_help = true)]
    pub checkpoint: Option<PathBuf>,
    /// Go on where this checkpoint left off, with the options it was made with; give the same tables and
    /// columns. It is kept up to date unless --checkpoint names another file
    #[arg(long, value_name = "FILE", help_heading = RUN, hide_short_help = true, conflicts_with_all = model_options::names())]
    pub resume: Option<PathBuf>,
    /// Threads to use; the model does not depend on it [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = RUN, hide_short_help = true)]
    pub threads: Option<u16>,
    /// Print the result as one JSON object
    #[arg(long, help_heading = RUN)]
    pub json: bool,
    /// Write no report
    #[arg(long, help_heading = RUN)]
    pub no_report: bool,
}

/// Arguments of `validate`.
#[derive(Debug, Args)]
pub struct Validate {
    /// Tables of measured data: CSV with a header line
    #[arg(value_name = "DATA.csv", required = true)]
    pub data: Vec<PathBuf>,
    /// Maximum number of folds that the records are divided into; a single record always gives five,
    /// cut in time
    #[arg(long, value_name = "N", default_value = "5", value_parser = folds)]
    pub folds: usize,
    /// Which columns are what.
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// The model and its training.
    #[command(flatten)]
    pub model: ModelOptions,
    /// Time for each fold, after which its best model so far is judged
    #[arg(long, value_name = "SECONDS", value_parser = seconds, help_heading = RUN)]
    pub time_limit: Option<f64>,
    /// Threads to use; the result does not depend on it [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = RUN, hide_short_help = true)]
    pub threads: Option<u16>,
    /// Print the result as one JSON object
    #[arg(long, help_heading = RUN)]
    pub json: bool,
}

fn model(name: &str) -> Result<ModelName, String> {
    name.parse().map_err(|error: hysid::Error| error.to_string())
}

fn number_within(text: &str, range: &RangeInclusive<usize>) -> Result<usize, String> {
    let (low, high) = (range.start(), range.end());
    let number: usize = text.parse().map_err(|_| format!("a whole number from {low} to {high} is needed"))?;
    if range.contains(&number) { Ok(number) } else { Err(format!("choose {low} to {high}")) }
}

/// A whole number without a bound above.
fn whole<N: FromStr>(text: &str) -> Result<N, String> {
    let is_below = text.strip_prefix('-').is_some_and(|number| number.parse::<N>().is_ok());
    let advice = if is_below { "choose 0 or more" } else { "a whole number, 0 or more, is needed" };
    text.parse().map_err(|_| advice.into())
}

fn folds(text: &str) -> Result<usize, String> {
    number_within(text, &(2..=1000))
}

fn fraction(text: &str) -> Result<f64, String> {
    let fraction = text.parse().ok().filter(|&fraction: &f64| fraction > 0.0 && fraction < 1.0);
    fraction.ok_or_else(|| "a number between 0 and 1 is needed".into())
}

fn probability(text: &str) -> Result<f64, String> {
    let probability = text.parse().ok().filter(|probability| BAND_PROBABILITIES.contains(probability));
    let (least, most) = (BAND_PROBABILITIES.start(), BAND_PROBABILITIES.end());
    probability.ok_or_else(|| format!("a probability from {least} to {most} is needed"))
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|&seconds: &f64| seconds > 0.0 && seconds < 1e9);
    seconds.ok_or_else(|| "a number of seconds above 0 is needed".into())
}

/// Arguments of `simulate`.
#[derive(Debug, Args)]
pub struct Simulate {
    /// A model file of `hysid fit`
    #[arg(value_name = "MODEL.json")]
    pub model: PathBuf,
    /// Table with the model's inputs; the output may be missing
    #[arg(value_name = "DATA.csv")]
    pub data: PathBuf,
    /// Where to write [default: stdout, as with `-`]
    #[arg(short, long, value_name = "OUT.csv")]
    pub out: Option<PathBuf>,
    /// Which files may be replaced.
    #[command(flatten)]
    pub overwriting: Overwriting,
    /// Two further columns, `<output>_low` and `<output>_high`: between them lies the measured output with this
    /// probability, such as 0.9, as far as the data are like those that were held out in training
    #[arg(long, value_name = "PROBABILITY", value_parser = probability)]
    pub band: Option<f64>,
    /// Which columns are what.
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// Which units are the same.
    #[command(flatten)]
    pub units: UnitOptions,
}

/// Arguments of `evaluate`.
#[derive(Debug, Args)]
pub struct Evaluate {
    /// A model file of `hysid fit`
    #[arg(value_name = "MODEL.json")]
    pub model: PathBuf,
    /// Table with the model's inputs and the measured output
    #[arg(value_name = "DATA.csv")]
    pub data: PathBuf,
    /// Tell how many of the measured outputs lie within the model's band of this probability, such as 0.9
    #[arg(long, value_name = "PROBABILITY", value_parser = probability)]
    pub band: Option<f64>,
    /// Which columns are what.
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// Which units are the same.
    #[command(flatten)]
    pub units: UnitOptions,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `compare`.
#[derive(Debug, Args)]
pub struct Compare {
    /// Tables of measured data to fit to: CSV with a header line
    #[arg(value_name = "TRAIN.csv", required = true)]
    pub train: Vec<PathBuf>,
    /// Table of measured data that no model sees; without it, errors are those of the training
    #[arg(long, value_name = "TEST.csv")]
    pub test: Option<PathBuf>,
    /// Models to compare, such as auto,xpnn,preisach, each in all its variants [default: auto and all others]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = model)]
    pub models: Vec<ModelName>,
    /// The page with table and loops [default: first TRAIN with `-compared.html`, in this folder]
    #[arg(short, long, value_name = "PAGE.html")]
    pub out: Option<PathBuf>,
    /// Which files may be replaced.
    #[command(flatten)]
    pub overwriting: Overwriting,
    /// Which columns are what.
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// Time for each model, after which its search ends with what it has [default: 20, and none for auto]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time_limit: Option<f64>,
    /// Seed of all randomness
    #[arg(long, value_name = "N", default_value_t = SEED, value_parser = whole::<u64>)]
    pub seed: u64,
    /// Models fitted at a time, each on one thread [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print the result as a list of JSON objects
    #[arg(long)]
    pub json: bool,
    /// Write no page
    #[arg(long)]
    pub no_report: bool,
}

/// Arguments of `diagnose`.
#[derive(Debug, Args)]
pub struct Diagnose {
    /// Tables of measured data, CSV with a header line; or one model file of `hysid fit`
    #[arg(value_name = "DATA.csv|MODEL.json", required = true)]
    pub files: Vec<PathBuf>,
    /// The page with pictures [default: first file with `.diagnosis.html`, in this folder]
    #[arg(short, long, value_name = "PAGE.html")]
    pub out: Option<PathBuf>,
    /// Which files may be replaced.
    #[command(flatten)]
    pub overwriting: Overwriting,
    /// Which columns are what.
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// Reversals of the input below this share of its range are no turning points
    #[arg(long, value_name = "FRACTION", default_value_t = DiagnosisOptions::default().smallest_reversal, value_parser = fraction)]
    pub smallest_reversal: f64,
    /// Smooth noise out of branches before they are compared: true or false
    #[arg(long, value_name = "BOOL", default_value_t = DiagnosisOptions::default().smoothing, action = ArgAction::Set)]
    pub smoothing: bool,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
    /// Write no page
    #[arg(long)]
    pub no_report: bool,
}

impl Diagnose {
    /// What the library is asked for.
    pub fn options(&self) -> DiagnosisOptions {
        DiagnosisOptions { smallest_reversal: self.smallest_reversal, smoothing: self.smoothing }
    }
}

/// Arguments of `reproduce`.
#[derive(Debug, Args)]
pub struct Reproduce {
    /// What to run: nds, example1 to example7, table2, training [default: all, and a page of all]
    #[arg(value_name = "EXPERIMENT", value_parser = experiment())]
    pub experiments: Vec<Experiment>,
    /// Folder for pages and tables; an experiment that was finished there with the same seed, version and
    /// --quick is not run again
    #[arg(short, long, value_name = "DIR", default_value = "hysid-reproduction")]
    pub out: PathBuf,
    /// Which files may be replaced.
    #[command(flatten)]
    pub overwriting: Overwriting,
    /// A fraction of the effort, to see how it looks
    #[arg(long)]
    pub quick: bool,
    /// Seed of all randomness; of several repetitions that of the first
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole::<u64>)]
    pub seed: u64,
}

fn experiment() -> impl TypedValueParser<Value = Experiment> {
    let names = Experiment::all().map(Experiment::name);
    PossibleValuesParser::new(names).map(|name| Experiment::named(&name).expect("one of the possible values"))
}

/// Arguments of `generate`.
#[derive(Debug, Args)]
pub struct Generate {
    /// Which specimen; --list describes them
    #[arg(value_name = "SPECIMEN", value_parser = specimen())]
    pub specimen: Option<&'static Specimen>,
    /// Where to write the training data [default: stdout, as with `-`; not written if only --test is given]
    #[arg(short, long, value_name = "TRAIN.csv")]
    pub out: Option<PathBuf>,
    /// Where to write the test data [default: not written; `-` is stdout]
    #[arg(long, value_name = "TEST.csv")]
    pub test: Option<PathBuf>,
    /// Which files may be replaced.
    #[command(flatten)]
    pub overwriting: Overwriting,
    /// Deviation of Gaussian noise on the output, in percent of the output's own standard deviation
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = noise)]
    pub noise: f64,
    /// Seed of the noise; training and test data get different noise from the same seed
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole::<u64>)]
    pub seed: u64,
    /// Describe all specimens
    #[arg(long, conflicts_with_all = ["specimen", "out", "test", "noise", "seed"])]
    pub list: bool,
    /// With --list: print a list of JSON objects
    #[arg(long, requires = "list")]
    pub json: bool,
}

fn specimen() -> impl TypedValueParser<Value = &'static Specimen> {
    let names = Specimen::all().iter().map(|specimen| specimen.name);
    PossibleValuesParser::new(names).map(|name| Specimen::named(&name).expect("one of the possible values"))
}

fn noise(text: &str) -> Result<f64, String> {
    let percent = text.parse().ok().filter(|percent: &f64| (0.0..1e9).contains(percent));
    percent.ok_or_else(|| "a number of percent, 0 or more, is needed".into())
}

/// Arguments of `bench`.
#[derive(Debug, Args)]
pub struct Bench {
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        Arguments::command().debug_assert();
    }
}

//! The command line.

/// The address of a page of the documentation: an installed program has no files of it.
macro_rules! page {
    ($name:literal) => {
        concat!(env!("CARGO_PKG_REPOSITORY"), "/blob/main/docs/", $name)
    };
}

mod cycles;
mod examples;
mod known_beginning;
mod limits;
mod model_options;
mod plan;
mod plot;
mod program;
mod program_help;
mod reading;
mod restoring_force;
mod studio;

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgAction, Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use hysid::Model;
use hysid::data::initial_state::InitialState;
use hysid::data::known_beginning::KnownSpan;
use hysid::diagnosis::DiagnosisOptions;
use hysid::model::{BAND_OF_TEN, BAND_PROBABILITIES, BandLevel};
use hysid::options::ModelName;
use hysid::options::network::SEED;
use hysid::specimens::Specimen;
use hysid_core::options::effort::Effort;
use hysid_export::Target;
use hysid_records::ColumnChoice;
pub use hysid_records::RateOption;

use crate::reproduction::Experiment;
pub use cycles::Cycles;
use examples::*;
pub use known_beginning::KnownOptions;
pub use model_options::ModelOptions;
pub use plan::Plan;
pub use plot::{Plot, PlotKind};
pub use program::{Completions, Man, Models};
pub use reading::ReadingOptions;
pub use restoring_force::RestoringForce;
pub use studio::Studio;

/// Identify models of hysteresis from measured input and output, simulate and evaluate them.
#[derive(Debug, Parser)]
#[command(name = "hysid", version, arg_required_else_help = true, max_term_width = 80)]
pub struct Arguments {
    /// Print only warnings and errors on stderr
    ///
    /// Leaves out the summary of the data, progress and the names of written files. Results on stdout stay, and
    /// so do the lines after Ctrl-C.
    #[arg(short, long, global = true, display_order = 1000)]
    pub quiet: bool,
    /// Command to run.
    #[command(subcommand)]
    pub command: Command,
}

/// Placeholders of numbers in the usage of an option.
const NUMBERS: &str = "N SHARE ROWS SECONDS FRACTION PROBABILITY PERCENT LOW:HIGH RATE TIME MM POINTS \
                       MASS";

impl Arguments {
    /// Parses the command line of the process.
    pub fn typed() -> Result<Self, clap::Error> {
        // What begins with a minus sign is the value of an option that takes a number, so that it is the option that
        // says what is wrong with it. Of other options, only a plain number is: a column may have that name.
        let takes_numbers = |option: clap::Arg| {
            let takes_value = matches!(option.get_action(), ArgAction::Set | ArgAction::Append);
            let names = option.get_value_names().unwrap_or_default();
            let is_number = names.iter().any(|name| NUMBERS.split(' ').any(|number| number == name));
            match option.get_long() {
                Some(_) if is_number => option.allow_hyphen_values(true),
                Some(_) if takes_value => option.allow_negative_numbers(true),
                _ => option,
            }
        };
        let command = Self::whole().mut_subcommands(|command| command.mut_args(takes_numbers));
        let words = program_help::in_one_word(std::env::args_os());
        Self::from_arg_matches(&command.try_get_matches_from(words)?)
    }

    /// The definition of the whole command line.
    pub fn whole() -> clap::Command {
        program_help::with_help(Self::command())
    }
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Fit a model to a synthetic ferromagnet: writes data, model and report
    Demo(Demo),
    /// Identify a model from measured data
    Fit(Box<Fit>),
    /// Simulate a model; adds the column `<output>_model` to the data
    Simulate(Simulate),
    /// Compute the errors of a model on measured data
    Evaluate(Evaluate),
    /// Find the input that drives a model along a wanted output
    Invert(Box<Invert>),
    /// Cross-validate a model; gives its errors on held-out data, fold by fold
    Validate(Box<Validate>),
    /// Fit all models to the same data and compare errors, on test data if given
    Compare(Compare),
    /// Show how tables are read: columns, units, ranges, missing values
    Look(Look),
    /// Determine properties of hysteresis, from measured data or of a model
    Diagnose(Diagnose),
    /// Tabulate each cycle: energy, damping, coercive field, losses, width, creep
    Cycles(Cycles),
    /// Compute the restoring force of an element from measured motion and force
    RestoringForce(Box<RestoringForce>),
    /// Draw a figure for a paper: loops, histories, errors, cycles, backbone, energy
    Plot(Box<Plot>),
    /// Fit and judge models in the browser; everything runs on this machine
    Studio(Studio),
    /// Plan the next test: its input, with a reason for each segment
    Plan(Box<Plan>),
    /// Run the paper's experiments and compare the results with the paper
    Reproduce(Reproduce),
    /// Write training and test data of a synthetic specimen
    Generate(Generate),
    /// Write a model as source code for other programs, with tests and test vectors
    Export(Export),
    /// List all models, or show what a model file holds
    Models(Models),
    /// Print a script by which a shell completes commands and options
    Completions(Completions),
    /// Write manual pages
    Man(Man),
}

#[derive(Debug, Args)]
#[command(after_help = DEMO_EXAMPLES)]
pub struct Demo {
    /// Folder for the data, the model and the report
    #[arg(short, long, value_name = "DIR", default_value = "hysid-demo")]
    pub out: PathBuf,
    #[command(flatten)]
    pub overwriting: Overwriting,
}

/// Which files may be replaced.
#[derive(Debug, Clone, Args)]
pub struct Overwriting {
    /// Replace also files that Hysid did not write
    ///
    /// Each of them is kept as `NAME.bak`, or as `NAME.bak2` and so on if that name exists.
    #[arg(long)]
    pub force: bool,
}

/// Which column is what.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Columns")]
pub struct ColumnOptions {
    /// Record of each row [default: a column `record`]
    ///
    /// A column with the name of the record; the rows of a record must follow each other. Without such a column, a record is a
    /// table, or a part of it where the time begins again or a condition of the test changes.
    #[arg(long, value_name = "COLUMN")]
    pub record: Option<String>,
    /// Time stamps, or none [default: detected]
    ///
    /// `--time none` uses no column as time.
    #[arg(long, value_name = "COLUMN")]
    pub time: Option<String>,
    /// Input; repeat for several [default: from names]
    #[arg(long, value_name = "COLUMN")]
    pub input: Vec<String>,
    /// Output [default: the last column that may be one]
    #[arg(long, value_name = "COLUMN")]
    pub output: Option<String>,
    /// Rate of the first input: auto, none, central, backward, savitzky-golay or a column with the rate
    #[arg(long, value_name = "METHOD|COLUMN", default_value = "auto", value_parser = rate, hide_short_help = true)]
    pub rate: RateOption,
    #[command(flatten)]
    pub reading: ReadingOptions,
}

impl ColumnOptions {
    pub fn choice(&self) -> ColumnChoice {
        let Self { record, time, input, output, rate, .. } = self.clone();
        ColumnChoice { record, time, input, output, rate }
    }

    /// The options on columns that are given, and those of `further` that are, by their names.
    pub fn given(&self, further: &[(&'static str, bool)]) -> Vec<&'static str> {
        let own = [
            ("--record", self.record.is_some()),
            ("--time", self.time.is_some()),
            ("--input", !self.input.is_empty()),
            ("--output", self.output.is_some()),
            ("--rate", self.rate != RateOption::default()),
        ];
        own.iter().chain(further).filter(|(_, is_given)| *is_given).map(|(option, _)| *option).collect()
    }
}

/// In how many data sets a band is to contain its share of the rows.
#[derive(Debug, Clone, Args)]
pub struct DataSetsOptions {
    /// With --band: the band contains that share in K of 10 data sets
    ///
    /// In K of ten new data sets, at least the share of `--band` lies within the band. 5-of-10 gives the narrowest band;
    /// 9-of-10 one about twice as wide.
    #[arg(long = "in", id = "of_ten", value_name = "K-of-10", default_value = "5-of-10", value_parser = of_ten, requires = "band")]
    pub of_ten: usize,
}

impl DataSetsOptions {
    pub fn level(&self, probability: Option<f64>) -> Option<BandLevel> {
        probability.map(|probability| BandLevel { probability, of_ten: self.of_ten })
    }
}

fn of_ten(text: &str) -> Result<usize, String> {
    let count = text.strip_suffix("-of-10").and_then(|count| count.parse().ok());
    let (least, most) = (BAND_OF_TEN.start(), BAND_OF_TEN.end());
    let advice = || format!("choose {least}-of-10 to {most}-of-10");
    count.filter(|count| BAND_OF_TEN.contains(count)).ok_or_else(advice)
}

/// In which state the memory of a model is at the beginning of each record.
#[derive(Debug, Clone, Args)]
pub struct BeginningOptions {
    /// State of the memory at the beginning of each record [default: as trained]
    ///
    /// One of virgin, saturated-up (after a visit of the upper end of the trained input range), saturated-down,
    /// demagnetised and periodic (after one period of the record itself). The default is the state of most training records;
    /// with free states, their mean.
    #[arg(long, value_name = "NAME", value_parser = known_state)]
    pub initial_state: Option<InitialState>,
}

impl BeginningOptions {
    /// The model with this initial state.
    pub fn of(&self, model: Model) -> hysid::Result<Model> {
        match self.initial_state {
            Some(state) => model.with_initial_state(state),
            None => Ok(model),
        }
    }
}

fn known_state(name: &str) -> Result<InitialState, String> {
    let state: Result<InitialState, hysid::Error> = name.parse();
    let advice = || format!("choose one of {}", InitialState::known().join(", "));
    match state {
        Ok(InitialState::Unknown) => Err(format!("{}: only a fit finds an unknown state", advice())),
        Ok(InitialState::Free) => Err(format!("{}; for free states, --known", advice())),
        Ok(state) => Ok(state),
        Err(_) => Err(advice()),
    }
}

/// How the units of a table and of a model are taken.
#[derive(Debug, Clone, Args)]
pub struct UnitOptions {
    /// Do not convert units
    ///
    /// Otherwise, units in column names are converted to those of the model, and a conversion that is not known is an
    /// error.
    #[arg(long, help_heading = "Columns")]
    pub same_units: bool,
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

/// The heading of options of a run, which do not change the model.
const RUN: &str = "Run";

#[derive(Debug, Args)]
#[command(after_help = FIT_EXAMPLES)]
pub struct Fit {
    /// Tables of measured data: text, spreadsheets, MATLAB files
    #[arg(value_name = "TRAIN.csv", required = true)]
    pub train: Vec<PathBuf>,
    /// Model file [default: name of TRAIN with `.json`]
    ///
    /// The default is in the current folder and named after the first table. The report has the same name with `.html`.
    #[arg(short, long, value_name = "MODEL.json")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub overwriting: Overwriting,
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// Fit an inverse model: the first input and the output are exchanged
    ///
    /// `hysid simulate` with this model computes the input for a wanted output. Rows without output before the first and
    /// after the last one are left out. See also `hysid invert`, which inverts a model of the system itself.
    #[arg(long, help_heading = "Columns", hide_short_help = true)]
    pub inverse: bool,
    #[command(flatten)]
    pub model: ModelOptions,
    /// Stop after this time with the best model so far
    ///
    /// The time for reading and writing files is not counted.
    #[arg(long, value_name = "SECONDS", value_parser = seconds, help_heading = RUN)]
    pub time_limit: Option<f64>,
    /// Save the state of the fit in this file every few seconds and at the end; for a single network, such as
    /// --model xpnn+
    #[arg(long, value_name = "FILE", help_heading = RUN, hide_short_help = true)]
    pub checkpoint: Option<PathBuf>,
    /// Resume the fit of this checkpoint with the same options; give the same tables and columns. The checkpoint
    /// is updated unless --checkpoint names another file
    #[arg(long, value_name = "FILE", help_heading = RUN, hide_short_help = true, conflicts_with_all = model_options::names())]
    pub resume: Option<PathBuf>,
    /// Number of threads; the model does not depend on it [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = RUN, hide_short_help = true)]
    pub threads: Option<u16>,
    /// Print the result as one JSON object
    #[arg(long, help_heading = RUN)]
    pub json: bool,
    /// Write no report
    #[arg(long, help_heading = RUN)]
    pub no_report: bool,
    /// Title of the report [default: the quantities and the model]
    #[arg(long, value_name = "TEXT", help_heading = RUN, hide_short_help = true, conflicts_with = "no_report")]
    pub title: Option<String>,
}

#[derive(Debug, Args)]
#[command(after_help = VALIDATE_EXAMPLES)]
pub struct Validate {
    /// Tables of measured data: text, spreadsheets, MATLAB files
    #[arg(value_name = "DATA.csv", required = true)]
    pub data: Vec<PathBuf>,
    /// Largest number of folds, if there are several records
    ///
    /// A single record always gives five folds, cut in time.
    #[arg(long, value_name = "N", default_value = "5", value_parser = folds)]
    pub folds: usize,
    #[command(flatten)]
    pub columns: ColumnOptions,
    #[command(flatten)]
    pub model: ModelOptions,
    /// Time for each fold, after which its best model so far is evaluated
    #[arg(long, value_name = "SECONDS", value_parser = seconds, help_heading = RUN)]
    pub time_limit: Option<f64>,
    /// Number of threads; the result does not depend on it [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = RUN, hide_short_help = true)]
    pub threads: Option<u16>,
    /// Print the result as one JSON object
    #[arg(long, help_heading = RUN)]
    pub json: bool,
}

fn model(name: &str) -> Result<ModelName, String> {
    name.parse().map_err(|error: hysid::Error| error.to_string())
}

fn effort(name: &str) -> Result<Effort, String> {
    name.parse().map_err(|_: hysid::Error| "choose quick, normal or thorough".into())
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
    let seconds = text.parse().unwrap_or(f64::NAN);
    hysid::time_limit(seconds).map(|_| seconds).map_err(String::from)
}

#[derive(Debug, Args)]
#[command(after_help = SIMULATE_EXAMPLES)]
pub struct Simulate {
    /// A model file of `hysid fit`
    #[arg(value_name = "MODEL.json")]
    pub model: PathBuf,
    /// Table with the inputs of the model; the output is not needed
    #[arg(value_name = "DATA.csv")]
    pub data: PathBuf,
    /// Table to write [default: stdout, as with `-`]
    #[arg(short, long, value_name = "OUT.csv")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub overwriting: Overwriting,
    /// Add a prediction band of this probability, such as 0.9
    ///
    /// The columns `<output>_low` and `<output>_high` are its edges. The band contains this share of the measured
    /// outputs on average over data sets that resemble those of the training; in one of them it may be less.
    #[arg(long, value_name = "PROBABILITY", value_parser = probability)]
    pub band: Option<f64>,
    #[command(flatten)]
    pub data_sets: DataSetsOptions,
    #[command(flatten)]
    pub beginning: BeginningOptions,
    #[command(flatten)]
    pub known: KnownOptions,
    #[command(flatten)]
    pub columns: ColumnOptions,
    #[command(flatten)]
    pub units: UnitOptions,
}

#[derive(Debug, Args)]
#[command(after_help = INVERT_EXAMPLES)]
pub struct Invert {
    /// A model file of `hysid fit`
    #[arg(value_name = "MODEL.json")]
    pub model: PathBuf,
    /// Table with the wanted output, and with time and further inputs if the model has them
    #[arg(value_name = "REFERENCE.csv")]
    pub reference: PathBuf,
    /// Table to write [default: stdout, as with `-`]
    ///
    /// It has the columns of the reference, the input that was found, `<output>_reached`, the output of the model, and the
    /// columns `reach` and `extrapolated`. A report with the same name and `.html` is written beside it.
    #[arg(short, long, value_name = "DRIVE.csv")]
    pub out: Option<PathBuf>,
    /// Do not write a report
    #[arg(long)]
    pub no_report: bool,
    #[command(flatten)]
    pub overwriting: Overwriting,
    /// Lowest and highest input, such as 0:150 or -1:1 [default: the trained range]
    #[arg(long, value_name = "LOW:HIGH", value_parser = limits::limits)]
    pub limits: Option<(f64, f64)>,
    /// Largest change of the input in a unit of time [default: unlimited]
    #[arg(long, value_name = "RATE", value_parser = limits::slew)]
    pub slew: Option<f64>,
    /// Time by which the search looks ahead in the reference, in the unit of time; 0 for not at all [default: auto]
    ///
    /// It matters for models whose output lags behind the input. `auto` finds the time with which the model follows the
    /// reference best.
    #[arg(long, value_name = "TIME", default_value = "auto", value_parser = limits::preview, hide_default_value = true, hide_short_help = true)]
    pub preview: hysid_app::inversion::Preview,
    /// Add the inputs whose band of this probability, such as 0.9, contains the wanted output
    ///
    /// The columns with `_low` and `_high` behind the name of the drive are the lowest and the highest of them.
    #[arg(long, value_name = "PROBABILITY", value_parser = probability)]
    pub band: Option<f64>,
    #[command(flatten)]
    pub data_sets: DataSetsOptions,
    #[command(flatten)]
    pub beginning: BeginningOptions,
    #[command(flatten)]
    pub columns: ColumnOptions,
    #[command(flatten)]
    pub units: UnitOptions,
    /// Print the result as one JSON object
    #[arg(long, help_heading = RUN)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = EVALUATE_EXAMPLES)]
pub struct Evaluate {
    /// A model file of `hysid fit`
    #[arg(value_name = "MODEL.json")]
    pub model: PathBuf,
    /// Tables with the inputs of the model and the measured output; each is evaluated by itself
    #[arg(value_name = "DATA.csv", required = true)]
    pub data: Vec<PathBuf>,
    /// Print the share of measured outputs within the prediction band of this probability, such as 0.9
    #[arg(long, value_name = "PROBABILITY", value_parser = probability)]
    pub band: Option<f64>,
    #[command(flatten)]
    pub data_sets: DataSetsOptions,
    /// Test whether the error depends on the input, its rate, the amplitude, the direction or time
    ///
    /// Says for each test what was found and what helps. The rows are kept in memory.
    #[arg(long)]
    pub residuals: bool,
    #[command(flatten)]
    pub beginning: BeginningOptions,
    #[command(flatten)]
    pub known: KnownOptions,
    #[command(flatten)]
    pub columns: ColumnOptions,
    #[command(flatten)]
    pub units: UnitOptions,
    /// Print the result as one JSON object
    #[arg(long, help_heading = RUN)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = COMPARE_EXAMPLES)]
pub struct Compare {
    /// Tables of training data: text, spreadsheets, MATLAB files
    #[arg(value_name = "TRAIN.csv", required = true)]
    pub train: Vec<PathBuf>,
    /// Table of test data [default: the training data]
    #[arg(long, value_name = "TEST.csv")]
    pub test: Option<PathBuf>,
    /// Models to compare, such as auto,xpnn,preisach; each in all its variants [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = model)]
    pub models: Vec<ModelName>,
    /// Page with table and loops [default: name of TRAIN with `-compared.html`]
    ///
    /// The default is in the current folder and named after the first table.
    #[arg(short, long, value_name = "PAGE.html")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub overwriting: Overwriting,
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// Measured beginning of each record, from which each model finds its state
    ///
    /// A number of rows, such as 100, or a time with its unit, such as 0.5s. Errors are those after it. `auto` also tries free
    /// initial states.
    #[arg(long, value_name = "ROWS|TIME", value_parser = KnownSpan::from_str)]
    pub known: Option<KnownSpan>,
    /// Search of auto: quick, normal, thorough [default: normal]
    #[arg(long, value_name = "EFFORT", value_parser = effort, help_heading = RUN)]
    pub effort: Option<Effort>,
    /// Time for each model, after which its best fit so far is used [default: 20, none for auto]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, help_heading = RUN)]
    pub time_limit: Option<f64>,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = SEED, value_parser = whole::<u64>, help_heading = RUN)]
    pub seed: u64,
    /// Number of models fitted at the same time; fewer models share the threads [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = RUN, hide_short_help = true)]
    pub threads: Option<u16>,
    /// Print the result as a list of JSON objects
    #[arg(long, help_heading = RUN)]
    pub json: bool,
    /// Write no report page
    #[arg(long, help_heading = RUN)]
    pub no_report: bool,
}

#[derive(Debug, Args)]
#[command(after_help = LOOK_EXAMPLES)]
pub struct Look {
    /// Tables: text, spreadsheets, MATLAB files, compressed or not; - is standard input
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Join the columns of the files, row by row, into one table: input and output of one test in two files
    #[arg(long)]
    pub join: bool,
    /// Write the columns that are used as a plain CSV table; - is standard output
    #[arg(short, long, value_name = "CLEAN.csv")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub overwriting: Overwriting,
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// Print the result as one JSON object
    #[arg(long, help_heading = RUN)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = DIAGNOSE_EXAMPLES)]
pub struct Diagnose {
    /// Tables of measured data (text, spreadsheets, MATLAB files), or one model file
    #[arg(value_name = "DATA.csv|MODEL.json", required = true)]
    pub files: Vec<PathBuf>,
    /// Page with plots [default: name of the file with `.diagnosis.html`]
    ///
    /// The default is in the current folder and named after the first file.
    #[arg(short, long, value_name = "PAGE.html")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub overwriting: Overwriting,
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// Ignore reversals of the input below this share of its range
    #[arg(long, value_name = "FRACTION", default_value_t = DiagnosisOptions::default().smallest_reversal, value_parser = fraction, help_heading = "Method", hide_short_help = true)]
    pub smallest_reversal: f64,
    /// Smooth branches before they are compared
    #[arg(long, value_name = "BOOL", default_value_t = DiagnosisOptions::default().smoothing, action = ArgAction::Set, help_heading = "Method", hide_short_help = true)]
    pub smoothing: bool,
    /// Print the result as one JSON object
    #[arg(long, help_heading = RUN)]
    pub json: bool,
    /// Write no report page
    #[arg(long, help_heading = RUN)]
    pub no_report: bool,
}

impl Diagnose {
    /// Options of the library.
    pub fn options(&self) -> DiagnosisOptions {
        DiagnosisOptions { smallest_reversal: self.smallest_reversal, smoothing: self.smoothing }
    }
}

#[derive(Debug, Args)]
#[command(after_help = REPRODUCE_EXAMPLES)]
pub struct Reproduce {
    /// Experiments to run [default: all]
    #[arg(value_name = "EXPERIMENT", value_parser = experiment())]
    pub experiments: Vec<Experiment>,
    /// Folder for pages and tables
    #[arg(short, long, value_name = "DIR", default_value = "hysid-reproduction")]
    pub out: PathBuf,
    #[command(flatten)]
    pub overwriting: Overwriting,
    /// Run with a fraction of the effort; results are worse
    #[arg(long)]
    pub quick: bool,
    /// Seed of all random numbers; with several repetitions, that of the first
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole::<u64>)]
    pub seed: u64,
}

fn experiment() -> impl TypedValueParser<Value = Experiment> {
    let names = Experiment::all().map(Experiment::name);
    PossibleValuesParser::new(names).map(|name| Experiment::named(&name).expect("one of the possible values"))
}

#[derive(Debug, Args)]
#[command(after_help = GENERATE_EXAMPLES)]
pub struct Generate {
    /// Specimen; --list describes all
    #[arg(value_name = "SPECIMEN", value_parser = specimen())]
    pub specimen: Option<&'static Specimen>,
    /// Table of training data [default: stdout, as with `-`; none if only --test is given]
    #[arg(short, long, value_name = "TRAIN.csv")]
    pub out: Option<PathBuf>,
    /// Table of test data; `-` is stdout [default: none]
    #[arg(long, value_name = "TEST.csv")]
    pub test: Option<PathBuf>,
    #[command(flatten)]
    pub overwriting: Overwriting,
    /// Standard deviation of Gaussian noise on the output, in percent of that of the output
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = noise)]
    pub noise: f64,
    /// Seed of the noise and of random excitations; training and test data get different ones
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

#[derive(Debug, Args)]
#[command(after_help = EXPORT_EXAMPLES)]
pub struct Export {
    /// Model file
    #[arg(value_name = "MODEL.json")]
    pub model: PathBuf,
    /// Where the model is to run
    #[arg(long, value_name = "TARGET", value_parser = target())]
    pub to: Target,
    /// Folder of the export, which appears whole or not at all [default: NAME_TARGET]
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Identifier with which all names of the export begin [default: that of the model file]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// Precision of the arithmetic: f64 or f32
    #[arg(long, value_name = "f64|f32", default_value = "f64", value_parser = ["f64", "f32"], hide_possible_values = true)]
    pub precision: String,
    /// How the model gets the rate of its first input: backward or argument
    ///
    /// By backward differences of the input, from the time step; or as an argument of each step. A model without rate
    /// ignores it.
    #[arg(long, value_name = "SOURCE", default_value = "backward", value_parser = ["backward", "argument"], hide_possible_values = true)]
    pub rate: String,
    /// Also compute half the width of the prediction band that contains this share of the rows (0.5 to 0.99)
    #[arg(long, value_name = "SHARE")]
    pub band: Option<f64>,
    #[command(flatten)]
    pub data_sets: DataSetsOptions,
    /// Version of the Functional Mock-up Interface of `--to fmu`: 3 or 2 [default: 3]
    #[arg(long, value_name = "3|2", value_parser = ["3", "2"], hide_possible_values = true)]
    pub fmi: Option<String>,
    /// Also export the inverse, which gives the input for a wanted output (c, fmu)
    ///
    /// With `--to fmu`, the FMU contains only the inverse. Its inputs are the wanted output and the further inputs of the
    /// model. Its outputs are the first input of the model, the output of the model, and whether the wanted output is
    /// reached.
    #[arg(long)]
    pub inverse: bool,
    /// Lowest and highest input that the inverse gives [default: trained range]
    #[arg(long, value_name = "LOW:HIGH", value_parser = limits::limits)]
    pub limits: Option<(f64, f64)>,
    /// Largest change in a unit of time of the input that the inverse gives [default: unlimited]
    ///
    /// The unit of time is that of the training data. The first sample is free. A step of the inverse in C then takes
    /// the time step, even if the model does not need it.
    #[arg(long, value_name = "RATE", value_parser = limits::slew)]
    pub slew: Option<f64>,
    #[command(flatten)]
    pub overwriting: Overwriting,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
}

fn target() -> impl TypedValueParser<Value = Target> {
    let names = Target::ALL.map(Target::name);
    PossibleValuesParser::new(names).map(|name| Target::named(&name).expect("one of the possible values"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        Arguments::whole().debug_assert();
    }

    #[test]
    fn the_short_help_of_a_command_fits_on_a_screen_and_has_examples() {
        const LINES: usize = 40;
        const COLUMNS: usize = 80;
        for command in Arguments::whole().get_subcommands() {
            let name = command.get_name().to_string();
            let typed = ["hysid", &name, "--help"];
            let help =
                Arguments::whole().try_get_matches_from(typed).expect_err("a request for help").to_string();
            assert!(help.contains("\nExamples:\n"), "{name} has no examples:\n{help}");
            assert!(help.lines().count() <= LINES, "{name} has {} lines:\n{help}", help.lines().count());
            let widest = help.lines().map(|line| line.chars().count()).max().unwrap_or(0);
            assert!(widest <= COLUMNS, "{name} has a line of {widest} columns:\n{help}");
        }
    }
}

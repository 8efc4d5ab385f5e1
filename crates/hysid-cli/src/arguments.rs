//! The command line. Every option of a model and its training has the name of its field in the library's
//! `ChosenOptions`.

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgAction, Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use hysid::diagnosis::DiagnosisOptions;
use hysid::model::BAND_PROBABILITIES;
use hysid::options::ModelName;
use hysid::options::auto::MOST_MEMBERS;
use hysid::options::chosen::{ChosenOptions, NEURONS, RateChoice, STARTS};
use hysid::options::classical::Sign;
use hysid::options::network::PENALTIES;
use hysid::options::network::POPULATIONS;
use hysid::options::network::{FitOptions, Trainer};
use hysid::plant::Specimen;

use crate::reproduction::Experiment;

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

/// Arguments of `fit`.
#[derive(Debug, Args)]
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
    pub training: TrainingOptions,
    /// What can be chosen of models that are no networks.
    #[command(flatten)]
    pub rival: RivalOptions,
    /// Stop the search after this time and keep the best model so far; reading and writing files is not counted
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time_limit: Option<f64>,
    /// Store the state of the fit in this file, every few seconds and at the end; for a single network, such as
    /// --model xpnn+
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Go on where this checkpoint left off, with the options it was made with; give the same tables and
    /// columns. It is kept up to date unless --checkpoint names another file
    #[arg(long, value_name = "FILE", conflicts_with_all = ["TrainingOptions", "RivalOptions"])]
    pub resume: Option<PathBuf>,
    /// Threads to use; the model does not depend on it [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
    /// Write no report
    #[arg(long)]
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
    pub training: TrainingOptions,
    /// What can be chosen of models that are no networks.
    #[command(flatten)]
    pub rival: RivalOptions,
    /// Time for each fold, after which its best model so far is judged
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time_limit: Option<f64>,
    /// Threads to use; the result does not depend on it [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// How a model is trained.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Model and training")]
pub struct TrainingOptions {
    /// auto: cross-validates all models and combines the best; or a network (pnn, gpnn, preisach-nn,
    /// xpnn, also epnn, or xpnn+), or another model: see `hysid compare`
    #[arg(long, value_name = "MODEL", default_value = "auto", value_parser = model)]
    pub model: ModelName,
    /// Maximum ensemble size; 1 gives a single small model. With a named model, the number of random
    /// starts that are combined [default: 32 for auto, otherwise 1]
    #[arg(long, value_name = "N", value_parser = members)]
    pub members: Option<usize>,
    /// Stop neurons of a network [default: 10]
    #[arg(long, value_name = "N", value_parser = neurons)]
    pub stops: Option<usize>,
    /// Tanh neurons, for models that have them [default: 10; neuro-madelung 8, random-stops none]
    #[arg(long, value_name = "N", value_parser = neurons)]
    pub hidden: Option<usize>,
    /// Relaxation neurons of each input, for xpnn+ with time stamps; 0 for none [default: 4]
    #[arg(long, value_name = "N", value_parser = whole::<usize>)]
    pub relaxation: Option<usize>,
    /// Stops do not deteriorate, whatever the family
    #[arg(long)]
    pub no_deterioration: bool,
    /// Expand the first input around zero by asinh: the scale, as a share of its largest magnitude, such as
    /// 0.1; 0 for off [default: chosen by cross-validation for auto, otherwise off]
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub companding: Option<f64>,
    /// The same for the rate, as a share of the rates that are common [default: as above]
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub rate_companding: Option<f64>,
    /// Add the running peak and the travelled path of the input as inputs, for xpnn+ and random-stops
    #[arg(long)]
    pub history: bool,
    /// Rows at the beginning of each record that drive the memory and are not trained on, where records do
    /// not begin in the virgin state [default: chosen by cross-validation for auto, otherwise 0]
    #[arg(long, value_name = "ROWS", value_parser = whole::<usize>)]
    pub warm_up: Option<usize>,
    /// The trainer: levenberg-marquardt, or the paper's hybrid of a genetic algorithm and the sub-gradient
    /// method with space dilatation, or either alone
    #[arg(long, value_name = "TRAINER", default_value = "levenberg-marquardt", value_parser = trainer())]
    pub training: Trainer,
    /// Random networks or populations to start from [default: 8, or 1 for other trainers than
    /// levenberg-marquardt]
    #[arg(long, value_name = "N", value_parser = starts)]
    pub starts: Option<usize>,
    /// Epochs of each start: iterations or generations, in a hybrid half of each; the best of several
    /// starts get as many again on all data [default: 40 for levenberg-marquardt, otherwise 2000]
    #[arg(long, value_name = "N", value_parser = whole::<usize>)]
    pub epochs: Option<usize>,
    /// Individuals of the genetic algorithm [default: 50]
    #[arg(long, value_name = "N", value_parser = population)]
    pub population: Option<usize>,
    /// Epochs without noticeable improvement after which genetic algorithm or sub-gradient method end; 0
    /// for never [default: 50]
    #[arg(long, value_name = "N", value_parser = whole::<usize>)]
    pub stall: Option<usize>,
    /// Seed of the random starts
    #[arg(long, value_name = "N", default_value_t = FitOptions::default().seed, value_parser = whole::<u64>)]
    pub seed: u64,
    /// Share of the data held out to validate a network on [default: the folds of a cross-validation]
    #[arg(long, value_name = "FRACTION", value_parser = fraction)]
    pub validation: Option<f64>,
    /// Penalty on the squared output weights of a network, in scaled units; 0 for plain least squares, as in the
    /// paper [default: 1e-6, nearly 0 where that lowers the cross-validation error; chosen by
    /// cross-validation for auto]
    #[arg(long, value_name = "PENALTY", value_parser = penalty)]
    pub ridge: Option<f64>,
    /// Penalty on the squared weights of stops and tanh neurons [default: 1e-7, otherwise as --ridge]
    #[arg(long, value_name = "PENALTY", value_parser = penalty)]
    pub decay: Option<f64>,
}

/// What can be chosen of the models that are no networks.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Models that are no networks")]
pub struct RivalOptions {
    /// Plays, breakpoints, intervals of each axis of a Preisach plane, or random stops
    #[arg(long, value_name = "N", value_parser = neurons)]
    pub operators: Option<usize>,
    /// Thresholds of masing, prandtl-ishlinskii or modified-prandtl-ishlinskii in the unit of the input, such as 0.1,0.2,0.5
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = threshold, allow_hyphen_values = true)]
    pub thresholds: Option<Vec<f64>>,
    /// Sign of the weights of plays or cells: any, non-negative or non-positive [default: cross-validated]
    #[arg(long, value_name = "SIGN", value_parser = sign())]
    pub sign: Option<Sign>,
    /// Dead zones on each side of modified-prandtl-ishlinskii [default: 6]
    #[arg(long, value_name = "N", value_parser = neurons)]
    pub dead_zones: Option<usize>,
    /// A weight for each play in place of an exponential law: true or false
    #[arg(long, value_name = "BOOL")]
    pub free_weights: Option<bool>,
    /// Thresholds of rate-dependent-prandtl-ishlinskii grow with the logarithm of the rate
    #[arg(long)]
    pub logarithmic_thresholds: bool,
    /// bouc-wen with the degradation and pinching of Baber and Noori
    #[arg(long)]
    pub degradation: bool,
    /// jiles-atherton in its differential form of 1992
    #[arg(long)]
    pub differential_form: bool,
}

impl TrainingOptions {
    /// All that was asked for, by the library's names.
    pub fn chosen(&self, rival: &RivalOptions) -> ChosenOptions {
        ChosenOptions {
            model: Some(self.model),
            stops: self.stops,
            hidden: self.hidden,
            members: self.members,
            relaxation: self.relaxation,
            no_deterioration: self.no_deterioration.then_some(true),
            companding: self.companding,
            rate_companding: self.rate_companding,
            history: self.history.then_some(true),
            warm_up: self.warm_up,
            training: Some(self.training),
            starts: self.starts,
            epochs: self.epochs,
            population: self.population,
            stall: self.stall,
            seed: Some(self.seed),
            validation: self.validation,
            ridge: self.ridge,
            decay: self.decay,
            operators: rival.operators,
            thresholds: rival.thresholds.clone(),
            sign: rival.sign,
            dead_zones: rival.dead_zones,
            free_weights: rival.free_weights,
            logarithmic_thresholds: Some(rival.logarithmic_thresholds),
            degradation: Some(rival.degradation),
            differential_form: Some(rival.differential_form),
        }
    }
}

fn sign() -> impl TypedValueParser<Value = Sign> {
    PossibleValuesParser::new(["any", "non-negative", "non-positive"]).map(|name| match name.as_str() {
        "non-negative" => Sign::NonNegative,
        "non-positive" => Sign::NonPositive,
        _ => Sign::Any,
    })
}

fn trainer() -> impl TypedValueParser<Value = Trainer> {
    PossibleValuesParser::new(Trainer::ALL.map(Trainer::name)).try_map(|name| name.parse::<Trainer>())
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

fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share: &f64| *share == 0.0 || (1e-6..=1e3).contains(share));
    share.ok_or_else(|| "choose 0 for never, or 1e-6 to 1e3".into())
}

fn threshold(text: &str) -> Result<f64, String> {
    let threshold = text.parse().ok().filter(|threshold: &f64| threshold.is_finite() && *threshold > 0.0);
    threshold.ok_or_else(|| "thresholds are numbers above 0, such as 0.1,0.2,0.5".into())
}

fn members(text: &str) -> Result<usize, String> {
    number_within(text, &(1..=MOST_MEMBERS))
}

fn folds(text: &str) -> Result<usize, String> {
    number_within(text, &(2..=1000))
}

fn neurons(text: &str) -> Result<usize, String> {
    number_within(text, &NEURONS)
}

fn population(text: &str) -> Result<usize, String> {
    number_within(text, &POPULATIONS)
}

fn starts(text: &str) -> Result<usize, String> {
    number_within(text, &STARTS)
}

fn fraction(text: &str) -> Result<f64, String> {
    let fraction = text.parse().ok().filter(|&fraction: &f64| fraction > 0.0 && fraction < 1.0);
    fraction.ok_or_else(|| "a number between 0 and 1 is needed".into())
}

fn penalty(text: &str) -> Result<f64, String> {
    let penalty = text.parse().ok().filter(|penalty| PENALTIES.contains(penalty));
    penalty.ok_or_else(|| format!("a number from {} to {:e} is needed", PENALTIES.start(), PENALTIES.end()))
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
    #[arg(long, value_name = "N", default_value_t = FitOptions::default().seed, value_parser = whole::<u64>)]
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

    #[test]
    fn options_have_the_library_s_names() {
        let names = |command: clap::Command| -> Vec<String> {
            let long = |option: &clap::Arg| option.get_long().map(|long| long.replace('-', "_"));
            command.get_arguments().filter_map(long).collect()
        };
        let command = TrainingOptions::augment_args(clap::Command::new("fit"));
        let mut names = names(RivalOptions::augment_args(command));
        names.sort();
        assert_eq!(names, ChosenOptions::names());
    }
}

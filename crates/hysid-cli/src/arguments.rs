//! The command line. Every option of `fit` has the name of its field in the library's `FitOptions`.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use hysid::network::{Family, Sizes};
use hysid::rate::RateMethod;
use hysid::training::genetic::POPULATIONS;
use hysid::training::{FitOptions, Trainer};

/// Identify hysteresis from measured input and output, simulate it and judge the model.
#[derive(Debug, Parser)]
#[command(name = "hysid", version, arg_required_else_help = true)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Identify a synthetic ferromagnet: data, model, report and what to type next
    Demo(Demo),
    /// Identify a model from measured data
    Fit(Box<Fit>),
    /// Run a model freely over data: their columns and `<output>_model`
    Simulate(Simulate),
    /// Errors of a model's free run against measured data
    Evaluate(Evaluate),
    /// Run the paper's experiments and set our figures beside its own
    Reproduce(Reproduce),
    /// Measure the speed on this machine
    Bench(Bench),
}

/// Arguments of `demo`.
#[derive(Debug, Args)]
pub struct Demo {
    /// Folder for the data, the model and the report
    #[arg(short, long, value_name = "DIR", default_value = "hysid-demo")]
    pub out: PathBuf,
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

/// What `--rate` asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RateOption {
    /// Central differences if there is time and the model has a use for them.
    Auto,
    /// No rate.
    None,
    /// Computed from the time stamps.
    Method(RateMethod),
    /// A column of this name.
    Column(String),
}

fn rate(text: &str) -> Result<RateOption, String> {
    Ok(match text {
        "auto" => RateOption::Auto,
        "none" => RateOption::None,
        "central" | "backward" | "savitzky-golay" => {
            RateOption::Method(text.parse().map_err(|error: hysid::Error| error.to_string())?)
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
    /// Which columns are what.
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// The network and its training.
    #[command(flatten)]
    pub training: TrainingOptions,
    /// Stop after this time and keep the best model so far
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time_limit: Option<f64>,
    /// Store the state of the fit in this file, every few seconds and at the end
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Go on where this checkpoint left off, with the options it was made with; give the same tables and
    /// columns. It is kept up to date unless --checkpoint names another file
    #[arg(long, value_name = "FILE", conflicts_with = "TrainingOptions")]
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

/// How a model is trained.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Model and training")]
pub struct TrainingOptions {
    /// Network family: pnn, gpnn, preisach-nn, xpnn (also epnn) or xpnn+
    #[arg(long, value_name = "MODEL", default_value = "xpnn+", value_parser = family)]
    pub model: Family,
    /// Stop neurons
    #[arg(long, value_name = "N", default_value_t = Sizes::default().stops, value_parser = neurons)]
    pub stops: usize,
    /// Tanh neurons, for families that have a tanh layer
    #[arg(long, value_name = "N", default_value_t = Sizes::default().hidden, value_parser = neurons)]
    pub hidden: usize,
    /// Relaxation neurons of each input, for xpnn+ with time stamps; 0 for none
    #[arg(long, value_name = "N", default_value_t = Sizes::default().relaxation)]
    pub relaxation: usize,
    /// Stops do not deteriorate, whatever the family
    #[arg(long)]
    pub no_deterioration: bool,
    /// The trainer: levenberg-marquardt, or the paper's hybrid of a genetic algorithm and the sub-gradient
    /// method with space dilatation, or either alone
    #[arg(long, value_name = "TRAINER", default_value = "levenberg-marquardt", value_parser = trainer())]
    pub training: Trainer,
    /// Random networks or populations to start from [default: 8 for levenberg-marquardt, otherwise 1]
    #[arg(long, value_name = "N", value_parser = starts)]
    pub starts: Option<usize>,
    /// Epochs of each start: iterations or generations, in a hybrid half of each; the best of several
    /// starts get as many again on all data [default: 40 for levenberg-marquardt, otherwise 2000]
    #[arg(long, value_name = "N")]
    pub epochs: Option<usize>,
    /// Individuals of the genetic algorithm [default: 50]
    #[arg(long, value_name = "N", value_parser = population)]
    pub population: Option<usize>,
    /// Epochs without noticeable improvement after which genetic algorithm or sub-gradient method end; 0
    /// for never [default: 50]
    #[arg(long, value_name = "N")]
    pub stall: Option<usize>,
    /// Seed of the random starts
    #[arg(long, value_name = "N", default_value_t = FitOptions::default().seed)]
    pub seed: u64,
    /// Share of the data held out to choose among the starts
    #[arg(long, value_name = "FRACTION", default_value_t = FitOptions::default().validation, value_parser = fraction)]
    pub validation: f64,
}

impl TrainingOptions {
    /// The library's options, with the rate decided.
    pub fn fit_options(&self, rate: Option<RateMethod>) -> FitOptions {
        let defaults = FitOptions::of(self.training);
        FitOptions {
            model: self.model,
            sizes: Sizes { stops: self.stops, hidden: self.hidden, relaxation: self.relaxation },
            no_deterioration: self.no_deterioration,
            rate,
            starts: self.starts.unwrap_or(defaults.starts),
            epochs: self.epochs.unwrap_or(defaults.epochs),
            population: self.population.unwrap_or(defaults.population),
            stall: self.stall.unwrap_or(defaults.stall),
            seed: self.seed,
            validation: self.validation,
            ..defaults
        }
    }

    /// Options that were asked for and that the trainer has no use for.
    pub fn useless(&self) -> Vec<&'static str> {
        let has = self.training;
        let asked = [
            ("--population", self.population.is_some() && !has.is_genetic()),
            ("--stall", self.stall.is_some() && has == Trainer::LevenbergMarquardt),
        ];
        asked.into_iter().filter(|(_, useless)| *useless).map(|(option, _)| option).collect()
    }
}

fn trainer() -> impl TypedValueParser<Value = Trainer> {
    PossibleValuesParser::new(Trainer::ALL.map(Trainer::name)).try_map(|name| name.parse::<Trainer>())
}

fn family(name: &str) -> Result<Family, String> {
    name.parse().map_err(|error: hysid::Error| error.to_string())
}

fn number_within(text: &str, low: usize, high: usize) -> Result<usize, String> {
    let number: usize = text.parse().map_err(|_| format!("a whole number from {low} to {high} is needed"))?;
    if (low..=high).contains(&number) { Ok(number) } else { Err(format!("choose {low} to {high}")) }
}

fn neurons(text: &str) -> Result<usize, String> {
    number_within(text, 1, 1000)
}

fn population(text: &str) -> Result<usize, String> {
    number_within(text, *POPULATIONS.start(), *POPULATIONS.end())
}

fn starts(text: &str) -> Result<usize, String> {
    number_within(text, 1, 10_000)
}

fn fraction(text: &str) -> Result<f64, String> {
    let fraction = text.parse().ok().filter(|&fraction: &f64| fraction > 0.0 && fraction < 1.0);
    fraction.ok_or_else(|| "a number between 0 and 1 is needed".into())
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
    /// Which columns are what.
    #[command(flatten)]
    pub columns: ColumnOptions,
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
    /// Which columns are what.
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `reproduce`.
#[derive(Debug, Args)]
pub struct Reproduce {
    /// What to run: training
    #[arg(value_name = "EXPERIMENT", required = true, value_parser = PossibleValuesParser::new(["training"]))]
    pub experiments: Vec<String>,
    /// Folder for tables, figures and the page
    #[arg(short, long, value_name = "DIR", default_value = "hysid-reproduction")]
    pub out: PathBuf,
    /// A tenth of the epochs, to see how it looks
    #[arg(long)]
    pub quick: bool,
    /// Seed of the first repetition
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
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
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Arguments::command().debug_assert();
    }
}

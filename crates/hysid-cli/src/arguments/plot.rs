//! Arguments of `hysid plot`.

use std::path::PathBuf;

use clap::{Arg, Args, ValueEnum};
use hysid::diagnosis::cycles::{CycleOptions, Division, Field};

use super::cycles::named;
use super::{BeginningOptions, ColumnOptions, DataSetsOptions, Overwriting, UnitOptions, probability};

const PLOT_EXAMPLES: &str = concat!(
    "\
Examples:
  hysid plot model.json test.csv -o loops.pdf
  hysid plot model.json test.csv --kind histories --band 0.9 -o time.pdf
  hysid plot data.csv --kind backbone --font serif -o backbone.svg

How to make figures for a paper:
",
    page!("how-to/figures-for-a-paper.md")
);

/// Content of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PlotKind {
    /// The output over the input
    Loops,
    /// Output and input over time
    Histories,
    /// The error of the model over time and over the input
    Errors,
    /// Energy, damping and other figures of cycles, over their amplitude
    Cycles,
    /// The backbone in front of the loops
    Backbone,
    /// The energy lost in all cycles so far, over time
    Energy,
    /// The loss in a cycle over its frequency; of actuators, the width of the loop
    Frequency,
}

impl PlotKind {
    /// Its name on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_string())
    }
}

#[derive(Debug, Args)]
#[command(after_help = PLOT_EXAMPLES, mut_arg("of_ten", hidden), mut_arg("initial_state", hidden), mut_arg("same_units", hidden))]
pub struct Plot {
    /// A model file and tables to simulate it on, or tables alone
    ///
    /// The model file comes first. Without a model, the measured data are drawn alone; without a measured output, the
    /// model alone.
    #[arg(value_name = "MODEL.json|DATA.csv", required = true)]
    pub files: Vec<PathBuf>,
    /// What to draw
    #[arg(short, long, value_enum, default_value_t = PlotKind::Loops)]
    pub kind: PlotKind,
    /// Figure to write, .svg, .pdf or .png
    ///
    /// The default is the name of DATA with `.KIND.svg`, in the current folder.
    #[arg(short, long, value_name = "FIGURE")]
    pub out: Option<PathBuf>,
    /// Draw only this record; repeat for several
    #[arg(long, value_name = "RECORD")]
    pub only: Vec<String>,
    /// In histories, a band of this probability, such as 0.9
    #[arg(long, value_name = "PROBABILITY", value_parser = probability)]
    pub band: Option<f64>,
    #[command(flatten)]
    pub data_sets: DataSetsOptions,
    #[command(flatten)]
    pub beginning: BeginningOptions,
    #[command(flatten)]
    pub overwriting: Overwriting,
    #[command(flatten)]
    pub columns: ColumnOptions,
    #[command(flatten)]
    pub units: UnitOptions,
    /// Field of engineering: structure, magnet, actuator or general [default: by the columns]
    #[arg(long, value_name = "FIELD", value_parser = named::<Field>, help_heading = "Cycles", hide_short_help = true)]
    pub field: Option<Field>,
    /// Where cycles begin: zero, mean or reversals [default: as suits the data]
    #[arg(long, value_name = "WHERE", value_parser = named::<Division>, help_heading = "Cycles", hide_short_help = true)]
    pub divide: Option<Division>,
    /// Width in millimetres
    ///
    /// The default is one column of most journals; two are about 180 mm.
    #[arg(long, value_name = "MM", default_value_t = 88.0, value_parser = side, help_heading = "Style")]
    pub width: f64,
    /// Height in millimetres [default: as suits the kind]
    #[arg(long, value_name = "MM", value_parser = side, help_heading = "Style")]
    pub height: Option<f64>,
    /// Family of the font; also serif and sans-serif
    #[arg(long, value_name = "NAME", default_value = "sans-serif", help_heading = "Style")]
    pub font: String,
    /// Size of the text in points
    #[arg(long, value_name = "POINTS", default_value_t = 8.0, value_parser = points, help_heading = "Style")]
    pub text_size: f64,
    /// Dots in an inch of a PNG
    #[arg(long, value_name = "N", default_value_t = 600.0, value_parser = dots, help_heading = "Style", hide_short_help = true)]
    pub dpi: f64,
}

impl Plot {
    pub fn options(&self) -> CycleOptions {
        CycleOptions { division: self.divide, field: self.field, ..CycleOptions::default() }
    }
}

fn hidden(option: Arg) -> Arg {
    option.hide_short_help(true)
}

fn within(text: &str, low: f64, high: f64) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| (low..=high).contains(number));
    number.ok_or_else(|| format!("a number from {low} to {high} is needed"))
}

fn side(text: &str) -> Result<f64, String> {
    within(text, 30.0, 1000.0)
}

fn points(text: &str) -> Result<f64, String> {
    within(text, 4.0, 36.0)
}

fn dots(text: &str) -> Result<f64, String> {
    within(text, 50.0, 2400.0)
}

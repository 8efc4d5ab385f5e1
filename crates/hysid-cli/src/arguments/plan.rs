//! Arguments of `hysid plan`.

use std::path::PathBuf;

use clap::Args;
use hysid::options::network::SEED;
use hysid::plan::Wave;

use super::limits::{limits, slew};
use super::{ColumnOptions, Overwriting, RUN, whole};

const PLAN_EXAMPLES: &str = concat!(
    "\
Examples:
  hysid plan --like data.csv             data.drive.csv, page data.drive.html
  hysid plan --like data.csv --length 2000 -o drive.csv
  hysid plan --for \"piezo stage\" --range 0:150 --step 0.001 --length 5000

Method, protocols and what they are worth:
",
    page!("plan.md")
);

#[derive(Debug, Args)]
#[command(after_help = PLAN_EXAMPLES)]
pub struct Plan {
    /// Measured data for which to plan the next test
    #[arg(long, value_name = "DATA.csv", num_args = 1.., conflicts_with = "kind")]
    pub like: Vec<PathBuf>,
    /// Plan a first test of a kind of specimen
    ///
    /// Structure, damper, rubber, actuator or magnet, or words that name one, such as "piezo stage".
    #[arg(long = "for", value_name = "KIND", id = "kind")]
    pub kind: Option<String>,
    /// Table to write; `-` is stdout
    ///
    /// The default is the name of DATA or KIND with `.drive.csv`, in the current folder. Its columns are time, if there is one, and the input. The page has the same name with `.html`.
    #[arg(short, long, value_name = "DRIVE.csv")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub overwriting: Overwriting,
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// Lowest and highest input [default: of the data]
    ///
    /// Two numbers, such as -5:5. It may be wider than the range of the data.
    #[arg(long, value_name = "LOW:HIGH", value_parser = limits, help_heading = "Limits")]
    pub range: Option<(f64, f64)>,
    /// Maximum number of rows [default: as many as the data]
    ///
    /// Without data, the default is 2000.
    #[arg(long, value_name = "ROWS", value_parser = whole::<usize>, help_heading = "Limits")]
    pub length: Option<usize>,
    /// Maximum duration, in the unit of time
    #[arg(long, value_name = "TIME", value_parser = slew, help_heading = "Limits", hide_short_help = true, conflicts_with = "length")]
    pub duration: Option<f64>,
    /// Time between rows [default: that of the data]
    ///
    /// Without data there is no time by default, and the test is to be run slowly.
    #[arg(long, value_name = "TIME", value_parser = slew, help_heading = "Limits")]
    pub step: Option<f64>,
    /// Largest rate of the input [default: of the data]
    ///
    /// The largest change of the input in a unit of time; without time stamps, from row to row. Without data, the
    /// default is the rate that gives a test of --length rows.
    #[arg(long, value_name = "RATE", value_parser = slew, help_heading = "Limits")]
    pub max_rate: Option<f64>,
    /// Shape of swings: smooth or triangle [default: smooth if there is time]
    #[arg(long, value_name = "NAME", value_parser = wave, help_heading = "Limits", hide_short_help = true)]
    pub wave: Option<Wave>,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = SEED, value_parser = whole::<u64>, help_heading = RUN)]
    pub seed: u64,
    /// Print the result as one JSON object
    #[arg(long, help_heading = RUN)]
    pub json: bool,
    /// Write no report page
    #[arg(long, help_heading = RUN)]
    pub no_report: bool,
}

fn wave(text: &str) -> Result<Wave, String> {
    text.parse().map_err(|error: hysid::Error| error.to_string())
}

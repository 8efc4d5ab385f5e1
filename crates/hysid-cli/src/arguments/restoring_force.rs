//! Arguments of `hysid restoring-force`.

use std::path::PathBuf;

use clap::Args;
use hysid_app::restoring_force::{Mass, MotionChoice, RestoringForceRequest};

use super::reading::missing_help;
use super::{Overwriting, RUN, ReadingOptions};

const FORCE_EXAMPLES: &str = concat!(
    "\
Examples:
  hysid restoring-force rig.csv --mass 2           force and displacement: rig.force.csv
  hysid restoring-force rig.csv --mass 2 --acceleration acc
  hysid restoring-force floor.csv --mass \"25 t\" --absolute-acceleration acc
  hysid restoring-force floor.csv --mass \"25 t\" --base-acceleration ag

Method: ",
    page!("how-to/restoring-force.md")
);

const ZERO_HELP: &str = "Subtract from the displacement and from the restoring force their means over the first ROWS rows of each record";

const MISSING_MEANS: &str = "Where an acceleration or the applied force is missing, the restoring force is blank; time, displacement and velocity need a number in every row.";

#[derive(Debug, Args)]
// The columns of a motion are neither inputs nor outputs.
#[command(
    after_help = FORCE_EXAMPLES,
    mut_arg("zero", |option| option.help(ZERO_HELP)),
    mut_arg("missing", |option| option.long_help(missing_help(MISSING_MEANS)))
)]
pub struct RestoringForce {
    /// Table of the measured motion of a mass
    #[arg(value_name = "DATA.csv")]
    pub data: PathBuf,
    /// Mass that moves, in kg or with a unit, such as "2 t"
    ///
    /// The result is the restoring force u - m (y'' + a) with the applied force u, the mass m, the acceleration y'' relative
    /// to the base and the acceleration a of the base. It is positive where it acts on the mass in the direction of negative
    /// displacement: a spring of stiffness k has k y.
    ///
    /// Units: g, kg, t, lb. Without a unit it is in kg; if no column has a known unit, in the unit that is consistent
    /// with the other numbers.
    #[arg(long, value_name = "MASS", value_parser = mass)]
    pub mass: Mass,
    /// Table to write [default: name of DATA with `.force.csv`]; `-` is stdout
    ///
    /// Its columns are record, time, displacement, velocity and restoring force. `hysid fit`, `diagnose`, `cycles` and
    /// `plot` take the displacement as input and the restoring force as output.
    #[arg(short, long, value_name = "FORCE.csv")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub overwriting: Overwriting,
    #[command(flatten)]
    pub columns: MotionOptions,
    #[command(flatten)]
    pub reading: ReadingOptions,
    /// Rows of the window of the filter that differentiates, an odd number [default: chosen from the data]
    ///
    /// A longer window reduces the noise and increases the smoothing error.
    #[arg(long, value_name = "ROWS", help_heading = "Method", hide_short_help = true)]
    pub window: Option<usize>,
    /// Print the result as one JSON object
    #[arg(long, help_heading = RUN)]
    pub json: bool,
}

/// Which column is what.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Columns")]
pub struct MotionOptions {
    /// Record of each row [default: a column `record`]
    #[arg(long, value_name = "COLUMN", hide_short_help = true)]
    pub record: Option<String>,
    /// Time stamps [default: `t` or `time`, also with a unit]
    #[arg(long, value_name = "COLUMN", hide_short_help = true)]
    pub time: Option<String>,
    /// Displacement relative to the base [default: by name and unit]
    #[arg(long, value_name = "COLUMN")]
    pub displacement: Option<String>,
    /// Velocity relative to the base [default: computed]
    #[arg(long, value_name = "COLUMN")]
    pub velocity: Option<String>,
    /// Acceleration relative to the base [default: computed]
    ///
    /// The second derivative of the displacement. Without one, it is the derivative of the velocity, or the second one of the
    /// displacement, by a Savitzky-Golay filter.
    #[arg(long, value_name = "COLUMN")]
    pub acceleration: Option<String>,
    /// Acceleration that an accelerometer on the mass measures
    ///
    /// The acceleration relative to the base plus that of the base. Not together with `--acceleration` or
    /// `--base-acceleration`.
    #[arg(long, value_name = "COLUMN", conflicts_with = "acceleration")]
    pub absolute_acceleration: Option<String>,
    /// Acceleration of the base, such as a shaking table
    ///
    /// Without one, the base is at rest.
    #[arg(long, value_name = "COLUMN", conflicts_with = "absolute_acceleration")]
    pub base_acceleration: Option<String>,
    /// Force applied to the mass, or `none` [default: by name and unit]
    ///
    /// Positive in the direction of a positive displacement. If neither base nor absolute acceleration is measured, it is
    /// needed: `none` is a free vibration.
    #[arg(long, value_name = "COLUMN")]
    pub applied_force: Option<String>,
    /// Do not convert units
    ///
    /// Otherwise known units are converted to kg, m, s and N. Numbers without a unit are taken as they are, as if in these.
    #[arg(long, hide_short_help = true)]
    pub same_units: bool,
    /// A further column to copy, such as a temperature; repeat for several
    #[arg(long, value_name = "COLUMN", hide_short_help = true)]
    pub keep: Vec<String>,
}

impl RestoringForce {
    pub fn request(&self) -> RestoringForceRequest {
        let MotionOptions { same_units, .. } = self.columns;
        let of = self.columns.clone();
        let columns = MotionChoice {
            record: of.record,
            time: of.time,
            displacement: of.displacement,
            velocity: of.velocity,
            acceleration: of.acceleration,
            absolute_acceleration: of.absolute_acceleration,
            base_acceleration: of.base_acceleration,
            applied_force: of.applied_force,
            keep: of.keep,
        };
        let (mass, window, zero) = (self.mass.clone(), self.window, self.reading.zero);
        RestoringForceRequest { columns, mass, same_units, window, zero }
    }
}

fn mass(text: &str) -> Result<Mass, String> {
    text.parse()
}

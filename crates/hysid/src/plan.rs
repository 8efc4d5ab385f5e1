//! Plans of experiments: what to measure next, so that a model is good on data that it has not seen.
//!
//! 1. The *survey*: properties that [`diagnosis`](hysid_diagnosis) cannot test, swings, pairs of turning points and
//!    speeds that were not run.
//! 2. *Tests* of such properties: a loop at two speeds, a repeated loop, holds.
//! 3. *Random reversals* within the limits, at several speeds if the data have time, until the length is reached.
//!
//! [`Protocol`] has first tests for specimens without data.
//!
//! ```
//! use hysid::plan::{Plan, PlanOptions};
//! use hysid::Dataset;
//! // A test of one amplitude.
//! let x: Vec<f64> = (0..600).map(|k| (0.1 * k as f64).sin()).collect();
//! let y: Vec<f64> = (0..600).map(|k| (0.1 * k as f64 - 0.3).sin()).collect();
//! let plan = Plan::of(&Dataset::from_slices(&x, &y)?, &PlanOptions::default())?;
//! assert!(plan.input.len() <= 600 && plan.input[0] == x[0]);
//! assert!(plan.gaps.iter().any(|gap| gap.what == "amplitudes"));
//! # Ok::<(), hysid::Error>(())
//! ```

mod drive;
mod limits;
mod path;
mod protocol;
mod segment;
mod survey;

use serde::Serialize;

use crate::data::record::{ColumnNames, Dataset};
use crate::error::{Error, Result};
use drive::DriveRows;
use survey::Survey;

pub use limits::{FEWEST_ROWS, LimitOptions, Limits, MOST_ROWS};
pub use path::{DrivePath, Leg, Wave};
pub use protocol::{Protocol, ProtocolOptions};
pub use segment::{Segment, SegmentKind};
pub use survey::Gap;

/// Options of a plan from data.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanOptions {
    /// Limits other than those of the data.
    pub limits: LimitOptions,
    /// Shape of swings; smooth with time stamps and triangles without if `None`.
    pub wave: Option<Wave>,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self { limits: LimitOptions::default(), wave: None, seed: 1 }
    }
}

/// A plan: a drive, why it is so, and what it is for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plan {
    /// Names of the columns of the data.
    pub names: ColumnNames,
    /// Limits that the drive keeps.
    pub limits: Limits,
    /// Shape of its swings.
    pub wave: Wave,
    /// Time stamps of the rows, from 0; `None` for data without time.
    pub time: Option<Vec<f64>>,
    /// The input of each row.
    pub input: Vec<f64>,
    /// The segments; the first row belongs to none.
    pub segments: Vec<Segment>,
    /// Gaps in the data.
    pub gaps: Vec<Gap>,
    /// Sources of a protocol; empty for a plan from data.
    pub sources: Vec<&'static str>,
}

impl Plan {
    /// A plan from data.
    ///
    /// # Errors
    /// Data from which nothing can be identified, with several inputs, or limits that leave no drive.
    pub fn of(data: &Dataset, options: &PlanOptions) -> Result<Self> {
        let inputs = data.names().inputs.len();
        if inputs > 1 {
            return Err(Error::Parts(format!(
                "the data have {inputs} inputs, and a plan drives one: choose it"
            )));
        }
        let limits = Limits::of(data, &options.limits)?;
        let survey = Survey::of(data, limits)?;
        let wave = options.wave.unwrap_or(if data.has_time() { Wave::Smooth } else { Wave::Triangle });
        let drive = DriveRows::for_data(DrivePath { limits, wave }, &survey, options.seed);
        Ok(Self {
            names: data.names().clone(),
            limits,
            wave,
            time: time(limits, drive.inputs.len()),
            segments: drive.segments(),
            input: drive.inputs,
            gaps: survey.gaps,
            sources: Vec::new(),
        })
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.input.len()
    }
}

fn time(limits: Limits, rows: usize) -> Option<Vec<f64>> {
    limits.step.map(|step| (0..rows).map(|row| row as f64 * step).collect())
}

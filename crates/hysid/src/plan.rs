//! Plans of experiments: what to measure next, so that a model is good on data that it has not seen.
//!
//! 1. *What the data do not cover*: properties that [`diagnosis`](hysid_diagnosis) cannot test, swings, pairs of turning
//!    points and speeds that were not run.
//! 2. *Tests* of such properties: a loop at two speeds, a repeated loop, holds.
//! 3. *Pieces* of all kinds (loops, minor loops, reversal curves, nested loops, random reversals) at several speeds. The
//!    one with the largest gain per row is added, again and again, until the length is reached.
//!
//! ```text
//! gain of a path = Σ_c v_c [h(n_c + a_c) - h(n_c)],    h(n) = n / (n + 1)             theory.md (14.1)
//! v_c = mean over the rows in c of 1/2 + 1/2 min(d/D, 4)                              theory.md (14.2)
//! ```
//!
//! A cell `c` is a state of the memory: the input, the reversal at which its branch began, the reversal before, and the
//! speed. `n_c` is how often the data and the plan so far crossed the cell, `a_c` how often the path does. `d` is the
//! disagreement of the members of an ensemble that was fitted to the data, each simulated along the path from the end of
//! the plan so far, and `D` its mean over the first candidates. Without an ensemble `v_c` is 1.
//!
//! ```
//! use hysid::plan::{Plan, PlanOptions};
//! use hysid::Dataset;
//! // A test of one amplitude.
//! let x: Vec<f64> = (0..600).map(|k| (0.1 * k as f64).sin()).collect();
//! let y: Vec<f64> = (0..600).map(|k| (0.1 * k as f64 - 0.3).sin()).collect();
//! let plan = Plan::of(&Dataset::from_slices(&x, &y)?, None, &PlanOptions::default())?;
//! assert!(plan.input.len() <= 600 && plan.input[0] == x[0]);
//! assert!(plan.segments.iter().any(|segment| segment.amplitude < 0.5));
//! # Ok::<(), hysid::Error>(())
//! ```

mod candidates;
mod choice;
mod coverage;
mod draft;
mod limits;
mod members;
mod path;
mod protocol;
mod reasons;
mod segment;
mod survey;

use serde::Serialize;

use crate::data::record::{ColumnNames, Dataset};
use crate::error::{Error, Result};
use crate::model::Model;
use coverage::Coverage;
use draft::Draft;
use members::Members;
use survey::Survey;

pub use limits::{FEWEST_ROWS, Limits, MOST_ROWS, Wanted};
pub use path::{Leg, Path, Wave};
pub use protocol::{Protocol, ProtocolOptions};
pub use segment::{Kind, Segment};
pub use survey::Gap;

/// What a plan is to be.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanOptions {
    /// Limits other than those of the data.
    pub limits: Wanted,
    /// Shape of swings; smooth with time stamps and triangles without if `None`.
    pub wave: Option<Wave>,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self { limits: Wanted::default(), wave: None, seed: 1 }
    }
}

/// Disagreement of the members of an ensemble: root mean square, in the unit of the output.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Disagreement {
    /// Along the drive of the plan.
    pub plan: f64,
    /// Along the test that the data are of: what repeating it would show.
    pub repeat: f64,
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
    /// What the data do not cover.
    pub gaps: Vec<Gap>,
    /// Disagreement of the members along the plan, and along the test of the data; `None` without an ensemble.
    pub disagreement: Option<Disagreement>,
    /// Sources of a protocol; empty for a plan from data.
    pub sources: Vec<&'static str>,
}

impl Plan {
    /// A plan from data, and from an ensemble that was fitted to them, if there is one.
    ///
    /// # Errors
    /// Data from which nothing can be identified, with several inputs, or limits that leave no drive; a model that is
    /// no ensemble.
    pub fn of(data: &Dataset, ensemble: Option<&Model>, options: &PlanOptions) -> Result<Self> {
        let inputs = data.names().inputs.len();
        if inputs > 1 {
            return Err(Error::Parts(format!(
                "the data have {inputs} inputs, and a plan drives one: choose it"
            )));
        }
        let limits = Limits::of(data, &options.limits)?;
        let survey = Survey::of(data, limits.range)?;
        let wave = options.wave.unwrap_or(if data.has_time() { Wave::Smooth } else { Wave::Triangle });
        let path = Path { limits, wave };
        let by_speed = limits.step.is_some() && survey.rate_dependence != hysid_diagnosis::Verdict::No;
        let mut coverage = Coverage::none(limits, path.fastest(), by_speed);
        coverage.add_data(data);
        let members = ensemble.map(|model| Members::new(model, limits.start, limits.step)).transpose()?;
        let mut draft = Draft::new(path, coverage, members);
        choice::fill(&mut draft, &survey, options.seed)?;
        draft.go_back()?;
        let repeat = ensemble.map(|model| members::along_data(model, data)).transpose()?;
        let disagreement = draft.disagreement().zip(repeat);
        let disagreement = disagreement.map(|(plan, repeat)| Disagreement { plan, repeat });
        let mut segments = draft.segments();
        reasons::give(&mut segments, data.names(), limits, disagreement);
        Ok(Self {
            names: data.names().clone(),
            limits,
            wave,
            time: time(limits, draft.inputs.len()),
            input: draft.inputs,
            segments,
            gaps: survey.gaps,
            disagreement,
            sources: Vec::new(),
        })
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.input.len()
    }
}

/// Time stamps of a drive.
fn time(limits: Limits, rows: usize) -> Option<Vec<f64>> {
    limits.step.map(|step| (0..rows).map(|row| row as f64 * step).collect())
}

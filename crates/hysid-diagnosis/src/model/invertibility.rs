//! Whether a model can be inverted sample by sample, theory.md (10.45): after any past, is the next output a monotone
//! function of the next input, in one direction and without jumps?
//!
//! The model is driven to many pasts. After each, trial steps scan the output over the trained range of the input. Of a
//! model with a rate, the rate belongs to the unknown input, so what is found depends on the time step; a scan then
//! covers the inputs that the trained rates can reach.

mod conclusions;
mod examination;
mod pasts;
mod scan;
mod words;

use serde::Serialize;

use super::probe::Probe;
use crate::Finding;
use conclusions::ScanConclusions;
use examination::Examination;
use hysid_core::error::Result;

/// A way back or a jump below this share of the output's range does not matter.
const EFFECT: f64 = 1e-6;

/// In which direction the output goes while the input rises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OutputDirection {
    /// Upwards.
    Rising,
    /// Downwards.
    Falling,
}

impl OutputDirection {
    fn sign(self) -> f64 {
        match self {
            Self::Rising => 1.0,
            Self::Falling => -1.0,
        }
    }
}

/// Obstacle to an inverse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlaceKind {
    /// The output goes back.
    Reversal,
    /// The output jumps.
    Jump,
}

/// Where a model is not monotone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NonMonotonePlace {
    /// Obstacle at this place.
    pub kind: PlaceKind,
    /// Its size, as a share of the range of the output.
    pub size: f64,
    /// The path of the input that led there.
    pub path: String,
    /// Row of the path after which it is, counted from 0; `None` before the first sample.
    pub row: Option<usize>,
    /// Time of that row, in the unit of the time.
    pub time: f64,
    /// The first input of that row, in its unit.
    pub input: f64,
    /// The last turning points of the input, in its unit; the latest at the end.
    pub turning_points: Vec<f64>,
    /// Time from that row to the next sample; `None` for a model that does not depend on it.
    pub time_step: Option<f64>,
    /// Next inputs between which the output goes back, or at which it jumps, in the unit of the input.
    pub inputs: (f64, f64),
    /// Outputs there, in the unit of the output.
    pub outputs: (f64, f64),
}

/// Lack of monotonicity at a time step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AtTimeStep {
    /// Time to the next sample, in its unit.
    pub time_step: f64,
    /// The largest way back or jump, as a share of the range of the output.
    pub index: f64,
}

/// Outputs over the next input, to be drawn.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scans {
    /// After several pasts, over the whole trained range.
    pub several: Vec<Vec<(f64, f64)>>,
    /// After the past with the worst place, if there is one.
    pub worst: Option<Vec<(f64, f64)>>,
}

/// Whether a model has an inverse sample by sample, and for which outputs. Ranges are in the unit of the output.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Invertibility {
    /// The verdict. Its index is the largest way back or jump of the output, as a share of its range.
    #[serde(flatten)]
    pub finding: Finding,
    /// In which direction the output goes while the input rises, in most scans.
    pub direction: OutputDirection,
    /// Outputs that can be reached in one step after each past; `None` if there are none. Of a model with a rate: in a
    /// step that is long enough for the whole trained range.
    pub always: Option<(f64, f64)>,
    /// The widest part of [`Self::always`] in which no past leaves an output that belongs to several inputs or that a
    /// jump omits. Time steps below the shortest one do not count.
    pub monotone_outputs: Option<(f64, f64)>,
    /// Shortest time step from which on all scans are monotone; `None` if there is none, or if time does not matter.
    pub shortest_time_step: Option<f64>,
    /// Results of each time step, the shortest first; empty if time does not matter.
    pub time_steps: Vec<AtTimeStep>,
    /// Number of pasts.
    pub pasts: usize,
    /// Number of scans, some of them with different time steps after the same past.
    pub scans: usize,
    /// Share of the scanned inputs over which the output does not change.
    pub flat_share: f64,
    /// Number of jumps that were found.
    pub jumps: usize,
    /// The largest way back or jump; `None` for a verdict *yes*.
    pub worst: Option<NonMonotonePlace>,
    /// Scans to be drawn.
    #[serde(skip)]
    pub drawing: Scans,
}

impl Invertibility {
    pub(super) fn of(probe: &Probe) -> Result<Self> {
        Ok(ScanConclusions::of(&Examination::of(probe)?).invertibility(probe))
    }
}

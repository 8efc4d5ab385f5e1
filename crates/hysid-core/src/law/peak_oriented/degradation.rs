//! Softening beyond a cap, and deterioration with dissipated work.
//!
//! ```text
//! D = 1 - exp{-(e/e_D)^p},   σ = 1 - s_D D,   d_t = (1 + a D) d_m,   φ_b (1 - g D) in place of φ_b    theory.md (8.46)
//! ```

use serde::{Deserialize, Serialize};

use crate::elementary::{exp_m1, powf};
use crate::law::{Dimension, Parameter};

use super::envelope::capped_share;

/// How a member softens and deteriorates. Displacements are counted in yield displacements, work in yield forces
/// times yield displacements; the equations are those of the [module of the law](super).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Degradation {
    /// `d_c`: displacement at the cap, beyond which the envelope softens.
    pub cap: f64,
    /// `κ`: after this share of `d_c` beyond the cap half of what can be lost is lost.
    pub softening: f64,
    /// `ρ`, 0 to 1: share of the envelope that is left far beyond the cap.
    pub residual: f64,
    /// `e_D`: work at which the deterioration `D` is 1 - 1/e.
    pub endurance: f64,
    /// `p`: below 1 deterioration slows down with work, above 1 it accelerates at first.
    pub pace: f64,
    /// `s_D`, 0 to 1: share of the strength that is lost at last.
    pub strength_loss: f64,
    /// `a`: growth of the target of reloading at last, as a share of the largest displacement.
    pub target_growth: f64,
    /// `g`, 0 to 1: share of the height of the pinch point that is lost at last.
    pub pinching_growth: f64,
}

/// Bounds of each parameter, in the order of the fields.
pub const BOUNDS: [(f64, f64); 8] =
    [(0.1, 1e6), (0.01, 1e3), (0.0, 1.0), (0.01, 1e9), (0.2, 5.0), (0.0, 1.0), (0.0, 5.0), (0.0, 1.0)];

impl Degradation {
    /// From its eight parameters, in the order of the fields.
    pub fn from_values(values: [f64; 8]) -> Self {
        let [cap, softening, residual, endurance, pace, strength_loss, target_growth, pinching_growth] =
            values;
        Self { cap, softening, residual, endurance, pace, strength_loss, target_growth, pinching_growth }
    }

    /// The values, in the order of [`Degradation::from_values`].
    pub fn values(&self) -> [f64; 8] {
        let &Self {
            cap,
            softening,
            residual,
            endurance,
            pace,
            strength_loss,
            target_growth,
            pinching_growth,
        } = self;
        [cap, softening, residual, endurance, pace, strength_loss, target_growth, pinching_growth]
    }

    /// `C(d)`: the share of the envelope that is left beyond the cap.
    pub(super) fn capped_share(&self, d: f64) -> f64 {
        capped_share(d, self.cap, self.softening, self.residual)
    }

    /// `D`, 0 to 1, after so much work.
    pub(super) fn deterioration(&self, work: f64) -> f64 {
        -exp_m1(-powf(work / self.endurance, self.pace))
    }

    pub(super) fn parameters(&self) -> Vec<Parameter> {
        let values = [
            ("d_c", "displacement at the cap, in yield displacements", self.cap),
            ("κ", "width of softening as a share of the displacement at the cap", self.softening),
            ("ρ", "share of the envelope that is left beyond the cap", self.residual),
            ("e_D", "work that deteriorates, in yield forces times yield displacements", self.endurance),
            ("p", "pace of deterioration", self.pace),
            ("s_D", "loss of strength at last", self.strength_loss),
            ("a", "growth of the target of reloading at last", self.target_growth),
            ("g", "loss of height of the pinch point at last", self.pinching_growth),
        ];
        let parameter = |((symbol, meaning, value), bounds)| {
            Parameter::new(symbol, meaning, value, bounds, Dimension::NONE)
        };
        values.into_iter().zip(BOUNDS).map(parameter).collect()
    }
}

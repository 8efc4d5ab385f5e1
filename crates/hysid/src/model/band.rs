//! How far off a prediction may be: a band about the output, calibrated on data held out.
//!
//! ```text
//! y ± q(p) √(f² + d²)                                                      theory.md (11.7)
//! ```
//!
//! `d` is how much the members of the ensemble disagree at that row, `f` the error that is left where they
//! agree. The factors `q(p)` are quantiles of what was found on rows that the members had not seen: split
//! conformal prediction. They are kept apart for rows inside the trained range and beyond it.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::model::ensemble::Votes;

/// Probabilities that the factors are kept for.
const LEVELS: [f64; 10] = [0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.925, 0.95, 0.975, 0.99];

/// A calibrated band.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// `f` of theory.md (11.7), in the output's unit.
    floor: f64,
    /// `q` inside the trained range, at each of the levels.
    inside: Vec<f64>,
    /// `q` beyond it.
    outside: Vec<f64>,
    /// Rows held out that the factors inside and outside were found on.
    rows: (usize, usize),
}

/// A simulated record with its band.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Output of each row, in the user's unit.
    pub output: Vec<f64>,
    /// Lower edge of the band.
    pub low: Vec<f64>,
    /// Upper edge.
    pub high: Vec<f64>,
}

/// What was found on a row held out.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HeldOutRow {
    /// Measured less simulated output.
    pub error: f64,
    /// How much the members disagreed: [`disagreement`].
    pub disagreement: f64,
    /// Degree of having been outside the range of the fold's training data, 0 to 1.
    pub outside: f64,
    /// What it counts, so that each fold counts the same.
    pub weight: f64,
}

/// Half the distance between the quantiles that a normal distribution has at one deviation on each side.
pub(crate) fn disagreement(votes: &mut Votes) -> f64 {
    0.5 * (votes.quantile(0.841) - votes.quantile(0.159))
}

/// Fewest rows from which factors are found.
const FEWEST_ROWS: usize = 20;

impl Band {
    /// Calibrates on rows held out; `None` if they are too few.
    pub(crate) fn calibrate(rows: &[HeldOutRow]) -> Option<Self> {
        let (outside, inside): (Vec<HeldOutRow>, Vec<HeldOutRow>) =
            rows.iter().partition(|row| row.outside > 0.5);
        if rows.len() < FEWEST_ROWS {
            return None;
        }
        let mut errors = Votes::default();
        rows.iter().for_each(|row| errors.cast(row.error.abs(), row.weight));
        // A typical error, so that rows where all members agree by chance do not ask for factors beyond all
        // reason.
        let floor = 0.5 * errors.quantile(0.5).max(f64::MIN_POSITIVE);
        let factors = |of: &[HeldOutRow]| {
            let rows = if of.len() < FEWEST_ROWS { rows } else { of };
            let mut scores = Votes::default();
            rows.iter()
                .for_each(|row| scores.cast(row.error.abs() / floor.hypot(row.disagreement), row.weight));
            LEVELS.map(|level| scores.quantile(level)).to_vec()
        };
        let (mut of_outside, of_inside) = (factors(&outside), factors(&inside));
        if outside.len() < FEWEST_ROWS {
            of_outside.clone_from(&of_inside);
        }
        Some(Self { floor, inside: of_inside, outside: of_outside, rows: (inside.len(), outside.len()) })
    }

    /// Rows held out, inside the trained range and beyond it, that the band was calibrated on.
    pub fn rows(&self) -> (usize, usize) {
        self.rows
    }

    /// Half the width of the band at a row, in the output's unit.
    pub(crate) fn half_width(&self, level: f64, disagreement: f64, outside: f64) -> f64 {
        let inside = factor(&self.inside, level);
        let factor = inside + outside * (factor(&self.outside, level) - inside);
        factor * self.floor.hypot(disagreement)
    }

    /// Refuses a probability that the band was not calibrated for.
    pub(crate) fn check(level: f64) -> Result<()> {
        let (least, most) = (LEVELS[0], LEVELS[LEVELS.len() - 1]);
        if (least..=most).contains(&level) {
            return Ok(());
        }
        Err(Error::Option(format!("a band of {level}: choose a probability from {least} to {most}")))
    }

    /// Refuses factors of a file that are none.
    pub(crate) fn validated(self) -> Result<Self> {
        let is_sound = |factors: &[f64]| {
            factors.len() == LEVELS.len() && factors.iter().all(|factor| *factor >= 0.0 && factor.is_finite())
        };
        if is_sound(&self.inside) && is_sound(&self.outside) && self.floor > 0.0 && self.floor.is_finite() {
            return Ok(self);
        }
        Err(Error::Option("its band is not a band".into()))
    }
}

/// Interpolated between the levels.
fn factor(factors: &[f64], level: f64) -> f64 {
    let above = LEVELS.iter().position(|known| *known >= level).unwrap_or(LEVELS.len() - 1).max(1);
    let share = (level - LEVELS[above - 1]) / (LEVELS[above] - LEVELS[above - 1]);
    factors[above - 1] + share.clamp(0.0, 1.0) * (factors[above] - factors[above - 1])
}

//! Prediction band: limits about the output between which the measured output lies with a given probability.
//!
//! ```text
//! y ± q(p) √(f² + d²)                                                      theory.md (11.7)
//! q(p) = quantile_p of |y_measured - y| / √(f² + d²)    on held-out rows
//! ```
//!
//! `y` is the output of the model at a row and `p` the probability. `d` is the disagreement of the members of
//! the ensemble at that row: half the distance between the 15.9 % and 84.1 % quantiles of their outputs. `f`
//! is half the median held-out error, in the unit of the output.
//!
//! This is split conformal prediction. The factors `q(p)` are separate for rows inside and outside the
//! trained range.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::model::ensemble::Predictions;

/// Probabilities for which the factors are stored.
const LEVELS: [f64; 10] = [0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.925, 0.95, 0.975, 0.99];

/// The smallest and largest probability of a band.
pub const BAND_PROBABILITIES: RangeInclusive<f64> = LEVELS[0]..=LEVELS[LEVELS.len() - 1];

/// A calibrated prediction band `y ± q(p) √(f² + d²)` (theory.md (11.7)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// `f`: half the median held-out error, in the output's unit.
    floor: f64,
    /// `q` inside the trained range, at each of the levels.
    inside: Vec<f64>,
    /// `q` beyond it.
    outside: Vec<f64>,
    /// Rows held out that the factors inside and outside were found on.
    rows: (usize, usize),
}

/// A simulated record with its prediction band.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Output of each row, in the user's unit.
    pub output: Vec<f64>,
    /// Lower limit of the band for each row, in the user's unit.
    pub low: Vec<f64>,
    /// Upper limit, likewise.
    pub high: Vec<f64>,
}

impl Prediction {
    /// The number of rows whose measured output (not NaN) lies within the band, and the number of rows with a
    /// measured output.
    pub fn covered(&self, measured: &[f64]) -> (usize, usize) {
        let edges = self.low.iter().zip(&self.high);
        let scored = measured.iter().zip(edges).filter(|(y, _)| !y.is_nan());
        scored.fold((0, 0), |(covered, all), (y, (low, high))| {
            (covered + usize::from((low..=high).contains(&y)), all + 1)
        })
    }
}

/// Result on a held-out row.
#[derive(Debug, Clone, Copy)]
pub struct HeldOutRow {
    /// Measured less simulated output.
    pub error: f64,
    /// Disagreement `d` of the members: [`disagreement`].
    pub disagreement: f64,
    /// How far the record had been outside the range of the fold's training data, 0 to 1.
    pub outside: f64,
    /// Weight of the row; each fold has the same total.
    pub weight: f64,
}

/// Disagreement `d` of the members: half the distance between the 15.9 % and 84.1 % weighted quantiles of
/// their outputs. For a normal distribution it is one standard deviation.
pub fn disagreement(votes: &mut Predictions) -> f64 {
    0.5 * (votes.quantile(0.841) - votes.quantile(0.159))
}

/// Least number of rows for a calibration.
const FEWEST_ROWS: usize = 20;

/// The quantile level `p (1 + 1/n)` of `n` rows, below which a further row lies with the probability `p`
/// (theory.md (11.7)).
fn of_rows(level: f64, rows: usize) -> f64 {
    (level * (1.0 + 1.0 / rows as f64)).min(1.0)
}

impl Band {
    /// A band calibrated on held-out rows; `None` if they are too few.
    pub fn calibrate(rows: &[HeldOutRow]) -> Option<Self> {
        let (outside, inside): (Vec<HeldOutRow>, Vec<HeldOutRow>) =
            rows.iter().partition(|row| row.outside > 0.5);
        if rows.len() < FEWEST_ROWS {
            return None;
        }
        let mut errors = Predictions::default();
        rows.iter().for_each(|row| errors.push(row.error.abs(), row.weight));
        // A typical error, so that rows where all members agree by chance do not ask for factors beyond all
        // reason.
        let floor = 0.5 * errors.quantile(0.5).max(f64::MIN_POSITIVE);
        let factors = |of: &[HeldOutRow]| {
            let rows = if of.len() < FEWEST_ROWS { rows } else { of };
            let mut scores = Predictions::default();
            rows.iter()
                .for_each(|row| scores.push(row.error.abs() / floor.hypot(row.disagreement), row.weight));
            LEVELS.map(|level| scores.quantile(of_rows(level, rows.len()))).to_vec()
        };
        let (mut of_outside, of_inside) = (factors(&outside), factors(&inside));
        if outside.len() < FEWEST_ROWS {
            of_outside.clone_from(&of_inside);
        }
        Some(Self { floor, inside: of_inside, outside: of_outside, rows: (inside.len(), outside.len()) })
    }

    /// The same band, wider by the factor `times`.
    pub fn wider(mut self, times: f64) -> Self {
        self.inside.iter_mut().chain(&mut self.outside).for_each(|factor| *factor *= times);
        self
    }

    /// Numbers of held-out rows, inside and outside the trained range, of the calibration.
    pub fn rows(&self) -> (usize, usize) {
        self.rows
    }

    /// Half the width of the band at a row, in the output's unit.
    pub(crate) fn half_width(&self, level: f64, disagreement: f64, outside: f64) -> f64 {
        let inside = factor(&self.inside, level);
        let factor = inside + outside * (factor(&self.outside, level) - inside);
        factor * self.floor.hypot(disagreement)
    }

    /// Rejects a probability outside those of the calibration.
    pub(crate) fn check(level: f64) -> Result<()> {
        if BAND_PROBABILITIES.contains(&level) {
            return Ok(());
        }
        let (least, most) = (BAND_PROBABILITIES.start(), BAND_PROBABILITIES.end());
        Err(Error::Probability { probability: level, least: *least, most: *most })
    }

    /// Rejects invalid factors of a file.
    pub(crate) fn validated(self) -> Result<Self> {
        let is_sound = |factors: &[f64]| {
            factors.len() == LEVELS.len() && factors.iter().all(|factor| *factor >= 0.0 && factor.is_finite())
        };
        if is_sound(&self.inside) && is_sound(&self.outside) && self.floor > 0.0 && self.floor.is_finite() {
            return Ok(self);
        }
        Err(Error::Parts("its band is not a band".into()))
    }
}

/// Interpolated between the levels.
fn factor(factors: &[f64], level: f64) -> f64 {
    let above = LEVELS.iter().position(|known| *known >= level).unwrap_or(LEVELS.len() - 1).max(1);
    let share = (level - LEVELS[above - 1]) / (LEVELS[above] - LEVELS[above - 1]);
    factors[above - 1] + share.clamp(0.0, 1.0) * (factors[above] - factors[above - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_within_are_counted_with_the_edges_and_without_blanks() {
        let (output, low, high) = (vec![0.0; 5], vec![-1.0; 5], vec![1.0, 2.0, 3.0, 4.0, 5.0]);
        let predicted = Prediction { output, low, high };
        assert_eq!(predicted.covered(&[1.0, 2.1, f64::NAN, -1.0, -1.1]), (2, 4));
    }

    /// Errors of 1 to 200, all members agree: the floor is half the median, and a band of 90 % has half the
    /// width that nine in ten errors stay below.
    #[test]
    fn a_band_from_few_rows_holds_a_further_row_as_often_as_promised() {
        for rows in [20, 50, 1000] {
            // Where the errors of so many rows lie on average, if all errors from 0 to 1 are equally likely: a
            // further error is below the half width with a probability of the half width.
            let row = |k: i32| HeldOutRow {
                error: f64::from(k) / f64::from(rows + 1),
                disagreement: 0.0,
                outside: 0.0,
                weight: 1.0,
            };
            let band = Band::calibrate(&(1..=rows).map(row).collect::<Vec<_>>()).unwrap();
            for level in [0.5, 0.8, 0.9, 0.95] {
                let held = band.half_width(level, 0.0, 0.0);
                assert!(
                    (level..level + 1.0 / f64::from(rows)).contains(&held),
                    "{rows} rows, {level}: {held}"
                );
            }
        }
    }

    #[test]
    fn a_band_is_as_wide_as_the_errors_that_were_found() {
        let row = |error: f64| HeldOutRow { error, disagreement: 0.0, outside: 0.0, weight: 1.0 };
        let rows: Vec<HeldOutRow> =
            (1..=200).map(|k| row(if k % 2 == 0 { f64::from(k) } else { -f64::from(k) })).collect();
        let band = Band::calibrate(&rows).unwrap();
        assert_eq!(band.rows(), (200, 0));
        assert!((band.floor - 0.5 * 100.5).abs() < 1e-12, "{}", band.floor);
        // Each vote stands at the middle of its weight: 0.9 of 201 votes below is between 181 and 182.
        let half = band.half_width(0.9, 0.0, 0.0);
        assert!((half - 181.4).abs() < 1e-9, "{half}");
        assert_eq!(band.half_width(0.9, 0.0, 1.0), half, "nothing is known of the outside");
        assert!((band.half_width(0.9, 2.0 * band.floor, 0.0) - half * 5f64.sqrt()).abs() < 1e-9);
        assert_eq!(Band::calibrate(&rows[..19]), None);
        assert!(Band::check(0.9).is_ok() && Band::check(0.995).is_err() && Band::check(f64::NAN).is_err());
    }
}

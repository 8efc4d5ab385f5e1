//! Prediction band: limits about the output between which the measured output lies with a given probability.
//!
//! ```text
//! y ± g_k q(p) √(f² + d²)                                                  theory.md (11.7)
//! q(p) = median over the folds of quantile_p of |y_measured - y| / √(f² + d²)    on the held-out rows of a fold
//! g_k  = e^{σ z(k/10)},   k = 5 .. 9                                       theory.md (11.12)
//! ```
//!
//! Each `q(p)` is at least the quantile of the same quotient over the training rows.
//!
//! `y` is the output of the model at a row and `p` the probability. `d` is the disagreement of the members of
//! the ensemble at that row: half the distance between the 15.9 % and 84.1 % quantiles of their outputs. `f`
//! is half the median held-out error, in the unit of the output.
//!
//! For one fold this is split conformal prediction. A data set to come is one fold more: its own quantile is
//! above the median of the folds as often as below, so the band contains the share `p` of its rows, or more, in
//! five of ten data sets. `g_k` widens it for `k` of ten; `z` is the quantile function of the normal
//! distribution. The factors `q(p)` are separate for rows inside and outside the trained range.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::elementary::{exp, hypot};
use crate::error::{Error, Result};
use crate::model::ensemble::Predictions;

/// Probabilities for which the factors are stored.
const LEVELS: [f64; 10] = [0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.925, 0.95, 0.975, 0.99];

/// Half the width of a band of normal errors of deviation 1, for each of [`LEVELS`].
const HALVES_OF_NORMAL: [f64; 10] = [
    0.674_490, 0.841_621, 1.036_433, 1.281_552, 1.439_531, 1.644_854, 1.780_464, 1.959_964, 2.241_403,
    2.575_829,
];

/// The level at which two bands are compared.
const TYPICAL: f64 = 0.9;

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
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Prediction {
    /// Output of each row, in the user's unit.
    pub output: Vec<f64>,
    /// Lower limit of the band for each row, in the user's unit.
    pub low: Vec<f64>,
    /// Upper limit, likewise.
    pub high: Vec<f64>,
}

impl Prediction {
    /// Numbers of rows with a measured output within the band, and of rows with a measured output.
    pub fn covered(&self, measured: &[f64]) -> (usize, usize) {
        let edges = self.low.iter().zip(&self.high);
        let scored = measured.iter().zip(edges).filter(|(y, _)| !y.is_nan());
        scored.fold((0, 0), |(covered, all), (y, (low, high))| {
            (covered + usize::from((low..=high).contains(&y)), all + 1)
        })
    }
}

/// How much a band contains: a share of the rows, in so many of ten data sets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandLevel {
    /// Share of the rows, 0.5 to 0.99.
    pub probability: f64,
    /// Data sets of ten in which the band contains this share of the rows or more, 5 to 9.
    pub of_ten: usize,
}

impl From<f64> for BandLevel {
    fn from(probability: f64) -> Self {
        Self { probability, of_ten: *BAND_OF_TEN.start() }
    }
}

/// The fewest and the most data sets of ten that a band can be for.
pub const BAND_OF_TEN: RangeInclusive<usize> = 5..=9;

/// Standard deviation of ln(needed width/width) of data sets at a probability of 0.9 (docs/accuracy.md).
const SPREAD_OF_WIDTHS: f64 = 0.62;

/// `z(k/10)`, quantiles of the normal distribution, for each of [`BAND_OF_TEN`].
const NORMAL_QUANTILES: [f64; 5] = [0.0, 0.253_347, 0.524_401, 0.841_621, 1.281_552];

impl BandLevel {
    pub(crate) fn check(self) -> Result<()> {
        let Self { probability, of_ten } = self;
        if !BAND_PROBABILITIES.contains(&probability) {
            let (least, most) = (BAND_PROBABILITIES.start(), BAND_PROBABILITIES.end());
            return Err(Error::Probability { probability, least: *least, most: *most });
        }
        if !BAND_OF_TEN.contains(&of_ten) {
            return Err(Error::DataSetsOfTen(of_ten));
        }
        Ok(())
    }

    /// `g_k`: times the width of the band for five of ten data sets (theory.md (11.12)).
    fn widening(self) -> f64 {
        let place = self.of_ten.saturating_sub(*BAND_OF_TEN.start()).min(NORMAL_QUANTILES.len() - 1);
        exp(SPREAD_OF_WIDTHS * NORMAL_QUANTILES[place])
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

/// Disagreement `d`: half the distance between the 15.9 % and 84.1 % weighted quantiles of the outputs.
pub fn disagreement(votes: &mut Predictions) -> f64 {
    0.5 * (votes.quantile(0.841) - votes.quantile(0.159))
}

/// Least number of rows for a calibration.
const FEWEST_ROWS: usize = 20;

/// The level `p (1 + 1/n)` of `n` rows, below which a further row lies with the probability `p` (theory.md (11.7)).
fn of_rows(level: f64, rows: usize) -> f64 {
    (level * (1.0 + 1.0 / rows as f64)).min(1.0)
}

/// The factors of the levels: medians over the folds that have rows enough, or those of all rows if none has.
fn factors(folds: &[Vec<HeldOutRow>], floor: f64) -> Vec<f64> {
    let scores = |rows: &[HeldOutRow]| {
        let mut scores = Predictions::default();
        rows.iter().for_each(|row| scores.push(row.error.abs() / hypot(floor, row.disagreement), row.weight));
        (scores, rows.len())
    };
    let mut of_folds: Vec<(Predictions, usize)> =
        folds.iter().filter(|fold| fold.len() >= FEWEST_ROWS).map(|fold| scores(fold)).collect();
    if of_folds.is_empty() {
        of_folds.push(scores(&folds.concat()));
    }
    let median = |level: f64| {
        let mut quantiles = Predictions::default();
        for (scores, rows) in &mut of_folds {
            quantiles.push(scores.quantile(of_rows(level, *rows)), 1.0);
        }
        quantiles.quantile(0.5)
    };
    LEVELS.map(median).to_vec()
}

impl Band {
    /// A band calibrated on the held-out rows of each fold; `None` if they are too few in all.
    pub fn calibrate(folds: &[Vec<HeldOutRow>]) -> Option<Self> {
        let all: Vec<HeldOutRow> = folds.iter().flatten().copied().collect();
        if all.len() < FEWEST_ROWS {
            return None;
        }
        let mut errors = Predictions::default();
        all.iter().for_each(|row| errors.push(row.error.abs(), row.weight));
        // A typical error, so that rows where all members agree by chance need no huge factors.
        let floor = 0.5 * errors.quantile(0.5).max(f64::MIN_POSITIVE);
        let of_class = |is_outside: bool| -> Vec<Vec<HeldOutRow>> {
            let of_fold = |fold: &Vec<HeldOutRow>| {
                fold.iter().copied().filter(|row| (row.outside > 0.5) == is_outside).collect()
            };
            folds.iter().map(of_fold).collect()
        };
        let (inside, outside) = (of_class(false), of_class(true));
        let rows = |class: &[Vec<HeldOutRow>]| class.iter().map(Vec::len).sum::<usize>();
        let of_inside =
            if rows(&inside) < FEWEST_ROWS { factors(folds, floor) } else { factors(&inside, floor) };
        let of_outside =
            if rows(&outside) < FEWEST_ROWS { of_inside.clone() } else { factors(&outside, floor) };
        Some(Self { floor, inside: of_inside, outside: of_outside, rows: (rows(&inside), rows(&outside)) })
    }

    /// The same band, wider by the factor `times`.
    pub fn wider(mut self, times: f64) -> Self {
        self.inside.iter_mut().chain(&mut self.outside).for_each(|factor| *factor *= times);
        self
    }

    /// The same band, or one of normal errors of this standard deviation where that is wider: errors that the held-out rows
    /// could not show.
    pub fn for_unseen(self, deviation: f64) -> Self {
        let quantiles = HALVES_OF_NORMAL.to_vec();
        if factor(&self.inside, TYPICAL) * self.floor >= factor(&quantiles, TYPICAL) * deviation {
            return self;
        }
        let beyond = |(outside, inside): (f64, f64)| (outside / inside).max(1.0);
        let ratios = self.outside.iter().copied().zip(self.inside.iter().copied()).map(beyond);
        let outside = ratios.zip(&quantiles).map(|(ratio, quantile)| ratio * quantile).collect();
        Self { floor: deviation, inside: quantiles, outside, ..self }
    }

    /// The same band, at each level at least as wide as the training errors, each over `√(f² + d²)`.
    pub(crate) fn at_least(mut self, errors: &mut Predictions) -> Self {
        for (place, level) in LEVELS.into_iter().enumerate() {
            let needed = errors.quantile(level);
            if needed > self.inside[place] {
                self.inside[place] = needed;
                self.outside[place] = self.outside[place].max(needed);
            }
        }
        self
    }

    /// The typical error of a row with such a disagreement, `√(f² + d²)`, in the output's unit.
    pub(crate) fn scale(&self, disagreement: f64) -> f64 {
        hypot(self.floor, disagreement)
    }

    /// Numbers of held-out rows, inside and outside the trained range, of the calibration.
    pub fn rows(&self) -> (usize, usize) {
        self.rows
    }

    /// Half the width of the band at a row, in the output's unit.
    pub(crate) fn half_width(&self, level: BandLevel, disagreement: f64, outside: f64) -> f64 {
        let (inside, far_outside) = self.factors(level);
        let factor = inside + outside * (far_outside - inside);
        level.widening() * factor * self.scale(disagreement)
    }

    /// `q` inside and outside the trained range, without the widening for other data sets.
    fn factors(&self, level: BandLevel) -> (f64, f64) {
        (factor(&self.inside, level.probability), factor(&self.outside, level.probability))
    }

    /// `g_k q` inside and outside the trained range, and `f` in the unit of the output: half the width of the band is
    /// `g_k q √(f² + d²)` (theory.md (11.7), (11.12)).
    ///
    /// # Errors
    /// A probability that is not from 0.5 to 0.99, or not 5 to 9 of ten.
    pub fn terms(&self, level: BandLevel) -> Result<(f64, f64, f64)> {
        level.check()?;
        let (inside, outside) = self.factors(level);
        Ok((level.widening() * inside, level.widening() * outside, self.floor))
    }

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

    #[test]
    fn a_band_holds_its_share_of_the_training_rows() {
        let rows: Vec<HeldOutRow> = (1..=200)
            .map(|k| HeldOutRow { error: f64::from(k), disagreement: 0.0, outside: 0.0, weight: 1.0 })
            .collect();
        let band = Band::calibrate(std::slice::from_ref(&rows)).unwrap();
        let with_errors = |times: f64| {
            let mut errors = Predictions::default();
            rows.iter().for_each(|row| errors.push(times * row.error / band.scale(0.0), 1.0));
            band.clone().at_least(&mut errors)
        };
        let half = |band: &Band| band.half_width(0.9.into(), 0.0, 0.0);
        assert_eq!(with_errors(0.5), band, "smaller errors change nothing");
        let wide = with_errors(3.0);
        let held = rows.iter().filter(|row| 3.0 * row.error <= half(&wide)).count();
        assert!((180..=182).contains(&held), "{held}");
        assert!(wide.half_width(0.9.into(), 0.0, 1.0) >= half(&wide));
    }

    #[test]
    fn a_band_for_unseen_errors_is_that_of_a_normal_number_where_it_is_wider() {
        let rows: Vec<HeldOutRow> = (1..=200)
            .map(|k| HeldOutRow { error: 1e-3 * f64::from(k), disagreement: 0.0, outside: 0.0, weight: 1.0 })
            .collect();
        let band = Band::calibrate(&[rows]).unwrap();
        assert_eq!(band.clone().for_unseen(0.01), band);
        let wide = band.for_unseen(2.0);
        for (probability, half) in [(0.5, 0.674_49), (0.9, 1.644_854), (0.99, 2.575_829)] {
            let found = wide.half_width(probability.into(), 0.0, 0.0);
            assert!((found / (2.0 * half) - 1.0).abs() < 1e-6, "{found}");
            // A member that disagrees adds to it as an independent error would.
            let found = wide.half_width(probability.into(), 1.5, 0.0);
            assert!((found / (2.5 * half) - 1.0).abs() < 1e-6, "{found}");
        }
    }

    /// Errors of 1 to 200, all members agree: the floor is half the median, and a band of 90 % has half the
    /// width that nine in ten errors stay below.
    #[test]
    fn a_band_from_few_rows_holds_a_further_row_as_often_as_promised() {
        for rows in [20, 50, 1000] {
            // Average places of so many errors that are evenly distributed from 0 to 1.
            let row = |k: i32| HeldOutRow {
                error: f64::from(k) / f64::from(rows + 1),
                disagreement: 0.0,
                outside: 0.0,
                weight: 1.0,
            };
            let band = Band::calibrate(&[(1..=rows).map(row).collect()]).unwrap();
            for level in [0.5, 0.8, 0.9, 0.95] {
                let held = band.half_width(level.into(), 0.0, 0.0);
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
        let band = Band::calibrate(std::slice::from_ref(&rows)).unwrap();
        assert_eq!(band.rows(), (200, 0));
        assert!((band.floor - 0.5 * 100.5).abs() < 1e-12, "{}", band.floor);
        // Each vote stands at the middle of its weight: 0.9 of 201 votes below is between 181 and 182.
        let half = band.half_width(0.9.into(), 0.0, 0.0);
        assert!((half - 181.4).abs() < 1e-9, "{half}");
        assert_eq!(band.half_width(0.9.into(), 0.0, 1.0), half, "nothing is known of the outside");
        assert!((band.half_width(0.9.into(), 2.0 * band.floor, 0.0) - half * 5f64.sqrt()).abs() < 1e-9);
        assert_eq!(Band::calibrate(&[rows[..19].to_vec()]), None);
        let is_refused = |probability: f64| BandLevel::from(probability).check().is_err();
        assert!(!is_refused(0.9) && is_refused(0.995) && is_refused(f64::NAN));
        for of_ten in 0..12 {
            let level = BandLevel { probability: 0.9, of_ten };
            assert_eq!(level.check().is_ok(), (5..=9).contains(&of_ten), "{of_ten}");
        }
        let of_nine = BandLevel { probability: 0.9, of_ten: 9 };
        let times = band.half_width(of_nine, 0.0, 0.0) / half;
        assert!((times - exp(SPREAD_OF_WIDTHS * 1.281_552)).abs() < 1e-12);
    }

    /// Four folds of small errors and one of errors a hundred times as large: the band is that of the third.
    #[test]
    fn one_bad_fold_does_not_decide_the_width() {
        let fold = |size: f64| -> Vec<HeldOutRow> {
            let row = |k: i32| HeldOutRow {
                error: size * f64::from(k) / 100.0,
                disagreement: 0.0,
                outside: 0.0,
                weight: 0.01,
            };
            (1..=100).map(row).collect()
        };
        let band = Band::calibrate(&[fold(1.0), fold(1.2), fold(100.0), fold(1.1), fold(0.9)]).unwrap();
        let alone = Band::calibrate(&[fold(1.1)]).unwrap();
        let half = |band: &Band| band.half_width(0.9.into(), 0.0, 0.0);
        assert!((half(&band) - half(&alone)).abs() < 1e-9, "{} and {}", half(&band), half(&alone));
        // Folds too short to tell are counted together.
        let short: Vec<Vec<HeldOutRow>> = fold(1.0).chunks(10).map(<[HeldOutRow]>::to_vec).collect();
        let together = Band::calibrate(&short).unwrap();
        assert!((half(&together) - half(&Band::calibrate(&[fold(1.0)]).unwrap())).abs() < 1e-9);
    }
}

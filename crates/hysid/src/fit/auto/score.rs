//! Scores of candidates on held-out data, and the weights that follow.
//!
//! ```text
//! S = weighted mean over the folds f of ln(rmse_f / σ_f)                   theory.md (11.5)
//! w = (e^S / e^{S_best})^{-p}                                              theory.md (11.6)
//! ```

use hysid_core::elementary::{exp, hypot, ln};

use crate::fit::auto::trial::{FoldRows, HeldOut};
use crate::model::Weights;

/// Rows of a class in a fold below which it says nothing of the class.
const FEWEST_ROWS: usize = 5;

/// Share of a fold's rows below which a class says nothing.
const LEAST_SHARE: f64 = 0.05;

/// Weight of the rows of the own class in a score; the rest is the other class's. Designed.
const OWN_CLASS: f64 = 0.75;

/// Bounds of errors in a score, as shares of the standard deviation.
const ERRORS: (f64, f64) = (1e-12, 1e150);

/// Weight of a fold that holds out records beyond the others; that of any other fold is 1. Designed.
const WEIGHT_BEYOND: f64 = 0.25;

/// Weighted mean over the folds of `ln(rmse_f / σ_f)`, for rows inside and outside the trained range (theory.md (11.5)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Score {
    pub inside: f64,
    pub outside: f64,
}

impl Score {
    /// Of what is predicted on each fold; of the folds that are `counted`, by their place.
    pub fn of(predicted: &[Vec<f64>], folds: &[HeldOut], counted: impl Fn(usize) -> bool) -> Self {
        let counted: Vec<(&Vec<f64>, &HeldOut)> = predicted
            .iter()
            .zip(folds)
            .enumerate()
            .filter(|(fold, _)| counted(*fold))
            .map(|(_, fold)| fold)
            .collect();
        let class = |is_outside: bool| {
            weighted_mean(counted.iter().filter_map(|(predicted, HeldOut { rows: fold, is_beyond, .. })| {
                let rows =
                    || squares(predicted, fold).filter(move |(_, outside)| (*outside > 0.5) == is_outside);
                let share = rows().count() as f64 / fold.measured.len() as f64;
                let is_enough = rows().count() >= FEWEST_ROWS && share >= LEAST_SHARE;
                let error = || logarithm(rows().map(|(square, _)| square), fold.deviation);
                is_enough.then(|| (error(), weight(*is_beyond)))
            }))
        };
        let all = || {
            let of_fold = |(predicted, HeldOut { rows, is_beyond, .. }): &(&Vec<f64>, &HeldOut)| {
                let squares = squares(predicted, rows).map(|(square, _)| square);
                (logarithm(squares, rows.deviation), weight(*is_beyond))
            };
            weighted_mean(counted.iter().map(of_fold)).unwrap_or_default()
        };
        let (inside, outside) = match (class(false), class(true)) {
            (Some(inside), Some(outside)) => (
                OWN_CLASS * inside + (1.0 - OWN_CLASS) * outside,
                OWN_CLASS * outside + (1.0 - OWN_CLASS) * inside,
            ),
            (Some(one), None) | (None, Some(one)) => (one, one),
            // No fold has rows enough of either class.
            (None, None) => (all(), all()),
        };
        Self { inside, outside }
    }

    /// With the error expected on unseen loops, as a share of the standard deviation (theory.md (11.14)).
    pub fn with_unseen(self, error: f64) -> Self {
        if error == 0.0 {
            return self;
        }
        let with = |score: f64| ln(hypot(exp(score), error));
        Self { inside: with(self.inside), outside: with(self.outside) }
    }

    /// At least this error, as a share of the standard deviation: a model that misses the data it was fitted to is no
    /// better on others, even if the rows held out happen to be easy.
    pub fn at_least(self, error: f64) -> Self {
        let least = logarithm(std::iter::once(error * error), 1.0);
        Self { inside: self.inside.max(least), outside: self.outside.max(least) }
    }

    /// Both classes alike.
    pub fn sum(self) -> f64 {
        self.inside + self.outside
    }

    /// Both classes alike, as one error in percent of the standard deviation.
    pub fn mean_percent(self) -> f64 {
        100.0 * exp(0.5 * self.sum())
    }

    /// As errors in percent of the standard deviation.
    pub fn percent(self) -> (f64, f64) {
        (100.0 * exp(self.inside), 100.0 * exp(self.outside))
    }
}

/// Weighted squared error of each row, and how far outside the trained range it is.
fn squares<'a>(predicted: &'a [f64], fold: &'a FoldRows) -> impl Iterator<Item = (f64, f64)> + 'a {
    let rows = predicted.iter().zip(&fold.measured).zip(&fold.outside).enumerate();
    rows.map(|(row, ((predicted, measured), outside))| {
        let weight = fold.weights.get(row).copied().unwrap_or(1.0);
        (weight * (predicted - measured) * (predicted - measured), *outside)
    })
}

fn logarithm(squares: impl Iterator<Item = f64>, deviation: f64) -> f64 {
    let (rows, sum) = squares.fold((0, 0.0), |(rows, sum), square| (rows + 1, sum + square));
    let error = (sum / f64::from(rows.max(1))).sqrt() / deviation;
    // No error at all may look like a small one.
    let error = if error.is_nan() { ERRORS.1 } else { error };
    ln(error.clamp(ERRORS.0, ERRORS.1))
}

fn weight(is_beyond: bool) -> f64 {
    if is_beyond { WEIGHT_BEYOND } else { 1.0 }
}

/// Mean of values, each with its weight; `None` of no values.
fn weighted_mean(values: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let (weights, sum) =
        values.fold((0.0, 0.0), |(weights, sum), (value, weight)| (weights + weight, sum + weight * value));
    (weights > 0.0).then(|| sum / weights)
}

/// Weights `(score / best)^-power` (theory.md (11.6)); 0 after the best `most` in either class.
pub(super) fn weights(scores: &[Score], power: f64, most: usize) -> Vec<Weights> {
    let of_class = |score: fn(&Score) -> f64| -> Vec<f64> {
        let best = scores.iter().map(score).fold(f64::INFINITY, f64::min);
        let mut order: Vec<usize> = (0..scores.len()).collect();
        order.sort_by(|&a, &b| score(&scores[a]).total_cmp(&score(&scores[b])));
        let mut weights = vec![0.0; scores.len()];
        for &index in order.iter().take(most) {
            weights[index] = exp(power * (best - score(&scores[index])));
        }
        weights
    };
    let (inside, outside) = (of_class(|score| score.inside), of_class(|score| score.outside));
    inside.into_iter().zip(outside).map(|(inside, outside)| Weights { inside, outside }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_fall_with_the_power_of_the_error() {
        let score = |inside: f64, outside: f64| Score { inside: ln(inside), outside: ln(outside) };
        let weights = weights(&[score(2.0, 1.0), score(1.0, 3.0), score(4.0, 2.0)], 4.0, 2);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(close(weights[0].inside, 1.0 / 16.0) && close(weights[0].outside, 1.0));
        assert!(close(weights[1].inside, 1.0) && weights[1].outside == 0.0);
        assert!(weights[2].inside == 0.0 && close(weights[2].outside, 1.0 / 16.0));
    }

    #[test]
    fn a_fold_beyond_the_others_counts_a_quarter() {
        let mean = weighted_mean([(1.0, weight(false)), (6.0, weight(true))].into_iter()).unwrap();
        assert!((mean - 2.0).abs() < 1e-15);
        // Where all are beyond the others, they count alike.
        let alike = weighted_mean([(1.0, weight(true)), (6.0, weight(true))].into_iter()).unwrap();
        assert!((alike - 3.5).abs() < 1e-15);
        assert!(weighted_mean(std::iter::empty()).is_none());
    }

    #[test]
    fn a_model_that_misses_its_own_data_is_no_better_elsewhere() {
        let easy = Score { inside: ln(0.01), outside: ln(0.2) };
        let floored = easy.at_least(0.1);
        assert!((floored.inside - ln(0.1)).abs() < 1e-12 && floored.outside == easy.outside);
        assert_eq!(easy.at_least(0.0), easy);
    }

    #[test]
    fn no_error_that_is_none_looks_small() {
        assert_eq!(logarithm([f64::NAN].into_iter(), 1.0), ln(ERRORS.1));
        assert_eq!(logarithm([f64::INFINITY].into_iter(), 1.0), ln(ERRORS.1));
        assert_eq!(logarithm([0.0].into_iter(), 1.0), ln(ERRORS.0));
        assert!((logarithm([4.0, 4.0].into_iter(), 2.0)).abs() < 1e-15);
    }
}

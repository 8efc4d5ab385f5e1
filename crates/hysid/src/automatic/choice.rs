//! What candidates count, by what they foretold: theory.md (11.5) and (11.6).

use crate::automatic::trials::{Judge, Trial};
use crate::model::{Votes, Weights};

/// Rows of a class in a fold below which it says nothing of the class.
const FEWEST_ROWS: usize = 5;

/// What the rows of its own class count for a score; the rest goes to the other class. Designed.
const OWN_CLASS: f64 = 0.75;

/// Mean over the folds of the logarithm of the error, theory.md (11.5): rows inside the trained range and
/// rows beyond it apart. The logarithm, so that one fold that goes far beyond the others does not decide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Score {
    pub inside: f64,
    pub outside: f64,
}

impl Score {
    /// Of what is foretold on each fold.
    pub fn of(foretold: &[Vec<f64>], judges: &[Judge]) -> Self {
        let mean = |is_outside: bool| {
            let of_folds = foretold.iter().zip(judges).filter_map(|(foretold, judge)| {
                let (mut rows, mut squares) = (0, 0.0);
                for ((foretold, measured), outside) in
                    foretold.iter().zip(&judge.measured).zip(&judge.outside)
                {
                    if (*outside > 0.5) == is_outside {
                        rows += 1;
                        squares += (foretold - measured) * (foretold - measured);
                    }
                }
                let share = rows as f64 / judge.measured.len() as f64;
                (rows >= FEWEST_ROWS && share >= 0.05)
                    .then(|| ((squares / rows as f64).sqrt() / judge.deviation).max(1e-12).ln())
            });
            let (count, sum) = of_folds.fold((0, 0.0), |(count, sum), error| (count + 1, sum + error));
            (count > 0).then(|| sum / f64::from(count))
        };
        let (inside, outside) = match (mean(false), mean(true)) {
            (Some(inside), Some(outside)) => (
                OWN_CLASS * inside + (1.0 - OWN_CLASS) * outside,
                OWN_CLASS * outside + (1.0 - OWN_CLASS) * inside,
            ),
            (Some(one), None) | (None, Some(one)) => (one, one),
            // No fold has rows enough of either class.
            (None, None) => (0.0, 0.0),
        };
        Self { inside, outside }
    }
}

/// Weights by scores, theory.md (11.6): (score / best)^-power, and 0 behind the best `most` in either class.
pub(super) fn weights(scores: &[Score], power: f64, most: usize) -> Vec<Weights> {
    let of_class = |score: fn(&Score) -> f64| -> Vec<f64> {
        let best = scores.iter().map(score).fold(f64::INFINITY, f64::min);
        let mut order: Vec<usize> = (0..scores.len()).collect();
        order.sort_by(|&a, &b| score(&scores[a]).total_cmp(&score(&scores[b])));
        let mut weights = vec![0.0; scores.len()];
        for &index in order.iter().take(most) {
            weights[index] = (power * (best - score(&scores[index]))).exp();
        }
        weights
    };
    let (inside, outside) = (of_class(|score| score.inside), of_class(|score| score.outside));
    inside.into_iter().zip(outside).map(|(inside, outside)| Weights { inside, outside }).collect()
}

/// The median of the starts of a candidate, fold by fold.
pub(super) fn of_starts(trial: &Trial) -> Vec<Vec<f64>> {
    let of_fold = |starts: &Vec<Vec<f64>>| {
        let voices: Vec<&[f64]> = starts.iter().map(Vec::as_slice).collect();
        medians(&voices, &vec![Weights::equal(); starts.len()], &[])
    };
    trial.folds.iter().map(of_fold).collect()
}

/// The weighted median of several voices, row by row; `outside` may be empty where it makes no difference.
pub(super) fn medians(voices: &[&[f64]], weights: &[Weights], outside: &[f64]) -> Vec<f64> {
    let mut votes = Votes::default();
    let row = |row: usize| {
        votes.clear();
        for (voice, weights) in voices.iter().zip(weights) {
            votes.cast(voice[row], weights.at(outside.get(row).copied().unwrap_or_default()));
        }
        votes.quantile(0.5)
    };
    (0..voices[0].len()).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_fall_with_the_power_of_the_error() {
        let score = |inside: f64, outside: f64| Score { inside: inside.ln(), outside: outside.ln() };
        let weights = weights(&[score(2.0, 1.0), score(1.0, 3.0), score(4.0, 2.0)], 4.0, 2);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(close(weights[0].inside, 1.0 / 16.0) && close(weights[0].outside, 1.0));
        assert!(close(weights[1].inside, 1.0) && weights[1].outside == 0.0);
        assert!(weights[2].inside == 0.0 && close(weights[2].outside, 1.0 / 16.0));
    }

    #[test]
    fn one_wild_start_does_not_move_a_candidate() {
        let trial = Trial { folds: vec![vec![vec![1.0, 2.0], vec![1.2, 2.2], vec![1e9, -1e9]]] };
        assert_eq!(of_starts(&trial), [[1.2, 2.0]]);
    }
}

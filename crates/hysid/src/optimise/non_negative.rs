//! Convex quadratic functions and their minima with sign constraints: non-negative least squares on the
//! normal equations.
//!
//! ```text
//! w = argmin ½ wᵀMw - bᵀw,   w_i ≥ 0 for some i                        theory.md (7.1)
//! ```
//!
//! `M = A + λP` is positive semi-definite.

use std::ops::Range;

use crate::error::{Error, Result};
use crate::linear_algebra::Symmetric;
use crate::optimise::ridge::{NoFactor, factor_with_ridge};
use crate::options::classical::Sign;
use crate::stop_check::StopCheck;

#[derive(Debug, Clone)]
pub(crate) struct WeightBounds {
    bounded: Vec<bool>,
    /// Of the bounded ones, those that are at most 0.
    flipped: Vec<bool>,
}

impl WeightBounds {
    /// Bounds of `count` weights under a sign: those after the first `reversible.end` have it, and those
    /// of `reversible` are at least 0 beside them; those before are free.
    pub fn new(sign: Sign, reversible: Range<usize>, count: usize) -> Self {
        Self {
            bounded: (0..count).map(|i| sign != Sign::Any && i >= reversible.start).collect(),
            flipped: (0..count).map(|i| sign == Sign::NonPositive && i >= reversible.end).collect(),
        }
    }

    /// Weights of `signed` have a sign, those of `positive` are at least 0, the others are free.
    pub fn apart(sign: Sign, signed: Range<usize>, positive: Range<usize>, count: usize) -> Self {
        let has_sign = |i: &usize| sign != Sign::Any && signed.contains(i);
        Self {
            bounded: (0..count).map(|i| has_sign(&i) || positive.contains(&i)).collect(),
            flipped: (0..count).map(|i| sign == Sign::NonPositive && signed.contains(&i)).collect(),
        }
    }

    /// Takes weights back to their bounds.
    pub fn limit(&self, weights: &mut [f64]) {
        let sides = self.bounded.iter().zip(&self.flipped);
        for (weight, (_, &flipped)) in weights.iter_mut().zip(sides).filter(|(_, (bounded, _))| **bounded) {
            *weight = if flipped { weight.min(0.0) } else { weight.max(0.0) };
        }
    }

    fn turn(&self, weights: &mut [f64]) {
        weights.iter_mut().zip(&self.flipped).filter(|(_, flipped)| **flipped).for_each(|(w, _)| *w = -*w);
    }
}

/// The function `½ wᵀMw - bᵀw` to be minimised.
#[derive(Debug, Clone)]
pub(crate) struct Quadratic {
    pub matrix: Symmetric,
    pub right: Vec<f64>,
}

impl Quadratic {
    /// Adds the penalty `½ factor wᵀPw`.
    pub fn penalise(&mut self, penalty: &Penalty, factor: f64) {
        for &(i, j, value) in &penalty.entries {
            self.matrix.add_at(i, j, factor * value);
        }
    }

    /// The minimum, with a ridge if rounding makes the matrix indefinite; `None` once stopped.
    pub fn minimum(&self, stop: StopCheck<'_>) -> Option<Vec<f64>> {
        minimum(&self.matrix, self.right.clone(), stop)
    }

    /// The minimum within bounds, from a guess near it (or none: an empty one); `None` once stopped.
    pub fn minimum_within(
        mut self,
        bounds: &WeightBounds,
        guess: &[f64],
        stop: StopCheck<'_>,
    ) -> Option<Vec<f64>> {
        if !bounds.bounded.contains(&true) {
            return self.minimum(stop);
        }
        self.flip(&bounds.flipped);
        let mut guess = guess.to_vec();
        bounds.turn(&mut guess);
        let mut weights = self.non_negative_minimum(&bounds.bounded, &guess, stop)?;
        bounds.turn(&mut weights);
        Some(weights)
    }

    /// The minimum that a fit ends with. Once stopped, it is still found where that takes little time, else an error.
    pub fn last_minimum(self, bounds: &WeightBounds, stop: StopCheck<'_>) -> Result<Vec<f64>> {
        let stop = if self.right.len() <= QUICKLY_SOLVED { StopCheck::never() } else { stop };
        self.minimum_within(bounds, &[], stop).ok_or(Error::Stopped)
    }

    /// Minima with each of several factors of a penalty, in their order (rising); `None` once stopped.
    pub fn path(
        &self,
        penalty: &Penalty,
        factors: &[f64],
        bounds: &WeightBounds,
        stop: StopCheck<'_>,
    ) -> Option<Vec<Vec<f64>>> {
        let mut path: Vec<Vec<f64>> = Vec::new();
        // From the largest on, each from the one before.
        for &factor in factors.iter().rev() {
            let mut penalised = self.clone();
            penalised.penalise(penalty, factor);
            let guess = path.last().map_or(&[] as &[f64], Vec::as_slice);
            path.push(penalised.minimum_within(bounds, guess, stop)?);
        }
        path.reverse();
        Some(path)
    }

    /// The same function of the weights with some of them of opposite sign.
    fn flip(&mut self, flipped: &[bool]) {
        let n = self.right.len();
        for i in (0..n).filter(|&i| flipped[i]) {
            self.right[i] = -self.right[i];
        }
        for i in 0..n {
            for j in (0..i).filter(|&j| flipped[i] != flipped[j]) {
                let value = self.matrix.at(i, j);
                self.matrix.add_at(i, j, -2.0 * value);
            }
        }
    }

    /// The minimum with `w_i ≥ 0` for all `i` with `bounded[i]`, from a guess which of them are positive
    /// (all, if it is empty); `None` once stopped. Block principal pivoting (Portugal, Júdice and Vicente 1994): variables
    /// change sides all at once while that lowers the number of those on the wrong side, else one at
    /// a time (Murty), which ends for a positive definite matrix.
    pub fn non_negative_minimum(
        &self,
        bounded: &[bool],
        guess: &[f64],
        stop: StopCheck<'_>,
    ) -> Option<Vec<f64>> {
        let n = self.right.len();
        let mut free: Vec<bool> =
            (0..n).map(|i| !bounded[i] || guess.get(i).is_none_or(|&w| w > 0.0)).collect();
        let scale = self.right.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
        let (mut fewest, mut patience) = (n + 1, PATIENCE);
        let mut weights = vec![0.0; n];
        for _ in 0..MOST_PIVOTS {
            let chosen: Vec<usize> = (0..n).filter(|&i| free[i]).collect();
            let right = chosen.iter().map(|&i| self.right[i]).collect();
            let solution = minimum(&self.matrix.select(&chosen), right, stop)?;
            weights.fill(0.0);
            chosen.iter().zip(&solution).for_each(|(&i, &w)| weights[i] = w);
            let product = self.matrix.times(&weights);
            let largest = solution.iter().fold(0.0, |most: f64, w| most.max(w.abs()));
            let is_wrong = |i: &usize| {
                let slope = product[*i] - self.right[*i];
                bounded[*i]
                    && if free[*i] { weights[*i] < -ROUNDING * largest } else { slope < -ROUNDING * scale }
            };
            let wrong: Vec<usize> = (0..n).filter(is_wrong).collect();
            let Some(&last) = wrong.last() else {
                break;
            };
            if wrong.len() < fewest {
                (fewest, patience) = (wrong.len(), PATIENCE);
            } else if patience > 0 {
                patience -= 1;
            } else {
                free[last] = !free[last];
                continue;
            }
            wrong.iter().for_each(|&i| free[i] = !free[i]);
        }
        (0..n).filter(|&i| bounded[i]).for_each(|i| weights[i] = weights[i].max(0.0));
        Some(weights)
    }
}

/// Exchanges of many variables without progress, before they are exchanged singly.
const PATIENCE: usize = 3;

/// Most exchanges, after which negative weights are set to 0; about ten are needed.
const MOST_PIVOTS: usize = 500;

/// Weights that are found within some hundredths of a second.
const QUICKLY_SOLVED: usize = 500;

/// Wrong sides up to this, relative to the largest, are rounding.
const ROUNDING: f64 = 1e-11;

/// The minimum; of a matrix that is not finite, all zeros; `None` once stopped.
fn minimum(matrix: &Symmetric, right: Vec<f64>, stop: StopCheck<'_>) -> Option<Vec<f64>> {
    match factor_with_ridge(matrix, right.len(), 0.0, 0, stop) {
        Ok((factor, _)) => {
            let mut weights = right;
            factor.solve(&mut weights);
            Some(weights)
        }
        Err(NoFactor::Stopped) => None,
        Err(NoFactor::NotFinite) => Some(vec![0.0; right.len()]),
    }
}

/// A penalty `wᵀPw`, sparse.
#[derive(Debug, Clone, Default)]
pub(crate) struct Penalty {
    /// Entries of the lower triangle, `row ≥ column`; several of one place add up.
    entries: Vec<(usize, usize, f64)>,
}

impl Penalty {
    /// `Σ_i weight_i w_i²`
    pub fn ridge(weights: impl IntoIterator<Item = f64>) -> Self {
        let entries = weights.into_iter().enumerate().map(|(i, weight)| (i, i, weight));
        Self { entries: entries.filter(|entry| entry.2 != 0.0).collect() }
    }

    /// Adds `factor (Σ_k c_k w_k)²`, for instance of a difference.
    pub fn add_square(&mut self, combination: &[(usize, f64)], factor: f64) {
        for (k, &(i, a)) in combination.iter().enumerate() {
            for &(j, b) in &combination[..=k] {
                self.entries.push((i.max(j), i.min(j), factor * a * b));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;

    /// Normal equations of made-up rows; with correlated columns, so that bounds bind.
    fn problem(n: usize, rows: usize, seed: u64) -> Quadratic {
        let value = |row: usize, column: usize| {
            let mixed =
                (row as u64 * 31 + column as u64 * 17 + seed * 101).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            (mixed >> 40) as f64 / (1u64 << 24) as f64 - 0.5 + 0.4 * sin((row + 3 * column) as f64 * 0.37)
        };
        let product = |i: usize, j: usize| {
            (0..rows).map(|row| value(row, i) * value(row, j)).sum::<f64>() / rows as f64
        };
        Quadratic { matrix: Symmetric::from_fn(n, product), right: (0..n).map(|i| product(i, n)).collect() }
    }

    fn objective(problem: &Quadratic, weights: &[f64]) -> f64 {
        let product = problem.matrix.times(weights);
        weights.iter().zip(product).zip(&problem.right).map(|((w, p), b)| w * (0.5 * p - b)).sum()
    }

    #[test]
    fn non_negative_least_squares_finds_the_best_of_all_sets() {
        let n = 7;
        let mut bound_somewhere = 0;
        for seed in 0..40 {
            let problem = problem(n, 30, seed);
            let bounded: Vec<bool> = (0..n).map(|i| i != 2).collect();
            let found = problem.non_negative_minimum(&bounded, &[], StopCheck::never()).unwrap();
            let mut best = f64::INFINITY;
            for set in 0..1usize << n {
                let chosen: Vec<usize> = (0..n).filter(|&i| !bounded[i] || set >> i & 1 == 1).collect();
                let right = chosen.iter().map(|&i| problem.right[i]).collect();
                let part = minimum(&problem.matrix.select(&chosen), right, StopCheck::never()).unwrap();
                let mut weights = vec![0.0; n];
                chosen.iter().zip(part).for_each(|(&i, w)| weights[i] = w);
                if (0..n).all(|i| !bounded[i] || weights[i] >= 0.0) {
                    best = best.min(objective(&problem, &weights));
                }
            }
            assert!((objective(&problem, &found) - best).abs() < 1e-12 * best.abs().max(1e-3));
            bound_somewhere += usize::from(found.contains(&0.0));
            // A bad guess leads to the same place.
            let from_zero =
                problem.non_negative_minimum(&bounded, &vec![0.0; n], StopCheck::never()).unwrap();
            for (a, b) in found.iter().zip(&from_zero) {
                approx::assert_relative_eq!(a, b, epsilon = 1e-9);
            }
        }
        assert!(bound_somewhere > 20, "the bounds hardly ever bound");
    }

    #[test]
    fn a_matrix_that_is_not_finite_has_an_end() {
        let mut problem = problem(5, 30, 1);
        problem.matrix.add_at(2, 1, f64::NAN);
        assert_eq!(problem.minimum(StopCheck::never()), Some(vec![0.0; 5]));
    }

    #[test]
    fn optimality_conditions_hold_for_many_weights() {
        let n = 300;
        let mut problem = problem(n, 420, 5);
        problem.penalise(&Penalty::ridge(vec![1.0; n]), 1e-4);
        problem.right.iter_mut().skip(1).step_by(2).for_each(|right| *right = -*right);
        for sign in [Sign::NonNegative, Sign::NonPositive] {
            let bounds = WeightBounds::apart(sign, 10..n, 0..0, n);
            let weights = problem.clone().minimum_within(&bounds, &[], StopCheck::never()).unwrap();
            let product = problem.matrix.times(&weights);
            let side = if sign == Sign::NonNegative { 1.0 } else { -1.0 };
            let mut at_bound = 0;
            for i in 0..n {
                let slope = side * (product[i] - problem.right[i]);
                if i < 10 || weights[i] != 0.0 {
                    assert!(slope.abs() < 1e-9, "{i}: {slope}");
                    assert!(i < 10 || side * weights[i] > 0.0);
                } else {
                    assert!(slope > -1e-9, "{i}: {slope}");
                    at_bound += 1;
                }
            }
            assert!(at_bound > 50 && at_bound < n - 50, "{at_bound} at their bounds");
        }
    }
}

//! States at the beginning of a record, found from its first outputs.
//!
//! ```text
//! min_u  Σ_k r_k²/σ² + |u|²,    s_0 = m + K x_0 + L u                       theory.md (8.62)
//! ```
//!
//! `r_k` is the residual of the free run at the known row `k` and `x_0` the first input. `m + K x_0` is the straight line through
//! the states at the beginning of the training records, `LLᵀ` the covariance about it, and `σ` the root mean square of the
//! residuals in training, or a share of that of the known outputs.

use serde::{Deserialize, Serialize};

use super::cell::{Cell, Input};
use super::parameters::CellLayout;
use super::sensitivities::CellRun;
use crate::error::LARGEST_VALUE;
use crate::law::state_search;
use crate::linear_algebra::{Cholesky, Symmetric};
use crate::random::uniform;
use crate::stop_check::StopCheck;

/// Draws from the distribution of the training states that the search begins from; the best is taken.
const DRAWS: u64 = 30;

/// Steps of the search.
const STEPS: usize = 12;

/// Distribution of the states at the beginning of a record, about those of the cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StatePrior {
    /// `K`: slope of each state by the first input.
    pub slope: Vec<f64>,
    /// `L`, row by row.
    pub factor: Vec<f64>,
    /// `σ` in scaled units, or as a share of the root mean square of the known outputs.
    pub deviation: f64,
    /// True if the deviation is such a share.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_relative: bool,
    /// Rows within which the residual at the end of a known beginning falls to 1/e; 0 for a residual that does not remain.
    pub residual_rows: f64,
}

impl StatePrior {
    /// True for as many states, with a deviation and rows that are possible.
    pub(super) fn is_sound(&self, states: usize) -> bool {
        let is_possible = |value: f64| value.is_finite() && value.abs() <= LARGEST_VALUE;
        self.slope.len() == states
            && self.slope.iter().copied().all(is_possible)
            && self.factor.len() == states * states
            && self.factor.iter().copied().all(is_possible)
            && self.deviation > 0.0
            && is_possible(self.deviation)
            && self.residual_rows >= 0.0
            && is_possible(self.residual_rows)
    }

    /// The prior of these states with their first scaled inputs, about a line through `m` at 0, without a residual that
    /// remains.
    pub fn of(states: &[Vec<f64>], first: &[f64], mean: &[f64], deviation: f64) -> Self {
        let size = mean.len();
        let count = states.len().max(1) as f64;
        let square = first.iter().map(|x| x * x).sum::<f64>().max(f64::MIN_POSITIVE);
        let with_input = |i: usize| states.iter().zip(first).map(move |(state, x)| x * (state[i] - mean[i]));
        let slope: Vec<f64> = (0..size).map(|i| with_input(i).sum::<f64>() / square).collect();
        let entry = |i: usize, j: usize| {
            let rest = |state: &Vec<f64>, x: f64, i: usize| state[i] - mean[i] - slope[i] * x;
            let product = |(state, &x): (&Vec<f64>, &f64)| rest(state, x, i) * rest(state, x, j);
            states.iter().zip(first).map(product).sum::<f64>() / count
        };
        let mut covariance = Symmetric::from_fn(size, entry);
        let largest = (0..size).map(|i| covariance.diagonal(i)).fold(0.0, f64::max);
        // States that never differed stay where they are.
        (0..size).for_each(|i| covariance.add_to_diagonal(i, 1e-6 * largest + 1e-12));
        // States that are not finite have no covariance: they are those of the cell.
        let factor = covariance.cholesky(StopCheck::never());
        let factor = factor.map_or_else(|| vec![0.0; size * size], Cholesky::into_rows);
        Self { slope, factor, deviation, is_relative: false, residual_rows: 0.0 }
    }

    /// `σ` for these outputs.
    fn deviation_for(&self, outputs: &[f64]) -> f64 {
        if !self.is_relative {
            return self.deviation;
        }
        let known = || outputs.iter().filter(|y| !y.is_nan());
        let square = known().map(|y| y * y).sum::<f64>() / known().count().max(1) as f64;
        (self.deviation * square.sqrt()).max(f64::MIN_POSITIVE)
    }

    fn states(&self, mean: &[f64], first: f64, u: &[f64]) -> Vec<f64> {
        let rows = self.slope.iter().zip(self.factor.chunks_exact(mean.len()));
        let spread = |row: &[f64]| row.iter().zip(u).map(|(l, u)| l * u).sum::<f64>();
        mean.iter().zip(rows).map(|(m, (slope, row))| m + slope * first + spread(row)).collect()
    }
}

impl Cell {
    /// The states before the first sample of a record with a known beginning (theory.md (8.62)).
    pub fn found_states(
        &self,
        prior: &StatePrior,
        drive: &[Input],
        further: &[f64],
        outputs: &[f64],
    ) -> Vec<f64> {
        let (drives, further, targets) = (&[drive.to_vec()], &[further.to_vec()], &[outputs.to_vec()]);
        let deviation = prior.deviation_for(outputs);
        let search = StateSearch { cell: self, prior, drives, further, targets, deviation };
        let size = self.initial.len();
        let draw = |number: u64| -> Vec<f64> {
            let at = |place: u64| uniform(number << 32 | place);
            // The sum of twelve uniform numbers less 6 is close to normal.
            let normal = |i: u64| (0..12).map(|k| at(12 * i + k)).sum::<f64>() - 6.0;
            (0..size as u64).map(|i| if number == 0 { 0.0 } else { normal(i) }).collect()
        };
        let drawn = (0..=DRAWS).map(|number| {
            let u = draw(number);
            (search.objective(&u), u)
        });
        let Some((objective, u)) = drawn.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return self.initial.clone();
        };
        let u = state_search::descended(u, objective, STEPS, |u| search.objective(u), |u| search.slope(u));
        search.states(&u)
    }
}

struct StateSearch<'a> {
    cell: &'a Cell,
    prior: &'a StatePrior,
    drives: &'a [Vec<Input>],
    further: &'a [Vec<f64>],
    targets: &'a [Vec<f64>],
    deviation: f64,
}

impl StateSearch<'_> {
    fn states(&self, u: &[f64]) -> Vec<f64> {
        let first = self.drives[0].first().map_or(0.0, |input| input.x);
        self.prior.states(&self.cell.initial, first, u)
    }

    /// Residuals over `σ`, each with its derivatives by `u` behind it if these are requested.
    fn residuals(&self, u: &[f64], with_jacobian: bool) -> Vec<Vec<f64>> {
        let initial = [self.states(u)];
        let run = CellRun {
            cell: self.cell,
            drives: self.drives,
            further: self.further,
            initial: &initial,
            targets: self.targets,
            with_jacobian,
            stop: StopCheck::never(),
        };
        let (terms, size) = (self.cell.output.len(), self.cell.initial.len());
        let states = CellLayout::new(self.cell.shape()).initial;
        let of_row = |row: Vec<f64>| -> Vec<f64> {
            let output: f64 = self.cell.output.iter().zip(&row).map(|(w, term)| w * term).sum();
            let mut entries = vec![output - row[terms]];
            if with_jacobian {
                let by_states = &row[terms + 1..][states.clone()];
                let column =
                    |j: usize| (0..size).map(|i| by_states[i] * self.prior.factor[i * size + j]).sum::<f64>();
                entries.extend((0..size).map(column));
            }
            entries.iter().map(|entry| entry / self.deviation).collect()
        };
        run.rows().unwrap_or_default().into_iter().map(of_row).collect()
    }

    fn objective(&self, u: &[f64]) -> f64 {
        let misfit: f64 = self.residuals(u, false).iter().map(|row| row[0] * row[0]).sum();
        misfit + u.iter().map(|u| u * u).sum::<f64>()
    }

    fn slope(&self, u: &[f64]) -> (Vec<f64>, Symmetric) {
        let rows = self.residuals(u, true);
        let size = u.len();
        let gradient = (0..size).map(|i| u[i] + rows.iter().map(|row| row[0] * row[1 + i]).sum::<f64>());
        let mut curvature =
            Symmetric::from_fn(size, |i, j| rows.iter().map(|row| row[1 + i] * row[1 + j]).sum());
        (0..size).for_each(|i| curvature.add_to_diagonal(i, 1.0));
        (gradient.collect(), curvature)
    }
}

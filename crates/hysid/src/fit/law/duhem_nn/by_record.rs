//! Objective as a sum over records, each weighted by its own size, and free initial states: the states before the first
//! sample of each record, found together with the parameters and eliminated record by record.
//!
//! ```text
//! F = 1/R Σ_r √(ω_r Σ_k (y_k - ŷ_k)² + ε) + ½ λ |w|² + ½ κ |θ|² + ½ μ/R Σ_r |s_0,r - m|²    theory.md (8.63)
//! ω_r = 1/Σ_k y_k²                                                                          theory.md (8.64)
//! ```
//!
//! `s_0,r` are the states before record `r` of `R`; `m` is the initial state of the network, 0 for an odd one. `y` and `ŷ` are
//! the scaled outputs, measured and simulated, at the rows that are compared. With an error of all rows alike, the sum of the
//! roots is replaced by half the mean square error.
//!
//! Each step solves the damped equations of output weights, parameters and states together: the states by a Schur
//! complement for each record, then the output weights. Each root is replaced by a weighted sum of squares with the same
//! gradient.

use crate::fit::law::duhem_nn::{DECAY, DuhemCurvature, DuhemTask, DuhemValue};
use crate::fit::sums::output_weights::OutputSolution;
use crate::law::duhem_nn::{Cell, CellRun, StatePrior};
use crate::law::remaining_share;
use crate::linear_algebra::{Cholesky, Gram, Symmetric, dot};
use crate::optimise::levenberg_marquardt::{Slope, step_within};
use crate::optimise::parallel;
use crate::options::classical::FittedError;
use crate::stop_check::StopCheck;

/// Records whose sums are formed together.
const TOGETHER: usize = 16;

/// Iterations of reweighted least squares for the output weights.
const ROUNDS: usize = 4;

/// `ε`: square of the relative error below which a record counts little. Designed.
const LEAST_SQUARE: f64 = 1e-4;

/// `μ`: penalty of free states. Designed.
const STATE_PENALTY: f64 = 1e-3;

/// Rows within which a residual may fall to 1/e; held-out records choose among them.
const RESIDUAL_ROWS: [f64; 6] = [0.0, 25.0, 50.0, 100.0, 200.0, 400.0];

/// Sum of the squared errors with these output weights.
pub(super) fn square_error(gram: &Gram, weights: &[f64]) -> f64 {
    let target = weights.len();
    let with_target = |i: usize| if i == target { -1.0 } else { weights[i] };
    let row = |i: usize| -> f64 { (0..=target).map(|j| gram.at(i, j) * with_target(j)).sum() };
    (0..=target).map(|i| with_target(i) * row(i)).sum::<f64>().max(0.0)
}

/// Weights of the records in the objective.
pub(super) struct RecordWeights {
    /// `ω_r/R`, or the same for all.
    weights: Vec<f64>,
    /// True for the mean of the relative errors of the records.
    is_relative: bool,
    /// `μ/R` of free states; `None` for records that begin with the initial state of the network.
    penalty: Option<f64>,
}

/// Sums of a record from which its states are eliminated.
struct RecordSums {
    /// Curvature by its states.
    own: Symmetric,
    /// Gradient by its states.
    gradient: Vec<f64>,
    /// Curvature by each state and all output weights and parameters, state by state.
    coupling: Vec<f64>,
}

/// Curvature by output weights, parameters and states.
pub(super) struct FreeCurvature {
    records: Vec<RecordSums>,
    terms: usize,
    /// Lower triangle of the curvature by output weights and parameters, row by row.
    matrix: Vec<f64>,
    /// Gradient by the same.
    gradient: Vec<f64>,
}

impl FreeCurvature {
    /// The damped step of parameters and states, within bounds of the parameters.
    pub fn step(
        &self,
        damping: &[f64],
        leaves: impl Fn(usize, f64) -> bool,
        stop: StopCheck<'_>,
    ) -> Option<Vec<f64>> {
        let unknowns = self.gradient.len();
        let (terms, count) = (self.terms, unknowns - self.terms);
        let (mut matrix, mut gradient) = (self.matrix.clone(), self.gradient.clone());
        let mut damped = damping[count..].iter();
        let mut factors = Vec::with_capacity(self.records.len());
        for record in &self.records {
            let mut own = record.own.clone();
            (0..record.gradient.len()).zip(damped.by_ref()).for_each(|(i, by)| own.add_to_diagonal(i, *by));
            let factor = own.cholesky(stop)?;
            record.eliminate(&factor, &mut matrix, &mut gradient);
            factors.push(factor);
        }
        let of_weights = Symmetric::from_fn(terms, |i, j| matrix[i * unknowns + j]);
        let of_weights = of_weights.cholesky(stop)?;
        let row = |k: usize| &matrix[(terms + k) * unknowns..][..terms];
        let mut lower = vec![0.0; count * terms];
        for (k, lower) in lower.chunks_exact_mut(terms).enumerate() {
            lower.copy_from_slice(row(k));
            of_weights.solve_lower(lower);
        }
        let mut reduced = gradient[..terms].to_vec();
        of_weights.solve_lower(&mut reduced);
        let of_parameters: Vec<f64> = lower
            .chunks_exact(terms)
            .zip(&gradient[terms..])
            .map(|(lower, gradient)| gradient - dot(lower, &reduced))
            .collect();
        let mut curvature = Symmetric::from_fn(count, |i, j| matrix[(terms + i) * unknowns + terms + j]);
        curvature.subtract_product(&lower, terms, stop);
        let mut step = step_within(&curvature, &of_parameters, damping, leaves, stop)?;
        let mut weights = gradient[..terms].to_vec();
        for (k, by) in step.iter().enumerate() {
            weights.iter_mut().zip(row(k)).for_each(|(sum, value)| *sum += value * by);
        }
        of_weights.solve(&mut weights);
        let all: Vec<f64> = weights.iter().map(|by| -by).chain(step.iter().copied()).collect();
        for (record, factor) in self.records.iter().zip(&factors) {
            let rows = record.coupling.chunks_exact(unknowns).zip(&record.gradient);
            let mut states: Vec<f64> = rows.map(|(row, gradient)| gradient + dot(row, &all)).collect();
            factor.solve(&mut states);
            step.extend(states.iter().map(|by| -by));
        }
        Some(step)
    }
}

impl RecordSums {
    /// Subtracts `H_As H_ss⁻¹ H_sA` and `H_As H_ss⁻¹ g_s`, from the factor of `H_ss`.
    fn eliminate(&self, factor: &Cholesky, matrix: &mut [f64], gradient: &mut [f64]) {
        let (size, unknowns) = (self.gradient.len(), gradient.len());
        // The rows of `L⁻¹ H_sA`.
        let mut rows = vec![0.0; size * unknowns];
        let mut column = vec![0.0; size];
        for k in 0..unknowns {
            (0..size).for_each(|i| column[i] = self.coupling[i * unknowns + k]);
            factor.solve_lower(&mut column);
            (0..size).for_each(|i| rows[i * unknowns + k] = column[i]);
        }
        let mut own = self.gradient.clone();
        factor.solve_lower(&mut own);
        for (row, own) in rows.chunks_exact(unknowns).zip(own) {
            for i in 0..unknowns {
                let by = row[i];
                gradient[i] -= by * own;
                let entries = matrix[i * unknowns..][..=i].iter_mut().zip(row);
                entries.for_each(|(entry, value)| *entry -= by * value);
            }
        }
    }
}

impl RecordWeights {
    pub fn of(targets: &[Vec<f64>], error: FittedError, is_free: bool) -> Self {
        let count = targets.len() as f64;
        let is_relative = error == FittedError::Record;
        let square =
            |output: &Vec<f64>| -> f64 { output.iter().filter(|y| !y.is_nan()).map(|y| y * y).sum() };
        let rows = targets.iter().flatten().filter(|y| !y.is_nan()).count() as f64;
        let weight = |output: &Vec<f64>| match is_relative {
            true => 1.0 / (count * square(output).max(f64::MIN_POSITIVE)),
            false => 1.0 / rows,
        };
        let penalty = is_free.then_some(STATE_PENALTY / count);
        Self { weights: targets.iter().map(weight).collect(), is_relative, penalty }
    }

    pub fn is_free(&self) -> bool {
        self.penalty.is_some()
    }

    fn states<'p>(task: &DuhemTask<'_>, parameters: &'p [f64]) -> impl Iterator<Item = &'p [f64]> {
        let layout = &task.frame.layout;
        parameters[layout.count()..].chunks_exact(layout.shape.states)
    }

    /// The Gram matrix of each record, in groups of records.
    fn each_gram(
        &self,
        task: &DuhemTask<'_>,
        parameters: &[f64],
        output: Option<&[f64]>,
        mut take: impl FnMut(usize, Gram),
    ) -> Option<()> {
        let layout = &task.frame.layout;
        let weights = output.map_or_else(|| vec![0.0; layout.shape.terms()], <[f64]>::to_vec);
        let cell = task.frame.cell(parameters, weights);
        let mut states: Vec<Vec<f64>> = Self::states(task, parameters).map(<[f64]>::to_vec).collect();
        let records = task.drives.len();
        states.resize(records, cell.initial.clone());
        for first in (0..records).step_by(TOGETHER) {
            let count = TOGETHER.min(records - first);
            let grams = parallel::numbered(count, |k| {
                let record = first + k..first + k + 1;
                let run = CellRun {
                    cell: &cell,
                    drives: &task.drives[record.clone()],
                    further: &task.further[record.clone()],
                    initial: &states[record.clone()],
                    targets: &task.targets[record],
                    with_jacobian: output.is_some(),
                    stop: task.stop,
                };
                run.gram()
            });
            for (k, gram) in grams.into_iter().enumerate() {
                take(first + k, gram?);
            }
        }
        Some(())
    }

    /// The objective at these parameters and states, with the best output weights.
    pub fn value(&self, task: &DuhemTask<'_>, parameters: &[f64]) -> DuhemValue {
        let layout = &task.frame.layout;
        let terms = layout.shape.terms();
        let mut grams = Vec::with_capacity(task.drives.len());
        let is_whole = self.each_gram(task, parameters, None, |_, gram| grams.push(gram));
        let (solution, loss, record_weights) = match is_whole {
            Some(()) => self.solution(task, &grams),
            None => (OutputSolution::broken_off(terms), f64::INFINITY, self.weights.clone()),
        };
        let decay: f64 = task.weights(parameters).map(|(_, w)| w * w).sum();
        let mean = &parameters[layout.initial.clone()];
        let squares = Self::states(task, parameters).flat_map(|state| state.iter().zip(mean));
        let spread: f64 = squares.map(|(s, m)| (s - m) * (s - m)).sum();
        let objective = loss + 0.5 * DECAY * decay + 0.5 * self.penalty.unwrap_or(0.0) * spread;
        let squares = grams.iter().zip(&self.weights);
        let mean_square = squares.map(|(gram, weight)| weight * square_error(gram, &solution.weights)).sum();
        DuhemValue { objective, mean_square, solution, record_weights }
    }

    /// Output weights, the objective without the penalties of parameters and states, and the weights of the records that have
    /// the same slope.
    fn solution(&self, task: &DuhemTask<'_>, grams: &[Gram]) -> (OutputSolution, f64, Vec<f64>) {
        let solve = |weights: &[f64]| {
            let mut sum = Gram::new(task.frame.layout.shape.terms() + 1);
            weights.iter().zip(grams).for_each(|(weight, gram)| sum.add_multiple(gram, *weight));
            // The weights of the rows have the sum 1.
            task.output_problem(&sum, 1.0).solve()
        };
        let mut weights = self.weights.clone();
        let mut solution = solve(&weights);
        if !self.is_relative {
            let objective = solution.objective;
            return (solution, objective, weights);
        }
        let count = weights.len() as f64;
        let roots = |output: &[f64]| -> Vec<f64> {
            let square = |(gram, weight): (&Gram, &f64)| count * weight * square_error(gram, output);
            grams.iter().zip(&self.weights).map(square).map(|square| (square + LEAST_SQUARE).sqrt()).collect()
        };
        for _ in 1..ROUNDS {
            weights =
                self.weights.iter().zip(roots(&solution.weights)).map(|(first, root)| first / root).collect();
            solution = solve(&weights);
        }
        let penalty = solution.objective - 0.5 * solution.mean_square;
        let loss = roots(&solution.weights).iter().sum::<f64>() / count + penalty;
        (solution, loss, weights)
    }

    /// Gradient and curvature by the parameters, after elimination of the states and of the output weights.
    pub fn slope(
        &self,
        task: &DuhemTask<'_>,
        parameters: &[f64],
        value: &DuhemValue,
    ) -> Option<Slope<DuhemCurvature>> {
        let layout = &task.frame.layout;
        let (terms, count) = (layout.shape.terms(), layout.count());
        let unknowns = terms + count;
        let initial = layout.initial.clone();
        let mean = &parameters[initial.clone()];
        let states: Vec<&[f64]> = Self::states(task, parameters).collect();
        let mut matrix = vec![0.0; unknowns * unknowns];
        let mut gradient = vec![0.0; unknowns];
        let mut records = Vec::with_capacity(states.len());
        let penalty = self.penalty.unwrap_or(0.0);
        let is_mean = |i: usize| self.is_free() && i >= terms && initial.contains(&(i - terms));
        let place = |i: usize| if i < terms { i } else { i + 1 };
        let weights = &value.solution.weights;
        let has_mean = !layout.shape.is_odd || !self.is_free();
        self.each_gram(task, parameters, Some(weights), |record, gram| {
            let omega = value.record_weights[record];
            let slope = |column: usize| {
                let predicted: f64 = weights.iter().enumerate().map(|(t, w)| w * gram.at(column, t)).sum();
                omega * (predicted - gram.at(column, terms))
            };
            let of_record = states.get(record).copied().unwrap_or_default();
            let from_mean: Vec<f64> = of_record.iter().zip(mean).map(|(s, m)| s - m).collect();
            let of_state = |i: usize| terms + 1 + initial.start + i;
            let size = from_mean.len();
            let mut own = Symmetric::from_fn(size, |i, j| omega * gram.at(of_state(i), of_state(j)));
            (0..size).for_each(|i| own.add_to_diagonal(i, penalty));
            let own_gradient: Vec<f64> =
                (0..size).map(|i| slope(of_state(i)) + penalty * from_mean[i]).collect();
            let mut coupling = vec![0.0; size * unknowns];
            for (i, row) in coupling.chunks_exact_mut(unknowns).enumerate() {
                for (k, value) in row.iter_mut().enumerate() {
                    *value = match is_mean(k) {
                        false => omega * gram.at(of_state(i), place(k)),
                        true if has_mean && k - terms - initial.start == i => -penalty,
                        true => 0.0,
                    };
                }
            }
            for i in (0..unknowns).filter(|&i| !is_mean(i)) {
                gradient[i] += slope(place(i));
                for j in (0..=i).filter(|&j| !is_mean(j)) {
                    matrix[i * unknowns + j] += omega * gram.at(place(i), place(j));
                }
            }
            if has_mean {
                for (i, distance) in from_mean.iter().enumerate() {
                    let at = terms + initial.start + i;
                    matrix[at * unknowns + at] += penalty;
                    gradient[at] -= penalty * distance;
                }
            }
            records.push(RecordSums { own, gradient: own_gradient, coupling });
        })?;
        for (t, weight) in weights.iter().enumerate() {
            let ridge = value.solution.ridge[t];
            matrix[t * unknowns + t] += ridge;
            gradient[t] += ridge * weight;
        }
        for (index, weight) in task.weights(parameters) {
            let at = terms + index;
            if has_mean || !is_mean(at) {
                gradient[at] += DECAY * weight; // (3.3)
                matrix[at * unknowns + at] += DECAY;
            }
        }
        if !has_mean {
            initial.clone().for_each(|i| matrix[(terms + i) * (unknowns + 1)] = 1.0);
        }
        // The curvature by each parameter with the best output weights.
        let of_weights = Symmetric::from_fn(terms, |i, j| matrix[i * unknowns + j]).cholesky(task.stop)?;
        let diagonal = (0..count).map(|k| {
            let row = &matrix[(terms + k) * unknowns..];
            let mut lower = row[..terms].to_vec();
            of_weights.solve_lower(&mut lower);
            row[terms + k] - dot(&lower, &lower)
        });
        let of_states =
            records.iter().flat_map(|record| (0..record.gradient.len()).map(|i| record.own.diagonal(i)));
        let diagonal = diagonal.chain(of_states).collect();
        let by_states = records.iter().flat_map(|record| record.gradient.iter().copied());
        let by_all = gradient[terms..].iter().copied().chain(by_states).collect();
        let curvature = DuhemCurvature::Free(FreeCurvature { records, terms, matrix, gradient });
        (!task.stop.is_asked()).then_some(Slope { gradient: by_all, diagonal, curvature, evaluations: 1 })
    }

    /// Distribution of the states of these records.
    pub fn prior(
        &self,
        task: &DuhemTask<'_>,
        parameters: &[f64],
        value: &DuhemValue,
        residual_rows: f64,
    ) -> StatePrior {
        let layout = &task.frame.layout;
        let states: Vec<Vec<f64>> = Self::states(task, parameters).map(<[f64]>::to_vec).collect();
        let deviation = value.mean_square.sqrt().max(f64::MIN_POSITIVE);
        let mean = &parameters[layout.initial.clone()];
        let first: Vec<f64> = task.drives.iter().map(|drive| drive[0].x).collect();
        StatePrior {
            residual_rows,
            is_relative: self.is_relative,
            ..StatePrior::of(&states, &first, mean, deviation)
        }
    }

    /// Mean relative error of other records behind their known beginning, and the rows within which a residual falls to 1/e
    /// with which it is lowest; `None` once stopped.
    pub fn error_after_beginning(
        &self,
        kept: &DuhemTask<'_>,
        held: &DuhemTask<'_>,
        parameters: &[f64],
        value: &DuhemValue,
    ) -> Option<(f64, f64)> {
        let prior = self.prior(kept, parameters, value, 0.0);
        let cell = kept.frame.cell(parameters, value.solution.weights.clone());
        let of_record = |record: usize| held.errors_after_beginning(&cell, &prior, record);
        let all: Option<Vec<_>> = parallel::numbered(held.drives.len(), of_record).into_iter().collect();
        let all = all?;
        let mean = |choice: usize| all.iter().map(|errors| errors[choice]).sum::<f64>() / all.len() as f64;
        let errors = RESIDUAL_ROWS.iter().enumerate().map(|(choice, &rows)| (mean(choice), rows));
        errors.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

impl DuhemTask<'_> {
    /// Relative error of a record behind its known beginning, for each of [`RESIDUAL_ROWS`].
    fn errors_after_beginning(&self, cell: &Cell, prior: &StatePrior, record: usize) -> Option<Vec<f64>> {
        let (drive, further) = (&self.drives[record], &self.further[record]);
        let outputs = &self.whole_targets[record];
        let known = self.known[record];
        let width = further.len() / drive.len();
        let states = cell.found_states(prior, &drive[..known], &further[..known * width], &outputs[..known]);
        let run = CellRun {
            cell,
            drives: std::slice::from_ref(drive),
            further: std::slice::from_ref(further),
            initial: &[states],
            targets: std::slice::from_ref(outputs),
            with_jacobian: false,
            stop: self.stop,
        };
        let rows = run.rows()?;
        let terms = cell.output.len();
        let residual = |row: &Vec<f64>| row[terms] - dot(&row[..terms], &cell.output);
        let known = outputs[..known].iter().filter(|y| !y.is_nan()).count();
        let (beginning, rest) = rows.split_at(known);
        let last = beginning.last().map_or(0.0, residual);
        let square: f64 = rest.iter().map(|row| row[terms] * row[terms]).sum();
        let error = |&rows: &f64| {
            let remaining = remaining_share(rows);
            let mut expected = last;
            let mut sum = 0.0;
            for row in rest {
                expected *= remaining;
                let error = residual(row) - expected;
                sum += error * error;
            }
            (sum / square.max(f64::MIN_POSITIVE)).sqrt()
        };
        Some(RESIDUAL_ROWS.iter().map(error).collect())
    }

    /// Parameters of a fit to these records, from those of a fit to others: the states before each record are found from
    /// the whole record.
    pub fn begun_from(&self, kept: &DuhemTask<'_>, parameters: &[f64], value: &DuhemValue) -> Vec<f64> {
        let count = self.frame.layout.count();
        let Some(weights) = kept.by_record.as_ref().filter(|weights| weights.is_free()) else {
            return parameters[..count].to_vec();
        };
        let prior = weights.prior(kept, parameters, value, 0.0);
        let cell = kept.frame.cell(parameters, value.solution.weights.clone());
        let of_record = |record: usize| {
            cell.found_states(
                &prior,
                &self.drives[record],
                &self.further[record],
                &self.whole_targets[record],
            )
        };
        let states = parallel::numbered(self.drives.len(), of_record);
        parameters[..count].iter().copied().chain(states.into_iter().flatten()).collect()
    }
}

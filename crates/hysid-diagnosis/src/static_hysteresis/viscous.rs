//! Whether loops may be those of a spring with dashpots: a curve of the input, its rate and one relaxation of it, all
//! linear in the memory. Such a law has no loop at rest, and at one speed its loops look like any other.

use std::f64::consts::SQRT_2;

use hysid_core::data::record::Record;
use hysid_core::elementary::{hypot, powf, powi};
use hysid_core::linear_algebra::Symmetric;
use hysid_core::operator::relaxation::{advance, decay};
use hysid_core::stop_check::StopCheck;

use crate::branch::BranchSet;

/// Relaxation times that are tried, from the mean time step to half of the longest record.
const TIMES: i32 = 32;

/// Columns without memory: 1, x, x², x³.
const CURVE: usize = 4;

/// All of them: with drift, the rate and the relaxed input.
const COLUMNS: usize = CURVE + 3;
const RATE: usize = CURVE + 1;
const RELAXED: usize = CURVE + 2;

/// Remainders below this share of what a curve of the input leaves are explained.
const EXPLAINED: f64 = 0.1;

/// Multiple of its deviation up to which remainders are noise.
const NOISE: f64 = 1.3;

/// So many rows around a turning point are left out: an output that is late by as many is that of the branch before.
const NEAR_A_TURN: usize = 3;

/// Rows before and after one, at most, over which its rate is taken, and the share of the rows of a branch that they may be.
const MOST_BESIDE: usize = 8;
const OF_A_BRANCH: f64 = 0.05;

/// Noise in the rate below this share of it does not matter.
const IN_THE_RATE: f64 = 0.03;

/// Records with more rows are not looked at beyond them.
const MOST_ROWS: usize = 100_000;

/// True if a law without static hysteresis leaves no more of the output than noise, or a small share of the loops.
pub(super) fn may_be_viscous(survey: &BranchSet) -> bool {
    let records: Vec<&Record> = survey.data.records().iter().collect();
    let longest =
        records.iter().filter_map(|r| Some(r.time()?[r.len() - 1] - r.time()?[0])).fold(0.0, f64::max);
    let beside = rows_beside(survey);
    let on_branches: Vec<Vec<bool>> =
        (0..records.len()).map(|record| between_turns(survey, record, beside.max(NEAR_A_TURN))).collect();
    let step = survey.time_step();
    if step <= 0.0 || longest <= 2.0 * step {
        return false;
    }
    let factor = powf(0.5 * longest / step, f64::from(TIMES - 1).recip());
    let products = |time: f64| {
        let mut products = ColumnProducts::new();
        for (record, on_branches) in records.iter().zip(&on_branches) {
            products.add(survey, record, on_branches, beside, time);
        }
        products
    };
    let first = products(step);
    let (without_memory, _) = first.fit(CURVE);
    let output_noise = survey.output_noise.deviation() / survey.height();
    let input_noise = 2.0 * survey.input_noise.deviation() / survey.width();
    let rate_noise = input_noise / (SQRT_2 * beside as f64);
    let explains = |products: &ColumnProducts| {
        let (left, weights) = products.fit(COLUMNS);
        let through_input = products.mean_square_slope(&weights).sqrt() * input_noise;
        let noise = hypot(hypot(output_noise, through_input), weights[RATE] * rate_noise);
        left.sqrt() <= (EXPLAINED * without_memory.sqrt()).max(NOISE * noise)
    };
    explains(&first) || (1..TIMES).any(|k| explains(&products(step * powi(factor, k))))
}

/// Rows before and after one over which its rate is taken: as many as the noise of the input needs.
fn rows_beside(survey: &BranchSet) -> usize {
    let travel: f64 = survey.branches.iter().map(|branch| branch.travel()).sum();
    let rows: usize = survey.branches.iter().map(|branch| branch.rows.len()).sum();
    let step = travel / rows as f64;
    let needed = survey.input_noise.deviation() / (IN_THE_RATE * step * SQRT_2);
    (needed.min(OF_A_BRANCH * survey.typical_rows() as f64) as usize).clamp(1, MOST_BESIDE)
}

/// Rows of a record that are more than so many rows away from a turning point.
fn between_turns(survey: &BranchSet, record: usize, near: usize) -> Vec<bool> {
    let mut between = vec![false; survey.data.records()[record].len()];
    for branch in survey.of_record(record).iter().filter(|branch| branch.rows.len() > 2 * near) {
        between[branch.rows.start + near..branch.rows.end - near].fill(true);
    }
    between
}

/// Products of all columns and the output, and the number of rows.
struct ColumnProducts {
    sums: [[f64; COLUMNS + 1]; COLUMNS + 1],
    /// Sums of the scaled input and its powers.
    powers: [f64; 4],
    rows: f64,
}

impl ColumnProducts {
    fn new() -> Self {
        Self { sums: [[0.0; COLUMNS + 1]; COLUMNS + 1], powers: [0.0; 4], rows: 0.0 }
    }

    /// Adds the rows of a record whose input relaxes in a time, without what an unknown force at its first row,
    /// which fades in the same time, explains.
    fn add(&mut self, survey: &BranchSet, record: &Record, on_branches: &[bool], beside: usize, time: f64) {
        let Some(stamps) = record.time() else {
            return;
        };
        let (x, y) = (&record.inputs()[0], record.output());
        let scale = 2.0 / survey.width();
        let middle = 0.5 * (survey.input.0 + survey.input.1);
        let mean_step = survey.time_step();
        let mut relaxation = 0.0;
        let mut fading = 1.0;
        let mut of_fading = [0.0; COLUMNS + 1];
        let mut fading_square = f64::MIN_POSITIVE;
        for row in 0..x.len().min(MOST_ROWS) {
            if row > 0 {
                let (step, change) = (stamps[row] - stamps[row - 1], x[row] - x[row - 1]);
                let factors = decay(step, time);
                relaxation = advance(relaxation, change, factors);
                fading *= factors.0;
            }
            if !on_branches[row] || y[row].is_nan() {
                continue;
            }
            let (before, after) = (row - beside, row + beside);
            let rate = scale * (x[after] - x[before]) / (stamps[after] - stamps[before]) * mean_step;
            let u = scale * (x[row] - middle);
            let columns = [
                1.0,
                u,
                u * u,
                u * u * u,
                row as f64 / x.len() as f64,
                rate,
                scale * relaxation,
                (y[row] - survey.output.0) / survey.height(),
            ];
            for (sums, a) in self.sums.iter_mut().zip(columns) {
                sums.iter_mut().zip(columns).for_each(|(sum, b)| *sum += a * b);
            }
            of_fading.iter_mut().zip(columns).for_each(|(sum, a)| *sum += a * fading);
            fading_square += fading * fading;
            self.powers
                .iter_mut()
                .zip([u, u * u, u * u * u, u * u * u * u])
                .for_each(|(sum, power)| *sum += power);
            self.rows += 1.0;
        }
        for (sums, a) in self.sums.iter_mut().zip(of_fading) {
            sums.iter_mut().zip(of_fading).for_each(|(sum, b)| *sum -= a * b / fading_square);
        }
    }

    /// Mean square of the output, as a share of its range, that the first so many columns leave, and their weights.
    fn fit(&self, columns: usize) -> (f64, Vec<f64>) {
        /// Ridge for nearly collinear columns.
        const RIDGE: f64 = 1e-12;
        let matrix = Symmetric::from_fn(columns, |i, j| {
            self.sums[i][j] + if i == j { RIDGE * self.sums[i][i] + f64::MIN_POSITIVE } else { 0.0 }
        });
        let right: Vec<f64> = (0..columns).map(|i| self.sums[i][COLUMNS]).collect();
        let total = self.sums[COLUMNS][COLUMNS];
        let Some(factor) = matrix.cholesky(StopCheck::never()) else {
            return (total / self.rows, vec![0.0; columns]);
        };
        let mut weights = right.clone();
        factor.solve(&mut weights);
        let explained: f64 = weights.iter().zip(&right).map(|(w, b)| w * b).sum();
        ((total - explained).max(0.0) / self.rows, weights)
    }

    /// Mean square of the slope by the scaled input `u`, at constant time: of the curve and of the relaxed input.
    fn mean_square_slope(&self, weights: &[f64]) -> f64 {
        let [a, b, c] = [weights[1] + weights[RELAXED], 2.0 * weights[2], 3.0 * weights[3]];
        let [u, square, cube, fourth] = self.powers.map(|sum| sum / self.rows);
        a * a + 2.0 * a * b * u + (b * b + 2.0 * a * c) * square + 2.0 * b * c * cube + c * c * fourth
    }
}

//! Whether loops may be those of a spring with dashpots: a curve of the input, its rate and one relaxation of it, all
//! linear in the memory. Such a law has no loop at rest, and at one speed its loops look like any other.

use std::f64::consts::SQRT_2;

use hysid_core::data::record::Record;
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

/// Remainders below this share of what a curve of the input leaves are explained.
const EXPLAINED: f64 = 0.1;

/// Remainders are noise up to so many times its deviation.
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
    let factor = (0.5 * longest / step).powf(f64::from(TIMES - 1).recip());
    let products = |time: f64| {
        let mut products = Products::new();
        for (record, on_branches) in records.iter().zip(&on_branches) {
            products.add(survey, record, on_branches, beside, time);
        }
        products
    };
    let first = products(step);
    let without_memory = first.remainder(CURVE);
    let least =
        (0..TIMES).map(|k| products(step * factor.powi(k)).remainder(COLUMNS)).fold(f64::INFINITY, f64::min);
    let noise = NOISE * survey.output_noise.deviation() / survey.height();
    least.sqrt() <= (EXPLAINED * without_memory.sqrt()).max(noise)
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
struct Products {
    sums: [[f64; COLUMNS + 1]; COLUMNS + 1],
    rows: f64,
}

impl Products {
    fn new() -> Self {
        Self { sums: [[0.0; COLUMNS + 1]; COLUMNS + 1], rows: 0.0 }
    }

    /// Adds the rows of a record whose input relaxes in a time.
    fn add(&mut self, survey: &BranchSet, record: &Record, on_branches: &[bool], beside: usize, time: f64) {
        let Some(stamps) = record.time() else {
            return;
        };
        let (x, y) = (&record.inputs()[0], record.output());
        let scale = 2.0 / survey.width();
        let middle = 0.5 * (survey.input.0 + survey.input.1);
        let speed = survey.width() / (stamps[stamps.len() - 1] - stamps[0]) * stamps.len() as f64;
        let mut relaxation = 0.0;
        for row in 0..x.len().min(MOST_ROWS) {
            if row > 0 {
                let (step, change) = (stamps[row] - stamps[row - 1], x[row] - x[row - 1]);
                relaxation = advance(relaxation, change, decay(step, time));
            }
            if !on_branches[row] || y[row].is_nan() {
                continue;
            }
            let (before, after) = (row - beside, row + beside);
            let rate = (x[after] - x[before]) / (stamps[after] - stamps[before]) / speed;
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
            self.rows += 1.0;
        }
    }

    /// Mean square of the output, as a share of its range, that the first so many columns leave.
    fn remainder(&self, columns: usize) -> f64 {
        /// Ridge for nearly collinear columns.
        const RIDGE: f64 = 1e-12;
        let matrix = Symmetric::from_fn(columns, |i, j| {
            self.sums[i][j] + if i == j { RIDGE * self.sums[i][i] + f64::MIN_POSITIVE } else { 0.0 }
        });
        let right: Vec<f64> = (0..columns).map(|i| self.sums[i][COLUMNS]).collect();
        let total = self.sums[COLUMNS][COLUMNS];
        let Some(factor) = matrix.cholesky(StopCheck::never()) else {
            return total / self.rows;
        };
        let mut weights = right.clone();
        factor.solve(&mut weights);
        let explained: f64 = weights.iter().zip(&right).map(|(w, b)| w * b).sum();
        (total - explained).max(0.0) / self.rows
    }
}

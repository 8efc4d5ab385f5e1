//! Rate dependence of a record in which no path was run at two speeds, but branches of many speeds occur: does a law with
//! the rate predict branches that it was not fitted to better than a law without?
//!
//! Both are linear in their columns: a curve of the input, stops, inputs that fade with the path, and products of both
//! with the input; with the rate, also the rate, inputs that fade with time, and stops times the logarithm of the speed,
//! theory.md (10.27).

use hysid_core::data::record::Record;
use hysid_core::elementary::ln;
use hysid_core::linear_algebra::Symmetric;
use hysid_core::operator::play::follow;
use hysid_core::operator::relaxation::{advance, decay};
use hysid_core::operator::stop::elongation;
use hysid_core::stop_check::StopCheck;

use crate::branch::BranchSet;
use crate::interpolation::at_row;

/// Branches at least, without the first two of each record, whose memory is that of an unknown beginning.
const FEWEST: usize = 12;
const FIRST: usize = 2;

/// Parts of the branches, each of which is predicted from the others.
const PARTS: usize = 6;

/// One in five branches is slower than the slow ones, and one in five faster than the fast ones.
const SLOW_AND_FAST: [usize; 2] = [1, 4];
const OF_BRANCHES: usize = 5;

const MOST_ROWS: usize = 5_000;

/// Columns of every law: 1, u, u², u³ and the drift; stops and inputs that fade with the path; their products with u.
const CURVE: usize = 5;
const STOPS: usize = 10;
const PATHS: [f64; 4] = [0.1, 0.3, 0.9, 2.7];
const MEMORY: usize = STOPS + PATHS.len();
const BASE: usize = CURVE + 2 * MEMORY;

/// Columns of the rate: itself, inputs that fade with time, and stops times the logarithm of the speed.
const TIMES: usize = 3;
const PACED: usize = 4;
const RATE: usize = 1 + TIMES + PACED;

/// As many further columns without the rate, for comparison: stops between the others.
const COLUMNS: usize = BASE + 2 * RATE;

/// Rows by which the output may be late.
const LAGS: [f64; 8] = [-3.0, -2.0, -1.0, -0.5, 0.5, 1.0, 1.5, 2.5];

/// Speeds below this share of the fastest are alike.
const SLOWEST: f64 = 0.01;

/// Ridge for nearly collinear columns.
const RIDGE: f64 = 1e-7;

/// Residuals of laws on branches that they were not fitted to: root mean squares as shares of the output's range.
#[derive(Debug, Clone, Copy)]
pub(super) struct Remainders {
    /// Ratio of the speed of the fast branches to that of the slow ones.
    pub ratio: f64,
    /// Of laws without the rate.
    pub without: f64,
    /// Of those with more columns, without the rate.
    pub with_more_stops: f64,
    /// Of those without the rate, with the lag of a few rows that suits them best.
    pub with_a_lag: f64,
    pub with_rate: f64,
    /// True if the rate helps in every part.
    pub everywhere: bool,
    pub noise: f64,
}

/// The remainders; `None` for few branches.
pub(super) fn remainders(survey: &BranchSet) -> Option<Remainders> {
    let ratio = ratio_of_speeds(survey)?;
    let parts = parts(survey);
    let records = survey.data.records();
    let stride = survey.data.rows().div_ceil(MOST_ROWS);
    let fastest = fastest(survey);
    let products = |lag: f64| -> Vec<SpeedProducts> {
        let mut products = vec![SpeedProducts::new(); PARTS];
        for (record, parts) in records.iter().zip(&parts) {
            add(survey, record, parts, stride, lag, fastest, &mut products);
        }
        products
    };
    let base: Vec<usize> = (0..BASE).collect();
    let with = |first: usize| -> Vec<usize> { base.iter().copied().chain(first..first + RATE).collect() };
    let measured = products(0.0);
    let mean = |squares: &[f64]| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    let without = held_out(&measured, &base)?;
    let with_rate = held_out(&measured, &with(BASE))?;
    let lagged = LAGS.iter().filter_map(|&lag| Some(mean(&held_out(&products(lag), &base)?)));
    Some(Remainders {
        ratio,
        without: mean(&without),
        with_more_stops: mean(&held_out(&measured, &with(BASE + RATE))?),
        with_a_lag: lagged.fold(mean(&without), f64::min),
        with_rate: mean(&with_rate),
        everywhere: with_rate.iter().zip(&without).all(|(with, without)| with < without),
        noise: survey.output_noise.deviation() / survey.height(),
    })
}

/// Ratio of the speeds of the fast and the slow branches.
fn ratio_of_speeds(survey: &BranchSet) -> Option<f64> {
    let long = survey.branches.iter().filter(|branch| branch.travel() >= super::SHORTEST * survey.width());
    let mut speeds: Vec<f64> = long.filter_map(|branch| branch.speed).collect();
    speeds.sort_by(f64::total_cmp);
    let [slow, fast] = SLOW_AND_FAST.map(|share| speeds.get(share * speeds.len() / OF_BRANCHES));
    (speeds.len() >= FEWEST).then_some(fast? / slow?)
}

fn fastest(survey: &BranchSet) -> f64 {
    survey.branches.iter().filter_map(|branch| branch.speed).fold(0.0, f64::max)
}

/// The part of each row of each record; none for rows whose memory is not known.
fn parts(survey: &BranchSet) -> Vec<Vec<Option<usize>>> {
    let all = survey.branches.len();
    let of_record = |(number, record): (usize, &Record)| {
        let mut parts = vec![None; record.len()];
        let first = survey.branches.partition_point(|branch| branch.record < number);
        for (place, branch) in survey.of_record(number).iter().enumerate().skip(FIRST) {
            parts[branch.rows.clone()].fill(Some((first + place) * PARTS / all));
        }
        parts
    };
    survey.data.records().iter().enumerate().map(of_record).collect()
}

/// Sums of the products of all columns and the output.
#[derive(Debug, Clone)]
struct SpeedProducts {
    sums: Vec<[f64; COLUMNS + 1]>,
    rows: f64,
}

impl SpeedProducts {
    fn new() -> Self {
        Self { sums: vec![[0.0; COLUMNS + 1]; COLUMNS + 1], rows: 0.0 }
    }

    fn add(&mut self, columns: &[f64; COLUMNS + 1]) {
        for (sums, a) in self.sums.iter_mut().zip(columns) {
            sums.iter_mut().zip(columns).for_each(|(sum, b)| *sum += a * b);
        }
        self.rows += 1.0;
    }

    fn merge(&mut self, other: &Self) {
        for (sums, others) in self.sums.iter_mut().zip(&other.sums) {
            sums.iter_mut().zip(others).for_each(|(sum, other)| *sum += other);
        }
    }

    /// Weights of the chosen columns by least squares.
    fn weights(&self, chosen: &[usize]) -> Option<Vec<f64>> {
        let matrix = Symmetric::from_fn(chosen.len(), |i, j| {
            let product = self.sums[chosen[i]][chosen[j]];
            if i == j { (1.0 + RIDGE) * product + f64::MIN_POSITIVE } else { product }
        });
        let mut weights: Vec<f64> = chosen.iter().map(|&column| self.sums[column][COLUMNS]).collect();
        matrix.cholesky(StopCheck::never())?.solve(&mut weights);
        Some(weights)
    }

    /// Mean square that weights leave.
    fn remainder(&self, chosen: &[usize], weights: &[f64]) -> f64 {
        let product = |a: usize, b: usize| self.sums[a][b];
        let explained: f64 = chosen.iter().zip(weights).map(|(&c, w)| w * product(c, COLUMNS)).sum();
        let own: f64 = chosen
            .iter()
            .zip(weights)
            .flat_map(|(&i, a)| chosen.iter().zip(weights).map(move |(&j, b)| a * b * product(i, j)))
            .sum();
        ((product(COLUMNS, COLUMNS) - 2.0 * explained + own) / self.rows).max(0.0)
    }
}

/// Mean square of each part that a fit to the others leaves; `None` where a part is empty.
fn held_out(parts: &[SpeedProducts], chosen: &[usize]) -> Option<Vec<f64>> {
    let of_part = |part: usize| -> Option<f64> {
        let mut others = SpeedProducts::new();
        parts
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != part)
            .for_each(|(_, other)| others.merge(other));
        let weights = others.weights(chosen)?;
        (parts[part].rows > 0.0).then(|| parts[part].remainder(chosen, &weights))
    };
    (0..parts.len()).map(of_part).collect()
}

/// Adds the rows of a record, with its output taken some rows earlier.
fn add(
    survey: &BranchSet,
    record: &Record,
    parts: &[Option<usize>],
    stride: usize,
    lag: f64,
    fastest: f64,
    products: &mut [SpeedProducts],
) {
    let Some(time) = record.time() else {
        return;
    };
    let (input, output) = (&record.inputs()[0], record.output());
    let middle = 0.5 * (survey.input.0 + survey.input.1);
    let scaled = |row: usize| 2.0 * (at_row(input, row as f64 - lag) - middle) / survey.width();
    let threshold = |stop: f64| (stop + 0.5) / STOPS as f64;
    // Speeds and relaxation times for the scaled input.
    let scale = 2.0 / survey.width();
    let times = [0.1, 0.5, 2.0].map(|share| share * 2.0 / (scale * fastest));
    let mut plays = [[scaled(0); STOPS]; 2];
    let (mut relaxed, mut faded) = ([0.0; TIMES], [0.0; PATHS.len()]);
    let mut before = scaled(0);
    for row in 0..input.len() {
        let u = scaled(row);
        for (between, plays) in plays.iter_mut().enumerate() {
            for (stop, play) in plays.iter_mut().enumerate() {
                *play = follow(*play, u, threshold(stop as f64 + 0.5 * between as f64));
            }
        }
        let (step, change) = (time[row] - time[row.saturating_sub(1)], u - before);
        for (relaxed, time) in relaxed.iter_mut().zip(times) {
            *relaxed = advance(*relaxed, change, decay(step, time));
        }
        for (faded, path) in faded.iter_mut().zip(PATHS) {
            *faded = advance(*faded, change, decay(change.abs(), path));
        }
        before = u;
        let Some(part) = parts[row].filter(|_| row % stride == 0 && !output[row].is_nan()) else { continue };
        let (last, next) = (row.saturating_sub(1), (row + 1).min(input.len() - 1));
        let speed = (scaled(next) - scaled(last)) / (time[next] - time[last]) / (scale * fastest);
        let pace = ln((speed.abs() / SLOWEST).max(1.0));
        let mut columns = [0.0; COLUMNS + 1];
        columns[..CURVE].copy_from_slice(&[1.0, u, u * u, u * u * u, row as f64 / input.len() as f64]);
        let stresses = plays[0].map(|play| elongation(u, play));
        for (memory, stress) in stresses.into_iter().chain(faded).enumerate() {
            columns[CURVE + memory] = stress;
            columns[CURVE + MEMORY + memory] = u * stress;
        }
        columns[BASE] = speed;
        columns[BASE + 1..BASE + 1 + TIMES].copy_from_slice(&relaxed);
        for paced in 0..PACED {
            columns[BASE + 1 + TIMES + paced] = pace * columns[CURVE + paced * (STOPS - 1) / (PACED - 1)];
        }
        for more in 0..RATE {
            columns[BASE + RATE + more] = elongation(u, plays[1][more]);
        }
        columns[COLUMNS] = (output[row] - survey.output.0) / survey.height() - 0.5;
        products[part].add(&columns);
    }
}

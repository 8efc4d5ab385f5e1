//! A fixed time by which the output lags behind the input: it widens loops in proportion to the speed, and so
//! looks like rate dependence, theory.md (10.14).

use serde::Serialize;

use crate::branch::{Branch, BranchSet};
use crate::interpolation::at_place;
use crate::minimum::lowest;
use crate::rate_dependence::SpeedPair;
use hysid_core::data::record::Record;
use hysid_core::elementary::square;

/// Delays are sought up to this share of the shortest branch, either way.
const LONGEST: f64 = 0.25;

/// Delays tried before the best is refined.
const TRIED: i32 = 20;

/// Courses and branches that are looked at.
const MOST: usize = 40;

/// A delay of the output.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Delay {
    /// By which the output lags behind the input, in the unit of time; negative if it leads.
    pub time: f64,
    /// Difference between speeds that is left after the shift, as a share of the output's range.
    pub remains: f64,
}

/// The delay that makes the outputs of all speeds agree best.
pub(crate) fn between_speeds(survey: &BranchSet, courses: &[SpeedPair]) -> Option<Delay> {
    let step = courses.len().div_ceil(MOST).max(1);
    let courses: Vec<&SpeedPair> = courses.iter().step_by(step).collect();
    let all = || courses.iter().flat_map(|speeds| speeds.slow.iter().chain(&speeds.fast));
    let shortest = all().filter_map(|branch| branch.duration()).fold(f64::INFINITY, f64::min);
    if !shortest.is_finite() {
        return None;
    }
    let squares = |delay: f64| courses.iter().filter_map(move |speeds| mean_square(survey, speeds, delay));
    let time = lowest(&|delay| squares(delay).sum(), 0.0, LONGEST * shortest, TRIED);
    let worst = squares(time).fold(0.0, f64::max);
    // Rows are taken with their noise, which no delay takes away.
    let remains = (worst - square(survey.output_noise.deviation())).max(0.0).sqrt();
    Some(Delay { time, remains: remains / survey.height() })
}

/// Mean square of the difference between slow and fast branches whose outputs are taken `delay` later. The rows
/// of the fast branches, which lie far apart, are taken as they are; between the many of the slow ones is read.
fn mean_square(survey: &BranchSet, speeds: &SpeedPair, delay: f64) -> Option<f64> {
    let records = survey.data.records();
    let shifted = |set: &[&Branch]| -> Vec<Vec<(f64, f64)>> {
        set.iter().map(|branch| later(&records[branch.record], branch, delay)).collect()
    };
    let slow = shifted(&speeds.slow);
    let (low, high) = (speeds.from.min(speeds.to), speeds.from.max(speeds.to));
    let (mut squares, mut rows) = (0.0, 0.0);
    for (x, y) in shifted(&speeds.fast).into_iter().flatten().filter(|(x, _)| *x >= low && *x <= high) {
        if let Some(slow) = mean(&slow, x) {
            squares += square(slow - y);
            rows += 1.0;
        }
    }
    (rows > 0.0).then(|| squares / rows)
}

/// The outputs that come `delay` after the inputs of a branch, over those inputs, in the order of the input.
/// The input is read between rows, not the output: it is the smoother of the two.
fn later(record: &Record, branch: &Branch, delay: f64) -> Vec<(f64, f64)> {
    let (x, y) = (&record.inputs()[0], record.output());
    let time = record.time().expect("delays are sought in data with time");
    let (begin, end) = (time[branch.rows.start], time[branch.rows.end - 1]);
    let first = time.partition_point(|&t| t < begin + delay);
    let mut points = Vec::with_capacity(branch.rows.len());
    let mut below = branch.rows.start;
    for row in first..time.len() {
        let wanted = time[row] - delay;
        if wanted > end {
            break;
        }
        while below + 2 < branch.rows.end && time[below + 1] <= wanted {
            below += 1;
        }
        if !y[row].is_nan() {
            points.push((cubic(time, x, below, wanted), y[row]));
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// Value at a time between rows `below` and `below + 1`, by the cubic through four rows (Lagrange); by a line
/// where a row is missing.
fn cubic(time: &[f64], x: &[f64], below: usize, wanted: f64) -> f64 {
    let rows = match below.checked_sub(1) {
        Some(first) if first + 4 <= x.len() => first..first + 4,
        _ => below..below + 2,
    };
    let weight = |row: usize| -> f64 {
        let others = rows.clone().filter(|&other| other != row);
        others.map(|other| (wanted - time[other]) / (time[row] - time[other])).product()
    };
    rows.clone().map(|row| x[row] * weight(row)).sum()
}

fn mean(set: &[Vec<(f64, f64)>], x: f64) -> Option<f64> {
    let values = set.iter().map(|points| at_place(points, x));
    Some(values.sum::<Option<f64>>()? / set.len() as f64)
}

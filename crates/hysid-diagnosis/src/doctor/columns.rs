//! Columns that may be the wrong way round, or have the wrong sign.

use hysid_core::elementary::{cos, sin};

use super::{DataIssue, DataIssueKind, Severity};
use crate::branch::{Branch, BranchSet};
use crate::significance;

/// Share of the way of the input on which the output goes the other way.
const THROUGHOUT: f64 = 0.95;

/// Branches longer than this share of the range of the input are looked at.
const LONG: f64 = 0.3;

/// Residual of a fitted sine or triangle: below `COMMAND` in a command, above `ANSWER` in a response.
const COMMAND: f64 = 0.01;
const ANSWER: f64 = 0.05;

/// Branches that are looked at.
const MOST: usize = 40;

pub(super) fn complaints(survey: &BranchSet) -> Vec<DataIssue> {
    wrong_sign(survey).into_iter().chain(swapped(survey)).collect()
}

fn wrong_sign(survey: &BranchSet) -> Option<DataIssue> {
    let (mut falls, mut all) = (0.0, 0.0);
    for branch in survey.branches.iter().filter(|branch| branch.travel() >= LONG * survey.width()) {
        let (Some(from), Some(to)) = (branch.curve.at(branch.from), branch.curve.at(branch.to)) else {
            continue;
        };
        all += branch.travel();
        if (to.y - from.y) * (branch.to - branch.from) < 0.0 {
            falls += branch.travel();
        }
    }
    (all > 0.0 && falls > THROUGHOUT * all).then(|| {
        DataIssue::of_all(
            DataIssueKind::WrongSign,
            Severity::Note,
            "the output decreases whenever the input increases: if this is not expected, one of the two has \
             the wrong sign"
                .into(),
        )
    })
}

/// An output that is a plain sine or triangle over time while the input is neither.
fn swapped(survey: &BranchSet) -> Option<DataIssue> {
    let long = |branch: &&Branch| branch.travel() >= LONG * survey.width() && !branch.curve.is_empty();
    let branches: Vec<&Branch> = survey.branches.iter().filter(long).collect();
    if branches.len() < 4 {
        return None;
    }
    let step = branches.len().div_ceil(MOST);
    let plain = |of_output: bool| {
        let mut left: Vec<f64> = branches
            .iter()
            .step_by(step)
            .filter_map(|branch| {
                let record = &survey.data.records()[branch.record];
                let column = if of_output { record.output() } else { &record.inputs()[0] };
                departure(column, branch)
            })
            .collect();
        (left.len() >= 4).then(|| significance::median(&mut left))
    };
    let (input, output) = (plain(false)?, plain(true)?);
    (output < COMMAND && input > ANSWER).then(|| {
        DataIssue::of_all(
            DataIssueKind::SwappedColumns,
            Severity::Note,
            "the output is a plain sine or triangle over time, and the input is not: the output looks like \
             a command signal; check that input and output are not exchanged"
                .into(),
        )
    })
}

/// How far a channel departs from a straight line, or from a sine of the same rhythm, over the middle of a branch,
/// whichever is less, as a share of what it covers there.
fn departure(column: &[f64], branch: &Branch) -> Option<f64> {
    let rows = branch.rows.clone();
    let (skip, last) = (rows.len() / 10, rows.len() - 1);
    let middle: Vec<f64> = (skip..=last - skip).map(|k| column[rows.start + k]).collect();
    if middle.len() < 12 || middle.iter().any(|value| value.is_nan()) {
        return None;
    }
    let places = |shape: &dyn Fn(f64) -> f64| -> Vec<f64> {
        (skip..=last - skip).map(|k| shape(k as f64 / last as f64)).collect()
    };
    // Where the channel itself turns a little before or after the input, the sine is shifted.
    let line = left_by(&middle, &[places(&|s| s)]);
    let turn = std::f64::consts::PI;
    let sine = left_by(&middle, &[places(&|s| cos(turn * s)), places(&|s| sin(turn * s))]);
    Some(line.min(sine))
}

/// Root mean square that a constant and some shapes leave of values, over their range.
fn left_by(values: &[f64], shapes: &[Vec<f64>]) -> f64 {
    let centred = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|value| value - mean).collect::<Vec<f64>>()
    };
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut rest = centred(values);
    let mut earlier: Vec<Vec<f64>> = Vec::new();
    for shape in shapes {
        let mut shape = centred(shape);
        for other in &earlier {
            let share = product(&shape, other) / product(other, other);
            shape.iter_mut().zip(other).for_each(|(a, b)| *a -= share * b);
        }
        let share = product(&rest, &shape) / product(&shape, &shape);
        rest.iter_mut().zip(&shape).for_each(|(a, b)| *a -= share * b);
        earlier.push(shape);
    }
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (product(&rest, &rest) / values.len() as f64).sqrt() / (high - low).max(f64::MIN_POSITIVE)
}

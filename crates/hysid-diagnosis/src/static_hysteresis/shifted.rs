//! Loops of an output that is read some rows later or earlier: those of a lag close.

use super::super::branch::{Branch, BranchSet, Opening};
use crate::interpolation::{at_place, at_row};

/// Rows of loops that are looked at, about.
const MOST_ROWS: usize = 100_000;

/// Shifts that are tried on each side of 0.
const SHIFTS: usize = 40;

/// Smallest difference of two shifts that are tried, in rows.
const FINEST: f64 = 0.25;

/// Places of the input at which two branches are compared.
const PLACES: usize = 40;

/// A shift closes a loop that keeps less than this share of its fullness.
const CLOSED: f64 = 0.3;

/// True if all loops close for one shift of the output: each then fills less than `small` of its box, or a small share of
/// what it did. `rows` is the largest shift that is tried.
pub(super) fn closes(survey: &BranchSet, loops: &[&Opening], rows: f64, small: f64) -> bool {
    let mut total = 0;
    let looked: Vec<&Opening> = loops
        .iter()
        .copied()
        .take_while(|opening| {
            total += opening.rows(survey);
            total <= MOST_ROWS
        })
        .collect();
    let step = (rows / SHIFTS as f64).max(FINEST);
    let count = (rows / step).ceil() as i64;
    let is_closed_by = |shift: f64| {
        looked.iter().all(|opening| {
            let left = fullness(survey, opening, shift);
            left.is_some_and(|left| left < small.max(CLOSED * opening.fullness()))
        })
    };
    !looked.is_empty() && (-count..=count).any(|number| number != 0 && is_closed_by(step * number as f64))
}

/// Area between the two branches of a loop as a share of its box, of the output a number of rows later.
fn fullness(survey: &BranchSet, opening: &Opening, shift: f64) -> Option<f64> {
    let curve = |branch: &Branch| {
        let record = &survey.data.records()[branch.record];
        let (x, y) = (&record.inputs()[0], record.output());
        let mut points: Vec<(f64, f64)> = branch
            .rows
            .clone()
            .map(|row| (x[row], at_row(y, row as f64 + shift)))
            .filter(|point| !point.1.is_nan())
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    };
    let (one, other) = (curve(&survey.branches[opening.branch]), curve(&survey.branches[opening.branch + 1]));
    let low = one.first()?.0.max(other.first()?.0);
    let high = one.last()?.0.min(other.last()?.0);
    let apart = |number: usize| {
        let place = low + (high - low) * (number as f64 + 0.5) / PLACES as f64;
        Some((at_place(&one, place)? - at_place(&other, place)?).abs())
    };
    Some((0..PLACES).map(apart).sum::<Option<f64>>()? / PLACES as f64 / opening.height)
}

//! Places within a cycle where another record seems to begin.

use std::f64::consts::SQRT_2;
use std::fmt;

use hysid_core::data::record::Record;
use hysid_core::significant::Significant;

use super::division::Span;
use super::path::width;
use crate::branch::{Branch, BranchSet};

/// A step of the input is a jump if it is so many times those beside it, and this share of the swing.
const JUMP: (f64, f64) = (3.0, 0.02);

/// More jumps of the input than this in a cycle are those of an input in steps.
const MOST_JUMPS: usize = 2;

/// Ratio of a change of the input's pace to those beside it.
const PACE: f64 = 3.0;

/// More rows with a change of pace in a cycle are those of rows at uneven steps; a joint has up to three.
const MOST_KINKS: usize = 4;

/// A jump of the output is so many times what the rows beside it deviate from straight lines, and this share of the height.
const BREAK: (f64, f64) = (3.0, 0.005);

/// Share of the steps beside it that a step of a smooth curve may differ from both.
const CURVED: f64 = 0.5;

/// Deviations of the noise of a row that a jump of the output exceeds: three of the difference of two steps.
const SURE: f64 = 6.0 * SQRT_2;

/// Rows on each side that a step is compared with.
const BESIDE: usize = 4;

/// Channel that jumps, and by how much.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Joint {
    /// The input, between two rows.
    Input(f64),
    /// The output, where the cycle ends or the input changes its pace.
    Output(f64),
}

impl fmt::Display for Joint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, jump) = match self {
            Self::Input(jump) => ("input", jump),
            Self::Output(jump) => ("output", jump),
        };
        write!(f, "the {what} jumps by {:.2} within the cycle,", Significant(jump.abs()))
    }
}

/// The largest jump in a cycle: of the input anywhere, or of the output at the end of the cycle and where an input that is
/// smooth otherwise changes its pace. Elsewhere the output may jump by itself, at turning points by friction.
pub(super) fn joint(record: &Record, span: &Span, survey: &BranchSet, branches: &[Branch]) -> Option<Joint> {
    let (x, y) = (&record.inputs()[0][..], record.output());
    let rows = span.from.floor() as usize..=span.to.ceil() as usize;
    let (inputs, outputs) = (x.get(rows.clone())?, y.get(rows.clone())?);
    let (swing, height) = (width(inputs), width(outputs));
    // A step over the beginning is no part of it.
    let steps = span.from.ceil() as usize..(rows.end() + 1).min(x.len() - 1);

    // Noise of the input is one of the output, by the slope.
    let input_noise = survey.input_noise.deviation();
    let noise = survey.output_noise.deviation() + height / swing * input_noise;
    let is_jump = |row: &usize| {
        let step = |row: usize| (x[row + 1] - x[row]).abs();
        let beside = row.saturating_sub(2)..(row + 3).min(x.len() - 1);
        let most = beside.filter(|other| other != row).map(step).fold(0.0, f64::max);
        step(*row) > f64::max(JUMP.0 * most, JUMP.1 * swing) + SURE * input_noise
    };
    let jumps: Vec<usize> = steps.clone().filter(is_jump).take(MOST_JUMPS + 1).collect();
    if let (Some(row), true) = (jumps.first(), jumps.len() <= MOST_JUMPS) {
        return Some(Joint::Input(x[row + 1] - x[*row]));
    }

    // Branches are in the order of their rows.
    let of_cycle = &branches[span.branches.clone()];
    let is_at_a_turn = |row: usize| {
        let next = of_cycle.partition_point(|branch| branch.rows.start + BESIDE < row);
        of_cycle.get(next).is_some_and(|branch| branch.rows.start <= row + BESIDE)
    };
    let is_kink = |row: &usize| changes_pace(x, *row) && !is_at_a_turn(*row);
    let mut kinks: Vec<usize> = steps.clone().filter(is_kink).take(MOST_KINKS + 1).collect();
    if kinks.len() > MOST_KINKS {
        kinks.clear();
    }
    let near =
        kinks.into_iter().chain([span.to.round() as usize]).flat_map(|row| row.saturating_sub(2)..row + 2);
    let jumps = near.filter(|row| steps.contains(row)).filter_map(|row| {
        let jump = jump_of_output(x, y, row)?;
        let beside = (row.saturating_sub(BESIDE)..row.saturating_sub(1)).chain(row + 2..row + 1 + BESIDE);
        let usual = beside.filter_map(|row| jump_of_output(x, y, row)).map(f64::abs).fold(0.0, f64::max);
        let step = |row: usize| y.get(row + 1).map_or(0.0, |after| (after - y[row]).abs());
        let curved = CURVED * f64::max(step(row.saturating_sub(1)), step(row + 1));
        let least = f64::max(BREAK.0 * usual + SURE * noise, BREAK.1 * height).max(curved);
        (jump.abs() > least).then_some(jump)
    });
    jumps.max_by(|a, b| a.abs().total_cmp(&b.abs())).map(Joint::Output)
}

/// True if the steps of the input before and after this one differ by more than those around them do.
fn changes_pace(x: &[f64], row: usize) -> bool {
    let change = |row: usize| {
        let around = x.get(row.checked_sub(1)?..row + 3)?;
        Some(((around[3] - around[2]) - (around[1] - around[0])).abs())
    };
    let beside = [3, 4].into_iter().flat_map(|by| [row.checked_sub(by), Some(row + by)]).flatten();
    let usual = beside.filter_map(change).fold(0.0, f64::max);
    change(row).is_some_and(|own| own > PACE * usual)
}

/// By how much the step of the output after a row exceeds what the steps before and after it both predict by straight lines,
/// over the input and over the rows.
fn jump_of_output(x: &[f64], y: &[f64], row: usize) -> Option<f64> {
    let step = |values: &[f64], row: usize| Some(values.get(row + 1)? - values.get(row)?);
    let (by, own) = (step(x, row)?, step(y, row)?);
    let [before, after] = [row.checked_sub(1)?, row + 1];
    let over_input = |other: usize| {
        let along = step(x, other)?;
        let ratio = if along == 0.0 { 0.0 } else { (by / along).clamp(-1.0, 1.0) };
        Some(own - ratio * step(y, other)?)
    };
    let over_rows = |other: usize| Some(own - step(y, other)?);
    let beyond = [over_input(before)?, over_input(after)?, over_rows(before)?, over_rows(after)?];
    // A kink or a smooth curve lies between its predictions.
    let is_between = !beyond.iter().all(|by| by * beyond[0] > 0.0);
    let least = beyond.into_iter().min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    Some(if is_between { 0.0 } else { least })
}

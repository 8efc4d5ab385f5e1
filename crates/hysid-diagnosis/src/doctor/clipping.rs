//! Clipping: a channel stands at the end of what its instrument shows while the other goes on. The saturation of a
//! law is smooth, and leaves its extreme as soon as the input turns; a clipped channel repeats one value exactly, on
//! both sides of the turning point, and comes to it abruptly.

use std::ops::Range;

use super::{ColumnUnits, DataIssue, DataIssueKind, Severity, piece};
use crate::Piece;
use crate::branch::BranchSet;
use hysid_core::data::record::{Dataset, Record};

/// Rows that repeat the extreme.
const FEWEST_ROWS: usize = 5;

/// Way of the input on both sides of its turning point, as a share of its range.
const GOES_ON: f64 = 0.01;

/// The slope with which the extreme is reached, as a share of the slope from corner to corner.
const ABRUPT: f64 = 0.2;

/// A step to the extreme that no rounding leaves, in resolutions.
const RESOLUTIONS: f64 = 20.0;

/// Rows over which that slope is taken.
const BEFORE: usize = 4;

const SHOWN: usize = 3;

/// An output that goes there and back while the input stands, as a share of its range.
const EXCURSION: f64 = 0.02;

/// True if an extreme of the first input or of the output is repeated at all: a quick look before the survey.
pub(super) fn may_be(data: &Dataset) -> bool {
    let (input, output) = (data.input_range(0), data.output_range());
    data.records().iter().any(|record| {
        let repeats = |column: &[f64], value: f64| {
            column.windows(FEWEST_ROWS).any(|run| run.iter().all(|v| *v == value))
        };
        let ends = |column: &[f64], (low, high): (f64, f64)| repeats(column, low) || repeats(column, high);
        ends(&record.inputs()[0], input) || ends(record.output(), output)
    })
}

pub(super) fn complaints(survey: &BranchSet) -> Vec<DataIssue> {
    let units = ColumnUnits::of(survey);
    let mut found = Vec::new();
    for of_output in [true, false] {
        for sign in [1.0, -1.0] {
            let Some(ClippedEnd { runs, value }) = clipped(survey, of_output, sign) else {
                continue;
            };
            let count: usize = runs.iter().map(|run| run.rows.len()).sum();
            let records = survey.data.records();
            let rows: Vec<Piece> = runs
                .iter()
                .take(SHOWN)
                .map(|run| piece(&records[run.record], run.rows.start, run.rows.end - 1))
                .collect();
            let (kind, name, other, shown) = match of_output {
                true => (DataIssueKind::OutputClipped, "output", "input", units.output(value)),
                false => (DataIssueKind::InputClipped, "input", "output", units.input(value)),
            };
            let statement = format!(
                "the {name} stays at {shown} for {count} rows while the {other} changes: clipped by the \
                 instrument; measure with a larger range, or blank the output of these rows"
            );
            let issue = DataIssue::of_rows(kind, Severity::Warning, statement, rows);
            found.push(issue.measured(value, if of_output { &units.output } else { &units.input }));
        }
    }
    found
}

/// The records and rows whose output an instrument clipped.
pub(crate) fn clipped_outputs(survey: &BranchSet) -> Vec<(usize, Range<usize>)> {
    let of_ends = [1.0, -1.0].into_iter().filter_map(|sign| clipped(survey, true, sign));
    of_ends.flat_map(|of_end| of_end.runs).map(|run| (run.record, run.rows)).collect()
}

/// Rows of a record at the end of what was measured.
struct LimitRun {
    record: usize,
    rows: Range<usize>,
}

/// Clipped runs at one end of a channel, and their value.
struct ClippedEnd {
    runs: Vec<LimitRun>,
    value: f64,
}

/// Runs of rows at the largest value of a channel (or the smallest, for sign -1) that are clipped.
fn clipped(survey: &BranchSet, of_output: bool, sign: f64) -> Option<ClippedEnd> {
    let range = if of_output { survey.output } else { survey.input };
    let extreme = if sign > 0.0 { range.1 } else { range.0 };
    let resolution = if of_output { resolution(survey) } else { 0.0 };
    let mut runs = Vec::new();
    for (number, record) in survey.data.records().iter().enumerate() {
        let (x, y) = (&record.inputs()[0], record.output());
        let column = if of_output { y } else { x };
        let mut row = 0;
        while row < column.len() {
            let length = column[row..].iter().take_while(|value| **value == extreme).count();
            let last = row + length.saturating_sub(1);
            let is_clipped = length >= FEWEST_ROWS
                && match of_output {
                    true => output_is_clipped(survey, x, y, (row, last), resolution),
                    false => there_and_back(survey, y, (row, last)),
                };
            if is_clipped {
                runs.push(LimitRun { record: number, rows: row..last + 1 });
            }
            row += length.max(1);
        }
    }
    (!runs.is_empty()).then_some(ClippedEnd { runs, value: extreme })
}

fn resolution(survey: &BranchSet) -> f64 {
    let outputs = survey.data.records().iter().flat_map(Record::output);
    let mut sorted: Vec<f64> = outputs.copied().filter(|y| !y.is_nan()).collect();
    sorted.sort_by(f64::total_cmp);
    let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
    steps.fold(f64::INFINITY, f64::min)
}

/// True if the output stands while the input turns, on both sides of its turning point, and came to its extreme
/// abruptly: steeply, or by a step much larger than the resolution, where a rounded saturation comes by single ones.
fn output_is_clipped(
    survey: &BranchSet,
    x: &[f64],
    y: &[f64],
    (first, last): (usize, usize),
    resolution: f64,
) -> bool {
    let during = &x[first..=last];
    let turned = |value: &f64| {
        let (came, goes) = (value - x[first], value - x[last]);
        came * goes > 0.0 && came.abs().min(goes.abs()) >= GOES_ON * survey.width()
    };
    let Some(before) = first.checked_sub(BEFORE) else {
        return false;
    };
    let slope = ((y[first] - y[before]) / (x[first] - x[before])).abs();
    // An output that jumps onto its extreme is switched, not clipped.
    let jump = (y[first] - y[before]).abs() > 0.5 * survey.height();
    let is_steep = slope > ABRUPT * survey.height() / survey.width();
    let is_step = (y[first] - y[first - 1]).abs() > RESOLUTIONS * resolution;
    during.iter().any(turned) && (is_steep || is_step) && !jump
}

/// True if the output goes somewhere and comes back, which no creep does.
fn there_and_back(survey: &BranchSet, y: &[f64], (first, last): (usize, usize)) -> bool {
    let ends = (y[first].min(y[last]), y[first].max(y[last]));
    let limit = EXCURSION * survey.height() + 5.0 * survey.output_noise.deviation();
    y[first..=last].iter().any(|value| *value > ends.1 + limit || *value < ends.0 - limit)
}

//! Values that repeat: whole rows, values held for a fixed number of rows, and columns with few different values.

use super::{ColumnUnits, DataIssue, DataIssueKind, Severity, piece};
use crate::branch::BranchSet;
use crate::significance;
use hysid_core::data::record::Record;

/// Share of rows that repeat the row before, where it matters.
const REPEATED: f64 = 0.05;

/// Longer runs of equal rows are holds.
const LONGEST_RUN: usize = 20;

/// Share of the rows in runs of one length, where values are held.
const HELD: f64 = 0.8;

/// A resolution that is coarse, as a share of the range.
const COARSE: f64 = 0.005;

/// Rows that are looked at for the resolution.
const MOST_ROWS: usize = 20_000;

pub(super) fn complaints(survey: &BranchSet) -> Vec<DataIssue> {
    let mut found: Vec<DataIssue> = repeated_rows(survey).into_iter().collect();
    let rows_repeat = !found.is_empty();
    for of_output in [true, false] {
        let coarse = coarse_resolution(survey, of_output);
        if coarse.is_none() && !rows_repeat {
            found.extend(held_samples(survey, of_output));
        }
        found.extend(coarse);
    }
    found
}

/// Rows that are the row before once more.
fn repeated_rows(survey: &BranchSet) -> Option<DataIssue> {
    let (mut repeated, mut rows) = (0, 0);
    let mut shown = None;
    for (number, record) in survey.data.records().iter().enumerate() {
        let (x, y) = (&record.inputs()[0], record.output());
        let same = |row: usize| x[row] == x[row - 1] && y[row] == y[row - 1];
        let mut row = 1;
        while row < x.len() {
            let run = (row..x.len()).take_while(|&row| same(row)).count();
            if (1..=LONGEST_RUN).contains(&run) {
                repeated += run;
                shown = shown.or_else(|| Some(piece(&survey.data.records()[number], row - 1, row + run - 1)));
            }
            row += run.max(1);
        }
        rows += record.scored();
    }
    let share = repeated as f64 / rows.max(1) as f64;
    (share > REPEATED).then(|| {
        let statement = format!(
            "{:.0} % of the rows repeat the row before: logged faster than measured, or joined twice; \
             remove them, because they distort rates and weights",
            100.0 * share
        );
        let issue = DataIssue::of_all(DataIssueKind::RepeatedRows, Severity::Note, statement);
        let evidence = shown.into_iter().collect();
        DataIssue { evidence, ..issue.measured(100.0 * share, &Some("percent".into())) }
    })
}

/// A column that changes only every few rows while the other changes with each.
fn held_samples(survey: &BranchSet, of_output: bool) -> Option<DataIssue> {
    let mut lengths: Vec<usize> = Vec::new();
    let (mut held, mut while_other_moves) = (0, 0);
    for record in survey.data.records() {
        let (column, other) = (column(record, of_output), column(record, !of_output));
        let mut length = 1;
        for row in 1..column.len() {
            if column[row] == column[row - 1] {
                length += 1;
                held += 1;
                while_other_moves += usize::from(other[row] != other[row - 1]);
            } else {
                if !column[row - 1].is_nan() {
                    lengths.push(length);
                }
                length = 1;
            }
        }
    }
    let rows: usize = lengths.iter().sum();
    let mut sorted = lengths.clone();
    sorted.sort_unstable();
    let typical = *sorted.get(sorted.len() / 2)?;
    // Two rates that do not divide each other give runs of two lengths.
    let near = |length: &&usize| length.abs_diff(typical) <= 1 && **length >= 2;
    let regular: usize = lengths.iter().filter(near).sum();
    let is_held = typical >= 2
        && regular as f64 > HELD * rows as f64
        && while_other_moves as f64 > HELD * held as f64
        && lengths.len() > 10;
    is_held.then(|| {
        let name = if of_output { "output" } else { "input" };
        let statement = format!(
            "the {name} keeps its value for {typical} rows at a time while the other channel changes: it was \
             sampled less often, and lags by half of that on average; keep one row in {typical}, or interpolate"
        );
        DataIssue::of_all(DataIssueKind::HeldSamples, Severity::Warning, statement)
            .measured(typical as f64, &None)
    })
}

/// A column whose values are all multiples of a large step.
fn coarse_resolution(survey: &BranchSet, of_output: bool) -> Option<DataIssue> {
    let stride = survey.data.rows().div_ceil(MOST_ROWS).max(1);
    let records = survey.data.records();
    let mut values: Vec<f64> = records
        .iter()
        .flat_map(|record| column(record, of_output).iter().step_by(stride))
        .copied()
        .filter(|value| !value.is_nan())
        .collect();
    let rows = values.len();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let range = values.last()? - values.first()?;
    if values.len() < 4 || values.len() as f64 > 1.0 / COARSE || rows < 3 * values.len() {
        return None;
    }
    let gaps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let step = significance::median(&mut gaps.clone());
    let off_the_grid = |gap: &&f64| (*gap / step - (*gap / step).round()).abs() > 0.02 || **gap < 0.5 * step;
    if gaps.iter().any(|gap| off_the_grid(&gap)) || step < COARSE * range {
        return None;
    }
    // A path whose rows lie on a grid goes on by equal steps; what is rounded stays where it is, or jumps.
    let mut jumps = [0_usize; 4];
    for record in records {
        for pair in column(record, of_output).windows(2) {
            let jump = ((pair[1] - pair[0]).abs() / step).round();
            jumps[if jump < 3.0 { jump as usize } else { 3 }] += 1;
        }
    }
    let total: usize = jumps.iter().sum();
    let commonest = jumps.iter().max().copied().unwrap_or(0);
    if commonest * 10 > total * 9 && jumps[0] * 10 < total {
        return None;
    }
    let units = ColumnUnits::of(survey);
    let (name, shown) = if of_output { ("output", units.output(step)) } else { ("input", units.input(step)) };
    let statement = format!(
        "the {name} comes in steps of {shown}, {:.1} % of its range: smaller differences, and turning \
         points, are not reliable; measure in a smaller range of the instrument",
        100.0 * step / range
    );
    let issue = DataIssue::of_all(DataIssueKind::CoarseResolution, Severity::Note, statement);
    Some(issue.measured(step, if of_output { &units.output } else { &units.input }))
}

fn column(record: &Record, of_output: bool) -> &[f64] {
    if of_output { record.output() } else { &record.inputs()[0] }
}

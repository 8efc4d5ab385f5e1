//! Spikes of the output: single rows that jump away from their neighbours and back, as a disturbed sensor makes them.

use super::{ColumnUnits, DataIssue, DataIssueKind, Severity, piece};
use crate::Piece;
use crate::branch::BranchSet;
use crate::significance::{MEDIAN_OF_NORMAL, median};

/// Least height of a spike, in multiples of the differences among the rows beside it. At the tip of a loop, these
/// differences are larger.
const ABOVE_NEIGHBOURS: f64 = 5.0;

/// Least height of a spike, in deviations of a row from the mean of its two neighbours.
const ABOVE_NOISE: f64 = 12.0;

/// It is at least this share of the range of the output.
const HIGH: f64 = 0.02;

/// Beyond this share of the rows they are no spikes.
const MOST: f64 = 0.01;

const SHOWN: usize = 3;

/// Spikes, as numbers of records and of their rows.
pub(super) fn spikes(survey: &BranchSet) -> Vec<(usize, usize)> {
    let records = survey.data.records();
    let outputs = || records.iter().enumerate().map(|(number, record)| (number, record.output()));
    let off_middle = |y: &[f64]| (y[2] - 0.5 * (y[1] + y[3])).abs();
    let mut sizes: Vec<f64> =
        outputs().flat_map(|(_, y)| y.windows(5).map(off_middle)).filter(|size| !size.is_nan()).collect();
    let scale = median(&mut sizes) / MEDIAN_OF_NORMAL;
    let least = (ABOVE_NOISE * scale).max(HIGH * survey.height());
    let is_spike = |y: &[f64]| {
        let neighbours = (y[1] - y[0]).abs().max((y[4] - y[3]).abs()).max((y[3] - y[1]).abs());
        off_middle(y) > least && off_middle(y) > ABOVE_NEIGHBOURS * neighbours
    };
    let of_record = |(number, y): (usize, &'_ [f64])| -> Vec<(usize, usize)> {
        y.windows(5)
            .enumerate()
            .filter(|(_, rows)| is_spike(rows))
            .map(|(row, _)| (number, row + 2))
            .collect()
    };
    let found: Vec<(usize, usize)> = outputs().flat_map(of_record).collect();
    if found.len() as f64 > MOST * survey.data.rows() as f64 { Vec::new() } else { found }
}

pub(super) fn complaint(survey: &BranchSet) -> Option<DataIssue> {
    let found = spikes(survey);
    let &(number, row) = found.first()?;
    let records = survey.data.records();
    let value = records[number].output()[row];
    let units = ColumnUnits::of(survey);
    let statement = format!(
        "the output has spikes in {}; the first is {}, in row {} of record \"{}\": leave the output of these rows \
         blank; the tests omit them",
        if found.len() == 1 { "1 row".into() } else { format!("{} rows", found.len()) },
        units.output(value),
        row + 1,
        records[number].name()
    );
    let rows: Vec<Piece> =
        found.iter().take(SHOWN).map(|&(number, row)| piece(&records[number], row, row)).collect();
    let issue = DataIssue::of_rows(DataIssueKind::MissingValueMark, Severity::Warning, statement, rows);
    Some(issue.measured(value, &units.output))
}

//! Signs in loops of magnets and of unknown columns that something lies under or beside them: a straight background, an
//! offset, an end that is not the beginning.

use super::{ColumnUnits, DataIssue, DataIssueKind, Severity};
use crate::Piece;
use crate::branch::BranchSet;
use crate::cycles::{CycleRow, CycleTable, Field};

/// Loops of this share of all cycles show the same sign.
const MOST: f64 = 0.5;

/// Amplitudes that differ by less than this share are one.
const SAME_SIZE: f64 = 0.03;

pub(super) fn complaints(survey: &BranchSet, table: &CycleTable) -> Vec<DataIssue> {
    if table.field != Field::Magnet {
        return Vec::new();
    }
    let units = ColumnUnits::of(survey);
    let rows: Vec<&CycleRow> = table.complete().collect();
    let piece = |row: &CycleRow| Piece { record: row.record.clone(), rows: row.rows };
    // A first loop from another state is open; most of them are where the instrument drifts.
    let shown = |has: &dyn Fn(&CycleRow) -> bool| -> Option<&CycleRow> {
        let found: Vec<&CycleRow> = rows.iter().copied().filter(|row| has(row)).collect();
        (found.len() as f64 > MOST * rows.len() as f64).then(|| found[0])
    };
    // A loop after one of another size is open because it begins elsewhere on the branch.
    let is_steady = |row: &CycleRow| {
        let place = rows.iter().position(|other| std::ptr::eq(*other, row)).unwrap_or(0);
        let before =
            place.checked_sub(1).map(|before| rows[before]).filter(|other| other.record == row.record);
        match before.and_then(|before| before.amplitude).zip(row.amplitude) {
            Some((before, now)) => (before - now).abs() <= SAME_SIZE * now,
            None => rows.iter().filter(|other| other.record == row.record).count() == 1,
        }
    };
    let issue = |kind, row: &CycleRow, value: f64, statement: String| {
        DataIssue::of_rows(kind, Severity::Warning, statement, vec![piece(row)])
            .measured(value, &units.output)
    };
    let mut issues = Vec::new();
    if let Some(row) = shown(&|row| row.faults.passings > 1) {
        let statement = format!(
            "both branches of a loop pass the middle of the outputs {} times: a straight background, such as the \
             diamagnetism of a holder, lies under the loop; `hysid cycles --subtract slope` removes it",
            row.faults.passings
        );
        issues.push(issue(DataIssueKind::LinearBackground, row, row.faults.passings as f64, statement));
    }
    if let Some((row, opening)) = shown(&|row| row.faults.opening.is_some() && is_steady(row))
        .and_then(|row| Some((row, row.faults.opening?)))
    {
        let height = row.output_max.zip(row.output_min).map_or(0.0, |(high, low)| high - low);
        let statement = format!(
            "a loop is open by {} of {}: drift of the output; `hysid cycles --subtract drift` removes it",
            units.output(opening.abs()),
            units.output(height)
        );
        issues.push(issue(DataIssueKind::UnclosedLoops, row, opening, statement));
    }
    if let Some((row, offset)) =
        shown(&|row| row.faults.offset.is_some()).and_then(|row| Some((row, row.faults.offset?)))
    {
        let statement = format!(
            "the middle of the outputs is {}, not 0; `hysid cycles --center` removes it",
            units.output(offset)
        );
        issues.push(issue(DataIssueKind::OutputOffset, row, offset, statement));
    }
    issues
}

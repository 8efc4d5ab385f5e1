//! Where records begin: a model starts from the virgin state, and a record that does not misleads it.

use super::{ColumnUnits, DataIssue, DataIssueKind, Severity, piece};
use crate::branch::{Branch, BranchSet};

/// A first input within this share of the largest is at rest.
const AT_REST: f64 = 0.05;

/// How far the first output may lie outside of what later loops have there, as a share of its range.
const OUTSIDE: f64 = 0.05;

/// Least height of loops at the first input that shows on which side of them a record begins.
const OPEN: f64 = 0.1;

/// A virgin record begins in the middle of its loops; within this share of their height from one side it does not.
const SIDE: f64 = 0.15;

const HELP: &str = "add a few earlier rows with blank outputs before it, give its initial state, or blank the output of its first \
     cycle";

pub(super) fn complaints(survey: &BranchSet) -> Vec<DataIssue> {
    (0..survey.data.records().len()).filter_map(|record| beginning(survey, record)).collect()
}

fn beginning(survey: &BranchSet, number: usize) -> Option<DataIssue> {
    let record = &survey.data.records()[number];
    let (x, y) = (record.inputs()[0][0], record.output()[0]);
    // Blank rows at first are its past.
    if y.is_nan() {
        return None;
    }
    let units = ColumnUnits::of(survey);
    let complaint = |kind, severity, statement: String| {
        Some(DataIssue::of_rows(kind, severity, statement, vec![piece(record, 0, 0)]))
    };
    let largest = survey.input.0.abs().max(survey.input.1.abs());
    let later: Vec<&Branch> = survey.of_record(number).iter().skip(2).collect();
    let inside = |branch: &&&Branch| {
        let (low, high) = branch.curve.range();
        low <= x && x <= high
    };
    let readings: Vec<(bool, f64)> = later
        .iter()
        .filter(inside)
        .filter_map(|branch| Some((branch.rises(), branch.curve.at(x)?.y)))
        .collect();
    let low = readings.iter().map(|(_, y)| *y).fold(f64::INFINITY, f64::min);
    let high = readings.iter().map(|(_, y)| *y).fold(f64::NEG_INFINITY, f64::max);
    let margin = OUTSIDE * survey.height() + 4.0 * survey.output_noise.deviation();
    if readings.len() >= 2 && (y > high + margin || y < low - margin) {
        return complaint(
            DataIssueKind::NotVirgin,
            Severity::Warning,
            format!(
                "it begins with an output of {} at an input of {}, where later loops are between {} and {}: \
                 a virgin curve outside the loops, an unknown history, or an output that was reset; {HELP}",
                units.output(y),
                units.input(x),
                units.output(low),
                units.output(high)
            ),
        );
    }
    if x.abs() > AT_REST * largest {
        return complaint(
            DataIssueKind::UnknownStart,
            Severity::Note,
            format!(
                "it begins at an input of {}, not at rest, so its initial memory is unknown; {HELP}",
                units.input(x)
            ),
        );
    }
    let both_ways = survey.input.0 < -4.0 * AT_REST * largest && survey.input.1 > 4.0 * AT_REST * largest;
    let mean = |rises: bool| {
        let of_way: Vec<f64> = readings.iter().filter(|r| r.0 == rises).map(|r| r.1).collect();
        (!of_way.is_empty()).then(|| of_way.iter().sum::<f64>() / of_way.len() as f64)
    };
    let (up, down) = (mean(true)?, mean(false)?);
    let open = (up - down).abs() > OPEN * survey.height() + 4.0 * survey.output_noise.deviation();
    let side = (y - up).abs().min((y - down).abs()) / (up - down).abs();
    if both_ways && open && side < SIDE {
        return complaint(
            DataIssueKind::NotVirgin,
            Severity::Warning,
            format!(
                "it begins with an output of {} at an input of {}, on one side of its later loops ({} and \
                 {}); a virgin specimen would begin between them; {HELP}",
                units.output(y),
                units.input(x),
                units.output(up),
                units.output(down)
            ),
        );
    }
    None
}

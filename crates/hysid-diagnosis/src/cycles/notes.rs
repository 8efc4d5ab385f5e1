//! Notes on a whole table of cycles.

use hysid_core::significant::Significant;

use super::division::Division;
use super::field::Field;
use super::row::CycleRow;
use crate::branch::{BranchSet, JITTERS};

/// Reversals that are ignored are said above this share of the range.
const HIDDEN: f64 = 0.005;

/// Relative difference of an amplitude and that of the reversals that is said.
const MISMATCH: f64 = 0.05;

/// Figures that every row lacks, and why.
pub(super) fn notes(
    survey: &BranchSet,
    cycles: &[CycleRow],
    (field, division): (Field, Division),
) -> Vec<String> {
    let mut notes = Vec::new();
    let complete = cycles.iter().filter(|row| row.complete).count();
    if complete == 0 {
        notes.push("no whole cycle: the input does not come back to where a cycle began".to_string());
    }
    let hidden = survey.smallest_reversal;
    if hidden > HIDDEN * survey.width() && survey.input_noise.deviation() > JITTERS * survey.width() {
        notes.push(format!(
            "reversals of the input below {:.2}, {:.1} % of its range, are not told from its noise",
            Significant(hidden),
            100.0 * hidden / survey.width()
        ));
    }
    notes.extend(check(cycles, division));
    if !survey.data.has_time() {
        let missing = match field {
            Field::Structure | Field::Thermal | Field::Battery | Field::Hydrology => "period and frequency",
            Field::Magnet => "period, frequency and loss per time",
            Field::Actuator => "period, frequency and creep",
            Field::General => "period, frequency, loss per time and creep",
        };
        notes.push(format!("no time: no {missing}"));
    } else if field == Field::Actuator && cycles.iter().all(|row| row.creep.is_none()) {
        notes.push("no creep: the input rests nowhere long enough".into());
    }
    notes
}

/// Contradictions in a table: rows that do not follow each other, amplitudes that are not those of the reversals.
fn check(cycles: &[CycleRow], division: Division) -> Vec<String> {
    let mut notes = Vec::new();
    let follows = |pair: &[CycleRow]| {
        pair[0].record != pair[1].record || pair[1].rows.0.saturating_sub(pair[0].rows.1) <= 1
    };
    if !cycles.windows(2).all(follows) {
        notes.push("cycles do not follow each other without a gap: check their rows".into());
    }
    let differs = |row: &&CycleRow| {
        let tips = row.peak_input.zip(row.valley_input).map(|(peak, valley)| 0.5 * (peak - valley));
        row.complete && tips.zip(row.amplitude).is_some_and(|(tips, own)| (tips - own).abs() > MISMATCH * own)
    };
    let unlike: Vec<String> = cycles.iter().filter(differs).map(|row| row.cycle.to_string()).collect();
    if division != Division::Reversals && !unlike.is_empty() {
        notes.push(format!(
            "amplitudes that are not half the distance of the reversals: cycles {}",
            unlike.join(", ")
        ));
    }
    notes
}

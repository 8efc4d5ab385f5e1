//! Creep: the output moves while the input stands still, theory.md (10.24).

use super::{ColumnUnits, DataIssue, DataIssueKind, Severity, piece};
use crate::branch::BranchSet;

/// Fewest rows of a hold.
const FEWEST_ROWS: usize = 20;

/// The input stands still within this share of its range.
const STILL: f64 = 1e-4;

/// A movement of the output that matters, as a share of its range.
const EFFECT: f64 = 0.01;

/// Largest slope that residual input motion may explain, as shares of the ranges.
const STEEPEST: f64 = 30.0;

/// A creep goes on: no quarter of the hold has more than this share of it.
const GOES_ON: f64 = 0.8;

const SHOWN: usize = 3;

/// A hold of the input during which the output moves.
struct InputHold {
    record: usize,
    rows: (usize, usize),
    movement: f64,
}

pub(super) fn complaint(survey: &BranchSet) -> Option<DataIssue> {
    let mut holds: Vec<InputHold> = Vec::new();
    let still = (STILL * survey.width()).max(2.5 * survey.input_noise.deviation());
    for (number, record) in survey.data.records().iter().enumerate() {
        let x = &record.inputs()[0];
        let mut first = 0;
        for row in 1..=x.len() {
            if row == x.len() || (x[row] - x[first]).abs() > still {
                holds.extend(creeping(survey, number, (first, row - 1)));
                first = row;
            }
        }
    }
    holds.sort_by(|a, b| b.movement.abs().total_cmp(&a.movement.abs()));
    let largest = holds.first()?;
    let units = ColumnUnits::of(survey);
    let (first, last) = largest.rows;
    let during = match survey.data.records()[largest.record].time() {
        Some(time) => units.time(time[last] - time[first]),
        None => format!("{} rows", last - first + 1),
    };
    let statement = format!(
        "while the input is constant for {during}, the output changes by {}, {:.1} % of its range (such \
         holds: {}): creep, which needs a model with fading memory (xpnn+)",
        units.output(largest.movement),
        100.0 * largest.movement.abs() / survey.height(),
        holds.len()
    );
    let rows = holds
        .iter()
        .take(SHOWN)
        .map(|hold| piece(&survey.data.records()[hold.record], hold.rows.0, hold.rows.1));
    let issue = DataIssue::of_rows(DataIssueKind::Creep, Severity::Warning, statement, rows.collect());
    Some(issue.measured(largest.movement, &units.output))
}

/// The hold, if the output creeps during it.
fn creeping(survey: &BranchSet, record: usize, rows: (usize, usize)) -> Option<InputHold> {
    let count = rows.1 + 1 - rows.0;
    if count < FEWEST_ROWS {
        return None;
    }
    let data = &survey.data.records()[record];
    let quarters = |column: &[f64]| -> [f64; 4] {
        std::array::from_fn(|k| {
            let part = &column[rows.0 + k * count / 4..rows.0 + (k + 1) * count / 4];
            part.iter().sum::<f64>() / part.len() as f64
        })
    };
    let (x, y) = (quarters(&data.inputs()[0]), quarters(data.output()));
    let movement = y[3] - y[0];
    let of_mean = 4.0 * (8.0 / count as f64).sqrt();
    let input_moves = (x[3] - x[0]).abs() + of_mean * survey.input_noise.deviation();
    let explained = STEEPEST * input_moves / survey.width() * survey.height();
    let least = (EFFECT * survey.height()).max(of_mean * survey.output_noise.deviation()).max(explained);
    let steps = [y[1] - y[0], y[2] - y[1], y[3] - y[2]];
    let goes_on = steps.iter().all(|step| {
        let share = step / movement;
        share > -0.5 * of_mean * survey.output_noise.deviation() / movement.abs() && share <= GOES_ON
    });
    (movement.abs() > least && goes_on).then_some(InputHold { record, rows, movement })
}

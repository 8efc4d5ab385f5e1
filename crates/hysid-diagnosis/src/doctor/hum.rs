//! Hum: noise of the output with a period of its own, mostly that of the mains.

use std::f64::consts::TAU;

use super::{ColumnUnits, DataIssue, DataIssueKind, Severity};
use crate::branch::BranchSet;
use hysid_core::data::record::Record;
use hysid_core::elementary::{hypot, sin_cos};

/// An amplitude that matters, as a share of the range of the output.
const EFFECT: f64 = 0.002;

/// Hum is a line in the spectrum of the output, of at least this share of its amplitude. Designed.
const LINE: f64 = 0.5;

/// Periods around the one that is known roughly: to either side by this share.
const AROUND: f64 = 0.15;

const MOST_ROWS: usize = 8192;

pub(super) fn complaint(survey: &BranchSet) -> Option<DataIssue> {
    let (rows, amplitude) = survey.output_noise.hum()?;
    let is_line = |record: &Record| {
        let (input, output) = (&record.inputs()[0], record.output());
        line(output, rows) >= LINE * amplitude
            && line(input, rows) / survey.width() < 0.5 * amplitude / survey.height()
    };
    if amplitude < EFFECT * survey.height() || !survey.data.records().iter().any(is_line) {
        return None;
    }
    let units = ColumnUnits::of(survey);
    let step = survey.time_step();
    let period = if step > 0.0 { units.time(rows * step) } else { format!("{rows:.0} rows") };
    let statement = format!(
        "the output contains hum with a period of about {period} and an amplitude of {}, {:.1} % of its range: remove the \
         hum with a zero-phase notch filter",
        units.output(amplitude),
        100.0 * amplitude / survey.height()
    );
    let issue = DataIssue::of_all(DataIssueKind::Hum, Severity::Note, statement);
    Some(issue.measured(amplitude, &units.output))
}

/// The largest amplitude of a sine of about this period, in rows, in the first rows.
fn line(values: &[f64], period: f64) -> f64 {
    let values = &values[..values.len().min(MOST_ROWS)];
    let count = values.iter().filter(|value| !value.is_nan()).count().max(1) as f64;
    let mean = values.iter().filter(|value| !value.is_nan()).sum::<f64>() / count;
    let (lowest, highest) = (1.0 / (period * (1.0 + AROUND)), 1.0 / (period * (1.0 - AROUND)));
    // Half of the width of a line apart.
    let places = ((highest - lowest) * 2.0 * values.len() as f64).ceil().max(1.0) as usize;
    let amplitude = |place: usize| {
        let angle = TAU * (lowest + (highest - lowest) * place as f64 / places as f64);
        let (turn_sin, turn_cos) = sin_cos(angle);
        let (mut sin, mut cos) = (0.0, 1.0);
        let (mut real, mut imaginary) = (0.0, 0.0);
        for value in values {
            if !value.is_nan() {
                real += (value - mean) * cos;
                imaginary += (value - mean) * sin;
            }
            (sin, cos) = (sin * turn_cos + cos * turn_sin, cos * turn_cos - sin * turn_sin);
        }
        2.0 * hypot(real, imaginary) / count
    };
    (0..=places).map(amplitude).fold(0.0, f64::max)
}

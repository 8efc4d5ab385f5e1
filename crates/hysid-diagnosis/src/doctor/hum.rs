//! Hum: noise of the output with a period of its own, mostly that of the mains.

use super::{DataIssue, DataIssueKind, Severity, Units};
use crate::branch::BranchSet;

/// An amplitude that matters, as a share of the range of the output.
const EFFECT: f64 = 0.002;

pub(super) fn complaints(survey: &BranchSet) -> Vec<DataIssue> {
    let Some((rows, amplitude)) = survey.output_noise.hum() else {
        return Vec::new();
    };
    if amplitude < EFFECT * survey.height() {
        return Vec::new();
    }
    let units = Units::of(survey);
    let step = survey.time_step();
    let period = if step > 0.0 { units.time(rows * step) } else { format!("{rows:.0} rows") };
    let statement = format!(
        "the output contains hum with a period of about {period} and an amplitude of {}, {:.1} % of its range: remove the \
         hum with a zero-phase notch filter",
        units.output(amplitude),
        100.0 * amplitude / survey.height()
    );
    vec![DataIssue {
        value: Some(amplitude),
        unit: units.output.clone(),
        ..DataIssue::of_all(DataIssueKind::Hum, Severity::Note, statement)
    }]
}

//! Delays and drifts that only the comparison of branches shows: with them removed, a property holds that the data as
//! they are contradict.

use super::{DataIssue, DataIssueKind, Severity};
use crate::artifact::{Artifact, Explanation};
use crate::branch::BranchSet;

/// The issues of one kind, or where there are none, what explains verdicts.
pub(super) fn added(
    survey: &BranchSet,
    complaints: Vec<DataIssue>,
    explanations: &[Explanation],
    kind: DataIssueKind,
) -> Vec<DataIssue> {
    let is_of_kind = |explanation: &&Explanation| match explanation.artifact {
        Artifact::Lag(_) => kind == DataIssueKind::Lag,
        Artifact::Drift(_) => kind == DataIssueKind::Drift,
    };
    if !complaints.is_empty() {
        return complaints;
    }
    explanations.iter().filter(is_of_kind).map(|explanation| complaint(survey, explanation, kind)).collect()
}

fn complaint(survey: &BranchSet, explanation: &Explanation, kind: DataIssueKind) -> DataIssue {
    let properties: Vec<String> =
        explanation.properties.iter().map(|property| property.to_string()).collect();
    let statement = format!(
        "{} would explain why these properties seem not to hold: {}. Their verdicts are \"not testable\". Check the measurement",
        explanation.artifact.in_words(survey.data),
        properties.join(", ")
    );
    DataIssue::of_all(kind, Severity::Note, statement)
}

//! Loops of a periodic input that stay open, reported as an issue of the data.

use super::{DataIssue, DataIssueKind, Severity};
use crate::{Finding, Property, Verdict};

pub(super) fn complaint(findings: &[Finding]) -> Option<DataIssue> {
    let verdict = |property| findings.iter().find(|finding| finding.property == property);
    let closure = verdict(Property::LoopClosure).filter(|finding| finding.verdict == Verdict::No)?;
    let wears = verdict(Property::Deterioration).is_some_and(|finding| finding.verdict == Verdict::Yes);
    let percent = 100.0 * closure.index.unwrap_or(0.0);
    let why = if wears {
        "the specimen deteriorates, which explains it"
    } else {
        "drift, creep, fading memory, or a specimen that has not settled; leave out the first cycles, or \
         remove the drift"
    };
    let rows = closure.evidence.iter().flat_map(|evidence| evidence.pieces.iter().cloned()).take(3).collect();
    let statement =
        format!("after a period of the input the output differs by {percent:.1} % of its range: {why}");
    let issue = DataIssue::of_all(DataIssueKind::UnclosedLoops, Severity::Note, statement);
    Some(DataIssue { evidence: rows, ..issue.measured(percent, &Some("percent".into())) })
}

//! Result of the choice by validation: what each part predicts and costs.

use std::time::Duration;

use hysid::model::selection::{CandidateResult, Selection};
use hysid::model::{Ensemble, Group, Model, Node, NodeKind};
use hysid_document::{Cell, Part, Table, number};

use crate::Report;
use crate::timing::ns_per_sample;

/// A member is timed over at least this time.
const TIMED: Duration = Duration::from_millis(3);

/// The section on the choice; `None` for a model that was not chosen from others.
pub fn section(report: &Report) -> Option<Part> {
    let selection = report.model.provenance().selection.as_ref()?;
    let [chosen, why] = selection.summary();
    let lines = vec![("Chosen".to_string(), chosen), ("Why".to_string(), why)];
    let (counting, others): (Vec<&CandidateResult>, Vec<&CandidateResult>) =
        selection.candidates.iter().partition(|one| counts(one));
    let (heading, content) = match report.model.ensemble() {
        Some(ensemble) => ("The ensemble", nodes(report, selection, ensemble, counting)),
        None => ("How it was chosen", single(selection, counting)),
    };
    let mut parts = vec![Part::Definitions(lines)];
    parts.extend(content);
    parts.extend(left_out(&others, &selection.dropped));
    parts.push(held_out(selection));
    Some(Part::section(heading, parts))
}

fn counts(candidate: &CandidateResult) -> bool {
    candidate.share.inside > 0.0 || candidate.share.outside > 0.0
}

/// Members of the ensemble: weight, contribution, run time.
fn nodes(
    report: &Report,
    selection: &Selection,
    ensemble: &Ensemble,
    mut candidates: Vec<&CandidateResult>,
) -> Vec<Part> {
    let costs: Vec<Option<f64>> = ensemble.members().iter().map(|member| cost(report, member)).collect();
    candidates.sort_by(|a, b| b.share.inside.total_cmp(&a.share.inside));
    let row = |one: &&CandidateResult| {
        let members = members_of(ensemble.group(), one);
        let cost: Option<f64> = members.iter().map(|&member| costs[member]).sum();
        let parameters: usize = members.iter().map(|&member| ensemble.members()[member].parameters()).sum();
        vec![
            one.name.as_str().into(),
            one.kind.as_str().into(),
            members.len().into(),
            shares(one).into(),
            Cell::number(one.held_out_percent, 3),
            Cell::number(cost, 2),
            parameters.into(),
        ]
    };
    let columns = [
        "candidate",
        "kind",
        "members",
        "share (%)",
        "held-out error alone (% of std)",
        "ns per sample",
        "parameters",
    ];
    let (low, high) = ensemble.range();
    let words = format!(
        "The members of a candidate are fits from different random starts. A weighted median combines the \
         candidates; the share is the weight of a candidate. Of two shares, the first is for rows before the first \
         input leaves the trained range ({} to {}), the second for the rows after. Errors are those of free \
         runs over all rows that were held out. The cost was measured on this machine, on one thread.",
        number(low, 4),
        number(high, 4)
    );
    let mut table = Table::new(columns).with_rows(candidates.iter().map(row));
    table.push([
        "whole ensemble".into(),
        "".into(),
        ensemble.members().len().into(),
        share(1.0).into(),
        Cell::number(selection.held_out_percent, 3),
        Cell::number(cost(report, report.model), 2),
        report.model.parameters().into(),
    ]);
    vec![Part::Table(table), Part::note(words)]
}

/// Candidates of a single model, or the ensemble that it was distilled from.
fn single(selection: &Selection, mut candidates: Vec<&CandidateResult>) -> Vec<Part> {
    candidates.sort_by(|a, b| b.share.inside.total_cmp(&a.share.inside));
    let row = |one: &&CandidateResult| {
        vec![
            one.name.as_str().into(),
            one.kind.as_str().into(),
            shares(one).into(),
            Cell::number(one.held_out_percent, 3),
        ]
    };
    let table = Table::new(["candidate", "kind", "share (%)", "held-out error (% of std)"])
        .with_rows(candidates.iter().map(row));
    let how = selection.single.as_ref();
    let is_distilled = how.is_none_or(|single| single.distilled);
    let (first, words) = match is_distilled {
        _ if how.is_some_and(|single| single.is_law) => (
            "The model is a law, in place of an ensemble: the product of its errors, on the data and on the \
             rows held out, is about the lowest of all candidates. Where the data say nothing, such a law \
             usually predicts better than networks do.",
            "The candidates are not part of the model.",
        ),
        true => (
            "A single model was requested. It was trained on the data, and on the output of an ensemble of \
             these candidates for paths that were not measured:",
            "The candidates are not part of the model. The share is the weight of a candidate in the \
             ensemble.",
        ),
        false => (
            "A single model was requested. It was fitted to the data alone, because its error is lower than \
             that of a model trained to imitate an ensemble of these candidates. The error is that on held-out \
             data, together with the distance from the ensemble on paths that were not measured.",
            "The share is the weight of a candidate in the ensemble.",
        ),
    };
    let errors = "Errors are those of free runs over all rows that were held out. Of two shares, the first is for rows \
                  before the first input leaves the trained range, the second for the rows after.";
    vec![Part::paragraph(first), Part::Table(table), Part::note(format!("{words} {errors}"))]
}

/// The candidates that are not part of the model: those that were validated, and those that were dropped before.
fn left_out(candidates: &[&CandidateResult], dropped: &[String]) -> Option<Part> {
    let mut candidates = candidates.to_vec();
    let error = |one: &CandidateResult| one.held_out_percent.unwrap_or(f64::INFINITY);
    candidates.sort_by(|a, b| error(a).total_cmp(&error(b)));
    let row = |one: &&CandidateResult| {
        vec![one.name.as_str().into(), one.kind.as_str().into(), Cell::number(one.held_out_percent, 3)]
    };
    let mut parts = Vec::new();
    if !candidates.is_empty() {
        let columns = ["candidate", "kind", "held-out error (% of std)"];
        parts.push(Part::Table(Table::new(columns).with_rows(candidates.iter().map(row))));
    }
    if !dropped.is_empty() {
        let names = dropped.join(", ");
        parts.push(Part::note(format!("Dropped early, because others had lower errors: {names}.")));
    }
    let count = candidates.len() + dropped.len();
    (!parts.is_empty()).then(|| Part::Folded(format!("Candidates without weight: {count}"), parts))
}

fn held_out(selection: &Selection) -> Part {
    let folds = selection.folds.iter().map(|fold| Part::paragraph(fold.as_str()));
    Part::Folded(
        format!("Folds: {} parts of the data, held out in turn", selection.folds.len()),
        folds.collect(),
    )
}

fn members_of(group: &Group, candidate: &CandidateResult) -> Vec<usize> {
    let of_node = |node: &Node| match &node.kind {
        NodeKind::Group(group) if group.name == candidate.name => {
            group.shares().into_iter().map(|(member, _)| member).collect()
        }
        NodeKind::Group(_) | NodeKind::Member(_) => Vec::new(),
    };
    group.nodes.iter().flat_map(of_node).collect()
}

/// Nanoseconds for a sample on the training data; `None` if it cannot be run there.
fn cost(report: &Report, model: &Model) -> Option<f64> {
    let records = report.sets.first()?.data.records();
    ns_per_sample(model, records, TIMED).ok()
}

fn share(share: f64) -> String {
    if share > 0.0 && share < 5e-4 { "<0.1".into() } else { number(100.0 * share, 2) }
}

fn shares(candidate: &CandidateResult) -> String {
    pair(share(candidate.share.inside), share(candidate.share.outside))
}

/// Values inside the trained range and beyond it; one value where both are the same.
fn pair(inside: String, outside: String) -> String {
    if inside == outside { inside } else { format!("{inside} / {outside}") }
}

//! What was chosen by validation, what each part of it adds and what it costs.

use std::time::Duration;

use hysid::model::selection::{CandidateResult, Selection};
use hysid::model::{Ensemble, Group, Model, Speaker};

use super::Report;
use crate::page::{definitions, folded, note, number, paragraph, section as section_of, table};
use crate::timing::ns_per_sample;

/// A member is timed over at least this time.
const TIMED: Duration = Duration::from_millis(3);

/// The section on the choice; empty for a model that was not chosen from others.
pub fn section(report: &Report) -> String {
    let Some(selection) = &report.model.provenance().selection else { return String::new() };
    let [chosen, why] = selection.summary();
    let lines = [("Chosen".to_string(), chosen), ("Why".to_string(), why)];
    let (counting, others): (Vec<&CandidateResult>, Vec<&CandidateResult>) =
        selection.candidates.iter().partition(|one| counts(one));
    let content = match report.model.ensemble() {
        Some(ensemble) => voices(report, selection, ensemble, counting),
        None => single(selection, counting),
    };
    let heading = if report.model.ensemble().is_some() { "The ensemble" } else { "How it was chosen" };
    section_of(heading, &(definitions(&lines) + &content + &left_out(&others) + &held_out(selection)))
}

fn counts(candidate: &CandidateResult) -> bool {
    candidate.share.inside > 0.0 || candidate.share.outside > 0.0
}

/// Those that answer together, what each adds and what it costs.
fn voices(
    report: &Report,
    selection: &Selection,
    ensemble: &Ensemble,
    mut candidates: Vec<&CandidateResult>,
) -> String {
    let costs: Vec<Option<f64>> = ensemble.members().iter().map(|member| cost(report, member)).collect();
    candidates.sort_by(|a, b| b.share.inside.total_cmp(&a.share.inside));
    let row = |one: &&CandidateResult| {
        let members = members_of(ensemble, one);
        let cost: Option<f64> = members.iter().map(|&member| costs[member]).sum();
        let parameters: usize = members.iter().map(|&member| ensemble.members()[member].parameters()).sum();
        vec![
            one.name.clone(),
            one.kind.clone(),
            members.len().to_string(),
            shares(one),
            errors(one.error_percent),
            without(one, selection),
            ns(cost),
            parameters.to_string(),
        ]
    };
    let mut rows: Vec<Vec<String>> = candidates.iter().map(row).collect();
    rows.push(vec![
        "all together".into(),
        String::new(),
        ensemble.members().len().to_string(),
        share(1.0),
        errors(selection.error_percent),
        String::new(),
        ns(cost(report, report.model)),
        report.model.parameters().to_string(),
    ]);
    let headings = [
        "candidate",
        "kind",
        "members",
        "share (%)",
        "error alone (% of std)",
        "error of the ensemble without it",
        "ns per sample",
        "parameters",
    ];
    let (low, high) = ensemble.range();
    let words = format!(
        "Members of a candidate are fits from different random starts. Candidates are combined by a weighted \
         median in each kind, then over the kinds; a share is a candidate's weight in it. Errors are of free \
         runs on data held out, geometric means over the folds. If the ensemble is worse without a candidate, that \
         is what it adds. Where two numbers stand, the first is of rows where the first input has not left the range \
         that was fitted to (here {} to {}), the second of those after it has. The cost was measured here, on one \
         thread.",
        number(low, 4),
        number(high, 4)
    );
    table(&headings.map(String::from), &rows) + &note(&words)
}

/// What a single model was chosen among, or distilled from.
fn single(selection: &Selection, mut candidates: Vec<&CandidateResult>) -> String {
    candidates.sort_by(|a, b| b.share.inside.total_cmp(&a.share.inside));
    let row = |one: &&CandidateResult| {
        vec![one.name.clone(), one.kind.clone(), shares(one), errors(one.error_percent)]
    };
    let rows: Vec<Vec<String>> = candidates.iter().map(row).collect();
    let headings = ["candidate", "kind", "share (%)", "error alone (% of std)"].map(String::from);
    let is_distilled = selection.single.as_ref().is_none_or(|single| single.distilled);
    let (first, words) = match is_distilled {
        true => (
            "One model was asked for. It was trained on the data and on what an ensemble of these candidates \
             predicts on paths that were not measured:",
            "The candidates are not part of the model. A share is what a candidate counts in the ensemble.",
        ),
        false => (
            "One model was asked for. It was fitted to the data alone, because that predicts data held out better \
             than a model distilled from an ensemble of these candidates:",
            "A share is what a candidate counts in the ensemble.",
        ),
    };
    let errors = "Errors are of free runs on data held out, geometric means over what was held out. Where two numbers \
                  stand, the first is of rows where the first input has not left the range that was fitted to, the \
                  second of those after it has.";
    paragraph(first) + &table(&headings, &rows) + &note(&format!("{words} {errors}"))
}

/// What was tried in vain.
fn left_out(candidates: &[&CandidateResult]) -> String {
    if candidates.is_empty() {
        return String::new();
    }
    let mut candidates = candidates.to_vec();
    candidates.sort_by(|a, b| a.error_percent.0.total_cmp(&b.error_percent.0));
    let row = |one: &&CandidateResult| vec![one.name.clone(), one.kind.clone(), errors(one.error_percent)];
    let rows: Vec<Vec<String>> = candidates.iter().map(row).collect();
    let headings = ["candidate", "kind", "error alone (% of std)"].map(String::from);
    folded(&format!("Tried and left out: {}", rows.len()), &table(&headings, &rows))
}

fn held_out(selection: &Selection) -> String {
    let items: String = selection.folds.iter().map(|fold| paragraph(fold)).collect();
    folded(&format!("Held out in turn: {} parts of the data", selection.folds.len()), &items)
}

/// The places of a candidate's members.
fn members_of(ensemble: &Ensemble, candidate: &CandidateResult) -> Vec<usize> {
    let named = |group: &'_ Group, name: &str| -> Option<Group> {
        group.voices.iter().find_map(|voice| match &voice.who {
            Speaker::Group(group) if group.name == name => Some(group.clone()),
            _ => None,
        })
    };
    let found = named(ensemble.group(), &candidate.kind).and_then(|kind| named(&kind, &candidate.name));
    let voices = found.map_or_else(Vec::new, |group| group.voices);
    let member = |voice: &hysid::model::Voice| match voice.who {
        Speaker::Member(place) => Some(place),
        Speaker::Group(_) => None,
    };
    voices.iter().filter_map(member).collect()
}

/// Nanoseconds for a sample on the training data; `None` if it cannot be run there.
fn cost(report: &Report, model: &Model) -> Option<f64> {
    let records = report.sets.first()?.data.records();
    ns_per_sample(model, records, TIMED).ok()
}

fn ns(cost: Option<f64>) -> String {
    cost.map_or("–".into(), |ns| number(ns, 2))
}

fn share(share: f64) -> String {
    if share > 0.0 && share < 5e-4 { "<0.1".into() } else { number(100.0 * share, 2) }
}

fn shares(candidate: &CandidateResult) -> String {
    pair(share(candidate.share.inside), share(candidate.share.outside))
}

fn errors((inside, outside): (f64, f64)) -> String {
    pair(number(inside, 3), number(outside, 3))
}

/// What holds inside the trained range and beyond it; once where both are the same.
fn pair(inside: String, outside: String) -> String {
    if inside == outside { inside } else { format!("{inside} / {outside}") }
}

fn without(candidate: &CandidateResult, selection: &Selection) -> String {
    let Some(without) = candidate.without_percent else { return "–".into() };
    let added = without.0 - selection.error_percent.0;
    let added = match added {
        nothing if nothing.abs() < 1e-3 * selection.error_percent.0 => "±0".into(),
        less if less < 0.0 => number(less, 2),
        more => format!("+{}", number(more, 2)),
    };
    format!("{} ({added})", errors(without))
}

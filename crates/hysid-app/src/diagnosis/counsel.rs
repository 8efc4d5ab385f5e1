//! Data issues, and the advised model.

use hysid::diagnosis::{Advice, DataIssue, Severity, Verdict};
use hysid_document::plain::indented;
use hysid_document::{Face, Item, Part};

use super::cards::sentence;

/// How far words stand in under their heading.
const INDENT: usize = 4;

/// The issues under a heading, which also reports that there are none.
pub fn doctor_text(complaints: &[DataIssue], face: Face) -> String {
    let told: String =
        complaints.iter().map(|complaint| indented(&labelled(complaint, face), INDENT)).collect();
    match complaints.len() {
        0 => "data quality: no issues found\n".into(),
        _ => format!("data quality\n{told}"),
    }
}

/// A complaint with how much it matters and whom it concerns.
fn labelled(complaint: &DataIssue, face: Face) -> String {
    format!("{}: {}", severity(complaint), face.told(&complaint.words()))
}

fn severity(complaint: &DataIssue) -> &'static str {
    match complaint.severity {
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}

/// The advice, and what to type to follow it: `fit` is the command that fits the default model.
pub fn advice_text(advice: &Advice, fit: &str) -> String {
    let said: String = advice.statement.iter().map(|line| indented(&sentence(line), INDENT)).collect();
    let needs = indented(&needs(advice), INDENT);
    let next = advice.model.map_or_else(String::new, |_| format!("\nnext:\n  {fit}\n"));
    format!("advice\n{said}{needs}{next}")
}

/// Requirements on the model, in a line.
fn needs(advice: &Advice) -> String {
    let needs = [
        ("rate dependence", advice.needs_rate),
        ("deterioration", advice.needs_deterioration),
        ("asymmetry", advice.needs_asymmetry),
        ("relaxation over time", advice.needs_memory_of_time),
    ];
    let of = |wanted: Verdict| -> Option<String> {
        let names: Vec<&str> =
            needs.iter().filter(|(_, verdict)| *verdict == wanted).map(|(name, _)| *name).collect();
        (!names.is_empty()).then(|| names.join(", "))
    };
    let parts = [
        of(Verdict::Yes).map(|names| format!("the model must represent: {names}")),
        of(Verdict::No).map(|names| format!("need not represent: {names}")),
        of(Verdict::NotTestable).map(|names| format!("not known from these data: {names}")),
    ];
    sentence(&parts.into_iter().flatten().collect::<Vec<String>>().join("; "))
}

/// The sentence that a reader of the page should take away, and what else is advised.
pub fn verdict(advice: &Advice) -> [Part; 2] {
    let mut said = advice.statement.iter().map(|line| sentence(line));
    let first = said.next().unwrap_or_default();
    let rest: Vec<String> = std::iter::once(needs(advice)).chain(said).collect();
    [Part::Lead(first.into()), Part::note(rest.join(" "))]
}

pub fn doctor_section(complaints: &[DataIssue], face: Face) -> Part {
    let item = |complaint: &DataIssue| Item {
        text: sentence(&labelled(complaint, face)).into(),
        is_warning: complaint.severity == Severity::Warning,
    };
    let said = match complaints.len() {
        0 => Part::paragraph("No issues found."),
        _ => Part::List(complaints.iter().map(item).collect()),
    };
    Part::section("Data quality", [said])
}

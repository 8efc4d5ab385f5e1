//! Findings in words and numbers: the table of verdicts for a terminal.

use hysid::diagnosis::{Evidence, Finding, Property};
use hysid_core::significant::Significant;
use hysid_document::plain::{aligned, indented};

const HEADINGS: [&str; 5] =
    ["property           verdict", "index %", "threshold %", "noise %", "comparisons"];

/// How far statements stand in under their verdict.
const INDENT: usize = 4;

/// Percentages below this are as good as nought.
const SMALLEST_PERCENT: f64 = 0.001;

/// Table of the verdicts, each with its evidence; then experiments for the properties without a verdict.
pub fn text<'f>(findings: impl IntoIterator<Item = &'f Finding>) -> String {
    let findings: Vec<&Finding> = findings.into_iter().collect();
    let mut rows = vec![HEADINGS.map(String::from).to_vec()];
    rows.extend(findings.iter().map(|finding| cells(finding)));
    let mut lines = aligned(&rows).into_iter();
    let mut text = lines.next().unwrap_or_default() + "\n";
    for (line, finding) in lines.zip(&findings) {
        text += &(line + "\n" + &indented(&finding.statement, INDENT));
    }
    let experiments = experiments(&findings);
    if !experiments.is_empty() {
        text += "\nexperiments for what could not be tested\n";
        for (experiment, properties) in experiments {
            text += &indented(&format!("{}: {experiment}", properties.join(", ")), INDENT);
        }
    }
    text
}

/// Experiments for properties without a verdict, each once, with its properties.
fn experiments<'f>(findings: &[&'f Finding]) -> Vec<(&'f str, Vec<&'static str>)> {
    let mut experiments: Vec<(&str, Vec<&str>)> = Vec::new();
    for finding in findings {
        let Some(experiment) = finding.experiment.as_deref() else { continue };
        match experiments.iter_mut().find(|(known, _)| *known == experiment) {
            Some((_, properties)) => properties.push(finding.property.name()),
            None => experiments.push((experiment, vec![finding.property.name()])),
        }
    }
    experiments
}

fn cells(finding: &Finding) -> Vec<String> {
    let share = |share: Option<f64>| share.map_or_else(|| "-".into(), |share| shown(100.0 * share));
    vec![
        format!("{:<17}  {:<12}", finding.property.name(), finding.verdict),
        share(finding.index),
        share(finding.threshold),
        share(finding.noise),
        finding.comparisons.to_string(),
    ]
}

/// A percentage with three digits.
pub fn shown(percent: f64) -> String {
    match percent.abs() {
        0.0 => "0".into(),
        small if small < SMALLEST_PERCENT => format!("<{SMALLEST_PERCENT}"),
        _ => format!("{:.3}", Significant(percent)),
    }
}

pub fn meaning(property: Property) -> &'static str {
    match property {
        Property::StaticHysteresis => "there is a loop however slowly the input changes",
        Property::Orientation => "loops are traversed clockwise, as with friction",
        Property::RateDependence => "the output depends on the speed of the input",
        Property::WipingOut => "a closed excursion of the input leaves no trace (return-point memory)",
        Property::Congruency => "minor loops between the same inputs have the same shape",
        Property::Masing => "all branches are the same curve, scaled",
        Property::OddSymmetry => "a branch rotated by 180° is the opposite branch",
        Property::Saturation => "the output hardly changes at the ends of the input range",
        Property::Deterioration => "loops shrink when they are repeated",
        Property::LoopClosure => "the output is the same after each period of the input",
        Property::StrengthLoss => "the force at the largest deformation falls",
        Property::Pinching => "loops are narrow near zero load, where the stiffness is low",
        Property::Invertible => "after any past, the next input follows from the next output",
    }
}

/// Where the strongest evidence stands, rows counted from 1; empty if there is none.
pub fn place(evidence: &[Evidence], several_records: bool) -> String {
    let Some(strongest) = evidence.first() else { return String::new() };
    let rows = strongest.pieces.iter().map(|piece| {
        let of = if several_records { format!(" of {}", piece.record) } else { String::new() };
        format!("{} to {}{of}", piece.rows.0 + 1, piece.rows.1 + 1)
    });
    let rows: Vec<String> = rows.collect();
    if rows.is_empty() { String::new() } else { format!("rows {}", rows.join(", ")) }
}

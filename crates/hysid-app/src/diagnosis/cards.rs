//! Findings on a page: the list of verdicts, and a card with its picture for each property.

use hysid::diagnosis::{Finding, Picture, Property, Verdict};
use hysid_document::chart::thin::thin;
use hysid_document::{Badge, Card, Chart, Colour, Curve, Part, Piece, Text, capitalised, count, unit};

use super::findings::{meaning, shown};
use crate::quantities::Quantities;

/// Points of a curve in a picture.
const POINTS: usize = 800;

/// Meaning of the numbers of a card.
pub const EXPLANATION: &str = "The index is a relative difference or size. The threshold separates yes from \
                               no: it is the larger of two values, the difference that matters in practice \
                               and the difference that noise alone can cause in this number of comparisons.";

/// All verdicts, each with what was found, as links to the cards.
pub fn verdicts<'f>(findings: impl IntoIterator<Item = &'f Finding>) -> Part {
    let verdict = |finding: &Finding| {
        let anchor = finding.property.name().to_string();
        let link = Piece::Link { anchor, text: finding.property.name().into() };
        Text::from(badge(finding.verdict)).and(link).and(Piece::Aside(finding.statement.clone()))
    };
    Part::Verdicts(findings.into_iter().map(verdict).collect())
}

/// A card for each property; `place` names the place of the evidence, empty if there is none to name.
pub fn cards(findings: &[Finding], quantities: &Quantities, place: impl Fn(&Finding) -> String) -> Vec<Card> {
    findings
        .iter()
        .map(|finding| card(finding, drawing(finding, quantities).into_iter().collect(), &place(finding)))
        .collect()
}

pub fn card(finding: &Finding, charts: Vec<Chart>, place: &str) -> Card {
    let mut parts = vec![Part::note(format!("Yes means: {}.", meaning(finding.property)))];
    parts.extend(charts.into_iter().map(Part::chart));
    parts.push(Part::paragraph(sentence(&finding.statement)));
    parts.extend(finding.experiment.as_ref().map(|experiment| {
        Part::Paragraph(
            Text::from(Piece::Strong("Experiment:".into())).and(Piece::Plain(sentence(experiment))),
        )
    }));
    let place = if place.is_empty() { String::new() } else { format!(" Found in {place}.") };
    parts.push(Part::note(numbers(finding) + &place));
    let heading = Text::from(badge(finding.verdict)).and(Piece::Plain(finding.property.name().into()));
    Card { anchor: finding.property.name().into(), heading, parts }
}

fn badge(verdict: Verdict) -> Piece {
    let badge = match verdict {
        Verdict::Yes => Badge::Yes,
        Verdict::No => Badge::No,
        Verdict::NotTestable => Badge::Unknown,
    };
    Piece::Badge(badge, verdict.to_string())
}

fn numbers(finding: &Finding) -> String {
    let share = |name: &str, value: Option<f64>| {
        Some(format!("{name} {} %", shown(100.0 * value?).replace('-', "−")))
    };
    let numbers = [
        share("Index", finding.index),
        share("threshold", finding.threshold),
        share("from noise alone", finding.noise),
        (finding.comparisons > 0).then(|| count(finding.comparisons, "comparison")),
    ];
    let numbers: Vec<String> = numbers.into_iter().flatten().collect();
    if numbers.is_empty() { String::new() } else { capitalised(&numbers.join(", ")) + "." }
}

pub fn sentence(text: &str) -> String {
    let text = capitalised(text);
    if text.ends_with(['.', '!', '?']) { text } else { text + "." }
}

/// The chart of a picture with any points.
fn drawing(finding: &Finding, quantities: &Quantities) -> Option<Chart> {
    let picture = finding.picture.as_ref()?;
    let is_drawn = picture.curves.iter().any(|curve| !curve.points.is_empty());
    is_drawn.then(|| chart(finding, picture, quantities))
}

fn chart(finding: &Finding, picture: &Picture, quantities: &Quantities) -> Chart {
    let label = |label: &str, column: &str| match label {
        "" => unit::label(column),
        label => label.to_string(),
    };
    let x = label(&picture.x_label, &quantities.input);
    let (y, factor) = match finding.property {
        Property::Deterioration => {
            (unit::label(&quantities.as_energy(&picture.y_label)), quantities.energy_factor())
        }
        _ => (label(&picture.y_label, &quantities.output), 1.0),
    };
    let (mut curves, mut legend) = (Vec::new(), Vec::new());
    for curve in &picture.curves {
        let points: Vec<_> = curve.points.iter().map(|&(x, y)| (x, factor * y)).collect();
        let points = thin(&points, POINTS);
        // What has no name is there for comparison only, and lies behind the rest.
        if curve.label.is_empty() {
            curves.insert(0, Curve::new(points, Colour::Faint, 1.0));
            continue;
        }
        // Of curves that lie upon each other, the lower ones show on both sides.
        let width = if legend.is_empty() { 3.0 } else { 1.4 };
        let colour = Colour::Series(legend.len());
        curves.push(Curve::new(points, colour, width));
        legend.push((colour, curve.label.clone()));
    }
    let description = format!("{}: {y} over {x}", finding.property);
    Chart::new(description, &x, &y, curves).sized(460.0, 320.0).with_legend(legend)
}

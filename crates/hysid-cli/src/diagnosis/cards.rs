//! Findings on a page: the list of verdicts, and a card with its picture for each property.

use hysid::diagnosis::{Finding, Picture, Property, Verdict};

use super::findings::{meaning, shown};
use super::quantities::Quantities;
use crate::page::{count, figure};
use crate::plot::thin::thin;
use crate::plot::{Axis, Chart, Colour, Curve, escape};
use crate::report::unit_label;

/// Points of a curve in a picture.
const POINTS: usize = 800;

/// What the numbers of a card mean.
pub const EXPLANATION: &str = "The index measures how far what should coincide does not, as a share; beyond the threshold the verdict turns. \
     A threshold is the difference that matters in practice, or what noise may give by chance in that many comparisons, whichever is larger.";

/// All verdicts, each with what was found, as links to the cards.
pub fn verdicts(findings: &[Finding]) -> String {
    let item = |finding: &Finding| {
        format!(
            "<li>{} <a href=\"#{}\">{}</a> <span>{}</span></li>\n",
            badge(finding.verdict),
            finding.property.name(),
            heading(finding),
            escape(&finding.statement)
        )
    };
    format!("<ul class=\"verdicts\">\n{}</ul>\n", findings.iter().map(item).collect::<String>())
}

/// A card for each property; `place` tells where it is seen, if that means anything to the reader.
pub fn cards(findings: &[Finding], quantities: &Quantities, place: impl Fn(&Finding) -> String) -> String {
    let cards: String = findings.iter().map(|finding| card(finding, quantities, &place(finding))).collect();
    format!("<div class=\"cards\">\n{cards}</div>\n")
}

fn card(finding: &Finding, quantities: &Quantities, place: &str) -> String {
    let picture = finding.picture.as_ref().filter(|picture| is_drawn(picture));
    let drawing =
        picture.map_or_else(String::new, |picture| figure(&chart(finding, picture, quantities), false));
    let experiment = finding.experiment.as_ref().map_or_else(String::new, |experiment| {
        format!("<p><strong>To tell:</strong> {}</p>\n", escape(&sentence(experiment)))
    });
    let place = if place.is_empty() { String::new() } else { format!(" Seen in {place}.") };
    format!(
        "<article class=\"card\" id=\"{}\">\n<h3>{} {}</h3>\n<p class=\"note\">Yes means: {}.</p>\n{drawing}<p>{}</p>\n{experiment}\
         <p class=\"note\">{}{}</p>\n</article>\n",
        finding.property.name(),
        badge(finding.verdict),
        heading(finding),
        escape(meaning(finding.property)),
        escape(&sentence(&finding.statement)),
        escape(&numbers(finding)),
        escape(&place)
    )
}

fn badge(verdict: Verdict) -> String {
    let class = match verdict {
        Verdict::Yes => "yes",
        Verdict::No => "no",
        Verdict::NotTestable => "untold",
    };
    format!("<span class=\"badge {class}\">{verdict}</span>")
}

/// The property's name as a heading: "Loop closure".
fn heading(finding: &Finding) -> String {
    capitalised(&finding.property.name().replace('-', " "))
}

fn numbers(finding: &Finding) -> String {
    let share = |name: &str, value: Option<f64>| {
        Some(format!("{name} {} %", shown(100.0 * value?).replace('-', "−")))
    };
    let numbers = [
        share("Index", finding.index),
        share("threshold", finding.threshold),
        share("noise alone gives", finding.noise),
        (finding.comparisons > 0).then(|| count(finding.comparisons, "comparison")),
    ];
    let numbers: Vec<String> = numbers.into_iter().flatten().collect();
    if numbers.is_empty() { String::new() } else { capitalised(&numbers.join(", ")) + "." }
}

/// A statement as a sentence.
pub fn sentence(text: &str) -> String {
    let text = capitalised(text);
    if text.ends_with(['.', '!', '?']) { text } else { text + "." }
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn is_drawn(picture: &Picture) -> bool {
    picture.curves.iter().any(|curve| !curve.points.is_empty())
}

fn chart(finding: &Finding, picture: &Picture, quantities: &Quantities) -> String {
    let label = |label: &str, column: &str| match (label, finding.property) {
        ("", _) => unit_label(column),
        (energy, Property::Deterioration) if energy == picture.y_label => {
            unit_label(&quantities.as_energy(energy))
        }
        (label, _) => label.to_string(),
    };
    let (x, y) = (label(&picture.x_label, &quantities.input), label(&picture.y_label, &quantities.output));
    let (mut curves, mut legend) = (Vec::new(), Vec::new());
    for curve in &picture.curves {
        let points = thin(&curve.points, POINTS);
        // What has no name is there for comparison only, and lies behind the rest.
        if curve.label.is_empty() {
            curves.insert(0, Curve { points, colour: Colour::Faint, width: 1.0 });
            continue;
        }
        // Of curves that lie upon each other, the lower ones show on both sides.
        let width = if legend.is_empty() { 3.0 } else { 1.4 };
        let colour = Colour::Series(legend.len());
        curves.push(Curve { points, colour, width });
        legend.push((colour, curve.label.clone()));
    }
    let points = || curves.iter().flat_map(|curve| &curve.points);
    Chart {
        description: format!("{}: {y} over {x}", heading(finding)),
        title: String::new(),
        size: (460.0, 320.0),
        x: Axis::linear(x, points().map(|point| point.0)),
        y: Axis::linear(y, points().map(|point| point.1)),
        curves,
        labels: Vec::new(),
        legend,
    }
    .svg()
}

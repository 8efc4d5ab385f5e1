//! The drawing of a chart.

use super::Chart;
use super::appearance::Appearance;
use super::curves::{attributes, curves};
use super::frame::{FINE, frame};
use super::palette::{fixed, style};
use crate::escape::escape;

/// Room between the rows of a sheet, in sizes of the text: a legend belongs to the chart below it.
const SHEET_GAP: f64 = 1.54;

/// The page behind a drawing that stands alone.
const STANDALONE: &str = "svg.plot { background: #ffffff; }\n\
     @media (prefers-color-scheme: dark) { svg.plot { background: #14171c; } }\n";

/// As [`Chart::svg`].
pub fn drawn(chart: &Chart) -> String {
    element(chart, &Appearance::of_page(), "", "", true)
}

/// As [`Chart::file`].
pub fn file(chart: &Chart, generator: &str) -> String {
    let (width, height) = chart.size;
    let attributes =
        format!(" data-generator=\"{}\" width=\"{width}\" height=\"{height}\"", escape(generator));
    let style = format!("<style>{}{STANDALONE}</style>", style());
    element(chart, &Appearance::of_page(), &attributes, &style, false)
}

/// As [`super::sheet`].
pub fn sheet(
    charts: &[Chart],
    columns: usize,
    appearance: &Appearance,
    description: &str,
    generator: &str,
) -> String {
    let largest = |of: fn(&Chart) -> f64| charts.iter().map(of).fold(0.0, f64::max);
    let (width, height) = (largest(|chart| chart.size.0), largest(|chart| chart.size.1));
    let columns = columns.clamp(1, charts.len().max(1));
    let gap = appearance.em(SHEET_GAP).round();
    let rows: Vec<f64> = match columns {
        // One below the other: each row is as high as its chart.
        1 => charts.iter().map(|chart| chart.size.1 + gap).collect(),
        _ => vec![height + gap; charts.len().div_ceil(columns)],
    };
    let (whole, high) = (width * columns as f64, rows.iter().sum::<f64>() - gap);
    // A drawing has no size of its own: the element around it determines place and size.
    let placed = |(index, chart): (usize, &Chart)| {
        let (x, y) = (
            width * (index % columns) as f64,
            rows[..index / columns].iter().fold(0.0, |sum, row| sum + row),
        );
        let (width, height) = chart.size;
        let drawn = element(chart, appearance, "", "", false);
        format!("<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\">\n{drawn}</svg>\n")
    };
    let (unit, style) = match appearance.fixed_colours {
        true => ("px", format!("<rect width=\"{whole}\" height=\"{high}\" fill=\"#ffffff\"/>")),
        false => ("", format!("<style>{}{STANDALONE}</style>", style())),
    };
    format!(
        "<svg class=\"plot\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {whole} {high}\" \
         xmlns=\"http://www.w3.org/2000/svg\" data-generator=\"{}\" width=\"{whole}{unit}\" height=\"{high}{unit}\">\
         {style}\n{}</svg>\n",
        escape(description),
        escape(generator),
        charts.iter().enumerate().map(placed).collect::<String>()
    )
}

/// The `svg` element; `outer` are further attributes of it and `beginning` its first content, both markup.
fn element(chart: &Chart, appearance: &Appearance, outer: &str, beginning: &str, tracks: bool) -> String {
    let frame = frame(chart, appearance);
    let curves = curves(chart, &frame, appearance, tracks);
    let attributes = if tracks { attributes(chart, &frame) } else { String::new() };
    let drawing = format!("<g class=\"frame\">{}</g>\n{curves}", frame.markup);
    let drawing = if appearance.fixed_colours { fixed(&drawing) } else { drawing };
    format!(
        "<svg class=\"plot\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {} {}\" \
         xmlns=\"http://www.w3.org/2000/svg\"{outer}{attributes}>{beginning}{drawing}</svg>\n",
        escape(&chart.description),
        FINE * chart.size.0,
        FINE * chart.size.1
    )
}

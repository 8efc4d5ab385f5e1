//! The drawing of a chart.

use super::Chart;
use super::curves::{attributes, curves};
use super::frame::{FINE, frame};
use super::palette::style;
use crate::escape::escape;

/// Room between the rows of a sheet, in pixels: a legend belongs to the chart below it.
const SHEET_GAP: f64 = 20.0;

/// The page behind a drawing that stands alone.
const STANDALONE: &str = "svg.plot { background: #ffffff; }\n\
     @media (prefers-color-scheme: dark) { svg.plot { background: #14171c; } }\n";

/// As [`Chart::svg`].
pub fn drawn(chart: &Chart) -> String {
    element(chart, "", "", true)
}

/// As [`Chart::file`].
pub fn file(chart: &Chart, generator: &str) -> String {
    let (width, height) = chart.size;
    let attributes =
        format!(" data-generator=\"{}\" width=\"{width}\" height=\"{height}\"", escape(generator));
    let style = format!("<style>{}{STANDALONE}</style>", style());
    element(chart, &attributes, &style, false)
}

/// As [`super::sheet`].
pub fn sheet(charts: &[Chart], columns: usize, description: &str, generator: &str) -> String {
    let largest = |of: fn(&Chart) -> f64| charts.iter().map(of).fold(0.0, f64::max);
    let (width, height) = (largest(|chart| chart.size.0), largest(|chart| chart.size.1));
    let columns = columns.clamp(1, charts.len().max(1));
    let rows = charts.len().div_ceil(columns);
    let (whole, high) = (width * columns as f64, (height + SHEET_GAP) * rows as f64 - SHEET_GAP);
    // A drawing has no size of its own: the element around it determines place and size.
    let placed = |(index, chart): (usize, &Chart)| {
        let (x, y) = (width * (index % columns) as f64, (height + SHEET_GAP) * (index / columns) as f64);
        let (width, height) = chart.size;
        let drawn = element(chart, "", "", false);
        format!("<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\">\n{drawn}</svg>\n")
    };
    format!(
        "<svg class=\"plot\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {whole} {high}\" \
         xmlns=\"http://www.w3.org/2000/svg\" data-generator=\"{}\" width=\"{whole}\" height=\"{high}\">\
         <style>{}{STANDALONE}</style>\n{}</svg>\n",
        escape(description),
        escape(generator),
        style(),
        charts.iter().enumerate().map(placed).collect::<String>()
    )
}

/// The `svg` element; `outer` are further attributes of it and `beginning` its first content, both markup.
fn element(chart: &Chart, outer: &str, beginning: &str, tracks: bool) -> String {
    let frame = frame(chart);
    let curves = curves(chart, &frame, tracks);
    let attributes = if tracks { attributes(chart, &frame) } else { String::new() };
    let drawing = format!("<g class=\"frame\">{}</g>\n{curves}", frame.markup);
    format!(
        "<svg class=\"plot\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {} {}\" \
         xmlns=\"http://www.w3.org/2000/svg\"{outer}{attributes}>{beginning}{drawing}</svg>\n",
        escape(&chart.description),
        FINE * chart.size.0,
        FINE * chart.size.1
    )
}

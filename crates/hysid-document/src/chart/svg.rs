//! The drawing of a chart.

use super::Chart;
use super::appearance::{Appearance, PIXELS_PER_MILLIMETRE};
use super::curves::{attributes, curves};
use super::frame::{self, FINE, room_of_axis};
use super::palette::{fixed, style};
use crate::escape::escape;

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

/// Several charts as one file, `columns` of them beside each other, in columns as wide as the widest chart and rows as high
/// as the highest chart of the row. `description` is for readers who cannot see them; `generator` names the program that
/// made the file.
pub fn sheet(
    charts: &[Chart],
    columns: usize,
    appearance: &Appearance,
    description: &str,
    generator: &str,
) -> String {
    let columns = columns.clamp(1, charts.len().max(1));
    let widest = charts.iter().map(|chart| chart.size.0).fold(0.0, f64::max);
    let gap = appearance.row_gap();
    // On paper a drawing has no margin around it: the label of the lowest axis needs a little.
    let begin = if appearance.fixed_colours { -appearance.em(0.3) } else { 0.0 };
    let (mut drawn, mut top) = (String::new(), begin);
    let (tick_letters, label_lines) = shared_room(charts, columns, appearance);
    let appearance = &Appearance { tick_letters, label_lines, ..appearance.clone() };
    let rows = charts.chunks(columns).len();
    for (number, row) in charts.chunks(columns).enumerate() {
        for (place, chart) in row.iter().enumerate() {
            // A drawing has no size of its own: the element around it determines place and size.
            let (x, (width, height)) = (widest * place as f64, chart.size);
            let one = element(chart, appearance, "", "", false);
            drawn +=
                &format!("<svg x=\"{x}\" y=\"{top}\" width=\"{width}\" height=\"{height}\">\n{one}</svg>\n");
        }
        top += row.iter().map(|chart| chart.size.1).fold(0.0, f64::max);
        // A chart that shares the axis of the next one belongs to it.
        let is_shared = row.iter().all(|chart| chart.shares_axis);
        top += if number + 1 == rows || is_shared { 0.0 } else { gap };
    }
    let (width, height) = (widest * columns as f64, top - begin);
    let background = match appearance.fixed_colours {
        true => format!("<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>"),
        false => format!("<style>{}{STANDALONE}</style>", style()),
    };
    let size = |pixels: f64| match appearance.fixed_colours {
        // A program that places the drawing on paper reads millimetres alike everywhere, and pixels not.
        true => format!("{:.3}mm", pixels / PIXELS_PER_MILLIMETRE),
        false => pixels.to_string(),
    };
    format!(
        "<svg class=\"plot\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {width} {height}\" \
         xmlns=\"http://www.w3.org/2000/svg\" data-generator=\"{}\" width=\"{}\" height=\"{}\">\
         {background}\n{drawn}</svg>\n",
        escape(description),
        escape(generator),
        size(width),
        size(height),
    )
}

/// Letters and lines of the texts of the vertical axes of charts in one column, which makes these begin at the same place.
fn shared_room(charts: &[Chart], columns: usize, appearance: &Appearance) -> (usize, usize) {
    let own = (appearance.tick_letters, appearance.label_lines);
    if columns > 1 {
        return own;
    }
    let rooms = charts.iter().map(|chart| room_of_axis(chart, appearance));
    rooms.fold(own, |(letters, lines), (more, further)| (letters.max(more), lines.max(further)))
}

/// The `svg` element; `outer` are further attributes of it and `beginning` its first content, both markup.
fn element(chart: &Chart, appearance: &Appearance, outer: &str, beginning: &str, tracks: bool) -> String {
    let mut chart = std::borrow::Cow::Borrowed(chart);
    // The texts of the ticks change with the range of an axis, and their width changes the place of the curves: twice is enough.
    for _ in 0..2 {
        if chart.has_equal_axes {
            chart = std::borrow::Cow::Owned(equalised(&chart, frame::frame(&chart, appearance).place));
        }
    }
    let (chart, frame) = (&*chart, frame::frame(&chart, appearance));
    let curves = curves(chart, &frame, appearance, tracks);
    let attributes = if tracks { attributes(chart, &frame) } else { String::new() };
    let bar = chart.bar.as_ref().map(|bar| bar.drawn(frame.place.map(f64::from), appearance));
    let drawing = format!("<g class=\"frame\">{}{}</g>\n{curves}", frame.markup, bar.unwrap_or_default());
    let drawing = if appearance.fixed_colours { fixed(&drawing) } else { drawing };
    format!(
        "<svg class=\"plot\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {} {}\" \
         xmlns=\"http://www.w3.org/2000/svg\"{outer}{attributes}>{beginning}{drawing}</svg>\n",
        escape(&chart.description),
        FINE * chart.size.0,
        FINE * chart.size.1
    )
}

/// The chart with one axis longer, so that both have the same scale in a place of this width and height.
fn equalised(chart: &Chart, [.., width, height]: [i32; 4]) -> Chart {
    let (width, height) = (f64::from(width), f64::from(height));
    let scale = (chart.x.span() / width).max(chart.y.span() / height);
    Chart { x: chart.x.with_span(scale * width), y: chart.y.with_span(scale * height), ..chart.clone() }
}

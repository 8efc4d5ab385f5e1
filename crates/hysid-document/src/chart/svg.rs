//! The drawing of a chart. The one place that knows the drawing library.
//!
//! Colours in the drawing are markers: the style sheet [`STYLE`] turns each into one that suits a light or a dark page.

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::thin::is_drawable;
use super::{Axis, Chart, Colour, Curve, LEVELS, Label, SERIES};
use crate::escape::{escape, is_not_xml};

/// Units of the drawing in a pixel, since the library draws on a grid of whole units.
const FINE: f64 = 4.0;

/// Size of all text, in pixels.
const TEXT: f64 = 13.0;

/// Mean width of a letter, in pixels.
const LETTER: f64 = 7.2;

/// Free space on the left, in pixels.
const EDGE: f64 = 5.0;

/// Distance of the legend's lines, in pixels.
const LEGEND_LINE: f64 = 18.0;

/// Room that the legend leaves free on both sides together, in pixels.
const LEGEND_EDGE: f64 = 40.0;

/// Room between the rows of a sheet, in pixels: a legend belongs to the chart below it.
const SHEET_GAP: f64 = 20.0;

/// Recolours the markers; to be put into the page once.
pub const STYLE: &str = include_str!("style.css");

/// The page behind a drawing that stands alone.
const STANDALONE: &str = "svg.plot { background: #ffffff; }\n\
     @media (prefers-color-scheme: dark) { svg.plot { background: #14171c; } }\n";

/// Markers of the series, told apart by hue and by lightness.
const SERIES_MARKERS: [RGBColor; SERIES] = [
    RGBColor(0x01, 0x60, 0xD0),
    RGBColor(0x02, 0x40, 0x20),
    RGBColor(0x03, 0x80, 0x40),
    RGBColor(0x04, 0x60, 0xA0),
    RGBColor(0x05, 0x90, 0x10),
    RGBColor(0x06, 0x90, 0x90),
];

impl Colour {
    pub(super) fn marker(self) -> RGBColor {
        match self {
            Colour::Measured => RGBColor(0x80, 0x80, 0x80),
            Colour::Simulated => RGBColor(0x00, 0x60, 0xD0),
            Colour::Input => RGBColor(0x20, 0x80, 0x40),
            Colour::Error => RGBColor(0xC0, 0x40, 0x20),
            Colour::Faint => RGBColor(0xB0, 0xB0, 0xB0),
            Colour::Band => RGBColor(0xA0, 0xC8, 0xF0),
            Colour::Series(index) => SERIES_MARKERS[index % SERIES],
            Colour::Level(level) => {
                let level = level.clamp(*LEVELS.start(), *LEVELS.end());
                RGBColor(0x10, if level < 0 { 0x21 } else { 0x20 }, 0x30 + level.unsigned_abs())
            }
        }
    }
}

pub(super) const INK: RGBColor = RGBColor(0x11, 0x11, 0x11);
pub(super) const GRID: RGBColor = RGBColor(0xDD, 0xDD, 0xDD);

type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

type Context<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

/// As [`Chart::svg`].
pub fn drawn(chart: &Chart) -> String {
    element(chart, "", "")
}

/// As [`Chart::file`].
pub fn file(chart: &Chart, generator: &str) -> String {
    let (width, height) = chart.size;
    let attributes =
        format!(" data-generator=\"{}\" width=\"{width}\" height=\"{height}\"", escape(generator));
    element(chart, &attributes, &format!("<style>{STYLE}{STANDALONE}</style>"))
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
        format!("<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\">\n{}</svg>\n", drawn(chart))
    };
    format!(
        "<svg class=\"plot\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {whole} {high}\" \
         xmlns=\"http://www.w3.org/2000/svg\" data-generator=\"{}\" width=\"{whole}\" height=\"{high}\">\
         <style>{STYLE}{STANDALONE}</style>\n{}</svg>\n",
        escape(description),
        escape(generator),
        charts.iter().enumerate().map(placed).collect::<String>()
    )
}

/// The `svg` element; `attributes` and what it begins with are markup.
fn element(chart: &Chart, attributes: &str, beginning: &str) -> String {
    let mut text = String::new();
    let size = (fine(chart.size.0) as u32, fine(chart.size.1) as u32);
    {
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        draw(chart, &root).expect("a drawing into a string succeeds");
        root.present().expect("a drawing into a string succeeds");
    }
    // The library escapes what XML needs, and lets through characters that XML has no place for.
    let text = text.replace(is_not_xml, "\u{FFFD}");
    let content = text.find('>').map_or("", |end| &text[end + 1..]);
    format!(
        "<svg class=\"plot\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {} {}\" \
         xmlns=\"http://www.w3.org/2000/svg\"{attributes}>{beginning}{content}",
        escape(&chart.description),
        size.0,
        size.1
    )
}

fn draw(chart: &Chart, root: &Area) -> Drawn {
    let legend = legend_lines(chart);
    let header = match legend.len() {
        0 if chart.title.is_empty() => 8.0,
        lines => 26.0 + LEGEND_LINE * lines.saturating_sub(1) as f64,
    };
    let (top, body) = root.split_vertically(fine(header));
    let x = chart.x.clone().with_ticks((chart.size.0 / 90.0) as usize);
    let y = chart.y.clone().with_ticks(((chart.size.1 - header - 42.0) / 36.0) as usize);
    // Charts below each other share their horizontal axis, so their labels get the same room.
    let letters = if chart.size.0 > 800.0 { y.longest_text().max(6) } else { y.longest_text() };
    let left = 34.0 + LETTER * letters as f64;
    draw_header(chart, &top, EDGE + left, &legend)?;
    let mut context = ChartBuilder::on(&body)
        .margin_left(fine(EDGE))
        .margin_right(fine(14.0))
        .x_label_area_size(fine(42.0))
        .y_label_area_size(fine(left))
        .build_cartesian_2d(x.clone(), y.clone())?;
    context
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(3))
        .axis_style(INK.stroke_width(4))
        .set_all_tick_mark_size(fine(4.0))
        .label_style(text_style())
        .axis_desc_style(text_style())
        .x_label_formatter(&|tick| x.text(*tick))
        .y_label_formatter(&|tick| y.text(*tick))
        .x_desc(shortened(&x.label, chart.size.0 - left))
        .y_desc(shortened(&y.label, chart.size.1 - header - 42.0))
        .draw()?;
    chart.curves.iter().try_for_each(|curve| draw_curve(curve, &mut context))?;
    chart.labels.iter().try_for_each(|label| draw_label(label, &mut context))
}

/// The runs between gaps: lines, areas, or dots.
fn draw_curve(curve: &Curve, context: &mut Context) -> Drawn {
    let marker = curve.colour.marker();
    let style = marker.stroke_width(fine(curve.width) as u32);
    for run in curve.points.split(|&point| !is_drawable(point)) {
        match run {
            [] => {}
            [point] => {
                let dot = Circle::new(*point, fine(curve.width), style.filled());
                context.draw_series(std::iter::once(dot))?;
            }
            _ if curve.colour.is_area() => {
                let area = Polygon::new(run.to_vec(), marker.filled());
                context.draw_series(std::iter::once(area))?;
            }
            _ => {
                let line = PathElement::new(run.to_vec(), style);
                context.draw_series(std::iter::once(line))?;
            }
        }
    }
    Ok(())
}

fn draw_label(Label { point, rise, text }: &Label, context: &mut Context) -> Drawn {
    let style = text_style().pos(Pos::new(HPos::Left, VPos::Center));
    let offset = (fine(8.0), -fine(*rise));
    let label = EmptyElement::at(*point) + Text::new(text.clone(), offset, style);
    context.draw_series(std::iter::once(label)).map(|_| ())
}

/// Entries of the legend whose colour is drawn, in as many lines as they need.
pub(super) fn legend_lines(chart: &Chart) -> Vec<Vec<&(Colour, String)>> {
    let is_used =
        |colour| chart.curves.iter().any(|curve| curve.colour == colour && !curve.points.is_empty());
    let mut lines: Vec<Vec<&(Colour, String)>> = Vec::new();
    for entry in chart.legend.iter().filter(|(colour, _)| is_used(*colour)) {
        match lines.last_mut() {
            Some(line) if width_of(line) + entry_width(&entry.1) <= chart.size.0 - LEGEND_EDGE => {
                line.push(entry);
            }
            _ => lines.push(vec![entry]),
        }
    }
    lines
}

/// Title and legend; the legend goes on below where it is too long for a line.
fn draw_header(chart: &Chart, area: &Area, left: f64, legend: &[Vec<&(Colour, String)>]) -> Drawn {
    let middle = |line: usize| fine(13.0 + LEGEND_LINE * line as f64);
    let style = || text_style().pos(Pos::new(HPos::Left, VPos::Center));
    let widest = legend.iter().map(|line| width_of(line)).fold(0.0, f64::max);
    let title = shortened(&chart.title, chart.size.0 - left - widest - 14.0);
    area.draw(&Text::new(title, (fine(left), middle(0)), style()))?;
    // Without a title the legend comes first, where a narrow screen that scrolls shows it.
    let room = chart.size.0 - 14.0 - widest;
    let begin = if chart.title.is_empty() { left.min(room.max(EDGE)) } else { room };
    for (number, line) in legend.iter().enumerate() {
        let mut x = begin;
        for (colour, name) in line {
            let dash = vec![(fine(x), middle(number)), (fine(x + 18.0), middle(number))];
            let width = if colour.is_area() { 10.0 } else { 2.0 };
            area.draw(&PathElement::new(dash, colour.marker().stroke_width(fine(width) as u32)))?;
            area.draw(&Text::new(name.clone(), (fine(x + 23.0), middle(number)), style()))?;
            x += entry_width(name);
        }
    }
    Ok(())
}

fn fine(pixels: f64) -> i32 {
    (FINE * pixels).round() as i32
}

/// Width of a line of the legend.
fn width_of(line: &[&(Colour, String)]) -> f64 {
    line.iter().map(|(_, name)| entry_width(name)).sum()
}

fn entry_width(name: &str) -> f64 {
    23.0 + LETTER * name.chars().count() as f64 + 14.0
}

fn text_style() -> TextStyle<'static> {
    // The library divides by 1.24.
    TextStyle::from(("system-ui", 1.24 * FINE * TEXT).into_font()).color(&INK)
}

/// The text, cut off where it would not fit into the width.
fn shortened(text: &str, width: f64) -> String {
    let room = (width / LETTER).max(4.0) as usize;
    if text.chars().count() <= room {
        return text.to_string();
    }
    text.chars().take(room - 1).chain(std::iter::once('…')).collect()
}

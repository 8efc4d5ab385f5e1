//! Charts as SVG. The one place that knows the drawing library.
//!
//! Colours in the drawing are markers: the style sheet [`STYLE`] turns each into one that suits a
//! light or a dark page.

pub mod axis;
mod drawing;
pub mod thin;

use hysid_files::GENERATOR;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub use axis::Axis;
pub use drawing::is_drawing;
use thin::{Point, is_drawable};

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

/// Recolours the markers; to be put into the page once.
pub const STYLE: &str = include_str!("plot/style.css");

/// The page behind a drawing that stands alone.
const STANDALONE: &str = "svg.plot { background: #ffffff; }\n\
     @media (prefers-color-scheme: dark) { svg.plot { background: #14171c; } }\n";

/// What a curve stands for, which gives its colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// What was measured.
    Measured,
    /// What the model says.
    Simulated,
    /// The input.
    Input,
    /// Their difference.
    Error,
    /// What is there for comparison only.
    Faint,
    /// Where the measurement is to be expected: an area, which the points of its curve go round.
    Band,
    /// One of several things of the same kind, counted from 0; colours repeat after [`SERIES`].
    Series(usize),
}

/// Markers of the series, told apart by hue and by lightness.
const SERIES_MARKERS: [RGBColor; SERIES] = [
    RGBColor(0x01, 0x60, 0xD0),
    RGBColor(0x02, 0x40, 0x20),
    RGBColor(0x03, 0x80, 0x40),
    RGBColor(0x04, 0x60, 0xA0),
    RGBColor(0x05, 0x90, 0x10),
    RGBColor(0x06, 0x90, 0x90),
];

/// Colours of [`Colour::Series`].
pub const SERIES: usize = 6;

impl Colour {
    fn marker(self) -> RGBColor {
        match self {
            Colour::Measured => RGBColor(0x80, 0x80, 0x80),
            Colour::Simulated => RGBColor(0x00, 0x60, 0xD0),
            Colour::Input => RGBColor(0x20, 0x80, 0x40),
            Colour::Error => RGBColor(0xC0, 0x40, 0x20),
            Colour::Faint => RGBColor(0xB0, 0xB0, 0xB0),
            Colour::Band => RGBColor(0xA0, 0xC8, 0xF0),
            Colour::Series(index) => SERIES_MARKERS[index % SERIES],
        }
    }
}

const INK: RGBColor = RGBColor(0x11, 0x11, 0x11);
const GRID: RGBColor = RGBColor(0xDD, 0xDD, 0xDD);

/// A line, or dots where a point has no neighbours; of [`Colour::Band`], an area.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Its points; one that is not finite leaves a gap.
    pub points: Vec<Point>,
    /// Its colour.
    pub colour: Colour,
    /// Width of the line in pixels.
    pub width: f64,
}

/// Text to the right of a point.
#[derive(Debug, Clone)]
pub struct Label {
    /// The point.
    pub point: Point,
    /// How far above the point it stands, in pixels.
    pub rise: f64,
    /// What is written.
    pub text: String,
}

/// A chart.
#[derive(Debug, Clone)]
pub struct Chart {
    /// What it shows, in words, for those who do not see it.
    pub description: String,
    /// Written above it; may be empty.
    pub title: String,
    /// Width and height in pixels.
    pub size: (f64, f64),
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is drawn, from the back to the front.
    pub curves: Vec<Curve>,
    /// Text beside points.
    pub labels: Vec<Label>,
    /// What the colours mean.
    pub legend: Vec<(Colour, String)>,
}

impl Chart {
    /// The drawing, an `svg` element of class `plot` without a size of its own.
    pub fn svg(&self) -> String {
        let mut text = String::new();
        let size = (fine(self.size.0) as u32, fine(self.size.1) as u32);
        {
            let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
            self.draw(&root).expect("a drawing into a string succeeds");
            root.present().expect("a drawing into a string succeeds");
        }
        // The library escapes what XML needs, and lets through characters that XML has no place for.
        let text = text.replace(is_not_xml, "\u{FFFD}");
        let content = text.find('>').map_or("", |end| &text[end + 1..]);
        format!(
            "<svg class=\"plot\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {} {}\" \
             xmlns=\"http://www.w3.org/2000/svg\">{content}",
            escape(&self.description),
            size.0,
            size.1
        )
    }

    fn draw(&self, root: &DrawingArea<SVGBackend, Shift>) -> Drawn {
        let legend = self.legend_lines();
        let header = match legend.len() {
            0 if self.title.is_empty() => 8.0,
            lines => 26.0 + LEGEND_LINE * lines.saturating_sub(1) as f64,
        };
        let (top, body) = root.split_vertically(fine(header));
        let x = self.x.clone().with_ticks((self.size.0 / 90.0) as usize);
        let y = self.y.clone().with_ticks(((self.size.1 - header - 42.0) / 36.0) as usize);
        // Charts below each other share their horizontal axis, so their labels get the same room.
        let letters = if self.size.0 > 800.0 { y.longest_text().max(6) } else { y.longest_text() };
        let left = 34.0 + LETTER * letters as f64;
        self.draw_header(&top, EDGE + left, &legend)?;
        let mut chart = ChartBuilder::on(&body)
            .margin_left(fine(EDGE))
            .margin_right(fine(14.0))
            .x_label_area_size(fine(42.0))
            .y_label_area_size(fine(left))
            .build_cartesian_2d(x.clone(), y.clone())?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(GRID.stroke_width(3))
            .axis_style(INK.stroke_width(4))
            .set_all_tick_mark_size(fine(4.0))
            .label_style(text_style())
            .axis_desc_style(text_style())
            .x_label_formatter(&|tick| x.text(*tick))
            .y_label_formatter(&|tick| y.text(*tick))
            .x_desc(shortened(&x.label, self.size.0 - left))
            .y_desc(shortened(&y.label, self.size.1 - header - 42.0))
            .draw()?;
        for curve in &self.curves {
            let style = curve.colour.marker().stroke_width(fine(curve.width) as u32);
            for run in curve.points.split(|&point| !is_drawable(point)) {
                match run {
                    [] => {}
                    [point] => {
                        let dot = Circle::new(*point, fine(curve.width), style.filled());
                        chart.draw_series(std::iter::once(dot))?;
                    }
                    _ if curve.colour == Colour::Band => {
                        let area = Polygon::new(run.to_vec(), curve.colour.marker().filled());
                        chart.draw_series(std::iter::once(area))?;
                    }
                    _ => {
                        let line = PathElement::new(run.to_vec(), style);
                        chart.draw_series(std::iter::once(line))?;
                    }
                }
            }
        }
        for Label { point, rise, text } in &self.labels {
            let style = text_style().pos(Pos::new(HPos::Left, VPos::Center));
            let offset = (fine(8.0), -fine(*rise));
            let label = EmptyElement::at(*point) + Text::new(text.clone(), offset, style);
            chart.draw_series(std::iter::once(label))?;
        }
        Ok(())
    }

    /// Entries of the legend whose colour is drawn, in as many lines as they need.
    fn legend_lines(&self) -> Vec<Vec<&(Colour, String)>> {
        let is_used =
            |colour| self.curves.iter().any(|curve| curve.colour == colour && !curve.points.is_empty());
        let mut lines: Vec<Vec<&(Colour, String)>> = Vec::new();
        for entry in self.legend.iter().filter(|(colour, _)| is_used(*colour)) {
            match lines.last_mut() {
                Some(line) if width_of(line) + entry_width(&entry.1) <= self.size.0 - LEGEND_EDGE => {
                    line.push(entry);
                }
                _ => lines.push(vec![entry]),
            }
        }
        lines
    }

    /// Title and legend; the legend goes on below where it is too long for a line.
    fn draw_header(
        &self,
        area: &DrawingArea<SVGBackend, Shift>,
        left: f64,
        legend: &[Vec<&(Colour, String)>],
    ) -> Drawn {
        let middle = |line: usize| fine(13.0 + LEGEND_LINE * line as f64);
        let style = || text_style().pos(Pos::new(HPos::Left, VPos::Center));
        let widest = legend.iter().map(|line| width_of(line)).fold(0.0, f64::max);
        let title = shortened(&self.title, self.size.0 - left - widest - 14.0);
        area.draw(&Text::new(title, (fine(left), middle(0)), style()))?;
        // Without a title the legend comes first, where a narrow screen that scrolls shows it.
        let room = self.size.0 - 14.0 - widest;
        let begin = if self.title.is_empty() { left.min(room.max(EDGE)) } else { room };
        for (number, line) in legend.iter().enumerate() {
            let mut x = begin;
            for (colour, name) in line {
                let dash = vec![(fine(x), middle(number)), (fine(x + 18.0), middle(number))];
                let width = if *colour == Colour::Band { 10.0 } else { 2.0 };
                area.draw(&PathElement::new(dash, colour.marker().stroke_width(fine(width) as u32)))?;
                area.draw(&Text::new(name.clone(), (fine(x + 23.0), middle(number)), style()))?;
                x += entry_width(name);
            }
        }
        Ok(())
    }
}

type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

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

/// Text as it may stand in HTML and SVG, in attributes too.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            control if is_not_xml(control) => escaped.push('\u{FFFD}'),
            other => escaped.push(other),
        }
    }
    escaped
}

/// Control characters have no place in XML.
fn is_not_xml(letter: char) -> bool {
    letter.is_control() && !"\n\t".contains(letter)
}

/// A chart's drawing as a file of its own, with its size and its style in it.
pub fn standalone(svg: &str) -> String {
    let Some((head, content)) = svg.split_once('>') else { return svg.to_string() };
    let view = head.split_once("viewBox=\"0 0 ").and_then(|(_, rest)| rest.split_once('"'));
    let mut sides =
        view.map_or("", |(sides, _)| sides).split(' ').filter_map(|side| side.parse::<f64>().ok());
    let size = match (sides.next(), sides.next()) {
        (Some(width), Some(height)) => format!(" width=\"{}\" height=\"{}\"", width / FINE, height / FINE),
        _ => String::new(),
    };
    format!("{head} data-generator=\"{GENERATOR}\"{size}><style>{STYLE}{STANDALONE}</style>{content}")
}

#[cfg(test)]
pub(crate) mod tests;

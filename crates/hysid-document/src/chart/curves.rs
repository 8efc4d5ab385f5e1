//! Curves and labels of a drawing, as markup.
//!
//! Coordinates have two decimals of a unit, so that the points can be read back from a drawing to about 3e-6 of its width.

use std::fmt::Write;

use super::appearance::Appearance;
use super::frame::{FINE, Frame};
use super::palette::{INK, written};
use super::thin::{Point, is_drawable};
use super::{Axis, Chart, Colour, Curve, Label, Track};
use crate::escape::escape;
use hysid_core::significant::Significant;

/// Distance of a label's text from its point, in pixels.
const BESIDE: f64 = 8.0;

/// From the middle of a line of text to its base, in sizes of the text.
const BASE: f64 = 0.36;

/// Curves and labels, cut off at the edges of the frame. With `tracks`, the curves carry what a page needs to follow them.
pub(super) fn curves(chart: &Chart, frame: &Frame, appearance: &Appearance, tracks: bool) -> String {
    let [left, top, width, height] = frame.place;
    let canvas = Canvas { chart, place: frame.place.map(f64::from), appearance, tracks };
    let curves: String = chart.curves.iter().map(|curve| canvas.curve(curve)).collect();
    let labels: String = chart.labels.iter().map(|label| canvas.label(label)).collect();
    // An inner `svg` cuts its content off, and needs no name for that.
    format!(
        "<svg class=\"curves\" x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"{left} {top} {width} {height}\">\n{curves}</svg>\n{labels}"
    )
}

struct Canvas<'a> {
    chart: &'a Chart,
    place: [f64; 4],
    appearance: &'a Appearance,
    tracks: bool,
}

impl Canvas<'_> {
    fn point(&self, point: Point) -> Point {
        let [left, top, width, height] = self.place;
        (left + width * self.chart.x.place(point.0), top + height * (1.0 - self.chart.y.place(point.1)))
    }

    /// The runs between gaps: lines, areas, or dots.
    fn curve(&self, curve: &Curve) -> String {
        let runs = curve.points.split(|&point| !is_drawable(point)).filter(|run| !run.is_empty());
        let marker = written(curve.colour.marker());
        let width = FINE * curve.width * self.appearance.lines;
        let mut drawn = String::new();
        for run in runs {
            drawn += &match run {
                [point] => {
                    let (x, y) = self.point(*point);
                    format!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{width:.1}\" fill=\"{marker}\"/>\n")
                }
                _ if curve.colour.is_area() => {
                    format!("<polygon fill=\"{marker}\" points=\"{}\"/>\n", self.points(run))
                }
                _ => format!(
                    "<polyline fill=\"none\" stroke=\"{marker}\" stroke-width=\"{width:.1}\" \
                     stroke-linejoin=\"round\" points=\"{}\"/>\n",
                    self.points(run)
                ),
            };
        }
        format!("<g{}>\n{drawn}</g>\n", self.attributes(curve))
    }

    fn points(&self, run: &[Point]) -> String {
        let mut text = String::with_capacity(18 * run.len());
        for &point in run {
            let (x, y) = self.point(point);
            write!(text, "{x:.2},{y:.2} ").expect("a string takes all");
        }
        text.truncate(text.trim_end().len());
        text
    }

    /// Attributes of a curve for the script of the page.
    fn attributes(&self, curve: &Curve) -> String {
        let class = match curve.colour {
            Colour::Level(_) => " class=\"curve level\"",
            _ => " class=\"curve\"",
        };
        if !self.tracks {
            return class.into();
        }
        let entry = self.chart.legend.iter().find(|(colour, _)| *colour == curve.colour);
        let name = entry.map_or(String::new(), |(_, name)| format!(" data-name=\"{}\"", escape(name)));
        let track = curve.track.as_ref().map_or(String::new(), |track| attributes_of(track, &curve.points));
        format!("{class}{name}{track}")
    }

    fn label(&self, label: &Label) -> String {
        let ((x, y), size) = (self.point(label.point), self.appearance.text);
        format!(
            "<text x=\"{:.1}\" y=\"{:.1}\" font-family=\"{}\" font-size=\"{}\" fill=\"{}\">{}</text>\n",
            x + FINE * BESIDE,
            y + FINE * (BASE * size - label.rise),
            escape(&self.appearance.family),
            FINE * size,
            written(INK),
            escape(&label.text)
        )
    }
}

/// Where the drawn points are in their record.
fn attributes_of(track: &Track, points: &[Point]) -> String {
    let mut text = format!(" data-record=\"{}\"", escape(&track.record));
    if let Some(times) = &track.times {
        let drawn = times.iter().zip(points).filter(|(_, point)| is_drawable(**point));
        let times: Vec<String> = drawn.map(|(time, _)| moment(*time)).collect();
        write!(text, " data-times=\"{}\"", times.join(" ")).expect("a string takes all");
    }
    if !track.cycles.is_empty() {
        let cycles: Vec<String> = track.cycles.iter().map(|time| moment(*time)).collect();
        write!(text, " data-cycles=\"{}\"", cycles.join(" ")).expect("a string takes all");
    }
    text
}

/// A time, with digits enough for a hundredth of a second of a date.
fn moment(time: f64) -> String {
    format!("{:.12}", Significant(time))
}

/// Attributes of a drawing for the script of the page, which enlarges a part of it.
pub(super) fn attributes(chart: &Chart, frame: &Frame) -> String {
    let axis = |name: &str, axis: &Axis| {
        let (low, high, is_logarithmic) = axis.limits();
        let scale = if is_logarithmic { " log" } else { "" };
        format!(" data-{name}=\"{low} {high}{scale}\" data-{name}-label=\"{}\"", escape(&axis.label))
    };
    let [left, top, width, height] = frame.place;
    format!(" data-place=\"{left} {top} {width} {height}\"{}{}", axis("x", &chart.x), axis("y", &chart.y))
}

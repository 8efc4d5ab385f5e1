//! Heat maps: values over two axes, as areas in the colours of classes of values.
//!
//! The classes have round limits, which the colour bar shows, so that the values can be read without the colours. The class
//! around 0 is next to the page's colour; positive values get darker on a light page and lighter on a dark one, and
//! negative values have another hue.

use std::ops::RangeInclusive;

use hysid_core::elementary::{log10, powf};

use super::appearance::Appearance;
use super::frame::FINE;
use super::palette::{INK, written};
use super::thin::Point;
use super::{Chart, Colour, Curve, LEVELS};
use crate::escape::escape;
use crate::number::number;

/// Width and height of a heat map, in pixels.
const WIDTH: f64 = 680.0;
const HEIGHT: f64 = 560.0;

/// A cell of a heat map: a range along each of two coordinates, and the value in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeatCell {
    /// From where to where along the first coordinate.
    pub u: (f64, f64),
    /// From where to where along the second coordinate.
    pub v: (f64, f64),
    pub value: f64,
}

/// Distance of a colour bar from the curves, its width, and the length of its ticks with a gap, in sizes of the text.
const BAR: [f64; 3] = [1.2, 1.2, 0.6];

/// Height of the label beside a colour bar, in sizes of the text.
const LABEL: f64 = 1.6;

/// A strip with the colours of all classes from the lowest to the highest that is used, and ticks at their limits.
#[derive(Debug, Clone, PartialEq)]
pub struct ColourBar {
    /// Quantity with its unit.
    pub label: String,
    levels: RangeInclusive<i8>,
    step: f64,
}

impl ColourBar {
    /// Limits of the classes as text, the lowest first, each with its distance from the lower end in classes.
    fn ticks(&self) -> impl Iterator<Item = (f64, String)> {
        // What lies below the lowest class of all has its colour too.
        let first = i8::from(self.levels.start() == LEVELS.start());
        let count = self.levels.clone().count() as i8;
        let low = f64::from(*self.levels.start()) - 0.5;
        let value = move |k: i8| (low + f64::from(k)) * self.step;
        // The smallest limit is half a step.
        let is_long = self.step < 2e-3 || value(count).abs().max(value(0).abs()) >= 1e5;
        let text = move |value: f64| match is_long {
            true => format!("{:e}", format!("{value:.4e}").parse::<f64>().unwrap_or(value)).replace('-', "−"),
            false => number(value, 4),
        };
        (first..=count).map(move |k| (f64::from(k), text(value(k))))
    }

    /// Its room to the right of the curves, in pixels.
    pub(super) fn room(&self, appearance: &Appearance) -> f64 {
        let letters = self.ticks().map(|(_, text)| text.chars().count()).max().unwrap_or(0);
        appearance.em(BAR.iter().sum::<f64>() + LABEL) + appearance.letter() * letters as f64
    }

    /// The strip as markup, beside a place of curves in units of the drawing.
    pub(super) fn drawn(&self, [left, top, width, height]: [f64; 4], appearance: &Appearance) -> String {
        let em = |times: f64| FINE * appearance.em(times);
        let (x, ink) = (left + width + em(BAR[0]), written(INK));
        let (right, size) = (x + em(BAR[1]), FINE * appearance.text);
        let y = |place: f64| top + height * (1.0 - place / self.levels.clone().count() as f64);
        let font =
            format!("font-family=\"{}\" font-size=\"{size}\" fill=\"{ink}\"", escape(&appearance.family));
        let mut text = String::from("<g class=\"bar\">\n");
        for (k, level) in self.levels.clone().enumerate() {
            let (low, high) = (y(k as f64), y(k as f64 + 1.0));
            let fill = written(Colour::Level(level).marker());
            let corners =
                format!("{x:.1},{low:.1} {right:.1},{low:.1} {right:.1},{high:.1} {x:.1},{high:.1}");
            text += &format!("<polygon fill=\"{fill}\" points=\"{corners}\"/>\n");
        }
        for (place, words) in self.ticks() {
            let (y, end) = (y(place), right + em(0.3));
            text += &format!(
                "<polyline fill=\"none\" stroke=\"{ink}\" stroke-width=\"4\" points=\"{right:.1},{y:.1} {end:.1},{y:.1}\"/>\n\
                 <text x=\"{:.1}\" y=\"{:.1}\" {font}>{words}</text>\n",
                right + em(BAR[2]),
                y + em(0.36),
            );
        }
        let (x, middle) = (left + width + FINE * self.room(appearance), top + 0.5 * height);
        text + &format!(
            "<text x=\"{x:.1}\" y=\"{middle:.1}\" text-anchor=\"middle\" transform=\"rotate(-90 {x:.1} {middle:.1})\" {font}>\
             {}</text>\n</g>\n",
            escape(&self.label)
        )
    }
}

/// A heat map of cells, which are in rows along the first coordinate. `place` gives the point of the chart at two coordinates.
/// Cells without a finite value are left out; both axes have the same scale. `labels` are those of both axes and of the values, `description` is for readers
/// who cannot see the chart.
///
/// ```
/// use hysid_document::chart::{HeatCell, heat_map};
/// let cell = |k: f64| HeatCell { u: (k, k + 1.0), v: (0.0, 1.0), value: k };
/// let chart = heat_map("values from 0 to 4", ["x", "y", "value"], &[0.0, 1.0, 2.0, 3.0, 4.0].map(cell), |u, v| (u, v));
/// assert_eq!(chart.legend.last().unwrap().1, "3.75 to 4.25");
/// ```
pub fn heat_map(
    description: impl Into<String>,
    [x, y, value]: [&str; 3],
    cells: &[HeatCell],
    place: impl Fn(f64, f64) -> Point,
) -> Chart {
    let step = class_width(cells);
    let class = |value: f64| {
        ((value / step).round() as i64).clamp((*LEVELS.start()).into(), (*LEVELS.end()).into()) as i8
    };
    let mut areas: Vec<(i8, HeatCell)> = Vec::new();
    for cell in cells.iter().filter(|cell| cell.value.is_finite()) {
        let level = class(cell.value);
        let width = cell.u.1 - cell.u.0;
        let goes_on = |(last, area): &&mut (i8, HeatCell)| {
            *last == level && area.v == cell.v && (area.u.1 - cell.u.0).abs() <= 1e-6 * width.abs()
        };
        match areas.last_mut().filter(|area| goes_on(area)) {
            Some((_, area)) => area.u.1 = cell.u.1,
            None => areas.push((level, *cell)),
        }
    }
    let outline = |(level, area): &(i8, HeatCell)| {
        let (u, v) = (area.u, area.v);
        let corners = [(u.0, v.0), (u.1, v.0), (u.1, v.1), (u.0, v.1)];
        Curve::new(corners.map(|(u, v)| place(u, v)).to_vec(), Colour::Level(*level), 1.0)
    };
    let curves = areas.iter().map(outline).collect();
    let used = LEVELS.filter(|level| areas.iter().any(|(used, _)| used == level));
    let legend: Vec<(Colour, String)> =
        used.map(|level| (Colour::Level(level), limits(level, step))).collect();
    let level = |(level, _): &(i8, HeatCell)| *level;
    let ends = areas.iter().map(level).min().zip(areas.iter().map(level).max());
    let bar = ends.map(|(low, high)| ColourBar { label: value.into(), levels: low..=high, step });
    let chart = Chart::new(description, x, y, curves).sized(WIDTH, HEIGHT).with_legend(legend);
    Chart { has_equal_axes: true, bar, ..chart }
}

/// The width of a class: round, and such that the values have at most as many classes as there are levels.
fn class_width(cells: &[HeatCell]) -> f64 {
    let largest =
        cells.iter().map(|cell| cell.value.abs()).filter(|value| value.is_finite()).fold(0.0, f64::max);
    if largest == 0.0 {
        return 1.0;
    }
    let most = f64::from(*LEVELS.end());
    let needed = largest / (most + 0.5);
    let power = powf(10.0, log10(needed).floor());
    let widths = [1.0, 2.0, 2.5, 5.0, 10.0].map(|factor| factor * power);
    widths.into_iter().find(|width| *width >= needed).unwrap_or(needed)
}

/// The values of a class in words; the last class of each sign has all beyond it.
fn limits(level: i8, step: f64) -> String {
    let middle = f64::from(level) * step;
    let (low, high) = (number(middle - 0.5 * step, 4), number(middle + 0.5 * step, 4));
    if level == *LEVELS.start() { format!("below {high}") } else { format!("{low} to {high}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::balance::assert_balanced;

    fn row(values: &[f64], v: f64) -> Vec<HeatCell> {
        let cell = |(k, &value): (usize, &f64)| {
            let u = k as f64;
            HeatCell { u: (u, u + 1.0), v: (v, v + 1.0), value }
        };
        values.iter().enumerate().map(cell).collect()
    }

    #[test]
    fn neighbours_of_one_class_are_one_area_and_blanks_are_none() {
        let cells = [row(&[0.0, 0.01, 8.0, 8.1], 0.0), row(&[f64::NAN, -8.0, 4.0], 1.0)].concat();
        let chart = heat_map("d", ["x", "y", "value, T"], &cells, |u, v| (u, v));
        let colours: Vec<Colour> = chart.curves.iter().map(|curve| curve.colour).collect();
        assert_eq!(colours, [0, 8, -3, 4].map(Colour::Level));
        assert_eq!(chart.curves[0].points, [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)]);
        let names: Vec<&str> = chart.legend.iter().map(|(_, name)| name.as_str()).collect();
        assert_eq!(names, ["below −2.5", "−0.5 to 0.5", "3.5 to 4.5", "7.5 to 8.5"]);
        let svg = chart.svg();
        assert_balanced(&svg);
        // The first area is two units wide and one high.
        let curves = svg.split("class=\"curves\"").nth(1).unwrap();
        let polygon =
            curves.split("<polygon fill=\"#102030\" points=\"").nth(1).unwrap().split('"').next().unwrap();
        let points: Vec<f64> = polygon.split([' ', ',']).map(|number| number.parse().unwrap()).collect();
        let (width, height) = ((points[2] - points[0]).abs(), (points[5] - points[3]).abs());
        assert!((width / height / 2.0 - 1.0).abs() < 0.01, "{polygon}");
        // A strip with all classes from the lowest to the highest; the legend is for narrow pages.
        let bar = svg.split("<g class=\"bar\">").nth(1).unwrap().split("</g>").next().unwrap();
        assert_eq!((bar.matches("<polygon").count(), bar.matches("<polyline").count()), (12, 12));
        for text in [">−2.5<", ">8.5<", ">value, T<"] {
            assert!(bar.contains(text) && svg.matches(text).count() == 1, "{text}: {bar}");
        }
        for marker in ["#102038", "#102133", "#102034", "#102030"] {
            assert!(svg.contains(&format!("fill=\"{marker}\"")), "{marker}");
            assert!(super::super::style().contains(&format!("[fill=\"{marker}\"]")), "{marker}");
        }
    }

    #[test]
    fn classes_have_round_limits_and_hold_every_value() {
        for largest in [1e-9, 0.37, 1.0, 8.5, 8.6, 99.0, 3.7e12] {
            let cells = row(&[largest, -0.2 * largest], 0.0);
            let step = class_width(&cells);
            assert!((3.0..=8.5).contains(&(largest / step)), "{largest} {step}");
        }
        assert_eq!(class_width(&row(&[0.0], 0.0)), 1.0);
    }

    #[test]
    fn coordinates_can_be_turned() {
        let chart = heat_map("d", ["x", "y", "value, T"], &row(&[1.0], 0.0), |u, v| (u - v, u + v));
        assert_eq!(chart.curves[0].points, [(0.0, 0.0), (1.0, 1.0), (0.0, 2.0), (-1.0, 1.0)]);
    }
}

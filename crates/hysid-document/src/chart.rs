//! Charts as data, drawn as SVG.

mod appearance;
mod axis;
mod curves;
mod frame;
mod heat_map;
mod palette;
mod svg;
pub mod thin;

pub use appearance::{Appearance, PIXELS_PER_MILLIMETRE, PIXELS_PER_POINT};
pub use axis::Axis;
pub use heat_map::{ColourBar, HeatCell, heat_map};
pub use palette::style;
pub use svg::sheet;
use thin::Point;

/// Content of a curve, which determines its colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    Measured,
    /// The output of a model.
    Simulated,
    Input,
    Error,
    /// A curve for comparison only.
    Faint,
    /// A prediction band: an area, whose outline is the points of its curve.
    Band,
    /// One of several curves of the same kind, counted from 0; colours repeat after [`SERIES`].
    Series(usize),
    /// A place in the order of several curves, from 0 for the first to [`RAMP`]` - 1` for the last.
    Ramp(usize),
    /// A class of values of a heat map: an area, from [`LEVELS`]`.start()` for the lowest to [`LEVELS`]`.end()` for the highest
    /// values; 0 is the class around 0.
    Level(i8),
}

/// Classes of values of a heat map.
pub const LEVELS: std::ops::RangeInclusive<i8> = -3..=8;

impl Colour {
    /// True if a curve of this colour is the outline of an area.
    pub fn is_area(self) -> bool {
        matches!(self, Self::Band | Self::Level(_))
    }
}

/// Number of different colours of [`Colour::Series`].
pub const SERIES: usize = 6;

/// Number of different colours of [`Colour::Ramp`].
pub const RAMP: usize = 12;

/// Records up to which a legend names each.
const MOST_NAMED: usize = 8;

/// Letters of a record's name in a legend.
const LONGEST_NAME: usize = 40;

/// The colour of each of several records, and the legend: the names of all of a few, those of the first and the last of many.
/// Colours and legend are in the order of the number that the names differ in, or else of the records. A single record has
/// no colour of its own.
pub fn records_in_colour(names: &[&str]) -> (Vec<Colour>, Vec<(Colour, String)>) {
    let last = names.len().saturating_sub(1);
    if last == 0 {
        return (Vec::new(), Vec::new());
    }
    let mut order: Vec<usize> = (0..=last).collect();
    if let Some(varied) = varied(names) {
        order.sort_by(|&a, &b| varied[a].total_cmp(&varied[b]));
    }
    let mut colours = vec![Colour::Faint; names.len()];
    for (rank, &place) in order.iter().enumerate() {
        colours[place] = Colour::Ramp((rank * (RAMP - 1) + last / 2) / last);
    }
    let entry = |place: usize, more: &str| {
        (colours[place], names[place].chars().take(LONGEST_NAME).collect::<String>() + more)
    };
    let legend = match names.len() > MOST_NAMED {
        true => vec![entry(order[0], &format!(" (first of {})", names.len())), entry(order[last], " (last)")],
        false => order.iter().map(|&place| entry(place, "")).collect(),
    };
    (colours, legend)
}

/// The number in each name, where the names differ in nothing else, such as a frequency.
fn varied(names: &[&str]) -> Option<Vec<f64>> {
    let is_digit = |letter: char| letter.is_ascii_digit() || letter == '.';
    let begin = names[0].find(is_digit)?;
    (begin..names[0].len()).filter(|&place| names[0].is_char_boundary(place)).find_map(|place| {
        let prefix = names[0][..place].trim_end_matches(is_digit);
        let numbers = names.iter().map(|name| {
            let rest = name.strip_prefix(prefix)?;
            let end = rest.find(|letter| !is_digit(letter)).unwrap_or(rest.len());
            Some((rest[..end].parse::<f64>().ok()?, &rest[end..]))
        });
        let numbers: Vec<(f64, &str)> = numbers.collect::<Option<_>>()?;
        let is_all = numbers.iter().all(|(_, suffix)| *suffix == numbers[0].1);
        is_all.then(|| numbers.iter().map(|(number, _)| *number).collect())
    })
}

/// A line, or dots where a point has no neighbours; or the outline of an area, see [`Colour::is_area`].
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its points, in the units of the axes; one that is not finite leaves a gap.
    pub points: Vec<Point>,
    pub colour: Colour,
    /// Width of the line, or radius of the dots, in pixels.
    pub width: f64,
    /// Where its points are in a record, for pages that show the same moment in several charts.
    pub track: Option<Track>,
}

/// Where the points of a curve are in a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Name of the record, the same in all charts that show it.
    pub record: String,
    /// Times of the points, or their rows; `None` where the horizontal axis is that of time.
    pub times: Option<Vec<f64>>,
    /// Times at which a cycle begins, and that at which the last one ends; empty where there are none.
    pub cycles: Vec<f64>,
}

/// Text to the right of a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    pub point: Point,
    /// Height of the text above the point, in pixels.
    pub rise: f64,
    pub text: String,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Description for readers who cannot see it.
    pub description: String,
    pub title: String,
    /// Width and height in pixels.
    pub size: (f64, f64),
    pub x: Axis,
    pub y: Axis,
    /// Curves, from the back to the front.
    pub curves: Vec<Curve>,
    /// Text beside points.
    pub labels: Vec<Label>,
    pub legend: Vec<(Colour, String)>,
    /// True for a chart whose horizontal axis is that of the chart below it, which has its ticks and label.
    pub shares_axis: bool,
    /// True if a unit is as long along one axis as along the other.
    pub has_equal_axes: bool,
    /// Colours of the classes beside the curves, in the place of a legend.
    pub bar: Option<ColourBar>,
}

/// Width and height of a chart over the width of the page, in pixels.
const WIDE: (f64, f64) = (860.0, 300.0);

/// The same of one of several small charts.
const SMALL: (f64, f64) = (400.0, 290.0);

/// Largest side of a chart, width of a line and distance of a text that make sense, in pixels.
const LARGEST: f64 = 4000.0;

impl Curve {
    pub fn new(points: Vec<Point>, colour: Colour, width: f64) -> Self {
        Self { points, colour, width, track: None }
    }

    /// The curve with the place of its points in a record.
    pub fn tracked(self, track: Track) -> Self {
        Self { track: Some(track), ..self }
    }

    pub fn dots(points: impl IntoIterator<Item = Point>, colour: Colour, radius: f64) -> Self {
        // A gap after each point makes dots of them.
        let points = points.into_iter().flat_map(|point| [point, (f64::NAN, f64::NAN)]).collect();
        Self::new(points, colour, radius)
    }
}

impl Chart {
    /// A wide chart with linear axes over all points of the curves, without title and legend. `x` and `y` are
    /// the labels of the axes.
    pub fn new(description: impl Into<String>, x: &str, y: &str, curves: Vec<Curve>) -> Self {
        let points = || curves.iter().flat_map(|curve| &curve.points);
        let x = Axis::linear(x, points().map(|point| point.0));
        let y = Axis::linear(y, points().map(|point| point.1));
        Self::on_axes(description, x, y, curves)
    }

    /// As [`Chart::new`], with these axes.
    pub fn on_axes(description: impl Into<String>, x: Axis, y: Axis, curves: Vec<Curve>) -> Self {
        let (description, title) = (description.into(), String::new());
        let (labels, legend) = (Vec::new(), Vec::new());
        let (shares_axis, has_equal_axes) = (false, false);
        let bar = None;
        Self {
            description,
            title,
            size: WIDE,
            x,
            y,
            curves,
            labels,
            legend,
            shares_axis,
            has_equal_axes,
            bar,
        }
    }

    /// The chart in this size, in pixels.
    pub fn sized(self, width: f64, height: f64) -> Self {
        Self { size: (width, height), ..self }
    }

    /// The chart in this height, in pixels.
    pub fn with_height(self, height: f64) -> Self {
        Self { size: (self.size.0, height), ..self }
    }

    /// The chart in the size of one of several small charts, with a title.
    pub fn small(self, title: impl Into<String>) -> Self {
        Self { size: SMALL, title: title.into(), ..self }
    }

    /// True for a chart that takes the width of the page.
    pub fn is_wide(&self) -> bool {
        self.size.0 >= WIDE.0
    }

    pub fn with_legend<N: Into<String>>(self, entries: impl IntoIterator<Item = (Colour, N)>) -> Self {
        let legend = entries.into_iter().map(|(colour, name)| (colour, name.into())).collect();
        Self { legend, ..self }
    }

    /// True if width and height have room for axes and curves.
    pub fn has_room(&self) -> bool {
        let is_side = |side: f64| (100.0..LARGEST).contains(&side);
        is_side(self.size.0) && is_side(self.size.1)
    }

    /// The drawing: an `svg` element of class `plot`, without a size of its own.
    pub fn svg(&self) -> String {
        svg::drawn(self)
    }

    /// The drawing as a file, with size and style. `generator` names the program that made it.
    pub fn file(&self, generator: &str) -> String {
        svg::file(self, generator)
    }
}

#[cfg(test)]
mod tests;

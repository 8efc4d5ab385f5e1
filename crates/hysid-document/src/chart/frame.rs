//! Axes, title and legend of a drawing. The one place that uses the drawing library.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::appearance::Appearance;
use super::palette::{GRID, INK};
use super::{Axis, Chart, Colour};
use crate::escape::is_not_xml;

/// Units of the drawing in a pixel, since the library draws on a grid of whole units.
pub(super) const FINE: f64 = 4.0;

/// Free space on the left, in pixels.
const EDGE: f64 = 5.0;

/// Free space on the right, in pixels.
const RIGHT: f64 = 14.0;

/// Distance of the legend's lines, in sizes of the text.
const LEGEND_LINE: f64 = 1.385;

/// Height of title and first line of the legend, in sizes of the text.
const HEADER: f64 = 2.0;

/// Height of the horizontal axis with its label, in sizes of the text.
const AXIS: f64 = 3.23;

/// The same of an axis without texts.
const BARE_AXIS: f64 = 0.8;

/// Distance of the lines of a label, in sizes of the text.
const LABEL_LINE: f64 = 1.3;

/// Room that the legend leaves free on both sides together, in pixels.
const LEGEND_EDGE: f64 = 40.0;

/// Surroundings of the curves: axes, labels and legend.
pub(super) struct Frame {
    pub markup: String,
    /// Left, top, width and height of the place of the curves, in units of the drawing.
    pub place: [i32; 4],
}

type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Draws what is around the curves of a chart.
pub(super) fn frame(chart: &Chart, appearance: &Appearance) -> Frame {
    let mut text = String::new();
    let place;
    {
        let size = (fine(chart.size.0) as u32, fine(chart.size.1) as u32);
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        place = ChartLayout { chart, appearance }.draw(&root).expect("a drawing into a string succeeds");
        root.present().expect("a drawing into a string succeeds");
    }
    // The library escapes what XML needs, and lets through characters that XML has no place for.
    let text = text.replace(is_not_xml, "\u{FFFD}");
    let content = text.find('>').map_or("", |end| &text[end + 1..]);
    let markup = content.trim().strip_suffix("</svg>").unwrap_or(content).to_string();
    Frame { markup, place }
}

/// Height of title and legend, in pixels.
fn header_height(chart: &Chart, appearance: &Appearance, legend_lines: usize) -> f64 {
    match legend_lines {
        0 if chart.title.is_empty() => 8.0,
        lines => appearance.em(HEADER + LEGEND_LINE * lines.saturating_sub(1) as f64),
    }
}

/// Height of the horizontal axis, in pixels: of the axis alone if the chart below has its ticks and label.
fn footer_height(chart: &Chart, appearance: &Appearance) -> f64 {
    appearance.em(if chart.shares_axis { BARE_AXIS } else { AXIS })
}

/// The vertical axis with its ticks, below a header of this height.
fn vertical_axis(chart: &Chart, appearance: &Appearance, header: f64) -> Axis {
    let height = chart.size.1 - header - footer_height(chart, appearance);
    chart.y.clone().with_ticks((height / appearance.em(2.77)) as usize)
}

/// Letters of the longest text of the vertical axis, and lines of its label.
pub(super) fn room_of_axis(chart: &Chart, appearance: &Appearance) -> (usize, usize) {
    let header = header_height(chart, appearance, legend_lines(chart, appearance).len());
    let height = chart.size.1 - header - footer_height(chart, appearance);
    let lines = wrapped_label(&chart.y.label, letters_in(height, appearance)).len();
    (vertical_axis(chart, appearance, header).longest_text(), lines)
}

/// Letters that fit into this width, in pixels.
fn letters_in(width: f64, appearance: &Appearance) -> usize {
    (width / appearance.letter()).max(4.0) as usize
}

/// Most lines of a label.
const MOST_LINES: usize = 3;

/// A label in lines of at most `most` letters, broken between words; what does not fit is cut off.
fn wrapped_label(label: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in label.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + word.chars().count() < most => *line += &format!(" {word}"),
            _ => lines.push(word.to_string()),
        }
    }
    let too_many = lines.split_off(lines.len().min(MOST_LINES));
    if let Some(last) = lines.last_mut() {
        too_many.iter().for_each(|more| *last += &format!(" {more}"));
    }
    lines.iter().map(|line| shortened(line, most)).collect()
}

/// The text, cut off where it is longer than `most` letters; its unit stays.
fn shortened(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_string();
    }
    let unit = text.rfind(" (").map_or("", |place| &text[place..]);
    let unit = if unit.chars().count() + 2 < most { unit } else { "" };
    let kept = text.chars().take(most - 1 - unit.chars().count());
    format!("{}…{unit}", kept.collect::<String>())
}

struct ChartLayout<'a> {
    chart: &'a Chart,
    appearance: &'a Appearance,
}

impl ChartLayout<'_> {
    fn draw(&self, root: &Area) -> Result<[i32; 4], DrawingAreaErrorKind<std::io::Error>> {
        let (chart, appearance) = (self.chart, self.appearance);
        let legend = legend_lines(chart, appearance);
        let header = header_height(chart, appearance, legend.len());
        let (top, body) = root.split_vertically(fine(header));
        let bottom = footer_height(chart, appearance);
        let x = chart.x.clone().with_ticks((chart.size.0 / appearance.em(7.0)) as usize);
        let y = vertical_axis(chart, appearance, header);
        // Charts below each other share their horizontal axis, so their labels get the same room.
        let least = if chart.size.0 > 800.0 { 6 } else { 0 };
        let letters = y.longest_text().max(least).max(appearance.tick_letters);
        let label = wrapped_label(&y.label, letters_in(chart.size.1 - header - bottom, appearance));
        let lines = label.len().max(appearance.label_lines);
        let of_label = appearance.em(LABEL_LINE) * (lines - 1) as f64;
        let left = appearance.em(2.6) + of_label + appearance.letter() * letters as f64;
        self.draw_header(&top, EDGE + left, &legend)?;
        let mut context = ChartBuilder::on(&body)
            .margin_left(fine(EDGE))
            .margin_right(fine(RIGHT + chart.bar.as_ref().map_or(0.0, |bar| bar.room(appearance))))
            .x_label_area_size(fine(bottom))
            .y_label_area_size(fine(left))
            .build_cartesian_2d(x.clone(), y.clone())?;
        context
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(GRID.stroke_width(3))
            .axis_style(INK.stroke_width(4))
            .set_all_tick_mark_size(fine(4.0))
            .label_style(self.text_style())
            .axis_desc_style(self.text_style())
            .x_label_formatter(&|tick| if chart.shares_axis { String::new() } else { x.text(*tick) })
            .y_label_formatter(&|tick| y.text(*tick))
            .x_desc(if chart.shares_axis {
                String::new()
            } else {
                shortened(&x.label, letters_in(chart.size.0 - left, appearance))
            })
            .draw()?;
        self.draw_label(&body, &label, chart.size.1 - header - bottom)?;
        let (across, down) = context.plotting_area().get_pixel_range();
        Ok([across.start, down.start, across.end - across.start, down.end - down.start])
    }

    /// The label of the vertical axis, upwards along its middle.
    fn draw_label(&self, body: &Area, lines: &[String], height: f64) -> Drawn {
        let style =
            self.text_style().pos(Pos::new(HPos::Center, VPos::Top)).transform(FontTransform::Rotate270);
        for (number, line) in lines.iter().enumerate() {
            let left = EDGE + self.appearance.em(LABEL_LINE * number as f64);
            body.draw(&Text::new(line.clone(), (fine(left), fine(0.5 * height)), style.clone()))?;
        }
        Ok(())
    }

    /// Title and legend; the legend goes on below where it is too long for a line.
    fn draw_header(&self, area: &Area, left: f64, legend: &[Vec<&(Colour, String)>]) -> Drawn {
        let (chart, appearance) = (self.chart, self.appearance);
        let middle = |line: usize| fine(appearance.em(1.0 + LEGEND_LINE * line as f64));
        let style = || self.text_style().pos(Pos::new(HPos::Left, VPos::Center));
        let widest = legend.iter().map(|line| width_of(line, appearance)).fold(0.0, f64::max);
        let beside = legend.first().map_or(0.0, |line| width_of(line, appearance));
        let room = letters_in(chart.size.0 - left - beside - RIGHT, appearance);
        let title = shortened(&chart.title, room);
        area.draw(&Text::new(title, (fine(left), middle(0)), style()))?;
        // Without a title the legend comes first, where a narrow screen that scrolls shows it.
        let room = chart.size.0 - RIGHT - widest;
        let begin = if chart.title.is_empty() { left.min(room.max(EDGE)) } else { room };
        for (number, line) in legend.iter().enumerate() {
            let mut x = begin;
            for (colour, name) in line {
                let dash = vec![(fine(x), middle(number)), (fine(x + appearance.em(SAMPLE)), middle(number))];
                let width = match colour {
                    colour if colour.is_area() => appearance.em(0.77),
                    colour => appearance.lines * line_width(chart, *colour),
                };
                area.draw(&PathElement::new(dash, colour.marker().stroke_width(fine(width) as u32)))?;
                let after = fine(x + appearance.em(BEFORE_NAME));
                area.draw(&Text::new(name.clone(), (after, middle(number)), style()))?;
                x += entry_width(name, appearance);
            }
        }
        Ok(())
    }

    fn text_style(&self) -> TextStyle<'_> {
        // The library divides by 1.24.
        let font = (self.appearance.family.as_str(), 1.24 * FINE * self.appearance.text).into_font();
        TextStyle::from(font).color(&INK)
    }
}

/// Length of the line of an entry of the legend, in sizes of the text.
const SAMPLE: f64 = 1.385;

/// From the beginning of an entry to its name, in sizes of the text.
const BEFORE_NAME: f64 = 1.77;

/// From an entry's name to the next entry, in sizes of the text.
const AFTER_NAME: f64 = 1.08;

/// Width of the letters of names with many figures, in mean widths of a letter.
const WIDE_LETTER: f64 = 1.15;

/// Room to the left of a title, in sizes of the text.
const BEFORE_TITLE: f64 = 9.0;

/// Entries of the legend whose colour is drawn and not beside the curves, in as many lines as they need. The first line is empty
/// where the title needs it.
pub(super) fn legend_lines<'c>(chart: &'c Chart, appearance: &Appearance) -> Vec<Vec<&'c (Colour, String)>> {
    let is_used =
        |colour| chart.curves.iter().any(|curve| curve.colour == colour && !curve.points.is_empty());
    let mut lines: Vec<Vec<&(Colour, String)>> = Vec::new();
    for entry in chart.legend.iter().filter(|(colour, _)| chart.bar.is_none() && is_used(*colour)) {
        let room = chart.size.0 - LEGEND_EDGE - entry_width(&entry.1, appearance);
        match lines.last_mut() {
            Some(line) if width_of(line, appearance) <= room => line.push(entry),
            _ => lines.push(vec![entry]),
        }
    }
    let title = appearance.em(BEFORE_TITLE) + appearance.letter() * chart.title.chars().count() as f64;
    if !chart.title.is_empty()
        && lines.first().is_some_and(|line| title + width_of(line, appearance) > chart.size.0)
    {
        lines.insert(0, Vec::new());
    }
    lines
}

fn width_of(line: &[&(Colour, String)], appearance: &Appearance) -> f64 {
    line.iter().map(|(_, name)| entry_width(name, appearance)).sum()
}

/// Width of the line that stands for a colour in the legend: that of its curve, and no less than can be seen well.
fn line_width(chart: &Chart, colour: Colour) -> f64 {
    chart.curves.iter().find(|curve| curve.colour == colour).map_or(0.0, |curve| curve.width).max(2.0)
}

fn entry_width(name: &str, appearance: &Appearance) -> f64 {
    appearance.em(BEFORE_NAME + AFTER_NAME) + WIDE_LETTER * appearance.letter() * name.chars().count() as f64
}

fn fine(pixels: f64) -> i32 {
    (FINE * pixels).round() as i32
}

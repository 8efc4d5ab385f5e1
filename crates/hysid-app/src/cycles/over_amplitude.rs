//! Figures of cycles as charts, over amplitude or frequency: of one set of cycles, or of several to compare.

use std::collections::HashMap;

use hysid::diagnosis::cycles::{CycleRow, Direction, Field, Figure, FigureQuantity, LossAtFrequency};
use hysid_document::chart::thin::Point;
use hysid_document::{Axis, Chart, Colour, Curve, number, unit};

use super::Cycles;
use super::table::{SEVERAL, at_several_frequencies, present};

/// Records and reversal curves that are drawn at most.
pub(super) const MOST_CURVES: usize = 60;

const MOST_DOTS: usize = 600;

/// Most amplitudes in a chart of losses over frequency: as many as there are colours.
const MOST_AMPLITUDES: usize = hysid_document::chart::SERIES;

/// Cycles, and how they are drawn beside others.
pub struct Shown<'a> {
    pub cycles: &'a Cycles<'a>,
    pub colour: Colour,
    /// Colours of their dots by record, in the place of that one.
    pub of_records: HashMap<&'a str, Colour>,
    /// Radius of their dots, in pixels.
    pub radius: f64,
    /// Source of the cycles, for the legend.
    pub name: &'a str,
}

/// Figures of loops that are compared: of one amplitude with another, and of a model with the data.
pub fn compared_figures(field: Field) -> &'static [&'static str] {
    match field {
        Field::Structure => &["energy", "damping_percent", "secant_stiffness", "residual_after_peak"],
        Field::Magnet => &["energy", "coercive_input", "remanent_output"],
        Field::Actuator => &["width_percent", "width", "peak_to_peak", "creep"],
        Field::Thermal => &["thermal_width", "heating_start", "cooling_start"],
        Field::Battery => &["energy", "mean_gap", "energy_efficiency_percent"],
        Field::Hydrology => &["hysteresis_index"],
        Field::General => &["energy", "width", "coercive_input", "secant_stiffness"],
    }
}

/// The figures of the field over amplitude. All sets have the columns of the first.
pub fn figures(sets: &[Shown]) -> Vec<Chart> {
    let Some(first) = sets.first() else { return Vec::new() };
    let amplitude = ("amplitude", first.cycles.quantities.as_input("amplitude"));
    let figures = present(&first.cycles.rows(), compared_figures(first.cycles.table.field));
    figures.into_iter().filter_map(|figure| over(sets, &amplitude, |row| row.amplitude, figure)).collect()
}

/// The width of the loops over frequency; `None` for a single frequency.
pub fn width_over_frequency(sets: &[Shown]) -> Option<Chart> {
    let first = sets.first()?.cycles;
    let figure = *present(&first.rows(), &["width_percent"]).first()?;
    let frequencies: Vec<f64> = first.table.complete().filter_map(|row| row.frequency).collect();
    let range = frequencies.iter().fold((f64::INFINITY, 0.0f64), |(low, high), &f| (low.min(f), high.max(f)));
    let frequency = ("frequency", first.quantities.as_figure("frequency", FigureQuantity::Frequency));
    (range.1 > SEVERAL * range.0).then(|| over(sets, &frequency, |row| row.frequency, figure)).flatten()
}

/// Dots of a figure of each complete cycle over another.
fn over(
    sets: &[Shown],
    (what, name): &(&str, String),
    abscissa: fn(&CycleRow) -> Option<f64>,
    figure: &Figure,
) -> Option<Chart> {
    let point = |row: &&CycleRow| Some((abscissa(row)?, (figure.of)(row)?));
    let mut curves = Vec::new();
    for set in sets {
        let rows: Vec<&CycleRow> = set.cycles.table.complete().collect();
        let every = rows.len().div_ceil(MOST_DOTS).max(1);
        for own in rows.chunk_by(|a, b| a.record == b.record) {
            let colour = *set.of_records.get(own[0].record.as_str()).unwrap_or(&set.colour);
            curves.push(Curve::dots(own.iter().filter_map(point).step_by(every), colour, set.radius));
        }
    }
    let all = || curves.iter().flat_map(|curve| &curve.points).filter(|point| point.0.is_finite());
    all().next()?;
    let label = unit::label(&sets[0].cycles.quantities.as_figure(figure.label, figure.quantity));
    let axis = |label: &str, of: fn(&Point) -> f64| Axis::linear(label, all().map(of).chain([0.0]));
    let axes = (axis(&unit::label(name), |point| point.0), axis(&label, |point| point.1));
    let chart =
        Chart::on_axes(format!("{label} of each cycle over its {what}"), axes.0, axes.1, curves).small("");
    Some(chart.with_legend(legend(sets)))
}

/// Colours and names of several sets; nothing for one.
pub fn legend<'a>(sets: &'a [Shown]) -> impl Iterator<Item = (Colour, &'a str)> + use<'a> {
    sets.iter().filter(|_| sets.len() > 1).map(|set| (set.colour, set.name))
}

/// The backbone of each record: a line from valley to peak, and its points. `sizes` are the width of the line and the
/// radius of the points, in pixels.
pub fn backbone(cycles: &Cycles, colour: Colour, sizes: (f64, f64)) -> Vec<Curve> {
    let mut curves = Vec::new();
    for record in cycles.data.records().iter().take(MOST_CURVES) {
        let own = cycles.table.backbone.iter().filter(|point| point.record == record.name());
        let mut points: Vec<Point> = own.clone().map(|point| (point.input, point.output)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if own.clone().any(|point| point.direction == Direction::Up) || own.count() > 1 {
            curves.push(Curve::dots(points.clone(), colour, sizes.1));
            curves.push(Curve::new(points, colour, sizes.0));
        }
    }
    curves
}

/// Loss per cycle over frequency, a colour for each amplitude; `None` for a single frequency. Those of the last set are
/// lines with dots, those of a set before it larger dots alone.
pub fn losses(sets: &[Shown]) -> Option<Chart> {
    let (last, before) = sets.split_last()?;
    let amplitudes: Vec<Vec<&[LossAtFrequency]>> =
        sets.iter().map(|set| at_several_frequencies(set.cycles)).collect();
    let all = || amplitudes.iter().flatten().copied().flatten();
    all().next()?;
    let q = &last.cycles.quantities;
    let x = unit::label(&q.as_figure("frequency", FigureQuantity::Frequency));
    let y = unit::label(&q.as_energy("loss per cycle"));
    let axes = (
        Axis::logarithmic(&x, all().map(|loss| loss.frequency)),
        Axis::linear(&y, all().map(|loss| loss.energy).chain([0.0])),
    );
    let mut curves = Vec::new();
    for (place, of_set) in amplitudes.iter().enumerate() {
        for (number, losses) in of_set.iter().enumerate() {
            let points: Vec<Point> = losses.iter().map(|loss| (loss.frequency, loss.energy)).collect();
            let colour = Colour::Series(number);
            match place < before.len() {
                true => curves.push(Curve::dots(points, colour, 4.5)),
                false => {
                    curves.extend([Curve::new(points.clone(), colour, 1.4), Curve::dots(points, colour, 2.2)])
                }
            }
        }
    }
    let amplitude = |(number, losses): (usize, &&[LossAtFrequency])| {
        let amplitude = unit::with(&number_of(losses), &q.input);
        (Colour::Series(number), format!("amplitude {amplitude}"))
    };
    let of_last = amplitudes.last().map_or(&[][..], Vec::as_slice);
    let legend: Vec<(Colour, String)> =
        of_last.iter().enumerate().take(MOST_AMPLITUDES).map(amplitude).collect();
    let description = format!("{y} over {x}, a colour for each amplitude");
    Some(Chart::on_axes(description, axes.0, axes.1, curves).small("").with_legend(legend))
}

fn number_of(losses: &[LossAtFrequency]) -> String {
    number(losses[0].amplitude, 3)
}

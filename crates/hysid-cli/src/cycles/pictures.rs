//! The pictures of the page.

use hysid::diagnosis::cycles::{CycleRow, Direction, Field, LossAtFrequency, Quantity};
use hysid::diagnosis::reversal_curves::{ReversalCurves, ReversalNode};
use hysid_document::chart::thin::{Point, thin, thin_path};
use hysid_document::chart::{HeatCell, heat_map};
use hysid_document::{Axis, Chart, Colour, Curve, unit};

use super::Cycles;

/// Points of all loops together.
const LOOP_POINTS: usize = 6000;

/// Records and reversal curves that are drawn at most.
const MOST_CURVES: usize = 60;

/// Dots of a chart at most.
const MOST_DOTS: usize = 600;

/// Frequencies that differ by more than this factor are drawn.
const SEVERAL: f64 = 1.05;

/// All loops, the last complete cycle, and the backbone.
pub fn loops(cycles: &Cycles) -> Chart {
    let records = cycles.data.records();
    let every = records.len().div_ceil(MOST_CURVES).max(1);
    let most = (LOOP_POINTS * every / records.len().max(1)).max(100);
    let mut curves = Vec::new();
    for record in records.iter().step_by(every) {
        let (x, y) = (&*record.inputs()[0], record.output());
        curves.push(Curve::new(path(x, y, most), Colour::Faint, 1.2));
    }
    let largest = cycles
        .table
        .complete()
        .max_by(|a, b| a.amplitude.unwrap_or(0.0).total_cmp(&b.amplitude.unwrap_or(0.0)));
    if let Some(row) = largest
        && let Some(record) = records.iter().find(|record| record.name() == row.record)
    {
        let rows = row.rows.0..row.rows.1 + 1;
        let points = path(&record.inputs()[0][rows.clone()], &record.output()[rows], 2000);
        curves.push(Curve::new(points, Colour::Simulated, 1.8));
    }
    curves.extend(backbone(cycles));
    let q = &cycles.quantities;
    let (x, y) = (unit::label(&q.input), unit::label(&q.output));
    let what = if cycles.of_model { "all loops of the model" } else { "all loops" };
    let description = format!("{y} over {x}: {what}, the cycle of the largest amplitude, and the backbone");
    Chart::new(description, &x, &y, curves).sized(760.0, 460.0).with_legend([
        (Colour::Faint, what),
        (Colour::Simulated, "largest cycle"),
        (Colour::Error, "backbone"),
    ])
}

/// Input and output where one or the other has moved visibly.
fn path(x: &[f64], y: &[f64], most: usize) -> Vec<Point> {
    let point = |row: Option<usize>| row.map_or((f64::NAN, f64::NAN), |row| (x[row], y[row]));
    thin_path(&[x, y], most).into_iter().map(point).collect()
}

/// The backbone of each record: a line from valley to peak, and its points.
fn backbone(cycles: &Cycles) -> Vec<Curve> {
    let mut curves = Vec::new();
    for record in cycles.data.records().iter().take(MOST_CURVES) {
        let own = cycles.table.backbone.iter().filter(|point| point.record == record.name());
        let mut points: Vec<Point> = own.clone().map(|point| (point.input, point.output)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if own.clone().any(|point| point.direction == Direction::Up) || own.count() > 1 {
            curves.push(Curve::dots(points.clone(), Colour::Error, 3.0));
            curves.push(Curve::new(points, Colour::Error, 1.6));
        }
    }
    curves
}

/// The figures of the field over cycle or amplitude, each with its title.
pub fn figures(cycles: &Cycles) -> Vec<Chart> {
    let names: &[&str] = match cycles.table.field {
        Field::Structure => &["energy", "damping_percent", "secant_stiffness", "residual_after_peak"],
        Field::Magnet => &["energy", "coercive_input", "remanent_output"],
        Field::Actuator => &["width_percent", "width", "creep"],
        Field::General => &["energy", "width", "coercive_input", "secant_stiffness"],
    };
    let amplitude = cycles.quantities.as_input("amplitude");
    let mut charts = Vec::new();
    for figure in super::text::present(cycles, names) {
        let point = |row: &CycleRow| Some((row.amplitude?, (figure.of)(row)?));
        let points: Vec<Point> = cycles.table.complete().filter_map(point).collect();
        if points.is_empty() {
            continue;
        }
        let label = unit::label(&cycles.quantities.as_figure(figure.label, figure.quantity));
        charts.push(dots(
            &format!("{label} of each cycle over its amplitude"),
            &unit::label(&amplitude),
            &label,
            &points,
        ));
    }
    charts.extend(losses(cycles));
    charts
}

fn dots(description: &str, x: &str, y: &str, points: &[Point]) -> Chart {
    let every = points.len().div_ceil(MOST_DOTS).max(1);
    let shown: Vec<Point> = points.iter().copied().step_by(every).collect();
    let axis = |label: &str, of: fn(&Point) -> f64| Axis::linear(label, points.iter().map(of).chain([0.0]));
    let curves = vec![Curve::dots(shown, Colour::Simulated, 3.0)];
    Chart::on_axes(description, axis(x, |point| point.0), axis(y, |point| point.1), curves).small("")
}

/// Losses of the amplitudes that have several frequencies.
pub fn at_several_frequencies<'a>(cycles: &'a Cycles) -> Vec<&'a [LossAtFrequency]> {
    let amplitudes =
        cycles.table.losses.chunk_by(|a, b| b.frequency > a.frequency && alike(a.amplitude, b.amplitude));
    let has_several =
        |losses: &&[LossAtFrequency]| losses[losses.len() - 1].frequency > SEVERAL * losses[0].frequency;
    if cycles.table.field == Field::Actuator { Vec::new() } else { amplitudes.filter(has_several).collect() }
}

fn alike(a: f64, b: f64) -> bool {
    a.max(b) <= SEVERAL * a.min(b)
}

/// Loss per cycle over frequency, a curve for each amplitude; `None` for a single frequency.
fn losses(cycles: &Cycles) -> Option<Chart> {
    let amplitudes = at_several_frequencies(cycles);
    let all = || amplitudes.iter().copied().flatten();
    all().next()?;
    let q = &cycles.quantities;
    let x = unit::label(&q.as_figure("frequency", Quantity::Frequency));
    let y = unit::label(&q.as_energy("loss per cycle"));
    let axes = (
        Axis::logarithmic(&x, all().map(|loss| loss.frequency)),
        Axis::linear(&y, all().map(|loss| loss.energy).chain([0.0])),
    );
    let curve = |(number, losses): (usize, &&[LossAtFrequency])| {
        let points: Vec<Point> = losses.iter().map(|loss| (loss.frequency, loss.energy)).collect();
        let colour = Colour::Series(number);
        [Curve::new(points.clone(), colour, 1.4), Curve::dots(points, colour, 3.0)]
    };
    let curves = amplitudes.iter().enumerate().flat_map(curve).collect();
    Some(
        Chart::on_axes(format!("{y} over {x}, a curve for each amplitude"), axes.0, axes.1, curves).small(""),
    )
}

/// The reversal curves.
pub fn reversal_curves(cycles: &Cycles, curves: &ReversalCurves) -> Chart {
    let every = curves.curves.len().div_ceil(MOST_CURVES).max(1);
    let line = |points: &Vec<Point>| Curve::new(thin(points, 400), Colour::Simulated, 1.0);
    let lines = curves.curves.iter().step_by(every).map(|curve| line(&curve.points)).collect();
    let q = &cycles.quantities;
    let (x, y) = (unit::label(&q.input), unit::label(&q.output));
    let description = format!("First-order reversal curves: {y} over {x}");
    Chart::new(description, &x, &y, lines).sized(760.0, 400.0)
}

/// The density in the coordinates of a FORC diagram: half the distance and the middle of reversal input and input.
pub fn forc_diagram(cycles: &Cycles, curves: &ReversalCurves) -> Chart {
    let q = &cycles.quantities;
    let (x, y) = (unit::label(&q.as_input("half width")), unit::label(&q.as_input("middle")));
    let value = unit::label(&q.as_density("density"));
    let description = format!(
        "FORC diagram: {value} over {x} and {y}; largest magnitude {}",
        hysid_document::number(curves.largest_density(), 3)
    );
    let sign = if curves.rising { 1.0 } else { -1.0 };
    let cells = cells(curves, |node| node.density.unwrap_or(f64::NAN));
    heat_map(description, &x, &y, &cells, |input, reversal| {
        (0.5 * sign * (input - reversal), 0.5 * (input + reversal))
    })
}

/// The Everett function over both inputs of the Preisach plane.
pub fn everett(cycles: &Cycles, curves: &ReversalCurves) -> Chart {
    let q = &cycles.quantities;
    let (x, y) = (unit::label(&q.as_input("input")), unit::label(&q.as_input("reversal input")));
    let value = unit::label(&q.as_output("Everett function"));
    let largest = curves.nodes.iter().map(|node| node.everett).fold(0.0, f64::max);
    let description =
        format!("{value} over {x} and {y}; largest value {}", hysid_document::number(largest, 3));
    heat_map(description, &x, &y, &cells(curves, |node| node.everett), |input, reversal| (input, reversal))
}

/// A cell around each node, half a step to each side and half way to the neighbouring curves.
fn cells(curves: &ReversalCurves, value: impl Fn(&ReversalNode) -> f64) -> Vec<HeatCell> {
    let half = 0.5 * curves.step;
    let mut reversals: Vec<f64> = curves.nodes.iter().map(|node| node.reversal_input).collect();
    reversals.dedup();
    let edges = |reversal: f64| {
        let place = reversals.iter().position(|known| *known == reversal).unwrap_or(0);
        let beside =
            |other: Option<&f64>, away: f64| other.map_or(reversal + away, |other| 0.5 * (reversal + other));
        let sign = if curves.rising { 1.0 } else { -1.0 };
        let before = beside(place.checked_sub(1).and_then(|before| reversals.get(before)), sign * half);
        let after = beside(reversals.get(place + 1), -sign * half);
        (before.min(after), before.max(after))
    };
    let mut rows: Vec<(f64, (f64, f64))> = Vec::new();
    let mut all = Vec::new();
    for node in &curves.nodes {
        if rows.last().is_none_or(|(reversal, _)| *reversal != node.reversal_input) {
            rows.push((node.reversal_input, edges(node.reversal_input)));
        }
        let v = rows[rows.len() - 1].1;
        all.push(HeatCell { u: (node.input - half, node.input + half), v, value: value(node) });
    }
    // Rising along each row, so that neighbours are joined.
    all.sort_by(|a, b| a.v.0.total_cmp(&b.v.0).then(a.u.0.total_cmp(&b.u.0)));
    all
}

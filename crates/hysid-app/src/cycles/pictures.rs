//! The pictures of the page.

use std::collections::HashMap;

use hysid::diagnosis::reversal_curves::{ReversalCurves, ReversalNode};
use hysid_document::chart::thin::{Point, thin, thin_path};
use hysid_document::chart::{HeatCell, heat_map, records_in_colour};
use hysid_document::{Chart, Colour, Curve, unit};

use super::Cycles;
use super::over_amplitude::{MOST_CURVES, backbone};

const LOOP_POINTS: usize = 6000;

/// The colour of each of several records, and their legend.
pub fn colours<'c>(cycles: &'c Cycles) -> (HashMap<&'c str, Colour>, Vec<(Colour, String)>) {
    let names: Vec<&str> = cycles.data.records().iter().map(|record| record.name()).collect();
    let (colours, legend) = records_in_colour(&names);
    (names.into_iter().zip(colours).collect(), legend)
}

/// All loops and the backbone; the largest cycle of a single record, and a colour for each of several.
pub fn loops(cycles: &Cycles) -> Chart {
    let records = cycles.data.records();
    let every = records.len().div_ceil(MOST_CURVES).max(1);
    let most = (LOOP_POINTS * every / records.len().max(1)).max(100);
    let mut curves = Vec::new();
    let what = if cycles.of_model { "all loops of the model" } else { "all loops" };
    let (colours, mut legend) = colours(cycles);
    for record in records.iter().step_by(every) {
        let (x, y) = (&*record.inputs()[0], record.output());
        let colour = colours.get(record.name()).copied().unwrap_or(Colour::Faint);
        curves.push(Curve::new(path(x, y, most), colour, 1.2));
    }
    let largest = cycles
        .table
        .complete()
        .max_by(|a, b| a.amplitude.unwrap_or(0.0).total_cmp(&b.amplitude.unwrap_or(0.0)));
    if records.len() == 1
        && let Some(row) = largest
        && let Some(record) = records.iter().find(|record| record.name() == row.record)
    {
        let rows = row.rows.0..row.rows.1 + 1;
        let points = path(&record.inputs()[0][rows.clone()], &record.output()[rows], 2000);
        curves.push(Curve::new(points, Colour::Simulated, 1.8));
        legend = vec![(Colour::Faint, what.into()), (Colour::Simulated, "largest cycle".into())];
    }
    curves.extend(backbone(cycles, Colour::Error, (1.6, 3.0)));
    let q = &cycles.quantities;
    let (x, y) = (unit::label(&q.input), unit::label(&q.output));
    legend.push((Colour::Error, "backbone".into()));
    let named: Vec<&str> = legend.iter().map(|(_, name)| name.as_str()).collect();
    let description = format!("{y} over {x}, {what}: {}", named.join(", "));
    Chart::new(description, &x, &y, curves).sized(760.0, 460.0).with_legend(legend)
}

/// Input and output where one or the other has moved visibly.
pub fn path(x: &[f64], y: &[f64], most: usize) -> Vec<Point> {
    let point = |row: Option<usize>| row.map_or((f64::NAN, f64::NAN), |row| (x[row], y[row]));
    thin_path(&[x, y], most).into_iter().map(point).collect()
}

pub fn reversal_curves(cycles: &Cycles, curves: &ReversalCurves) -> Chart {
    let every = curves.curves.len().div_ceil(MOST_CURVES).max(1);
    let line = |points: &Vec<Point>| Curve::new(thin(points, 400), Colour::Simulated, 1.0);
    let lines = curves.curves.iter().step_by(every).map(|curve| line(&curve.points)).collect();
    let q = &cycles.quantities;
    let (x, y) = (unit::label(&q.input), unit::label(&q.output));
    let description = format!("First-order reversal curves: {y} over {x}");
    Chart::new(description, &x, &y, lines).sized(760.0, 400.0)
}

/// The density in the coordinates of a FORC diagram: coercivity `H_c`, half the distance of reversal input and input, and
/// interaction field `H_u`, their mean.
pub fn forc_diagram(cycles: &Cycles, curves: &ReversalCurves) -> Chart {
    let q = &cycles.quantities;
    let (x, y) = (unit::label(&q.as_input("H_c")), unit::label(&q.as_input("H_u")));
    let value = unit::label(&q.as_density("density"));
    let description = format!(
        "FORC diagram: {value} over {x} and {y}; largest magnitude {}",
        hysid_document::number(curves.largest_density(), 3)
    );
    let sign = if curves.rising { 1.0 } else { -1.0 };
    let cells = cells(curves, |node| node.density.unwrap_or(f64::NAN));
    heat_map(description, [&x, &y, &value], &cells, |input, reversal| {
        // A cell ends where the input is the reversal input, so that those of neighbouring curves stay side by side.
        let input = if sign * (input - reversal) < 0.0 { reversal } else { input };
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
    heat_map(description, [&x, &y, &value], &cells(curves, |node| node.everett), |input, reversal| {
        (input, reversal)
    })
}

/// A cell around each node, half a step to each side and half way to the neighbouring curves, and never beyond the
/// fields that were measured.
fn cells(curves: &ReversalCurves, value: impl Fn(&ReversalNode) -> f64) -> Vec<HeatCell> {
    let half = 0.5 * curves.step;
    let mut reversals: Vec<f64> = curves.nodes.iter().map(|node| node.reversal_input).collect();
    reversals.dedup();
    let edges = |reversal: f64| {
        let place = reversals.iter().position(|known| *known == reversal).unwrap_or(0);
        let beside = |other: Option<&f64>| other.map_or(reversal, |other| 0.5 * (reversal + other));
        let before = beside(place.checked_sub(1).and_then(|before| reversals.get(before)));
        let after = beside(reversals.get(place + 1));
        (before.min(after), before.max(after))
    };
    let mut rows: Vec<(f64, (f64, f64))> = Vec::new();
    let mut all = Vec::new();
    for node in &curves.nodes {
        if rows.last().is_none_or(|(reversal, _)| *reversal != node.reversal_input) {
            rows.push((node.reversal_input, edges(node.reversal_input)));
        }
        let v = rows[rows.len() - 1].1;
        let (one, other) = (node.reversal_input, curves.end);
        let within = |x: f64| x.clamp(one.min(other), one.max(other));
        let u = (within(node.input - half), within(node.input + half));
        all.push(HeatCell { u, v, value: value(node) });
    }
    // Rising along each row, so that neighbours are joined.
    all.sort_by(|a, b| a.v.0.total_cmp(&b.v.0).then(a.u.0.total_cmp(&b.u.0)));
    all
}

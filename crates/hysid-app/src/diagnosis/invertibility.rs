//! The card of invertibility: the next output over the next input, after several pasts.

use hysid::diagnosis::model::{Invertibility, NonMonotonePlace, PlaceKind};
use hysid_document::chart::thin::Point;
use hysid_document::{Card, Chart, Colour, Curve, unit};

use super::cards;
use crate::quantities::Quantities;

/// Width and height of a chart in a card, in pixels.
const SIZE: (f64, f64) = (460.0, 320.0);

/// A scan narrower than this share of the range gets a chart of its own.
const NARROW: f64 = 0.5;

pub fn card(found: &Invertibility, quantities: &Quantities) -> Card {
    let mut charts = vec![overview(found, quantities)];
    let narrow = found.drawing.worst.as_ref().filter(|worst| width(worst) < NARROW * whole(found));
    if let (Some(worst), Some(place)) = (narrow, &found.worst) {
        charts.push(close(worst, place, quantities));
    }
    cards::card(&found.finding, charts, "")
}

/// Largest width of a scan.
fn whole(found: &Invertibility) -> f64 {
    found.drawing.several.iter().map(|scan| width(scan)).fold(0.0, f64::max)
}

fn width(scan: &[Point]) -> f64 {
    scan.last().zip(scan.first()).map_or(0.0, |(last, first)| last.0 - first.0)
}

/// All scans over the whole range, and the outputs that each of them has.
fn overview(found: &Invertibility, quantities: &Quantities) -> Chart {
    let scans = &found.drawing.several;
    let inputs = || scans.iter().flatten().map(|point| point.0);
    let (low, high) = (inputs().fold(f64::INFINITY, f64::min), inputs().fold(f64::NEG_INFINITY, f64::max));
    let mut curves: Vec<Curve> = found
        .always
        .map(|(from, to)| {
            Curve::new(vec![(low, from), (high, from), (high, to), (low, to)], Colour::Band, 1.0)
        })
        .into_iter()
        .collect();
    curves.extend(scans.iter().map(|scan| Curve::new(scan.clone(), Colour::Simulated, 0.8)));
    if let (Some(worst), Some(place)) = (&found.drawing.worst, &found.worst) {
        curves.extend(marked(worst, place));
    }
    chart("Next output over the next input, after several pasts", curves, quantities).with_legend([
        (Colour::Simulated, "after a past"),
        (Colour::Band, "reached after any"),
        (Colour::Error, mark(found.worst.as_ref())),
    ])
}

/// The worst scan alone.
fn close(worst: &[Point], place: &NonMonotonePlace, quantities: &Quantities) -> Chart {
    let curves = marked(worst, place);
    chart("Next output over the next input where it is not monotone", curves, quantities)
        .with_legend([(Colour::Measured, "after the worst past"), (Colour::Error, mark(Some(place)))])
}

fn chart(description: &str, curves: Vec<Curve>, quantities: &Quantities) -> Chart {
    let next = |column: &str| format!("next {}", unit::label(column));
    Chart::new(description, &next(&quantities.input), &next(&quantities.output), curves).sized(SIZE.0, SIZE.1)
}

fn mark(place: Option<&NonMonotonePlace>) -> &'static str {
    match place.map(|place| place.kind) {
        Some(PlaceKind::Jump) => "jump",
        _ => "goes back",
    }
}

fn marked(scan: &[Point], place: &NonMonotonePlace) -> Vec<Curve> {
    let (from, to) = place.inputs;
    let ends = [(from, place.outputs.0), (to, place.outputs.1)];
    let inside = scan.iter().copied().filter(|point| point.0 > from && point.0 < to);
    let way: Vec<Point> = [ends[0]].into_iter().chain(inside).chain([ends[1]]).collect();
    vec![
        Curve::new(scan.to_vec(), Colour::Measured, 1.6),
        Curve::new(way, Colour::Error, 2.6),
        Curve::dots(ends, Colour::Error, 3.0),
    ]
}

//! The figures of `docs/theory.md` that explain memory, superposition, classical laws, rates and bands. Each is computed
//! by the operators and laws of the library. `HYSID_WRITE=1 cargo test --test theory_figures` draws
//! them anew.

mod laws;
mod memory;
#[path = "../paths/mod.rs"]
mod paths;
mod superposition;
mod time;

use std::path::Path;

use hysid_core::operator::{Operator, Stop};
use hysid_document::chart::{Appearance, Axis, Chart, Colour, Curve, Label, sheet};
use paths::{corners, path};

/// Size of a chart that stands beside another, in pixels.
const SIZE: (f64, f64) = (430.0, 320.0);

/// Most bytes of a figure: a page of theory is also read over slow networks.
const MOST_BYTES: usize = 100_000;

type Points = Vec<(f64, f64)>;

/// The last row of the path at which each of these turning points is reached.
fn rows(turning: &[f64]) -> Vec<usize> {
    (1..=turning.len()).map(|count| path(&turning[..count]).len() - 1).collect()
}

fn line(points: &[(f64, f64)], colour: Colour) -> Curve {
    Curve::new(corners(points), colour, 2.0)
}

/// Output over input.
fn loops(x: &[f64], y: &[f64]) -> Points {
    x.iter().copied().zip(y.iter().copied()).collect()
}

/// Input over the number of the row.
fn history(x: &[f64]) -> Points {
    x.iter().enumerate().map(|(k, x)| (k as f64, *x)).collect()
}

fn label(point: (f64, f64), rise: f64, text: &str) -> Label {
    Label { point, rise, text: text.into() }
}

/// A chart with some room around its curves.
fn chart(title: &str, x: &str, y: &str, curves: Vec<Curve>) -> Chart {
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let roomy = |name: &str, values: Vec<f64>| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let room = 0.06 * (high - low);
        Axis::linear(name, [low - room, high + room].into_iter())
    };
    let (x, y) = (
        roomy(x, points().map(|point| point.0).collect()),
        roomy(y, points().map(|point| point.1).collect()),
    );
    let chart = Chart::on_axes(title, x, y, curves).sized(SIZE.0, SIZE.1);
    Chart { title: title.into(), ..chart }
}

/// The sum of stops with the thresholds 0.2, 0.4 ... 1.2: a rising law with memory.
fn sum_of_stops(x: &[f64]) -> Vec<f64> {
    let mut stops: Vec<Stop> = (1..=6).map(|k| Stop::new(0.2 * f64::from(k)).unwrap()).collect();
    x.iter().map(|x| stops.iter_mut().map(|stop| stop.step(*x)).sum::<f64>() / 4.0).collect()
}

#[test]
fn figures_are_as_the_library_draws_them() {
    let figures: [(&str, &str, Vec<Chart>); 10] = [
        ("relay", "Output of a relay: it switches up at s + r and down at s - r", vec![memory::relay()]),
        ("wiping_out", "An inner loop is closed and leaves no trace", memory::wiping_out()),
        ("congruency", "Inner loops of a sum of stops and of a network", memory::congruency()),
        ("masing", "All branches are the virgin curve, twice as large", superposition::masing()),
        ("superposition", "Three plays and their weighted sum", superposition::plays()),
        ("preisach_plane", "Input and the relays that are up", superposition::preisach_plane()),
        ("generalized_play", "A play between two curved envelopes", laws::generalized_play()),
        ("pinching", "Loops without and with degradation and pinching", laws::pinching()),
        ("rate", "Loops of one input at three frequencies", time::rate()),
        ("band", "Output of an ensemble with its prediction band", time::band()),
    ];
    for (name, description, charts) in figures {
        let drawn = sheet(&charts, 2, &Appearance::of_page(), description, "lab/tests/theory_figures");
        let place = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../docs/images/{name}.svg"));
        if std::env::var_os("HYSID_WRITE").is_some() {
            std::fs::write(&place, &drawn).unwrap();
        }
        assert!(drawn.len() < MOST_BYTES, "{name}: {} bytes", drawn.len());
        let stored = std::fs::read_to_string(&place).unwrap_or_default();
        let place = place.display();
        assert!(stored.replace("\r\n", "\n") == drawn, "{place}: HYSID_WRITE=1 cargo test draws it anew");
    }
}

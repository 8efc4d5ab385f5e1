//! The inverse of every model: round trips, limits, and errors.

#[path = "../../hysid-export/tests/models/mod.rs"]
mod models;

use std::collections::BTreeMap;
use std::sync::LazyLock;

use hysid::{Model, Reach};

use crate::models::time_step;

static MODELS: LazyLock<Vec<(String, Model)>> = LazyLock::new(models::all);

/// Inputs inside the trained range, with reversals of all sizes, and their times.
fn drive(model: &Model, rows: usize) -> Vec<(f64, Vec<f64>, f64)> {
    let (low, high) = model.trained_ranges().inputs[0];
    let mut time = 0.0;
    let mut bits: u64 = 7;
    let mut unit = move || {
        bits = bits.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (bits >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut at, mut goal, mut stride) = (0.5, 0.9, 0.02);
    (0..rows)
        .map(|row| {
            time += time_step(row);
            let way: f64 = goal - at;
            if way.abs() < stride {
                at = goal;
                (goal, stride) = (0.02 + 0.96 * unit(), 0.002 + 0.05 * unit());
            } else {
                at += stride.copysign(way);
            }
            let others = (1..model.names().inputs.len()).map(|_| 5.0 + (0.013 * row as f64).cos()).collect();
            (low + at * (high - low), others, time)
        })
        .collect()
}

/// Drives the inverse to the outputs of a drive, and a second model with what the inverse gives.
///
/// Returns the largest deviation of the outputs of rows that were reached, as a share of the trained range, and the number
/// of rows by their reach.
fn round_trip(model: &Model, rows: usize) -> (f64, BTreeMap<&'static str, usize>) {
    let (low, high) = model.trained_ranges().output;
    let mut specimen = model.stepper();
    let mut inverse = model.inverse();
    let mut driven = model.stepper();
    let mut counts = BTreeMap::new();
    let mut largest: f64 = 0.0;
    for (x, others, time) in drive(model, rows) {
        let inputs = |x: f64| [&[x], &others[..]].concat();
        let wanted = specimen.step(&inputs(x), time, None).unwrap();
        let found = inverse.step(wanted, &others, time).unwrap();
        let output = driven.step(&inputs(found.input), time, None).unwrap();
        assert_eq!(output.to_bits(), found.output.to_bits());
        *counts.entry(found.reach.word()).or_default() += 1;
        if found.reach == Reach::Reached {
            largest = largest.max((output - wanted).abs() / (high - low));
        }
    }
    (largest, counts)
}

/// `HYSID_ROWS=1000000 cargo test --release -p hysid --test inverse -- --nocapture` is the long one.
#[test]
fn models_driven_by_their_inverses_have_the_wanted_outputs() {
    let rows = std::env::var("HYSID_ROWS").map_or(5000, |rows| rows.parse().unwrap());
    for (name, model) in MODELS.iter() {
        let (largest, counts) = round_trip(model, rows);
        println!("{name}: {largest:.1e}, {counts:?}");
        assert!(largest <= 1e-9, "{name}: {largest:e}");
    }
}

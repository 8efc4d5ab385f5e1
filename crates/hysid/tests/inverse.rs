//! The inverse of every model: round trips, limits, and errors.

#[path = "../../hysid-export/tests/models/mod.rs"]
mod models;

use std::collections::BTreeMap;
use std::sync::LazyLock;

use hysid::diagnosis::{ModelDiagnosis, Verdict};
use hysid::model::MOST_TRIALS;
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
/// Also compares the largest number of trials with its bound.
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
        assert!(found.trials <= MOST_TRIALS);
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
        let reached = counts.get("reached").copied().unwrap_or(0);
        // These three models are not monotone everywhere.
        let is_monotone =
            !["neuro-madelung", "duhem-nn", "xpnn+"].iter().any(|other| name.starts_with(other));
        assert!(!is_monotone || rows - reached <= 1 + rows / 1000, "{name}: {counts:?}");
    }
}

fn model(beginning: &str) -> &'static Model {
    &MODELS.iter().find(|(name, _)| name.starts_with(beginning)).unwrap().1
}

/// A strictly increasing model has one input for each output, so the inverse must find the drive itself.
#[test]
fn the_drive_itself_is_found_where_the_model_increases_strictly() {
    for name in ["prandtl-ishlinskii", "modified-prandtl-ishlinskii", "menegotto-pinto"] {
        let model = model(name);
        let (low, high) = model.trained_ranges().inputs[0];
        let (mut stepper, mut inverse) = (model.stepper(), model.inverse());
        for (x, others, time) in drive(model, 2000) {
            let wanted = stepper.step(&[x], time, None).unwrap();
            let found = inverse.step(wanted, &others, time).unwrap().input;
            assert!((found - x).abs() <= 1e-8 * (high - low), "{name} at {time}: {found}, not {x}");
        }
    }
}

#[test]
fn outputs_beyond_the_limits_give_the_nearest_input() {
    let model = model("prandtl-ishlinskii");
    let mut inverse = model.inverse().limits(39.0, 41.0).unwrap();
    let far = 1e3;
    let mut step = |wanted| {
        let found = inverse.step(wanted, &[], 0.0).unwrap();
        (found.input, found.reach)
    };
    assert_eq!(step(far), (41.0, Reach::HighLimit));
    assert_eq!(step(-far), (39.0, Reach::LowLimit));
    // Afterwards it goes on from there.
    assert_eq!(
        step(model.trained_ranges().output.0 * 0.5 + model.trained_ranges().output.1 * 0.5).1,
        Reach::Reached
    );
}

#[test]
fn the_slew_limit_bounds_the_change_of_the_input() {
    let model = model("prandtl-ishlinskii");
    let (low, high) = model.trained_ranges().output;
    let mut inverse = model.inverse().slew(2.0).unwrap();
    let (mut before, mut slewing, mut reached) = (None::<f64>, 0, 0);
    for k in 0..400 {
        let time = 0.05 * f64::from(k);
        let wanted = if k % 80 < 40 { 0.7 * low + 0.3 * high } else { 0.3 * low + 0.7 * high };
        let found = inverse.step(wanted, &[], time).unwrap();
        if let Some(before) = before {
            assert!((found.input - before).abs() <= 0.1 + 1e-12);
        }
        before = Some(found.input);
        match found.reach {
            Reach::Slew => slewing += 1,
            Reach::Reached => reached += 1,
            other => panic!("{other:?}"),
        }
    }
    assert!(slewing > 50 && reached > 50, "{slewing}, {reached}");
}

#[test]
fn invalid_samples_leave_the_inverse_as_it_was() {
    let model = model("xpnn ");
    let (low, high) = model.trained_ranges().output;
    let wanted = |k: i32| low + (0.5 + 0.3 * (0.1 * f64::from(k)).sin()) * (high - low);
    let mut inverse = model.inverse();
    for k in 0..20 {
        inverse.step(wanted(k), &[], 0.01 * f64::from(k)).unwrap();
    }
    let mut other = inverse.clone();
    for (wanted, others, time) in [
        (f64::NAN, vec![], 0.5),
        (wanted(0), vec![1.0], 0.5),
        (wanted(0), vec![], 0.1),
        (wanted(0), vec![], f64::INFINITY),
    ] {
        other.step(wanted, &others, time).unwrap_err();
    }
    assert_eq!(inverse.step(wanted(20), &[], 0.2), other.step(wanted(20), &[], 0.2));
    for (low, high) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        model.inverse().limits(low, high).unwrap_err();
    }
    for slew in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        model.inverse().slew(slew).unwrap_err();
    }
}

/// Laws whose fits to these data are monotone.
const MONOTONE: [&str; 6] = [
    "prandtl-ishlinskii",
    "modified-prandtl-ishlinskii",
    "generalized-prandtl-ishlinskii",
    "masing",
    "preisach",
    "jiles-atherton",
];

/// The diagnosis drives a model to other pasts than the round trip: where the first finds a model monotone, the second
/// must find the inputs.
#[test]
fn models_judged_invertible_are_inverted() {
    const ROWS: usize = 5000;
    for (name, model) in MODELS.iter() {
        let found = ModelDiagnosis::of(model).unwrap().invertibility;
        let (_, counts) = round_trip(model, ROWS);
        let verdict = found.finding.verdict;
        println!("{name}: {verdict}, index {:.1e}, {counts:?}", found.finding.index.unwrap());
        println!("    {}", found.finding.statement);
        let count = |reach: Reach| counts.get(reach.word()).copied().unwrap_or(0);
        let missed = count(Reach::NotMonotone) + count(Reach::Jump);
        assert!(verdict != Verdict::Yes || missed <= ROWS / 1000, "{name}: {counts:?}");
        assert!(missed == 0 || verdict == Verdict::No, "{name}: {counts:?}");
        if MONOTONE.contains(&name.split(' ').next().unwrap()) {
            assert_eq!(verdict, Verdict::Yes, "{name}");
        }
    }
}

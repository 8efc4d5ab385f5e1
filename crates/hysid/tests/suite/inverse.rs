//! The inverse of every model: round trips, limits, and errors.

use crate::models;
use std::collections::BTreeMap;
use std::sync::LazyLock;

use hysid::diagnosis::{ModelDiagnosis, Verdict};
use hysid::model::{BandLevel, MOST_TRIALS};
use hysid::model::{Reach, Reference};
use hysid::specimens::Specimen;
use hysid::{Fit, Model};
use hysid_core::elementary::{cos, sin};

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
            let others = (1..model.names().inputs.len()).map(|_| 5.0 + cos(0.013 * row as f64)).collect();
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
    // The drive is faster than the training data.
    let mut inverse = model.inverse().slew(f64::MAX).unwrap();
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

/// `HYSID_ROWS=1000000 cargo test --release -p hysid --test suite -- --nocapture inverse` is the long one.
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
        // The inverse of a model with inertia is unstable: it ends at the limits.
        let is_monotone = is_monotone && !model.has_inertia();
        assert!(!is_monotone || rows - reached <= 1 + rows / 1000, "{name}: {counts:?}");
    }
}

fn model(beginning: &str) -> &'static Model {
    &MODELS.iter().find(|(name, _)| name.starts_with(beginning)).unwrap().1
}

#[test]
fn the_drive_itself_is_found_where_the_model_increases_strictly() {
    for name in ["prandtl-ishlinskii", "modified-prandtl-ishlinskii", "menegotto-pinto"] {
        let model = model(name);
        let (low, high) = model.trained_ranges().inputs[0];
        let (mut stepper, mut inverse, mut trials) = (model.stepper(), model.inverse(), 0);
        for (x, others, time) in drive(model, 2000) {
            let wanted = stepper.step(&[x], time, None).unwrap();
            let found = inverse.step(wanted, &others, time).unwrap();
            trials += found.trials;
            let found = found.input;
            assert!((found - x).abs() <= 1e-8 * (high - low), "{name} at {time}: {found}, not {x}");
        }
        // Where the closed inverse is exact, one trial confirms it; two more find the first slope.
        assert!(name == "menegotto-pinto" || trials == 2000 + 2, "{name}: {trials}");
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
    let wanted = |k: i32| low + (0.5 + 0.3 * sin(0.1 * f64::from(k))) * (high - low);
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
    let error = model.inverse().slew(1.0).unwrap().step(wanted(0), &[], f64::NAN).unwrap_err();
    let expected = "the time of the sample is missing or not finite, and the model, its slew limit or its preview needs it";
    assert_eq!(error.to_string(), expected);
}

/// A law that wears needs another input for the same output later.
#[test]
fn the_inverse_follows_the_wear_of_the_model() {
    let model = model("bouc-wen starts=1 epochs=3 degradation=true");
    let (low, high) = model.trained_ranges().output;
    let range = model.trained_ranges().inputs[0];
    let rows = 4000;
    let mut inverse = model.inverse().limits(range.0 - 10.0, range.1 + 10.0).unwrap();
    let mut peaks = Vec::new();
    let mut driven = model.stepper();
    for row in 0..rows {
        let wanted = 0.5 * (low + high) + 0.3 * (high - low) * sin(0.0314 * f64::from(row));
        let found = inverse.step(wanted, &[], 0.01 * f64::from(row)).unwrap();
        assert_eq!(found.reach, Reach::Reached);
        let output = driven.step(&[found.input], 0.01 * f64::from(row), None).unwrap();
        assert!((output - wanted).abs() <= 1e-9 * (high - low));
        if row % 200 == 50 {
            peaks.push(found.input);
        }
    }
    // Another amplitude of the input with each cycle, always to the same side.
    let change = (peaks[peaks.len() - 1] - peaks[0]) / (range.1 - range.0);
    assert!(change.abs() > 1e-3, "{change}: {peaks:?}");
    let steps = peaks.windows(2).filter(|pair| (pair[1] - pair[0]) * change > 0.0).count();
    assert!(steps + 1 >= peaks.len() - 1, "{peaks:?}");
}

/// An actuator that lags: the model of its training data, and a wanted output at `rows` rows.
fn lagging() -> Model {
    let data = Specimen::named("magnetostrictive-actuator").unwrap().train();
    Fit::new().model("rate-dependent-prandtl-ishlinskii").run(&data).unwrap()
}

fn tones(rows: usize) -> (Vec<f64>, Vec<f64>) {
    let time: Vec<f64> = (0..rows).map(|row| 0.1 * row as f64 / rows as f64).collect();
    let tone = |t: &f64| 26.0 + 11.0 * sin(125.7 * t) + 6.0 * sin(880.0 * t + 1.0);
    (time.iter().map(tone).collect(), time)
}

#[test]
fn a_preview_follows_where_the_output_lags_behind_the_input() {
    let model = lagging();
    let (wanted, time) = tones(4000);
    let reference = Reference { wanted: &wanted, others: &[], time: Some(&time) };
    let preview = model.inverse().best_preview(&reference).unwrap();
    assert!(preview > 0.0);
    let run = |preview: f64| {
        let found = model.inverse().preview(preview).unwrap().run(&reference).unwrap();
        let way: f64 = found.input.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        (100.0 * found.rms_deviation(&wanted) / 34.0, way)
    };
    // Without a preview every output is reached, by an input that runs to and fro from sample to sample.
    let ((without, to_and_fro), (with, way)) = (run(0.0), run(preview));
    assert!(without < 0.01 && to_and_fro > 2.0 * way, "{without} %, {to_and_fro} A against {way} A");
    assert!(with < 0.5, "{with} %");
}

/// Four times as many samples of the same wanted output, and the same input.
#[test]
fn the_time_step_does_not_change_the_input() {
    let model = lagging();
    let drive = |rows: usize| {
        let (wanted, time) = tones(rows);
        let reference = Reference { wanted: &wanted, others: &[], time: Some(&time) };
        let preview = model.inverse().best_preview(&reference).unwrap();
        (preview, model.inverse().preview(preview).unwrap().run(&reference).unwrap().input)
    };
    let ((slow_preview, slow), (fast_preview, fast)) = (drive(1000), drive(4000));
    assert_eq!(slow_preview, fast_preview);
    let deviations = slow.iter().zip(fast.iter().step_by(4)).skip(10).map(|(slow, fast)| (slow - fast).abs());
    let largest = deviations.fold(0.0, f64::max);
    // Of a range of 1.6 A.
    assert!(largest < 0.016, "{largest} A");
}

/// At the edges of the band of the drive, an edge of the band of the output is the wanted output.
#[test]
fn the_band_of_the_drive_is_that_of_the_output() {
    let (x, y): (Vec<f64>, Vec<f64>) = {
        let data = models::data(1);
        let record = &data.records()[0];
        (record.inputs()[0].to_vec(), record.output().to_vec())
    };
    let noisy: Vec<f64> = y.iter().enumerate().map(|(row, y)| y + 0.3 * sin(12.9898 * row as f64)).collect();
    let quick = hysid::Fit::new().option("epochs", 12).option("members", 3).option("starts", 1);
    let model = quick.run(&hysid::Dataset::from_slices(&x, &noisy).unwrap()).unwrap();
    let level = BandLevel::from(0.9);
    let (low, high) = model.trained_ranges().output;
    let mut inverse = model.inverse().band(level).unwrap();
    let mut stepper = model.stepper();
    let mut inside = 0;
    for (row, time) in (0..200).map(|row| (row, 0.02 * f64::from(row))) {
        let wanted = 0.5 * (low + high) + 0.3 * (high - low) * sin(0.07 * f64::from(row));
        let found = inverse.step(wanted, &[], time).unwrap();
        let (from, to) = found.band.unwrap();
        assert!(from <= found.input && found.input <= to, "{from}, {}, {to}", found.input);
        let limits = model.trained_ranges().inputs[0];
        for (edge, sign) in [(from, 1.0), (to, -1.0)] {
            if edge == limits.0 || edge == limits.1 {
                continue;
            }
            let output = stepper.trial(&[edge], time, None).unwrap();
            let reached = output + sign * stepper.half_width(level).unwrap();
            inside += 1;
            assert!((reached - wanted).abs() <= 1e-6 * (high - low), "row {row}: {reached}, not {wanted}");
        }
        stepper.step(&[found.input], time, None).unwrap();
    }
    assert!(inside > 300, "{inside}");
    // With a preview, they are the inputs of the row, not those at the end of the preview.
    let mut inverse = model.inverse().band(level).unwrap().preview(0.1).unwrap();
    for row in (0..200).map(f64::from) {
        let wanted = 0.5 * (low + high) + 0.3 * (high - low) * sin(0.07 * row);
        let found = inverse.step(wanted, &[], 0.02 * row).unwrap();
        let (from, to) = found.band.unwrap();
        assert!(from <= found.input && found.input <= to, "{from}, {}, {to}", found.input);
    }
    assert!(self::model("pnn").inverse().band(level).is_err());
}

#[test]
fn records_are_refused_with_the_row() {
    let model = model("xpnn ");
    let wanted = [100.0, f64::NAN];
    let time = [0.0, 1.0];
    let run = |wanted: &[f64], time: Option<&[f64]>| {
        let others: &[&[f64]] = &[];
        model.inverse().run(&Reference { wanted, others, time }).unwrap_err().to_string()
    };
    assert!(run(&wanted, Some(&time)).starts_with("row 2: "));
    assert!(run(&[100.0, 100.0], Some(&[0.0, 0.0])).starts_with("row 2: time"));
    assert!(run(&wanted, Some(&time[..1])).contains("1 values for 2"));
    assert!(run(&wanted, None).contains("no time stamps"));
    model.inverse().preview(-1.0).unwrap_err();
    model.inverse().preview(f64::NAN).unwrap_err();
}

/// Laws whose fits to these data are monotone.
const MONOTONE: &str = "prandtl-ishlinskii modified-prandtl-ishlinskii generalized-prandtl-ishlinskii masing \
    preisach jiles-atherton";

/// Where the diagnosis finds a model monotone, the inverse must find the inputs.
#[test]
fn models_judged_invertible_are_inverted() {
    const ROWS: usize = 1000;
    for (name, model) in MODELS.iter() {
        let found = ModelDiagnosis::of(model).unwrap().invertibility;
        let verdict = found.finding.verdict;
        if model.has_inertia() {
            assert_eq!(verdict, Verdict::NotTestable, "{name}");
            continue;
        }
        let (_, counts) = round_trip(model, ROWS);
        println!("{name}: {verdict}, index {:.1e}, {counts:?}", found.finding.index.unwrap());
        println!("    {}", found.finding.statement);
        let count = |reach: Reach| counts.get(reach.word()).copied().unwrap_or(0);
        let missed = count(Reach::NotMonotone) + count(Reach::Jump);
        assert!(verdict != Verdict::Yes || missed <= ROWS / 1000, "{name}: {counts:?}");
        assert!(missed == 0 || verdict == Verdict::No, "{name}: {counts:?}");
        if MONOTONE.split(' ').any(|monotone| name.split(' ').next() == Some(monotone)) {
            assert_eq!(verdict, Verdict::Yes, "{name}");
        }
    }
}

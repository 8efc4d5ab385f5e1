//! Hysteretic oscillators and state space models on data whose law is known, and the promises of every fit.

use crate::scaffold::*;
use hysid::Fit;
use hysid::law::hysteretic_oscillator::HystereticOscillator;
use hysid::law::hysteretic_state_space::HystereticStateSpace;
use hysid::specimens::{BoucWenOscillator, DuffingOscillator, PiezoStage};
use hysid_core::elementary::{exp, sin};

/// Rows a second, and steps of the integration in a row.
const RATE: f64 = 750.0;
const STEPS: usize = 8;

/// A number between 0 and 1 that `k` decides: the fractional parts of multiples of the golden ratio.
fn number(k: u64) -> f64 {
    (k as f64 * 0.618_033_988_749_895).fract()
}

/// A force of tones with random phases, in N, at time `t` in s.
fn force(seed: u64, t: f64) -> f64 {
    let phase = |k: u64| std::f64::consts::TAU * number(seed * 37 + k * k);
    (1..=12).map(|k| 20.0 * sin(std::f64::consts::TAU * 5.3 * k as f64 * t + phase(k))).sum()
}

/// A record of the oscillator of the benchmark, or of one without its hysteretic element.
fn record(seed: u64, rows: usize, is_linear: bool) -> Record {
    let step = 1.0 / (RATE * STEPS as f64);
    let mut oscillator = BoucWenOscillator::benchmark();
    if is_linear {
        oscillator.alpha = 0.0;
    }
    let forces: Vec<f64> = (0..rows * STEPS).map(|k| force(seed, k as f64 * step)).collect();
    let motion: Vec<f64> =
        oscillator.motion(forces.iter().copied(), step).map(|at| at.displacement).collect();
    let at_rows = |values: &[f64]| values.iter().copied().step_by(STEPS).collect::<Vec<f64>>();
    let time = (0..rows).map(|k| k as f64 / RATE).collect();
    Record::new("r", vec![at_rows(&forces)], at_rows(&motion)).unwrap().with_time(time).unwrap()
}

/// A mass of 2 kg on a spring and two deteriorating stops, by central differences in steps of 1/24000 s.
fn deteriorating_record(seed: u64, rows: usize) -> Record {
    let (mass, damping, stiffness) = (2.0, 10.0, 3e4);
    let mut stops = [(4e4, 4e-4), (3e4, 1.2e-3)]
        .map(|(stiffness, threshold)| (stiffness, DeterioratingStop::new(threshold, 60.0).unwrap()));
    let parts = 32;
    let step = 1.0 / (RATE * f64::from(parts));
    let (mut before, mut displacement) = (0.0, 0.0);
    let (mut forces, mut displacements) = (Vec::new(), Vec::new());
    for row in 0..rows {
        forces.push(force(seed, row as f64 / RATE));
        displacements.push(displacement);
        for part in 0..parts {
            let restoring: f64 = stops.iter_mut().map(|(k, stop)| *k * stop.step(displacement)).sum();
            let pushed = force(seed, (row as f64 + f64::from(part) / f64::from(parts)) / RATE);
            let inertia = mass / (step * step);
            let drag = damping / (2.0 * step);
            let next = (pushed - stiffness * displacement - restoring
                + inertia * (2.0 * displacement - before)
                + drag * before)
                / (inertia + drag);
            (before, displacement) = (displacement, next);
        }
    }
    let time = (0..rows).map(|k| k as f64 / RATE).collect();
    Record::new("r", vec![forces], displacements).unwrap().with_time(time).unwrap()
}

/// A Duffing oscillator whose force begins with a jump, with displacement noise of 1 % of the deviation.
fn record_without_hysteresis(seed: u64, rows: usize) -> Record {
    let rate = 610.0;
    let step = 1.0 / (rate * STEPS as f64);
    let forces: Vec<f64> = (0..2 * rows * STEPS).map(|half| force(seed, 0.5 * half as f64 * step)).collect();
    let motion: Vec<f64> =
        DuffingOscillator::designed().motion(&forces, step).map(|at| at.displacement).collect();
    let deviation = (motion.iter().map(|y| y * y).sum::<f64>() / motion.len() as f64).sqrt();
    let noise = |k: usize| 0.01 * deviation * 12f64.sqrt() * (number(k as u64 * 7919 + seed) - 0.5);
    let motion: Vec<f64> = motion.iter().enumerate().map(|(k, y)| y + noise(k)).collect();
    let every = |values: &[f64], steps: usize| values.iter().copied().step_by(steps).collect::<Vec<f64>>();
    let time = (0..rows).map(|k| k as f64 / rate).collect();
    let record = Record::new("r", vec![every(&forces, 2 * STEPS)], every(&motion, STEPS)).unwrap();
    record.with_time(time).unwrap()
}

fn data(records: Vec<Record>) -> Dataset {
    let names = ColumnNames { time: Some("t".into()), ..ColumnNames::plain(1) };
    Dataset::new(names, records).unwrap()
}

fn options(model: ClassicalModel) -> ClassicalOptions {
    ClassicalOptions { starts: Some(2), epochs: Some(100), hidden: Some(6), ..of(model) }
}

/// Error of a law on data, as a share of the standard deviation of their output.
fn error<L: Law>(law: &L, data: &Dataset) -> f64 {
    error_of(law, data, None) / 100.0
}

#[test]
fn the_bouc_wen_oscillator_is_identified_and_simulated_on_unseen_forces() {
    let (seen, unseen) = (data(vec![record(1, 1600, false)]), data(vec![record(2, 1000, false)]));
    let found =
        HystereticOscillator::fit(&seen, &options(ClassicalModel::HystereticOscillator), &mut go_on).unwrap();
    let of_oscillator = error(&found.law, &unseen);
    assert!(of_oscillator < 0.03, "{of_oscillator}");
    let all_starts = ClassicalOptions { starts: None, ..options(ClassicalModel::HystereticStateSpace) };
    let found = HystereticStateSpace::fit(&seen, &all_starts, &mut go_on).unwrap();
    let of_state_space = error(&found.law, &unseen);
    assert!(of_state_space < 0.15, "{of_state_space}");
}

#[test]
fn stops_that_deteriorate_are_identified() {
    let (seen, unseen) =
        (data(vec![deteriorating_record(1, 1500)]), data(vec![deteriorating_record(2, 1500)]));
    let fitted = |degradation: bool| {
        let few = ClassicalOptions {
            operators: Some(2),
            hidden: Some(1),
            states: Some(0),
            degradation,
            ..options(ClassicalModel::HystereticOscillator)
        };
        error(&HystereticOscillator::fit(&seen, &few, &mut go_on).unwrap().law, &unseen)
    };
    let (deteriorating, plain) = (fitted(true), fitted(false));
    assert!(deteriorating < 0.04 && deteriorating < 0.2 * plain, "{deteriorating} {plain}");
}

#[test]
fn the_parameters_of_a_linear_oscillator_are_found() {
    let seen = data(vec![record(3, 1200, true)]);
    let found =
        HystereticOscillator::fit(&seen, &options(ClassicalModel::HystereticOscillator), &mut go_on).unwrap();
    let unseen = error(&found.law, &data(vec![record(4, 1200, true)]));
    assert!(unseen < 2e-3, "{unseen}");
    // m = 2 kg and k = 5e4 N/m; the displacement under a unit force is 1/k. The element may take a share of k.
    let mode = found.law.0.modes[0];
    let gain = mode.gain * found.law.0.output_scale / found.law.0.input_scale;
    let mass = 1.0 / (gain * mode.frequency * mode.frequency);
    assert!((mass / 2.0 - 1.0).abs() < 0.01, "{mass}");
}

/// Neither a record cut out in mid-motion nor how it begins changes the oscillator that is found.
#[test]
fn a_record_in_mid_motion_does_not_change_the_oscillator() {
    let whole = record(3, 1500, true);
    let cut = |from: usize| {
        let inputs = vec![whole.inputs()[0][from..].to_vec()];
        let time = whole.time().unwrap()[from..].to_vec();
        Record::new("cut", inputs, whole.output()[from..].to_vec()).unwrap().with_time(time).unwrap()
    };
    let records = vec![record(5, 400, true), cut(700)];
    let linear = ClassicalOptions {
        hidden: Some(1),
        states: Some(0),
        ..options(ClassicalModel::HystereticOscillator)
    };
    let found = HystereticOscillator::fit(&data(records), &linear, &mut go_on).unwrap();
    let unseen = error(&found.law, &data(vec![record(4, 1200, true)]));
    assert!(unseen < 2e-3, "{unseen}");
}

/// A piezo stage has hysteresis at the input and one mode; a second mode in the model must do little harm.
#[test]
fn hysteresis_at_the_input_is_identified_with_a_mode_too_many() {
    let stage = |seed: u64, rows: usize| {
        let step = 2e-4;
        let voltage = |k: usize| {
            let t = k as f64 * step;
            let phase = |k: u64| std::f64::consts::TAU * number(seed * 37 + k * k);
            let tone = |k: u64, frequency: f64| sin(std::f64::consts::TAU * frequency * t + phase(k));
            let slow: f64 = (1..=5).map(|k| 8.0 * tone(k, 5.1 * k as f64)).sum();
            let fast: f64 = (6..=14).map(|k| 0.7 * tone(k, 31.3 * (k - 4) as f64)).sum();
            (1.0 - exp(-t / 0.01)) * (50.0 + slow + fast)
        };
        let volts: Vec<f64> = (0..rows).map(voltage).collect();
        let motion = PiezoStage::designed().motion(volts.iter().copied(), step, 4);
        let displacement = motion.map(|at| at.displacement).collect();
        let time = (0..rows).map(|k| k as f64 * step).collect();
        Record::new("stage", vec![volts], displacement).unwrap().with_time(time).unwrap()
    };
    let (seen, unseen) = (data(vec![stage(1, 2500)]), data(vec![stage(2, 2500)]));
    let asked =
        ClassicalOptions { modes: Some(2), starts: None, ..options(ClassicalModel::HystereticStateSpace) };
    let found = HystereticStateSpace::fit(&seen, &asked, &mut go_on).unwrap();
    let unseen = error(&found.law, &unseen);
    assert!(unseen < 0.02, "{unseen}");
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let without_time =
        Dataset::from_slices(&[0.0, 1.0, 0.5, 0.0, 1.0, 0.3], &[0.0, 0.5, 0.4, 0.1, 0.6, 0.2]).unwrap();
    let name = ModelName::Classical(ClassicalModel::HystereticOscillator);
    let refused = name.check_data(&without_time, None);
    assert_eq!(refused, Err(Error::TimeNeeded("hysteretic-oscillator")));
    for (change, words) in [
        ((|o: &mut ClassicalOptions| o.modes = Some(11)) as fn(&mut ClassicalOptions), "modes 11"),
        (|o| o.hidden = Some(61), "hidden 61"),
        (|o| o.states = Some(11), "states 11"),
        (|o| o.operators = Some(61), "operators 61"),
        (|o| (o.operators, o.degradation) = (Some(0), true), "nothing deteriorates"),
    ] {
        let mut wrong = options(ClassicalModel::HystereticOscillator);
        change(&mut wrong);
        let error = HystereticOscillator::fit(&data(vec![record(8, 100, true)]), &wrong, &mut go_on);
        let error = error.unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

/// Data that look like a resonance make `auto` try models with inertia, which win.
#[test]
fn auto_chooses_a_model_with_inertia_for_a_resonance() {
    let seen = data(vec![record(9, 1200, false)]);
    let quick = Fit::new().option("epochs", 12).option("members", 2).option("starts", 1).option("hidden", 4);
    let model = quick.run(&seen).unwrap();
    let unseen = data(vec![record(10, 600, false)]);
    let nrmse = model.evaluate(&unseen).unwrap().nrmse_std_percent.unwrap();
    assert!(nrmse < 15.0, "{nrmse}");
    let selection = model.provenance().selection.as_ref().unwrap();
    assert_eq!(selection.candidates.iter().find(|c| c.members > 0).unwrap().kind, "dynamic");
    // Its steps need a time, and time that advances.
    let mut stepper = model.stepper();
    let mut refused = |time: f64| stepper.step(&[0.0], time, None).map_err(|error| error.to_string());
    let missing = "the time of the sample is missing or not finite, and the model needs it";
    assert_eq!(refused(f64::NAN), Err(missing.into()));
    assert!(refused(0.5).is_ok());
    assert_eq!(refused(f64::INFINITY), Err(missing.into()));
    assert_eq!(refused(0.5), Err("time 0.5 does not come after the last sample's".into()));
}

/// A model with hysteresis fits these data too, but would have false loops beyond the training range.
#[test]
fn auto_leaves_out_hysteresis_that_the_data_do_not_have() {
    let seen = data(vec![record_without_hysteresis(1, 1000)]);
    let quick = Fit::new().option("epochs", 20).option("members", 2).option("starts", 1).option("hidden", 4);
    let model = quick.run(&seen).unwrap();
    let selection = model.provenance().selection.as_ref().unwrap();
    let kept: Vec<&str> = selection.candidates.iter().map(|candidate| candidate.name.as_str()).collect();
    assert_eq!(kept, ["hysteretic-state-space (no memory, 1 mode)"]);
    assert!(selection.dropped.contains(&"hysteretic-state-space (1 mode)".to_owned()), "{selection:?}");
}

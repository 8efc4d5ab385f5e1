//! Online use of measured outputs: against laws of known disturbance, gain and offset (theory.md (8.65) to (8.69)).

use hysid::error::SampleError;
use hysid::model::{ADAPTATION_ROWS, Stepper, Tracking};

use crate::scaffold::*;

const ROWS: usize = 6000;
/// Rows that a comparison leaves out: the memory fills.
const BEGINNING: usize = 1000;

fn plays() -> Model {
    let data = Dataset::new(ColumnNames::plain(1), vec![record(200, "a")]).unwrap();
    model_of(&data, &small(ModelName::Classical(ClassicalModel::PrandtlIshlinskii), None))
}

fn normal(generator: &mut Generator) -> f64 {
    (0..12).map(|_| between(generator, -0.5, 0.5)).sum()
}

/// A system whose output is made from that of its model.
struct Followed {
    /// Mean square deviation of the measured outputs from the model's and from the stepper's, after the beginning.
    raw: f64,
    corrected: f64,
    /// Mean of the states behind the beginning: decay and Kalman gain.
    decay: f64,
    kalman_gain: f64,
    last: Tracking,
}

/// Steps along a record, where `measured` makes the output of the system from that of the model.
fn follow(
    model: &Model,
    mut measured: impl FnMut(usize, f64) -> f64,
    take: impl Fn(&mut Stepper<'_>, f64),
) -> Followed {
    let path = record(ROWS, "path");
    let outputs = model.simulate(&path).unwrap();
    let mut stepper = model.stepper();
    let mut sums = [0.0; 4];
    for (row, &output) in outputs.iter().enumerate() {
        let corrected = stepper.step(&[path.inputs()[0][row]], 0.0, None).unwrap();
        let y = measured(row, output);
        take(&mut stepper, y);
        if row >= BEGINNING {
            let Tracking { decay, kalman_gain, .. } = stepper.tracking();
            let terms = [(y - output) * (y - output), (y - corrected) * (y - corrected), decay, kalman_gain];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term / (ROWS - BEGINNING) as f64);
        }
    }
    let [raw, corrected, decay, kalman_gain] = sums;
    Followed { raw, corrected, decay, kalman_gain, last: stepper.tracking() }
}

fn correct(stepper: &mut Stepper<'_>, y: f64) {
    stepper.correct(y).unwrap();
}

/// Gain and variance of the innovations of the Kalman filter of a scalar process, by iteration of its equations.
fn filter(decay: f64, process: f64, noise: f64) -> (f64, f64) {
    let mut variance = process;
    for _ in 0..100_000 {
        let gain = variance / (variance + noise);
        variance = decay * decay * (1.0 - gain) * variance + (1.0 - decay * decay) * process;
    }
    (variance / (variance + noise), variance + noise)
}

#[test]
fn the_filter_of_a_known_disturbance_is_found() {
    let model = plays();
    for (decay, process, noise) in [(0.95, 1.0, 0.5), (0.8, 1.0, 0.2), (0.98, 1.0, 0.5), (0.9, 1.0, 0.0)] {
        let (gain, least) = filter(decay, process, noise);
        let (mut sums, runs) = ([0.0; 4], 8);
        for seed in 0..runs {
            let mut generator = Generator::seed_from_u64(seed);
            let mut state = f64::sqrt(process) * normal(&mut generator);
            let renewed = f64::sqrt((1.0 - decay * decay) * process);
            let measured = |_, output| {
                state = decay * state + renewed * normal(&mut generator);
                output + 0.1 * (state + f64::sqrt(noise) * normal(&mut generator))
            };
            let found = follow(&model, measured, correct);
            let terms = [found.decay, found.kalman_gain, 100.0 * found.corrected, 100.0 * found.raw];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term / runs as f64);
        }
        let [found_decay, found_gain, corrected, raw] = sums;
        println!(
            "λ {decay} ({found_decay:.3}), K {gain:.3} ({found_gain:.3}), squares {least:.3} ({corrected:.3}, raw {raw:.3})"
        );
        assert!((found_decay - decay).abs() < 0.03, "{decay}: {found_decay}");
        assert!((found_gain - gain).abs() < 0.05, "{decay}: {found_gain}, not {gain}");
        assert!(corrected < 1.05 * least && corrected < 0.9 * raw, "{decay}: {corrected}, {least}, {raw}");
    }
}

#[test]
fn white_residuals_are_not_corrected() {
    let model = plays();
    for seed in 0..20 {
        let mut generator = Generator::seed_from_u64(seed);
        let found = follow(&model, |_, output| output + 0.1 * normal(&mut generator), correct);
        assert!(found.kalman_gain < 0.01, "seed {seed}: {}", found.kalman_gain);
        assert!(
            found.corrected < 1.02 * 1.02 * found.raw,
            "seed {seed}: {} of {}",
            found.corrected,
            found.raw
        );
    }
}

#[test]
fn rows_that_were_not_measured_break_pairs_only() {
    let model = plays();
    let measured = |period: usize| {
        let (mut generator, mut state) = (Generator::seed_from_u64(1), 0.0);
        move |row: usize, output: f64| {
            state = 0.95 * state + 0.03 * normal(&mut generator);
            if row.is_multiple_of(period) { f64::NAN } else { output + state }
        }
    };
    let take = |stepper: &mut Stepper<'_>, y: f64| {
        if !y.is_nan() {
            stepper.correct(y).unwrap();
        }
    };
    let found = follow(&model, measured(7), take);
    assert!((found.decay - 0.95).abs() < 0.03 && found.kalman_gain > 0.9, "{}", found.decay);
    // Without a pair of consecutive rows, nothing is corrected.
    assert_eq!(follow(&model, measured(2), take).last.kalman_gain, 0.0);
}

#[test]
fn absurd_measurements_give_finite_outputs() {
    let model = plays();
    let absurd: [fn(usize) -> f64; 4] = [
        |row| if row % 2 == 0 { 1e300 } else { -1e300 },
        |_| 1e300,
        |row| if row == 40 { f64::MAX } else { 20.0 },
        |row| 1e-300 * row as f64,
    ];
    for y in absurd {
        let found = follow(
            &model,
            |row, _| y(row),
            |stepper, y| {
                stepper.adapt(y, 10).unwrap();
                stepper.correct(y).unwrap();
                let Tracking { gain, offset, disturbance, decay, kalman_gain, residual, .. } =
                    stepper.tracking();
                assert!((0.5..=2.0).contains(&gain) && offset.is_finite() && disturbance.is_finite());
                assert!((0.0..1.0).contains(&decay) && (0.0..=1.0).contains(&kalman_gain));
                assert!(residual.unwrap().is_finite());
            },
        );
        assert!(!found.corrected.is_nan());
    }
}

#[test]
fn what_cannot_be_taken_changes_nothing() {
    let model = plays();
    let mut stepper = model.stepper();
    let not_committed = Err(Error::Sample(SampleError::NotCommitted));
    assert_eq!(stepper.correct(20.0), not_committed);
    stepper.step(&[0.1], 0.0, None).unwrap();
    stepper.correct(20.5).unwrap();
    stepper.adapt(20.5, 100).unwrap();
    let before = stepper.tracking();
    for y in [f64::NAN, f64::INFINITY] {
        assert!(matches!(stepper.correct(y), Err(Error::Sample(SampleError::Measured(_)))));
        assert!(matches!(stepper.adapt(y, 100), Err(Error::Sample(SampleError::Measured(_)))));
    }
    assert_eq!(stepper.adapt(20.0, 9), Err(Error::Sample(SampleError::AdaptationRows(9))));
    stepper.trial(&[0.2], 0.0, None).unwrap();
    assert_eq!(stepper.correct(20.0), not_committed);
    assert_eq!(stepper.tracking(), before);
    stepper.commit();
    stepper.correct(20.0).unwrap();
}

/// A stepper that has learned from outputs of a plant with a gain of 0.9 and a constant offset.
fn learned<'m>(model: &'m Model, path: &Record, rows: usize) -> Stepper<'m> {
    let mut stepper = model.stepper();
    for row in 0..rows {
        let output = step(&mut stepper, path, row);
        stepper.adapt(0.9 * output + 1.0, 100).unwrap();
        stepper.correct(0.9 * output + 1.0).unwrap();
    }
    stepper
}

fn step(stepper: &mut Stepper<'_>, path: &Record, row: usize) -> f64 {
    stepper.step(&[path.inputs()[0][row]], path.time().unwrap()[row], None).unwrap()
}

#[test]
fn every_model_steps_tries_and_begins_anew_as_it_is_corrected() {
    let data = Dataset::new(ColumnNames::plain(1), vec![record(200, "a"), record(150, "b")]).unwrap();
    let path = record(130, "path");
    for name in ModelName::all().chain([ModelName::AUTO]) {
        let request = small(name, Some(RateMethod::Backward));
        if name.check_data(&data, Some(RateMethod::Backward)).is_err() {
            continue;
        }
        let model = model_of(&data, &request);
        let plain: Vec<f64> = {
            let mut stepper = model.stepper();
            (0..path.len()).map(|row| step(&mut stepper, &path, row)).collect()
        };
        let mut stepper = learned(&model, &path, 120);
        let (state, tracking) = (stepper.snapshot(), stepper.tracking());
        assert!(tracking.disturbance != 0.0 && tracking.gain != 1.0, "{name:?}: {tracking:?}");
        let mut once = stepper.clone();
        let expected: Vec<f64> = (120..130).map(|row| step(&mut once, &path, row)).collect();
        assert_ne!(bits(&expected), bits(&plain[120..]), "{name:?}");
        for (row, y) in (120..).zip(&expected) {
            let (x, time) = ([path.inputs()[0][row]], path.time().unwrap()[row]);
            for _ in 0..3 {
                assert_eq!(stepper.trial(&x, time, None).unwrap().to_bits(), y.to_bits(), "{name:?}");
            }
            assert_eq!(stepper.trial_with_tangent(&x, time, None).unwrap().0.to_bits(), y.to_bits());
            stepper.commit();
        }
        stepper.restore(&state);
        assert_eq!(stepper.tracking(), tracking);
        assert_eq!(step(&mut stepper, &path, 120).to_bits(), expected[0].to_bits());
        for begin in [
            |stepper: &mut Stepper<'_>| stepper.reset(),
            |stepper: &mut Stepper<'_>| {
                stepper.reset_to(InitialState::Virgin).unwrap();
            },
        ] {
            begin(&mut stepper);
            let again: Vec<f64> = (0..path.len()).map(|row| step(&mut stepper, &path, row)).collect();
            assert_eq!(bits(&again), bits(&plain), "{name:?}");
            assert_eq!(stepper.tracking().residual, None);
        }
    }
}

#[test]
fn gain_and_offset_of_a_drifting_plant_are_followed() {
    let model = plays();
    let mut generator = Generator::seed_from_u64(3);
    // The output falls by 20 %: by more than its width, as it is about 20 everywhere.
    let (rows, slope, noise) = (200, 0.2 / ROWS as f64, 0.04);
    let measured = |row: usize, y: f64| (1.0 - slope * row as f64) * y + noise * normal(&mut generator);
    let found = follow(&model, measured, |stepper, y| stepper.adapt(y, rows).unwrap());
    // An exponential memory is behind a ramp by its length.
    let (gain, level) = (found.last.gain, 20.0 * found.last.gain + found.last.offset);
    let behind = slope * rows as f64;
    println!("{:?}: {} of {}", found.last, found.corrected.sqrt(), found.raw.sqrt());
    assert!((gain - 0.8 - behind).abs() < 0.01, "{gain}");
    assert!((level - 20.0 * (0.8 + behind)).abs() < 0.02, "{level}");
    let expected = noise * noise + (20.0 * behind) * (20.0 * behind);
    assert!((found.corrected - expected).abs() < 0.1 * expected, "{}, not {expected}", found.corrected);
}

#[test]
fn a_gain_that_is_not_excited_stays() {
    let model = plays();
    for x in [0.0, 0.9] {
        let (mut stepper, mut generator) = (model.stepper(), Generator::seed_from_u64(5));
        let mut residual = 0.0;
        for row in 0..50_000 {
            let output = stepper.step(&[x], 0.0, None).unwrap();
            let y = model.run(&[x]).unwrap()[0] + 0.3 + 0.1 * normal(&mut generator);
            residual = y - output;
            stepper.adapt(y, if row < 100 { 10 } else { ADAPTATION_ROWS }).unwrap();
        }
        let found = stepper.tracking();
        println!("{x}: {found:?}");
        assert!((found.gain - 1.0).abs() < 0.05 && residual.abs() < 0.5, "{x}: {found:?}");
    }
}

#[test]
fn a_wrong_memory_is_noticed_where_the_model_has_a_validation_error() {
    let data = Dataset::new(ColumnNames::plain(1), vec![record(200, "a"), record(150, "b")]).unwrap();
    let model = model_of(&data, &small(ModelName::AUTO, None));
    let expected = model.provenance().validation.as_ref().unwrap().rmse;
    for (error, fits) in [(0.5, true), (4.0, false)] {
        let mut stepper = model.stepper();
        for row in 0..150 {
            let y = stepper.step(&[0.5], row as f64, None).unwrap();
            stepper.correct(y + error * expected * if row % 2 == 0 { 1.0 } else { -1.0 }).unwrap();
            assert_eq!(stepper.tracking().memory_fits.is_some(), row >= 105, "row {row}");
        }
        assert_eq!(stepper.tracking().memory_fits, Some(fits));
    }
    assert_eq!(follow(&plays(), |_, output| output, correct).last.memory_fits, None);
}

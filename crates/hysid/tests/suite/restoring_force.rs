//! Restoring forces from measured motion and force: against closed forms, against integrated specimens, and as data for
//! the identification of a model.

use std::f64::consts::TAU;

use hysid::data::record::ColumnNames;
use hysid::restoring_force::{Acceleration, Motion, RestoringForce, restoring_force};
use hysid::specimens::{BoucWenOscillator, ShearBuilding};
use hysid::{Dataset, Error, Fit, Record};
use hysid_core::elementary::{cos, hypot, sin, square};

fn times(rows: usize, step: f64) -> Vec<f64> {
    (0..rows).map(|row| row as f64 * step).collect()
}

/// Largest error in percent of the largest exact value, over the rows with a force.
fn largest_error_percent(found: &[f64], exact: &[f64]) -> f64 {
    let largest = exact.iter().fold(0.0f64, |largest, r| largest.max(r.abs()));
    let errors = found.iter().zip(exact).filter(|(found, _)| !found.is_nan()).map(|(a, b)| (a - b).abs());
    100.0 * errors.fold(0.0, f64::max) / largest
}

fn rms_error(found: &[f64], exact: &[f64]) -> f64 {
    let squares: Vec<f64> =
        found.iter().zip(exact).filter(|(found, _)| !found.is_nan()).map(|(a, b)| square(a - b)).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// A motion in three tones and the force on 2 kg beside a spring of 500 N/m and a damper of 4 N s/m that causes it: time,
/// displacement, velocity, acceleration, applied force, restoring force.
fn linear(rows: usize, step: f64) -> [Vec<f64>; 6] {
    let (mass, stiffness, damping) = (2.0, 500.0, 4.0);
    let tones = [(0.02, 6.0), (0.012, 13.0), (0.004, 21.0)];
    let time = times(rows, step);
    let sum = |of: &dyn Fn(f64, f64, f64) -> f64| -> Vec<f64> {
        time.iter().map(|t| tones.iter().map(|&(size, pace)| of(size, pace, *t)).sum()).collect()
    };
    let y = sum(&|size, pace, t| size * sin(pace * t));
    let v = sum(&|size, pace, t| size * pace * cos(pace * t));
    let a = sum(&|size, pace, t| -size * pace * pace * sin(pace * t));
    let r: Vec<f64> = y.iter().zip(&v).map(|(y, v)| stiffness * y + damping * v).collect();
    let u = a.iter().zip(&r).map(|(a, r)| mass * a + r).collect();
    [time, y, v, a, u, r]
}

#[test]
fn a_spring_and_a_damper_have_their_closed_form() {
    let [time, y, v, a, u, r] = linear(2000, 0.005);
    let motion = Motion { time: &time, displacement: &y, applied_force: Some(&u), ..Motion::default() };
    let of = |motion: Motion<'_>| restoring_force(&[motion], 2.0, None).unwrap();
    // Measured accelerations give the force to rounding, relative and absolute alike.
    let ground: Vec<f64> = time.iter().map(|t| 3.0 * sin(5.0 * t)).collect();
    let absolute: Vec<f64> = a.iter().zip(&ground).map(|(a, ground)| a + ground).collect();
    let pushed: Vec<f64> = u.iter().zip(&ground).map(|(u, ground)| u + 2.0 * ground).collect();
    let relative = of(Motion { acceleration: Acceleration::Relative(&a), ..motion });
    let with_base = of(Motion {
        acceleration: Acceleration::Relative(&a),
        base_acceleration: Some(&ground),
        applied_force: Some(&pushed),
        ..motion
    });
    let with_absolute = of(Motion {
        acceleration: Acceleration::Absolute(&absolute),
        applied_force: Some(&pushed),
        ..motion
    });
    for found in [&relative, &with_base, &with_absolute] {
        assert!(largest_error_percent(&found.records[0].force, &r) < 1e-10);
        assert_eq!((found.acceleration_filter, found.smoothing), (None, 0.0));
        // The velocity comes from the displacement, up to the ends.
        assert!(largest_error_percent(&found.records[0].velocity, &v) < 1e-2);
    }
    // Computed ones to the bias of the filter.
    let from_displacement = of(motion);
    let from_velocity = of(Motion { velocity: Some(&v), ..motion });
    assert_eq!(from_velocity.records[0].velocity, v);
    for (found, bound) in [(&from_displacement, 2e-3), (&from_velocity, 1e-3)] {
        let error = largest_error_percent(&found.records[0].force, &r);
        assert!(error < bound, "{error}");
        let (filter, force) = (found.acceleration_filter.unwrap(), &found.records[0].force);
        let without = force.iter().filter(|force| force.is_nan()).count();
        assert_eq!(without, 2 * filter.on_a_side, "half a window at each end");
        assert!(force[filter.on_a_side].is_finite() && force[filter.on_a_side - 1].is_nan());
    }
}

#[test]
fn the_bias_has_the_order_of_the_polynomial() {
    // A quartic leaves the sixth derivative: halving the time step divides the error by 16.
    let error = |step: f64| {
        let [time, y, _, _, u, r] = linear((8.0 / step) as usize, step);
        let motion = Motion { time: &time, displacement: &y, applied_force: Some(&u), ..Motion::default() };
        let found = restoring_force(&[motion], 2.0, Some(9)).unwrap();
        assert_eq!(found.acceleration_filter.unwrap().degree, 4);
        rms_error(&found.records[0].force, &r)
    };
    let ratio = error(0.02) / error(0.01);
    assert!((ratio / 16.0 - 1.0).abs() < 0.1, "{ratio}");
}

#[test]
fn noise_is_told_and_a_record_may_have_blanks_and_uneven_time() {
    let [mut time, ..] = linear(3000, 0.005);
    time.iter_mut().enumerate().for_each(|(row, t)| *t += 0.0008 * sin(2.3 * row as f64));
    let (mass, stiffness) = (2.0, 500.0);
    let exact: Vec<f64> = time.iter().map(|t| stiffness * 0.02 * sin(9.0 * t)).collect();
    // Noise of 5e-5 m, from a generator of its own.
    let mut state = 1u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let noise: Vec<f64> = (0..time.len()).map(|_| 5e-5 * uniform() * 12f64.sqrt()).collect();
    let y: Vec<f64> = exact.iter().zip(&noise).map(|(r, noise)| r / stiffness + noise).collect();
    let mut u: Vec<f64> = exact.iter().map(|r| r - mass * 81.0 * r / stiffness).collect();
    u[1000] = f64::NAN;
    let motion = Motion { time: &time, displacement: &y, applied_force: Some(&u), ..Motion::default() };
    let found = restoring_force(&[motion], mass, None).unwrap();
    assert!(found.records[0].force[1000].is_nan() && found.records[0].force[999].is_finite());
    let error = rms_error(&found.records[0].force, &exact);
    let told = hypot(found.noise, found.smoothing);
    assert!((0.6..1.7).contains(&(told / error)), "{told} {error}");
    assert!(found.noise_percent().unwrap() < 5.0, "{:?}", found.noise_percent());
    // A short window lets more noise through, and says so.
    let short = restoring_force(&[motion], mass, Some(7)).unwrap();
    let error = rms_error(&short.records[0].force, &exact);
    assert!(
        short.noise > 3.0 * found.noise && (short.noise / error - 1.0).abs() < 0.2,
        "{} {error}",
        short.noise
    );
}

/// A random-phase multisine of force in N with frequencies in Hz up to 60, at these times in s.
fn multisine(seed: u64, size: f64, rows: usize, step: f64) -> Vec<f64> {
    let tone = |k: u64| {
        let phase = TAU * ((seed * 7919 + k * k * 104_729) % 1009) as f64 / 1009.0;
        move |t: f64| sin(TAU * (5.0 + 2.5 * k as f64) * t + phase)
    };
    let tones: Vec<_> = (0..22).map(tone).collect();
    let scale = size / 11f64.sqrt();
    (0..rows).map(|row| scale * tones.iter().map(|tone| tone(row as f64 * step)).sum::<f64>()).collect()
}

/// An oscillator sampled at 1500 Hz: time, displacement, force, and restoring force `k y + c y' + r`.
fn sampled(oscillator: BoucWenOscillator, seed: u64, size: f64) -> [Vec<f64>; 4] {
    const EVERY: usize = 10;
    let step = 1.0 / 15_000.0;
    let force = multisine(seed, size, 2000 * EVERY, step);
    let motion: Vec<_> = oscillator.motion(force.iter().copied(), step).step_by(EVERY).collect();
    let restoring = motion.iter().map(|at| {
        oscillator.stiffness * at.displacement + oscillator.damping * at.velocity + at.hysteretic_force
    });
    [
        times(motion.len(), step * EVERY as f64),
        motion.iter().map(|at| at.displacement).collect(),
        force.iter().step_by(EVERY).copied().collect(),
        restoring.collect(),
    ]
}

fn of_oscillator([time, y, u, _]: &[Vec<f64>; 4]) -> RestoringForce {
    let motion = Motion { time, displacement: y, applied_force: Some(u), ..Motion::default() };
    restoring_force(&[motion], BoucWenOscillator::benchmark().mass, None).unwrap()
}

#[test]
fn the_force_of_the_benchmark_is_found() {
    let exact = sampled(BoucWenOscillator::benchmark(), 1, 60.0);
    let found = of_oscillator(&exact);
    let error = 100.0 * rms_error(&found.records[0].force, &exact[3]) / found.deviation;
    // Measured: 0.28 %; its branches have kinks, which a filter rounds.
    assert!(error < 0.5, "{error}");
    let told = hypot(found.noise_percent().unwrap(), found.smoothing_percent().unwrap());
    assert!((0.7..1.4).contains(&(told / error)), "{told} {error}");
}

#[test]
fn a_model_of_the_force_has_the_error_of_the_law_on_unseen_motion() {
    // Without viscous damping, and softening: the Bouc-Wen law has the force exactly.
    let oscillator = BoucWenOscillator { damping: 0.0, delta: 0.2, ..BoucWenOscillator::benchmark() };
    let [train, test] = [(1, 60.0), (2, 55.0)].map(|(seed, size)| sampled(oscillator, seed, size));
    let data = |columns: &[Vec<f64>; 4], force: Vec<f64>| {
        let record = Record::new("r", vec![columns[1].clone()], force).unwrap();
        let names = ColumnNames::of(Some("t_s"), &["y_m"], "restoring_force_N");
        Dataset::new(names, vec![record.with_time(columns[0].clone()).unwrap()]).unwrap()
    };
    let found = of_oscillator(&train);
    let model = Fit::new().model("bouc-wen").run(&data(&train, found.records[0].force.clone())).unwrap();
    // The true force of the second record was not seen. Measured: 0.055 %.
    let unseen = model.evaluate(&data(&test, test[3].clone())).unwrap().nrmse_std_percent.unwrap();
    assert!(unseen < 0.2, "{unseen}");
}

#[test]
fn the_storey_of_a_shaken_building_has_the_force_of_its_law() {
    let building = ShearBuilding::designed();
    let step = 0.005;
    let ground: Vec<f64> = (0..4000)
        .map(|row| {
            let t = row as f64 * step;
            3.0 * sin(0.3 * t) * (sin(11.0 * t) + 0.6 * sin(17.0 * t + 1.0))
        })
        .collect();
    let motion: Vec<_> = building.motion(ground.iter().copied(), step, 10).collect();
    // The force of a storey by (6.46).
    let force = |storey: usize| -> Vec<f64> {
        let law = building.storeys[storey];
        let of = |at: &hysid::specimens::shear_building::BuildingMotion| {
            let (d, v, z) = (at.drift[storey], at.drift_rate[storey], at.hysteretic_displacement[storey]);
            let share = building.elastic_share;
            law.damping * v + law.stiffness * (share * d + (1.0 - share) * z)
        };
        motion.iter().map(of).collect()
    };
    let (lower, upper) = (force(0), force(1));
    // The base of the upper storey is the first floor.
    let floor: Vec<f64> =
        lower.iter().zip(&upper).map(|(lower, upper)| (upper - lower) / building.storeys[0].mass).collect();
    let drift: Vec<f64> = motion.iter().map(|at| at.drift[1]).collect();
    let time = times(motion.len(), step);
    let measured =
        Motion { time: &time, displacement: &drift, base_acceleration: Some(&floor), ..Motion::default() };
    let found = restoring_force(&[measured], building.storeys[1].mass, None).unwrap();
    let error = 100.0 * rms_error(&found.records[0].force, &upper) / found.deviation;
    // Measured: 0.02 %.
    assert!(error < 0.05, "{error}");
}

#[test]
fn what_has_no_restoring_force_is_refused() {
    let [time, y, _, _, u, _] = linear(100, 0.01);
    let motion = Motion { time: &time, displacement: &y, applied_force: Some(&u), ..Motion::default() };
    let refused = |motion: Motion<'_>, mass: f64, window: Option<usize>, expected: &str| {
        let error = restoring_force(&[motion], mass, window).unwrap_err().to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    };
    for mass in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused(motion, mass, None, "a number above 0 is needed");
    }
    refused(Motion { time: &time[..99], ..motion }, 1.0, None, "time: has 99 values where");
    let mut wrong = y.clone();
    wrong[7] = f64::NAN;
    refused(Motion { displacement: &wrong, ..motion }, 1.0, None, "record 1, row 8, displacement: NaN");
    wrong[7] = 1e200;
    refused(Motion { displacement: &wrong, ..motion }, 1.0, None, "too large");
    let blank = [f64::NAN; 100];
    refused(Motion { applied_force: Some(&blank), ..motion }, 1.0, None, "no row has all");
    let mut endless = u.clone();
    endless[3] = f64::INFINITY;
    refused(Motion { applied_force: Some(&endless), ..motion }, 1.0, None, "row 4, applied force: inf");
    assert_eq!(restoring_force(&[], 1.0, None).unwrap_err(), Error::NoRecords);
}

//! Plans of experiments: limits of the machine, what single amplitudes and single speeds leave out, and a lower error than
//! by repeating a test.

use crate::scaffold::*;
use hysid::diagnosis::Verdict;
use hysid::plan::{DrivePath, Leg, LimitOptions, Limits, Plan, PlanOptions, SegmentKind, Wave};
use hysid::specimens::Ferromagnet;
use hysid::{Fit, diagnose};
use hysid_core::elementary::{exp, sin};
use hysid_core::property::Property;
use proptest::prelude::*;

fn cycles(amplitude: f64, mean: f64, rows: usize, step: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let at = |row: usize, lag: f64| mean + amplitude * sin(0.12 * row as f64 - lag);
    let t: Vec<f64> = (0..rows).map(|row| row as f64 * step).collect();
    let x = (0..rows).map(|row| at(row, 0.0)).collect();
    let y = (0..rows).map(|row| at(row, 0.3)).collect();
    (t, x, y)
}

fn timed(amplitude: f64, mean: f64, rows: usize, step: f64) -> Dataset {
    let (t, x, y) = cycles(amplitude, mean, rows, step);
    Dataset::from_columns(Some(("t", &t)), &[("x", &x)], ("y", &y)).unwrap()
}

/// The whole contract of a drive.
fn keeps_its_limits(plan: &Plan) -> Result<(), TestCaseError> {
    let Limits { range: (low, high), start, step, max_rate, rows } = plan.limits;
    prop_assert!(plan.rows() <= rows, "{} rows of {rows}", plan.rows());
    prop_assert!(plan.input.iter().all(|x| (low..=high).contains(x)));
    prop_assert_eq!((plan.input[0], plan.input[plan.rows() - 1]), (start, start));
    let longest = max_rate * step.unwrap_or(1.0);
    let largest = plan.input.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    prop_assert!(largest <= longest * (1.0 + 1e-9), "{largest} of {longest}");
    prop_assert_eq!(plan.time.is_some(), step.is_some());
    if let (Some(time), Some(step)) = (&plan.time, step) {
        prop_assert!(time.iter().enumerate().all(|(row, t)| *t == row as f64 * step));
    }
    let mut next = 1;
    for segment in &plan.segments {
        prop_assert_eq!(segment.rows.start, next);
        next = segment.rows.end;
        prop_assert!(!segment.reason.is_empty());
    }
    prop_assert_eq!(next, plan.rows());
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn a_drive_keeps_the_limits_of_the_machine(
        amplitude in 1e-3..1e4_f64, mean in -3.0..3.0_f64, rows in 80_usize..900, step in 1e-5..10.0_f64,
        has_time: bool, is_smooth: bool, wider in 0.5..2.0_f64, slower in 0.5..3.0_f64, seed: u64,
        length in proptest::option::of(200_usize..1500),
    ) {
        let (t, x, y) = cycles(amplitude, mean * amplitude, rows, step);
        let time = has_time.then_some(("t", &t[..]));
        let data = Dataset::from_columns(time, &[("x", &x)], ("y", &y)).unwrap();
        let (low, high) = data.input_range(0);
        let middle = 0.5 * (low + high);
        let limits = LimitOptions {
            range: Some((middle - wider * (middle - low), middle + wider * (high - middle))),
            max_rate: Some(0.12 * amplitude / if has_time { step } else { 1.0 } / slower),
            length,
            step: None,
        };
        let wave = Some(if is_smooth { Wave::Smooth } else { Wave::Triangle });
        match Plan::of(&data, &PlanOptions { limits, wave, seed }) {
            Ok(plan) => keeps_its_limits(&plan)?,
            // Only a length too short for the rate may be refused.
            Err(error) => prop_assert!(error.to_string().contains("too few"), "{error}"),
        }
    }
}

/// Without other wishes, range, start, step and rate are those of the data, and the plan is no longer than they are.
#[test]
fn the_limits_of_the_data_are_kept() {
    let data = timed(2.0, 5.0, 600, 0.01);
    let plan = Plan::of(&data, &PlanOptions::default()).unwrap();
    keeps_its_limits(&plan).unwrap();
    assert_eq!(plan.limits.range, data.input_range(0));
    assert!(plan.limits.max_rate <= 2.0 * 0.12 / 0.01 && plan.rows() > 550);
}

#[test]
fn after_cycles_of_one_amplitude_smaller_ones_are_run() {
    let plan = Plan::of(&timed(1.0, 0.0, 600, 0.1), &PlanOptions::default()).unwrap();
    let swings: Vec<f64> = plan
        .segments
        .iter()
        .filter(|segment| segment.kind != SegmentKind::Return)
        .flat_map(|segment| segment.turning_points.windows(2).map(|pair| (pair[1] - pair[0]).abs()))
        .collect();
    let between = |low: f64, high: f64| swings.iter().any(|swing| (low..high).contains(swing));
    assert!(between(0.1, 0.7) && between(0.7, 1.4), "{swings:?}");
    assert!(plan.gaps.iter().any(|gap| gap.what == "amplitudes"));
    // Away from the middle too.
    let middles: Vec<f64> = plan
        .segments
        .iter()
        .flat_map(|segment| segment.turning_points.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])))
        .collect();
    assert!(middles.iter().any(|middle| middle.abs() > 0.2), "{middles:?}");
}

/// All amplitudes at one speed: the data cannot test the rate, and the plan runs several speeds.
#[test]
fn after_tests_at_one_speed_several_are_run() {
    let (mut x, mut to) = (vec![0.0], Vec::new());
    for amplitude in 1..=8 {
        to.extend([0.125 * f64::from(amplitude), -0.125 * f64::from(amplitude)]);
    }
    for end in to {
        let from: f64 = x[x.len() - 1];
        let rows = ((end - from).abs() / 0.015).ceil() as usize;
        x.extend((1..=rows).map(|row| from + (end - from) * row as f64 / rows as f64));
    }
    let data = spring_and_slider(&x, 0.1);
    let rate = |data: &Dataset| diagnose(data).unwrap().verdict(Property::RateDependence);
    assert_eq!(rate(&data), Verdict::NotTestable);
    let limits = LimitOptions { length: Some(2400), ..LimitOptions::default() };
    let plan = Plan::of(&data, &PlanOptions { limits, ..PlanOptions::default() }).unwrap();
    assert!(plan.gaps.iter().any(|gap| gap.what == "speeds" || gap.what == "rate-dependence"));
    // The longest step of each random swing.
    let random = plan.segments.iter().find(|segment| segment.kind == SegmentKind::RandomReversals).unwrap();
    let steps: Vec<f64> =
        plan.input[random.rows.clone()].windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let mut speeds: Vec<f64> =
        steps.chunks(40).map(|some| some.iter().copied().fold(0.0, f64::max)).collect();
    speeds.sort_unstable_by(f64::total_cmp);
    assert!(speeds[speeds.len() - 1] > 1.7 * speeds[0], "{speeds:?}");
    assert!(plan.segments.iter().any(|segment| segment.kind == SegmentKind::TwoSpeeds));
    // What the plan is for: now the property can be tested, and the law has none.
    assert_eq!(rate(&spring_and_slider(&plan.input, 0.1)), Verdict::No);
}

/// A spring beside a friction slider: the speed makes no difference.
fn spring_and_slider(x: &[f64], step: f64) -> Dataset {
    let slider = Stop::new(0.2).unwrap().run(x);
    let y: Vec<f64> = x.iter().zip(slider).map(|(x, slider)| slider + 0.1 * x).collect();
    let t: Vec<f64> = (0..x.len()).map(|row| step * row as f64).collect();
    Dataset::from_columns(Some(("t", &t)), &[("x", x)], ("y", &y)).unwrap()
}

#[test]
fn data_that_cannot_be_planned_from_are_refused_in_one_line() {
    let refused = |x: &[f64], y: &[f64]| {
        let data = Dataset::from_slices(x, y).unwrap();
        let error = Plan::of(&data, &PlanOptions::default()).unwrap_err().to_string();
        assert!(!error.contains('\n') && !error.is_empty());
        error
    };
    let rows: Vec<f64> = (0..100).map(f64::from).collect();
    refused(&[3.0; 100], &rows);
    refused(&rows, &[3.0; 100]);
    refused(&[1.0], &[2.0]);
    refused(&rows, &[f64::NAN; 100]);
    // Gaps of the output are none of the input's concern; neither are huge values.
    let (t, x, mut y) = cycles(1e90, 0.0, 400, 1.0);
    y[100..180].fill(f64::NAN);
    let data = Dataset::from_columns(Some(("t", &t)), &[("x", &x)], ("y", &y)).unwrap();
    keeps_its_limits(&Plan::of(&data, &PlanOptions::default()).unwrap()).unwrap();
    // A small swing far from 0.
    let data = timed(1e-3, 1e3, 400, 0.1);
    keeps_its_limits(&Plan::of(&data, &PlanOptions::default()).unwrap()).unwrap();
}

#[test]
fn a_seed_determines_the_plan() {
    let data = timed(1.0, 0.0, 400, 0.1);
    let of_seed = |seed| Plan::of(&data, &PlanOptions { seed, ..PlanOptions::default() }).unwrap();
    assert!(of_seed(1) == of_seed(1) && of_seed(1) != of_seed(2));
}

/// Large swings may damage a specimen that deteriorates, so that they come last.
#[test]
fn swings_of_a_specimen_that_deteriorates_grow() {
    let (t, x, mut y) = cycles(10.0, 0.0, 600, 0.1);
    y.iter_mut().enumerate().for_each(|(row, y)| *y *= exp(-0.003 * row as f64));
    let data = Dataset::from_columns(Some(("t", &t)), &[("x", &x)], ("y", &y)).unwrap();
    assert_eq!(diagnose(&data).unwrap().verdict(Property::Deterioration), Verdict::Yes);
    let plan = Plan::of(&data, &PlanOptions::default()).unwrap();
    let largest = |rows: &[f64]| rows.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let random = plan.segments.iter().find(|segment| segment.kind == SegmentKind::RandomReversals).unwrap();
    assert!(largest(&plan.input[..300]) < 0.9 * largest(&plan.input), "{random:?}");
    assert!(random.amplitude > 8.0, "{random:?}");
}

/// A steel after cycles over its range: error of a Preisach model after the same cycles again, and after the plan.
fn errors_after_cycles() -> (f64, f64) {
    let (low, high) = (-300.0, 300.0);
    let limits =
        Limits { range: (low, high), start: 0.0, step: None, max_rate: (high - low) / 50.0, rows: 500 };
    let path = DrivePath { limits, wave: Wave::Triangle };
    let through = |turns: &[f64]| {
        let mut x = vec![0.0];
        for &to in turns {
            x.extend(path.leg(x[x.len() - 1], Leg::Swing { to, speed: 1.0 }));
        }
        x
    };
    let first = through(&[high, low, high, low, high, low, high, low, high]);
    let golden = |k: usize| low + (high - low) * (k as f64 * 0.618_033_988_749_895).fract();
    let unseen = through(&(1..40).map(golden).collect::<Vec<_>>());
    let run =
        |name: &str, x: &[f64]| Record::new(name, vec![x.to_vec()], Ferromagnet::m330_50a().run(x)).unwrap();
    let data = |records: Vec<Record>| Dataset::new(ColumnNames::plain(1), records).unwrap();
    let measured = |name: &str, x: &[f64], seed| {
        with_noise(&data(vec![run(name, x)]), 1.0, seed).unwrap().records()[0].clone()
    };
    let unseen = data(vec![run("unseen", &unseen)]);
    let one = measured("first", &first, 1);
    let plan = Plan::of(&data(vec![one.clone()]), &PlanOptions::default()).unwrap();
    assert!(plan.rows() <= first.len());
    let error = |x: &[f64], seed| {
        let data = data(vec![one.clone(), measured("second", x, seed)]);
        let model = Fit::new().model("preisach").run(&data).unwrap();
        model.evaluate(&unseen).unwrap().nrmse_std_percent.unwrap()
    };
    (error(&first, 2), error(&plan.input, 3))
}

#[test]
fn a_plan_lowers_the_unseen_error_more_than_the_same_test_again() {
    let (repeated, planned) = errors_after_cycles();
    assert!(repeated > 1.5 * planned, "repeated {repeated}, planned {planned}");
}

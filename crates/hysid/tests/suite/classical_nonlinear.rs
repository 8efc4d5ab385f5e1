//! The classical models that are fitted by search: regression values of independent implementations,
//! the properties that each must and must not have, and recovery of their own outputs.

use crate::scaffold::*;
use std::f64::consts::TAU;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use hysid::law::bouc_wen::{BoucWen, Degradation};
use hysid::law::generalized_prandtl_ishlinskii::{Envelope, GeneralizedPrandtlIshlinskii, PlayWeights};
use hysid::law::jiles_atherton::{JilesAtherton, JilesAthertonForm};
use hysid::law::neuro_madelung::NeuroMadelung;
use hysid::law::rate_dependent_prandtl_ishlinskii::{RateDependentPrandtlIshlinskii, Thresholds};
use hysid::law::series::run;
use hysid_core::elementary::{cos, exp, powf, sin};

fn shape_memory_actuator() -> GeneralizedPrandtlIshlinskii {
    GeneralizedPrandtlIshlinskii {
        offset: 17.72,
        left: Envelope::new([0.8380, 6.4364, -9.9631, 0.5618]),
        right: Envelope::new([15.7940, 2.7649, -5.6356, 15.5400]),
        initial: 1e6,
        spacing: 0.0395,
        weights: PlayWeights::Exponential { plays: 21, rho: 10.9590, tau: 2.5785 },
    }
}

fn terfenol_actuator() -> GeneralizedPrandtlIshlinskii {
    GeneralizedPrandtlIshlinskii {
        offset: 24.0,
        left: Envelope::new([4.0, 1.35, -0.35, 0.0]),
        right: Envelope::new([4.0, 1.25, 0.05, 0.15]),
        initial: 0.0,
        spacing: 0.25,
        weights: PlayWeights::Exponential { plays: 11, rho: 2.4, tau: 0.55 },
    }
}

fn rate_dependent_actuator() -> RateDependentPrandtlIshlinskii {
    RateDependentPrandtlIshlinskii {
        offset: 0.0,
        spring: 0.5,
        spacing: 0.6,
        thresholds: Thresholds::Linear { beta: 2e-3 },
        weights: PlayWeights::Exponential { plays: 10, rho: 0.4, tau: 0.2 },
    }
}

fn bouc_wen(n: f64) -> BoucWen {
    BoucWen { b: 0.6, n, ..BoucWen::new(2.0, 30.0, 1.5).unwrap() }
}

fn degrading_bouc_wen() -> BoucWen {
    let degradation = Degradation::from_values([1e-4, 0.01, 0.02, 0.8, 0.05, 0.1, 0.2, 0.001, 0.4]);
    BoucWen { degradation: Some(degradation), ..bouc_wen(1.3) }
}

/// The set of JAmodel's demonstration: M_s = 1.6e6 A/m, a = 1100, k = 400, alpha = 1.6e-3, c = 0.2.
fn jiles_atherton(form: JilesAthertonForm) -> JilesAtherton {
    JilesAtherton {
        offset: 0.0,
        permeability: 0.0,
        saturation: 1.6e6,
        a: 1100.0,
        k: 400.0,
        alpha: 1.6e-3,
        c: 0.2,
        form,
    }
}

fn neuro_madelung(rate_scale: Option<f64>) -> NeuroMadelung {
    let inputs = if rate_scale.is_some() { 4 } else { 3 };
    NeuroMadelung {
        input_scale: 2.0,
        rate_scale,
        output_mean: 1.0,
        output_scale: 3.0,
        output_range: (-5.0, 7.0),
        hidden: (0..4 * (1 + inputs)).map(|k| sin(1.7 * k as f64)).collect(),
        output: vec![0.9, 0.2, -0.3, 0.25, 0.15],
        virgin_output: 0.1,
    }
}

fn sine(frequency: f64, amplitude: f64, samples: usize, periods: usize) -> Vec<Sample> {
    let sample = |k: usize| {
        let angle = TAU * k as f64 / samples as f64;
        let rate = amplitude * TAU * frequency * cos(angle);
        let step = if k == 0 { 0.0 } else { 1.0 / (frequency * samples as f64) };
        Sample { x: amplitude * sin(angle), rate, step }
    };
    (0..=periods * samples).map(sample).collect()
}

fn last_area(samples: &[Sample], y: &[f64], period: usize) -> f64 {
    let first = samples.len() - 1 - period;
    let rows = first..samples.len() - 1;
    rows.map(|k| 0.5 * (y[k] + y[k + 1]) * (samples[k + 1].x - samples[k].x)).sum::<f64>().abs()
}

/// Values of an independent implementation in numpy: area, output at rising zero, largest output.
#[test]
fn rate_dependent_plays_have_their_regression_values() {
    let expected =
        [(1.0, 155.97, -5.857), (10.0, 212.91, -7.915), (50.0, 407.69, -14.621), (100.0, 528.48, -15.961)];
    for (frequency, area, rising_at_zero) in expected {
        let samples = sine(frequency, 10.0, 4000, 3);
        let y = run(&rate_dependent_actuator(), &samples);
        assert_abs_diff_eq!(last_area(&samples, &y, 4000), area, epsilon = 0.006);
        assert_abs_diff_eq!(y[8000], rising_at_zero, epsilon = 5.1e-4);
        let highest = y[8000..].iter().fold(0.0, |highest: f64, y| highest.max(*y));
        assert_abs_diff_eq!(highest, 20.9607, epsilon = 5.1e-5);
    }
}

/// Coercivity in A/m, remanence and tip over the saturation, computed independently in numpy.
#[test]
fn jiles_atherton_has_its_regression_values() {
    let expected = [
        (JilesAthertonForm::Original, 392.82, 0.35576, 0.85828),
        (JilesAthertonForm::Differential, 314.2, 0.3103, 0.8601),
    ];
    for (form, coercivity, remanence, tip) in expected {
        let law = jiles_atherton(form);
        let h = through(&[0.0, 6000.0, -6000.0, 6000.0, 0.0, -6000.0], 6000);
        let m = outputs(&law, &h);
        assert_abs_diff_eq!(m[18_000] / law.saturation, tip, epsilon = 1e-4);
        assert_abs_diff_eq!(m[24_000] / law.saturation, remanence, epsilon = 1e-4);
        let crossing = (24_000..30_000).find(|&k| m[k] > 0.0 && m[k + 1] <= 0.0).unwrap();
        let found =
            -h[crossing] + (h[crossing] - h[crossing + 1]) * m[crossing] / (m[crossing] - m[crossing + 1]);
        assert_abs_diff_eq!(found, coercivity, epsilon = 0.15);
    }
}

/// theory.md (8.7) against the integration just beside n = 1, and the yield force.
#[test]
fn the_closed_form_of_bouc_wen_continues_the_integrated_one() {
    let path = through(&[0.0, 4.0, -2.0, 3.0, -6.0, 0.5], 50);
    for b in [0.05, 0.5, 0.6, 2.5] {
        let exact = outputs(&BoucWen { b, ..bouc_wen(1.0) }, &path);
        let integrated = outputs(&BoucWen { b, ..bouc_wen(1.0 + 1e-9) }, &path);
        for (exact, integrated) in exact.iter().zip(&integrated) {
            assert_relative_eq!(*exact, *integrated, epsilon = 5e-4);
        }
    }
    let law = bouc_wen(1.0);
    assert_relative_eq!(last(&law, &[100.0]), 2.0 * 100.0 + 30.0 * 1.5, epsilon = 1e-9);
    let virgin = 1.5 * (1.0 - exp(-0.7_f64 / 1.5));
    assert_relative_eq!(last(&law, &[0.7]), 2.0 * 0.7 + 30.0 * virgin, epsilon = 1e-12);
}

#[test]
fn laws_that_are_integrated_do_not_depend_on_the_sampling() {
    let turning = [0.0, 3.0, -2.0, 5.0, -6.0, 1.0, -1.5, 8.0, 0.0];
    let (coarse, fine) = (through(&turning, 1), through(&turning, 211));
    let mut worst = [0.0_f64; 5];
    let differences = |a: Vec<f64>, b: Vec<f64>, scale: f64| {
        (0..a.len()).map(|k| (a[k] - b[211 * k]).abs() / scale).fold(0.0, f64::max)
    };
    for (index, law) in [bouc_wen(1.0), bouc_wen(1.4), bouc_wen(4.0), degrading_bouc_wen()].iter().enumerate()
    {
        worst[index] = differences(outputs(law, &coarse), outputs(law, &fine), 45.0);
    }
    for form in [JilesAthertonForm::Original, JilesAthertonForm::Differential] {
        let law = jiles_atherton(form);
        let scaled = |x: &[f64]| outputs(&law, &x.iter().map(|x| 500.0 * x).collect::<Vec<_>>());
        worst[4] = worst[4].max(differences(scaled(&coarse), scaled(&fine), 1.6e6));
    }
    assert!(worst[0] < 1e-12 && worst[1..].iter().all(|worst| *worst < 2e-4), "{worst:?}");
}

/// theory.md (8.6), (8.8) to (8.11) by Euler's method of second order in steps of 1/1000 yield displacement.
fn degraded_by_small_steps(law: &BoucWen, path: &[f64]) -> Vec<f64> {
    let d = law.degradation.unwrap();
    let slope = |z: f64, e: f64, direction: f64| {
        let (a, nu, eta) = ((1.0 - d.delta_a * e).max(0.0), 1.0 + d.delta_nu * e, 1.0 + d.delta_eta * e);
        let zeta_1 = d.zeta_s * (1.0 - exp(-d.p * e));
        let zeta_2 = (d.psi_0 + d.delta_psi * e) * (d.lambda + zeta_1);
        let distance = (z * direction - d.q * powf(nu, -1.0 / law.n)) / zeta_2;
        let h = 1.0 - zeta_1 * exp(-distance * distance);
        let share = 1.0 - law.b + law.b * (z * direction).signum();
        h / eta * (a - nu * powf(z.abs(), law.n) * share)
    };
    let (mut x, mut z, mut e) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut outputs = Vec::new();
    for &to in path {
        let by = (to - x) / law.yield_displacement;
        let direction = by.signum();
        let steps = (by.abs() / 1e-3).ceil().max(1.0);
        let h = by / steps;
        for _ in 0..steps as usize {
            let (z_middle, e_middle) = (z + 0.5 * h * slope(z, e, direction), e + 0.5 * h * z);
            (z, e) = (z + h * slope(z_middle, e_middle, direction), e + h * z_middle);
        }
        x = to;
        outputs.push(z);
    }
    outputs
}

#[test]
fn degradation_is_that_of_small_steps() {
    let mut generator = Generator::seed_from_u64(3);
    let mut worst: Vec<f64> = Vec::new();
    for _ in 0..200 {
        let mut log = |low: f64, high: f64| low * powf(high / low, generator.random::<f64>());
        let values = [
            log(1e-5, 1e-3),
            log(1e-4, 0.1),
            log(1e-4, 0.1),
            log(0.1, 0.95),
            log(0.01, 3.0),
            log(0.05, 0.5),
            log(0.1, 1.0),
            log(1e-4, 0.05),
            log(0.1, 1.0),
        ];
        let law = BoucWen {
            offset: 0.0,
            elastic_stiffness: 0.0,
            hysteretic_stiffness: 1.0,
            yield_displacement: 1.0,
            b: log(0.3, 1.2),
            n: log(1.0, 6.0),
            degradation: Some(Degradation::from_values(values)),
            ..bouc_wen(1.0)
        };
        let path = through(&[0.0, 4.0, -9.0, 17.0, -25.0, 30.0, 3.0, 8.0, -40.0], 1);
        let (fast, slow) = (outputs(&law, &path), degraded_by_small_steps(&law, &path));
        worst.push(fast.iter().zip(&slow).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max));
    }
    worst.sort_by(f64::total_cmp);
    assert!(worst[100] < 2e-4 && worst[199] < 2e-3, "{:?}", &worst[95..]);
}

#[test]
fn damping_is_the_only_share_of_the_rate() {
    let law = BoucWen { damping: 0.25, ..bouc_wen(1.4) };
    let samples = sine(3.0, 4.0, 200, 1);
    let (with, without) = (run(&law, &samples), run(&bouc_wen(1.4), &samples));
    for ((with, without), sample) in with.iter().zip(&without).zip(&samples) {
        assert_relative_eq!(with - without, 0.25 * sample.rate, epsilon = 1e-9);
    }
}

#[test]
fn the_output_of_neuro_madelung_is_continuous_at_reversals() {
    let law = neuro_madelung(None);
    let turning = [0.0, 1.8, -0.7, 1.1, -0.2, 0.6, 0.1];
    let y = outputs(&law, &through(&turning, 20_000));
    let largest = y.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    assert!(largest < 2e-3, "{largest}");
}

#[test]
fn free_runs_stay_finite_whatever_the_parameters_and_the_input() {
    let wild: Vec<Sample> =
        [0.0, 1e-300, 3.0, 1e100, -1e100, 5.0, 4.999999, -1e50, 0.1, 0.1, -0.2, 1e9, -7.0]
            .iter()
            .map(|&x| Sample { x, rate: 1e50 * x / (1.0 + f64::abs(x)), step: 1e-3 })
            .collect();
    fn check<L: Law + std::fmt::Debug>(law: hysid::Result<L>, wild: &[Sample]) {
        let law = law.unwrap();
        assert!(run(&law, wild).iter().all(|y| y.is_finite()), "{law:?}");
        let mut state = law.virgin();
        for k in 0..50 {
            let x = 20.0 * sin(0.37 * f64::from(k));
            let y = law.step(&mut state, Sample { x, rate: 0.0, step: 0.0 });
            assert!(y.is_finite(), "{law:?}");
        }
    }
    for seed in 0..20 {
        let mut generator = Generator::seed_from_u64(seed);
        let mut extreme = |low: f64, high: f64| if generator.random::<f64>() < 0.5 { low } else { high };
        let degradation = Degradation {
            delta_a: extreme(0.0, 1.0),
            delta_nu: extreme(0.0, 10.0),
            delta_eta: extreme(0.0, 10.0),
            zeta_s: extreme(0.0, 0.99),
            p: extreme(0.0, 100.0),
            q: extreme(-1.0, 1.0),
            psi_0: extreme(0.01, 10.0),
            delta_psi: extreme(0.0, 1.0),
            lambda: extreme(0.01, 10.0),
        };
        let element = BoucWen {
            b: extreme(0.05, 3.0),
            n: extreme(1.0, 10.0),
            damping: 1.0,
            degradation: Some(degradation),
            ..BoucWen::new(1.0, -5.0, extreme(1e-3, 1e6)).unwrap()
        };
        check(element.validated(), &wild);
        check(BoucWen { degradation: None, ..element }.validated(), &wild);
        let a = extreme(1e-3, 1e3);
        let form = if extreme(0.0, 1.0) > 0.5 {
            JilesAthertonForm::Original
        } else {
            JilesAthertonForm::Differential
        };
        let material = JilesAtherton {
            a,
            k: extreme(1e-3, 1e3),
            alpha: extreme(0.0, 3.0 * a) / 1.6e6,
            c: extreme(0.0, 0.99),
            ..jiles_atherton(form)
        };
        check(material.validated(), &wild);
        // Quotients of numbers that are no measured quantity would be no numbers.
        assert!(JilesAtherton { k: 1e-310, ..material }.validated().is_err());
        assert!(JilesAtherton { a: 5e-324, alpha: 0.0, ..material }.validated().is_err());
        let mut envelope =
            || Envelope::new([extreme(0.0, 1e6), extreme(0.0, 1e6), extreme(-9.0, 9.0), extreme(-1e6, 1e6)]);
        let (left, right) = (envelope(), envelope());
        let plays =
            GeneralizedPrandtlIshlinskii { left, right, initial: extreme(0.0, 1e100), ..terfenol_actuator() };
        check(plays.validated(), &wild);
        let thresholds = Thresholds::Logarithmic {
            beta: extreme(1e-6, 1e6),
            lambda: extreme(0.0, 1e6),
            epsilon: extreme(0.0, 2.0),
        };
        check(RateDependentPrandtlIshlinskii { thresholds, ..rate_dependent_actuator() }.validated(), &wild);
        let network = NeuroMadelung {
            hidden: (0..20).map(|_| extreme(-1e6, 1e6)).collect(),
            output: (0..5).map(|_| extreme(-1e6, 1e6)).collect(),
            ..neuro_madelung(Some(1.0))
        };
        check(network.validated(), &wild);
    }
}

#[test]
fn parameters_out_of_bounds_are_refused() {
    assert!(BoucWen::new(1.0, 1.0, 0.0).is_err());
    assert!(BoucWen { n: 0.5, ..bouc_wen(1.0) }.validated().is_err());
    assert!(BoucWen { b: f64::NAN, ..bouc_wen(1.0) }.validated().is_err());
    let material = jiles_atherton(JilesAthertonForm::Original);
    assert!(JilesAtherton { alpha: 4.0 * material.a / material.saturation, ..material }.validated().is_err());
    assert!(JilesAtherton { k: 0.0, ..material }.validated().is_err());
    let growing = PlayWeights::Exponential { plays: 900, rho: 1.0, tau: -10.0 };
    assert!(GeneralizedPrandtlIshlinskii { weights: growing, ..terfenol_actuator() }.validated().is_err());
    let none = PlayWeights::Free(Vec::new());
    assert!(
        RateDependentPrandtlIshlinskii { weights: none, ..rate_dependent_actuator() }.validated().is_err()
    );
    assert!(NeuroMadelung { hidden: vec![1.0; 7], ..neuro_madelung(None) }.validated().is_err());
    assert!(neuro_madelung(None).validated().is_ok());
}

fn record(name: &str, samples: &[Sample], y: Vec<f64>) -> Record {
    let x = samples.iter().map(|sample| sample.x).collect();
    let record = Record::new(name, vec![x], y).unwrap();
    if samples.iter().all(|sample| sample.step == 0.0) {
        return record;
    }
    let time = samples.iter().scan(0.0, |time, sample| {
        *time += sample.step;
        Some(*time)
    });
    let rate = samples.iter().map(|sample| sample.rate).collect();
    record.with_time(time.collect()).unwrap().with_given_rate(rate).unwrap()
}

fn data<L: Law>(law: &L, runs: &[Vec<Sample>]) -> Dataset {
    let records =
        runs.iter().enumerate().map(|(k, samples)| record(&format!("r{k}"), samples, run(law, samples)));
    Dataset::new(ColumnNames::plain(1), records.collect()).unwrap()
}

/// Unseen minor loops within the range of [`TRAINED`].
const TRAINED: [f64; 11] = [0.0, 1.0, -1.0, 0.8, -0.6, 1.0, -0.2, 0.5, -0.9, 0.3, 0.0];
const UNSEEN: [f64; 9] = [0.0, 0.7, -0.4, 0.9, 0.1, 0.6, -0.8, 0.2, -0.5];

fn paths(place: impl Fn(f64) -> f64) -> (Vec<Vec<Sample>>, Vec<Vec<Sample>>) {
    let placed = |turning: &[f64]| {
        let turning: Vec<f64> = turning.iter().map(|u| place(*u)).collect();
        vec![samples_of(&through(&turning, 40))]
    };
    (placed(&TRAINED), placed(&UNSEEN))
}

#[test]
fn bouc_wen_recovers_itself() {
    let (seen, unseen) = paths(|u| 6.0 * u);
    let law = BoucWen { offset: 3.0, ..bouc_wen(1.6) };
    let options = ClassicalOptions { starts: Some(4), ..of(ClassicalModel::BoucWen) };
    let found = BoucWen::fit(&data(&law, &seen), &options, &mut go_on).unwrap();
    assert!(found.train_nrmse_percent < 0.1, "{}", found.train_nrmse_percent);
    assert!(error_of(&found.law, &data(&law, &unseen), None) < 0.2);
    assert_relative_eq!(found.law.yield_displacement, 1.5, max_relative = 0.02);
    assert_relative_eq!(found.law.alpha(), law.alpha(), max_relative = 0.02);
    assert_relative_eq!(found.law.n, 1.6, max_relative = 0.03);
}

#[test]
fn degradation_is_recovered() {
    let cycles = |peaks: &[f64]| {
        let turning: Vec<f64> = [0.0].into_iter().chain(peaks.iter().flat_map(|&x| [x, -x])).collect();
        vec![samples_of(&through(&turning, 20))]
    };
    let (seen, unseen) = (cycles(&[1.5, 3.0, 3.0, 6.0, 6.0, 6.0, 9.0]), cycles(&[2.0, 5.0, 5.0, 8.0]));
    let law = degrading_bouc_wen();
    let options = ClassicalOptions { degradation: true, starts: Some(6), ..of(ClassicalModel::BoucWen) };
    let found = BoucWen::fit(&data(&law, &seen), &options, &mut go_on).unwrap();
    assert!(found.train_nrmse_percent < 1.0, "{}", found.train_nrmse_percent);
    assert!(error_of(&found.law, &data(&law, &unseen), None) < 3.0);
    let plain = ClassicalOptions { starts: Some(4), ..of(ClassicalModel::BoucWen) };
    let without = BoucWen::fit(&data(&law, &seen), &plain, &mut go_on).unwrap();
    assert!(without.train_nrmse_percent > 5.0 * found.train_nrmse_percent);
}

#[test]
fn generalized_plays_recover_themselves_in_both_forms() {
    for (law, place) in [
        (terfenol_actuator(), (|u| 0.25 + 0.95 * u) as fn(f64) -> f64),
        (shape_memory_actuator(), |u| 1.2 + 1.2 * u),
    ] {
        let (seen, unseen) = paths(place);
        for (free_weights, most) in [(false, 1.0), (true, 1.0)] {
            let options = ClassicalOptions {
                free_weights: Some(free_weights),
                starts: Some(8),
                ..of(ClassicalModel::GeneralizedPrandtlIshlinskii)
            };
            let found = GeneralizedPrandtlIshlinskii::fit(&data(&law, &seen), &options, &mut go_on).unwrap();
            assert!(found.train_nrmse_percent < most, "{} {free_weights}", found.train_nrmse_percent);
            let unseen = error_of(&found.law, &data(&law, &unseen), None);
            assert!(unseen < 3.0 * most, "{unseen} {free_weights}");
        }
    }
}

#[test]
fn rate_dependent_plays_recover_themselves_in_both_forms() {
    let law = rate_dependent_actuator();
    let seen = [1.0, 10.0, 50.0].map(|frequency| sine(frequency, 10.0, 100, 2));
    let unseen = [sine(25.0, 10.0, 100, 2), sine(40.0, 6.0, 100, 2)];
    for free_weights in [false, true] {
        let options = ClassicalOptions {
            free_weights: Some(free_weights),
            rate: Some(RateMethod::Given),
            ..of(ClassicalModel::RateDependentPrandtlIshlinskii)
        };
        let found = RateDependentPrandtlIshlinskii::fit(&data(&law, &seen), &options, &mut go_on).unwrap();
        assert!(found.train_nrmse_percent < 0.1, "{}", found.train_nrmse_percent);
        assert!(error_of(&found.law, &data(&law, &unseen), Some(RateMethod::Given)) < 0.3);
        let Thresholds::Linear { beta } = found.law.thresholds else { panic!("{:?}", found.law) };
        assert_relative_eq!(beta, 2e-3, max_relative = 0.02);
    }
    let law = RateDependentPrandtlIshlinskii {
        thresholds: Thresholds::Logarithmic { beta: 2.0, lambda: 0.01, epsilon: 0.8 },
        ..law
    };
    let options = ClassicalOptions {
        logarithmic_thresholds: true,
        rate: Some(RateMethod::Given),
        ..of(ClassicalModel::RateDependentPrandtlIshlinskii)
    };
    let found = RateDependentPrandtlIshlinskii::fit(&data(&law, &seen), &options, &mut go_on).unwrap();
    assert!(found.train_nrmse_percent < 0.5, "{}", found.train_nrmse_percent);
    assert!(error_of(&found.law, &data(&law, &unseen), Some(RateMethod::Given)) < 1.0);
    // Without time there is no rate.
    let (still, _) = paths(|u| u);
    assert!(RateDependentPrandtlIshlinskii::fit(&data(&law, &still), &options, &mut go_on).is_err());
}

#[test]
fn jiles_atherton_recovers_itself_in_both_forms() {
    let (seen, unseen) = paths(|u| 4000.0 * u);
    for form in [JilesAthertonForm::Original, JilesAthertonForm::Differential] {
        let law = JilesAtherton { permeability: 2.0, offset: 1e4, ..jiles_atherton(form) };
        let options = ClassicalOptions {
            differential_form: form == JilesAthertonForm::Differential,
            starts: Some(4),
            ..of(ClassicalModel::JilesAtherton)
        };
        let found = JilesAtherton::fit(&data(&law, &seen), &options, &mut go_on).unwrap();
        assert!(found.train_nrmse_percent < 0.2, "{form:?} {}", found.train_nrmse_percent);
        assert!(error_of(&found.law, &data(&law, &unseen), None) < 0.4);
        assert_relative_eq!(found.law.k, 400.0, max_relative = 0.1);
    }
}

#[test]
fn jiles_atherton_has_the_symbols_and_numbers_of_the_literature() {
    let mu_0 = 4e-7 * std::f64::consts::PI;
    let known = jiles_atherton(JilesAthertonForm::Original);
    let law = JilesAtherton { permeability: mu_0, saturation: 1.6e6 * mu_0, alpha: 1.6e-3 / mu_0, ..known };
    let (seen, _) = paths(|u| 5000.0 * u);
    let records = data(&law, &seen).records().to_vec();
    let names =
        ColumnNames { inputs: vec!["H (A/m)".into()], output: "B (T)".into(), ..ColumnNames::plain(1) };
    let options =
        FitSpec::Classical(ClassicalOptions { starts: Some(4), ..of(ClassicalModel::JilesAtherton) });
    let found = identify(&Dataset::new(names, records).unwrap(), &options, &mut |_| {
        std::ops::ControlFlow::Continue(())
    })
    .unwrap();
    let shown: Vec<_> = found.model.law_parameters().unwrap();
    for (symbol, expected, unit) in
        [("M_s", 2.0106, "T"), ("a", 1100.0, "A/m"), ("k", 400.0, "A/m"), ("α", 1.6e-3, ""), ("c", 0.2, "")]
    {
        let found = shown.iter().find(|shown| shown.parameter.symbol == symbol).unwrap();
        assert_relative_eq!(found.parameter.value, expected, max_relative = 0.01);
        assert_eq!(found.unit, unit, "{symbol}");
    }
}

#[test]
fn jiles_atherton_is_refused_for_data_that_do_not_determine_it() {
    let law = jiles_atherton(JilesAthertonForm::Original);
    let options = ClassicalOptions { starts: Some(2), ..of(ClassicalModel::JilesAtherton) };
    let branch = samples_of(&through(&[5000.0, -5000.0], 60));
    let error = JilesAtherton::fit(&data(&law, &[branch]), &options, &mut go_on).unwrap_err().to_string();
    assert!(error.contains("never turns") && error.contains("whole loop"), "{error}");
    let (seen, _) = paths(|u| 5000.0 * u);
    let falling = run(&law, &seen[0]).into_iter().map(|m| -m).collect();
    // The force of a yielding member over its displacement, with the sign reversed: it lags, and falls.
    let mut member = Stop::new(1000.0).unwrap();
    let yielding = seen[0].iter().map(|sample| -(sample.x + 5.0 * member.step(sample.x))).collect();
    for output in [falling, yielding] {
        let data = Dataset::new(ColumnNames::plain(1), vec![record("r", &seen[0], output)]).unwrap();
        let error = JilesAtherton::fit(&data, &options, &mut go_on).unwrap_err().to_string();
        assert!(error.contains("sign of one of them reversed"), "{error}");
    }
}

#[test]
fn neuro_madelung_learns_its_own_kind_and_plays() {
    let (seen, unseen) = paths(|u| 2.0 * u);
    let law = neuro_madelung(None);
    let options =
        ClassicalOptions { hidden: Some(6), starts: Some(6), seed: 0, ..of(ClassicalModel::NeuroMadelung) };
    let found = NeuroMadelung::fit(&data(&law, &seen), &options, &mut go_on).unwrap();
    assert!(found.train_nrmse_percent < 1.0, "{}", found.train_nrmse_percent);
    assert!(error_of(&found.law, &data(&law, &unseen), None) < 15.0);

    let (seen, unseen) = paths(|u| 0.25 + 0.95 * u);
    let found = NeuroMadelung::fit(&data(&terfenol_actuator(), &seen), &options, &mut go_on).unwrap();
    assert!(found.train_nrmse_percent < 2.0, "{}", found.train_nrmse_percent);
    assert!(error_of(&found.law, &data(&terfenol_actuator(), &unseen), None) < 15.0);
}

#[test]
fn a_search_can_be_broken_off_and_gives_the_best_so_far() {
    let (seen, _) = paths(|u| 6.0 * u);
    let data = data(&bouc_wen(1.6), &seen);
    let mut told = Vec::new();
    let mut observer = |progress: SearchProgress| {
        told.push((progress.round, progress.train_nrmse_percent, progress.law_so_far()));
        if progress.round == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let found = BoucWen::fit(&data, &of(ClassicalModel::BoucWen), &mut observer).unwrap();
    assert_eq!(found.termination, Termination::Stopped);
    assert_eq!(told.iter().map(|(round, ..)| *round).collect::<Vec<_>>(), [1, 2, 3]);
    assert!(told.windows(2).all(|pair| pair[1].1 <= pair[0].1));
    assert_eq!((found.train_nrmse_percent, Some(found.law.into())), (told[2].1, told[2].2.clone()));
    assert_relative_eq!(found.train_nrmse_percent, error_of(&found.law, &data, None), max_relative = 1e-6);
    let none = ClassicalOptions { starts: Some(0), ..of(ClassicalModel::BoucWen) };
    assert!(BoucWen::fit(&data, &none, &mut go_on).is_err());
}

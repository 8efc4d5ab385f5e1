//! Laws of members and of steel are found again from their own data, and predict other paths.

use crate::scaffold::*;
use hysid::law::menegotto_pinto::{Downwards, MenegottoPinto};
use hysid::law::peak_oriented::{Degradation, PeakOriented, Side};
use hysid::law::ramberg_osgood::RambergOsgood;
use hysid::{Dataset, Fit, Model};
use serde_json::json;

/// Cycles of growing amplitude, each twice, and small ones in between.
fn cycles(amplitudes: &[f64], steps: usize) -> Vec<f64> {
    let mut x = vec![0.0];
    for &amplitude in amplitudes {
        for to in [amplitude, -amplitude, amplitude, 0.4 * amplitude, 0.9 * amplitude, -amplitude, 0.0] {
            let from = x[x.len() - 1];
            x.extend((1..=steps).map(|k| from + (to - from) * k as f64 / steps as f64));
        }
    }
    x
}

fn fitted(law: &Classical, x: &[f64], options: &[&str]) -> Model {
    let y = law.run(&samples_of(x));
    let mut fit = Fit::new().model(law.facts().name).seed(2);
    for option in options {
        fit = fit.option(option, json!(true));
    }
    fit.run(&Dataset::from_slices(x, &y).unwrap()).unwrap()
}

fn error(model: &Model, law: &Classical, x: &[f64]) -> f64 {
    let data = Dataset::from_slices(x, &law.run(&samples_of(x))).unwrap();
    error_percent(model, &data)
}

/// Every parameter within a share of its value.
fn assert_recovered(model: &Model, law: &Classical, share: f64) {
    for (found, expected) in model.law().unwrap().parameters().iter().zip(law.parameters()) {
        let limit = share * expected.value.abs().max(0.02);
        assert!((found.value - expected.value).abs() < limit, "{found:?}, not {}", expected.value);
    }
}

/// A member without degradation.
fn member() -> PeakOriented {
    PeakOriented {
        offset: 2.0,
        spring: 0.4,
        up: Side { strength: 120.0, yield_displacement: 7.0 },
        down: None,
        n: 2.5,
        hardening: 0.08,
        unloading: 0.35,
        curvature: 2.0,
        pinch_place: 0.55,
        pinch_height: 0.25,
        pinch_weight: 1.6,
        degradation: None,
    }
}

#[test]
fn a_peak_oriented_member_is_found_again() {
    let law = Classical::from(member());
    let model = fitted(&law, &cycles(&[3.0, 8.0, 15.0, 25.0, 40.0], 24), &[]);
    assert_recovered(&model, &law, 0.01);
    let found = error(&model, &law, &cycles(&[5.0, 30.0, 12.0, 60.0], 17));
    assert!(found < 0.1, "{found} %");
}

#[test]
fn different_sides_are_found_again() {
    let down = Some(Side { strength: 80.0, yield_displacement: 10.0 });
    let law = Classical::from(PeakOriented { down, ..member() });
    let x = cycles(&[3.0, 8.0, 15.0, 25.0, 40.0], 24);
    let model = fitted(&law, &x, &["asymmetric"]);
    assert_recovered(&model, &law, 0.01);
    let symmetric = fitted(&law, &x, &[]);
    let other = cycles(&[5.0, 30.0, 12.0, 60.0], 17);
    let (with, without) = (error(&model, &law, &other), error(&symmetric, &law, &other));
    assert!(with < 0.1 && without > 2.0, "{with} % and {without} %");
}

#[test]
fn a_degrading_member_is_predicted_beyond_its_data() {
    let degradation = Degradation::from_values([3.0, 1.5, 0.3, 60.0, 1.0, 0.5, 0.2, 0.4]);
    let law = Classical::from(PeakOriented { degradation: Some(degradation), ..member() });
    let x = cycles(&[3.0, 8.0, 15.0, 25.0, 40.0], 24);
    let model = fitted(&law, &x, &["degradation"]);
    let (train, plain) = (error(&model, &law, &x), error(&fitted(&law, &x, &[]), &law, &x));
    assert!(train < 1.0 && plain > 5.0, "{train} % and {plain} %");
    let found = error(&model, &law, &cycles(&[5.0, 20.0, 12.0, 45.0], 17));
    assert!(found < 5.0, "{found} %");
}

#[test]
fn a_steel_is_found_again() {
    let steel = MenegottoPinto {
        offset: 4.0,
        roundness: 12.0,
        loss: 0.8,
        pace: 0.5,
        isotropic: 0.04,
        ..MenegottoPinto::steel(200.0, 400.0, 0.015).unwrap()
    };
    let law = Classical::from(steel);
    let x = cycles(&[3.0, 6.0, 12.0, 20.0], 24);
    let model = fitted(&law, &x, &[]);
    assert_recovered(&model, &law, 0.01);
    let found = error(&model, &law, &cycles(&[8.0, 4.0, 28.0], 17));
    assert!(found < 0.1, "{found} %");

    let law =
        Classical::from(MenegottoPinto { down: Some(Downwards { ratio: 0.8, isotropic: 0.1 }), ..steel });
    let model = fitted(&law, &x, &["asymmetric"]);
    let found = error(&model, &law, &cycles(&[8.0, 4.0, 28.0], 17));
    assert!(found < 1.0, "{found} %");
}

#[test]
fn a_power_curve_is_found_again() {
    for (yield_displacement, exponent) in [(4.0, 5.5), (9.0, 2.2)] {
        let law = RambergOsgood { offset: 4.0, strength: 120.0, yield_displacement, exponent };
        let law = Classical::from(law);
        let x = cycles(&[3.0, 6.0, 12.0, 20.0], 24);
        let model = fitted(&law, &x, &[]);
        assert_recovered(&model, &law, 1e-6);
        let found = error(&model, &law, &cycles(&[8.0, 4.0, 28.0], 17));
        assert!(found < 1e-6, "{found} %");
    }
}

//! The classical models that are linear in their weights: against each other, against published values,
//! and against the memory laws they must obey or break.

use crate::scaffold::*;
use hysid::fit::law::random_stops::fit_random_stops;
use hysid::law::masing::{Masing, MasingParts};
use hysid::law::modified_prandtl_ishlinskii::{DeadZoneParts, DeadZones, ModifiedPrandtlIshlinskii};
use hysid::law::prandtl_ishlinskii::PrandtlIshlinskii;
use hysid::law::preisach::{Preisach, PreisachWeights};
use hysid::law::turning_point_stack::TurningPointStack;
use hysid::options::classical::Sign;
use hysid::specimens::Ferromagnet;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn repeatable() -> ProptestConfig {
    ProptestConfig {
        cases: 300,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(7),
        ..ProptestConfig::default()
    }
}

fn nrmse(y: &[f64], model: &[f64]) -> f64 {
    let mean = y.iter().sum::<f64>() / y.len() as f64;
    let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let errors = squares(&mut y.iter().zip(model).map(|(y, m)| y - m));
    100.0 * (errors / squares(&mut y.iter().map(|y| y - mean))).sqrt()
}

/// Published demonstration parameters (theory.md (7.4); program of an IEEE Control Systems Magazine lecture, example 1).
fn lecture_model() -> PrandtlIshlinskii {
    let thresholds = vec![0.45, 0.9, 1.35, 1.8, 2.25, 2.7];
    PrandtlIshlinskii::new(0.0, 0.72, thresholds, vec![0.6, 0.48, 0.36, 0.24, 0.12, 0.012]).unwrap()
}

/// Electrical steel: cell weights from its published Everett function.
fn steel(lines: Vec<f64>) -> Preisach {
    let everett = Ferromagnet::m330_50a().everett;
    let e = |a: f64, b: f64| 0.5 * everett.value(a, b);
    let n = lines.len() - 1;
    let mut cells = Vec::new();
    for i in 0..n {
        for j in 0..=i {
            let (low, high) = (lines[i], lines[i + 1]);
            let (bottom, top) = (lines[j], lines[j + 1]);
            cells.push(if i == j {
                e(high, low)
            } else {
                e(high, bottom) - e(low, bottom) - e(high, top) + e(low, top)
            });
        }
    }
    let reversible = vec![0.0; n];
    Preisach::new(PreisachWeights { constant: 0.0, slope: 0.0, lines, reversible, cells }).unwrap()
}

/// Symmetric, uneven lines through the fields of the published values.
fn steel_lines() -> Vec<f64> {
    let positive = [12.0, 25.0, 40.0, 55.0, 75.0, 100.0, 140.0, 200.0, 300.0, 450.0, 650.0];
    positive.iter().rev().map(|h| -h).chain([0.0]).chain(positive).collect()
}

fn saturating() -> ModifiedPrandtlIshlinskii {
    let zones = DeadZoneParts {
        constant: 1.0,
        linear: 1.0,
        thresholds: vec![-2.0, -1.0, 1.0, 3.0],
        weights: vec![0.5, -0.3, -0.4, -0.4],
    };
    ModifiedPrandtlIshlinskii::new(lecture_model(), DeadZones::new(zones).unwrap())
}

fn masing() -> Masing {
    let thresholds = vec![0.3, 0.8, 1.5, 2.2];
    Masing::new(MasingParts { constant: 0.5, thresholds, slopes: vec![3.0, 2.0, 2.5, 0.5, 0.1] }).unwrap()
}

/// Dominant extrema of a path from rest at 0, found by looking at the whole path: theory.md (7.2).
fn dominant_extrema(path: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0];
    x.extend(path);
    let end = x.len() - 1;
    let last_of_largest = |from: usize, size: &dyn Fn(f64) -> f64| {
        (from..=end).fold(from, |best, k| if size(x[k]) >= size(x[best]) { k } else { best })
    };
    let mut at = last_of_largest(0, &f64::abs);
    let mut side = x[at].signum();
    let mut found = Vec::new();
    while at < end && x[at] != x[end] {
        found.push(x[at]);
        side = -side;
        at = last_of_largest(at + 1, &|x| side * x);
    }
    found
}

proptest! {
    #![proptest_config(repeatable())]

    /// Values on a coarse grid make ties and exact returns frequent.
    #[test]
    fn the_stack_holds_the_dominant_extrema(path in vec(-6i32..=6, 1..60), fine in vec(-1.0..1.0, 1..60)) {
        for path in [path.iter().map(|&x| f64::from(x)).collect::<Vec<f64>>(), fine] {
            let mut stack = TurningPointStack::default();
            for end in 1..=path.len() {
                stack.advance(path[end - 1], end);
                let points: Vec<f64> = stack.points().iter().map(|point| point.x).collect();
                prop_assert_eq!(&points, &dominant_extrema(&path[..end]), "after {:?}", &path[..end]);
                prop_assert_eq!(stack.present().unwrap().x, path[end - 1]);
            }
        }
    }

    #[test]
    fn masings_rule_is_the_prandtl_model(path in vec(-3.0..3.0, 1..80)) {
        let model = masing();
        let MasingParts { constant, thresholds, slopes } = model.parts();
        let mut prandtl: Vec<f64> = path.iter().map(|x| constant + slopes[slopes.len() - 1] * x).collect();
        for (j, &r) in thresholds.iter().enumerate() {
            let stop = Stop::new(r).unwrap().run(&path);
            prandtl.iter_mut().zip(stop).for_each(|(y, z)| *y += (slopes[j] - slopes[j + 1]) * z);
        }
        for (y, exact) in outputs(&model, &path).iter().zip(prandtl) {
            prop_assert!((y - exact).abs() < 1e-12, "{y} and {exact}");
        }
    }

    /// At inputs on the lines a cell is switched as a whole, as a relay in its middle.
    #[test]
    fn a_plane_is_its_relays(places in vec(0usize..=7, 1..40), weights in vec(-1.0..1.0, 28)) {
        let lines = vec![-2.0, -1.5, -0.3, 0.0, 0.4, 0.9, 2.1, 3.0];
        let reversible = vec![0.0; 7];
        let model = Preisach::new(PreisachWeights { constant: 0.2, slope: 0.1, lines: lines.clone(), reversible, cells: weights.clone() }).unwrap();
        // From saturation, where it does not matter how relays began.
        let mut x = vec![4.0];
        x.extend(places.iter().map(|&place| lines[place]));
        let mut expected: Vec<f64> = x.iter().map(|x| 0.2 + 0.1 * x).collect();
        let mut cell = weights.iter();
        for i in 0..7 {
            for j in 0..=i {
                let middle = |k: usize, share: f64| lines[k] + share * (lines[k + 1] - lines[k]);
                let (alpha, beta) = (middle(i, 0.6), middle(j, 0.4));
                let relay = Relay::new(0.5 * (alpha - beta), 0.5 * (alpha + beta)).unwrap().run(&x);
                let weight = cell.next().unwrap();
                expected.iter_mut().zip(relay).for_each(|(y, state)| *y += weight * state);
            }
        }
        for (y, exact) in outputs(&model, &x).iter().zip(expected) {
            prop_assert!((y - exact).abs() < 1e-12, "{y} and {exact}");
        }
    }

    /// Cutting a path into finer steps changes nothing at the points they share.
    #[test]
    fn steps_may_be_of_any_size(turning in vec(-2.9..2.9, 2..12)) {
        fn check<L: Law>(name: &str, law: &L, turning: &[f64], scale: f64) -> Result<(), TestCaseError> {
            let turning: Vec<f64> = turning.iter().map(|x| x * scale).collect();
            let coarse = outputs(law, &turning);
            let fine = outputs(law, &through(&turning, 13));
            for (k, y) in coarse.iter().enumerate() {
                prop_assert!((y - fine[13 * k]).abs() < 1e-11, "{name}: {y} and {}", fine[13 * k]);
            }
            Ok(())
        }
        check("prandtl-ishlinskii", &lecture_model(), &turning, 1.0)?;
        check("modified", &saturating(), &turning, 1.0)?;
        check("masing", &masing(), &turning, 1.0)?;
        check("preisach", &steel(steel_lines()), &turning, 250.0)?;
    }
}

/// The published inverse of the published parameters, as a model of the same kind, undoes them.
#[test]
fn the_published_inverse_undoes_the_published_model() {
    let model = lecture_model();
    let inverse = PrandtlIshlinskii::new(
        0.0,
        1.3889,
        vec![0.324, 0.918, 1.728, 2.7, 3.78, 4.914],
        vec![-0.6313, -0.202, -0.0926, -0.0463, -0.0198, -0.0019],
    )
    .unwrap();
    let x = through(&[0.0, 4.0, -4.0, 1.5, -2.0, 3.0, 0.0], 40);
    let y = outputs(&model, &x);
    for (back, x) in outputs(&inverse, &y).iter().zip(&x) {
        // The weights are published with four decimals.
        assert!((back - x).abs() < 2e-3, "{back} and {x}");
    }
    // By hand, on the virgin curve.
    approx::assert_relative_eq!(last(&model, &[4.0]), 8.2056, epsilon = 1e-12);
}

/// Polarisation of M330-50A by an independent program from the same Everett function.
#[test]
fn a_plane_from_the_everett_function_of_m330_has_its_return_points() {
    let j = outputs(&steel(steel_lines()), &[300.0, -100.0, 100.0, -100.0, 300.0]);
    let expected = [1.319871, -1.110440, 1.125961, -1.110440, 1.319871];
    for (j, expected) in j.iter().zip(expected) {
        assert!((j - expected).abs() < 5.1e-7, "{j} and {expected}");
    }
    let model = steel(steel_lines());
    let everett = Ferromagnet::m330_50a().everett;
    approx::assert_relative_eq!(
        2.0 * model.everett(200.0, -40.0),
        everett.value(200.0, -40.0),
        epsilon = 1e-12
    );
    assert_eq!(model.everett(-40.0, 200.0), 0.0);
}

#[test]
fn between_its_lines_a_plane_is_near_the_everett_function() {
    let h = through(&[0.0, 63.0, -177.0, 244.0, 31.0, 98.0, -311.0, 17.0], 37);
    let mut sheet = Ferromagnet::m330_50a();
    sheet.everett.k = 0.0;
    let exact = sheet.run(&h);
    let error = |intervals: i32| {
        let lines = (-intervals..=intervals).map(|k| 650.0 * f64::from(k) / f64::from(intervals)).collect();
        nrmse(&exact, &outputs(&steel(lines), &h))
    };
    let (coarse, fine) = (error(50), error(100));
    assert!(fine < 0.5 && fine < 0.4 * coarse, "{coarse} % and {fine} %");
}

#[test]
fn a_fit_finds_the_weights_of_plays() {
    let model = lecture_model();
    let x = through(&[0.0, 4.0, -3.5, 3.0, -2.5, 2.0, -1.5, 1.0, -0.5, 4.0, -4.0], 40);
    let data = Dataset::from_slices(&x, &outputs(&model, &x)).unwrap();
    let options = ClassicalOptions {
        thresholds: Some(model.thresholds().to_vec()),
        ..of(ClassicalModel::PrandtlIshlinskii)
    };
    let fitted = PrandtlIshlinskii::fit(&data, &options, &mut go_on).unwrap().law;
    for (found, exact) in fitted.weights().iter().zip(model.weights()) {
        assert!((found - exact).abs() < 1e-4, "{found} and {exact}");
    }
    // With thresholds of its own it must find the same behaviour on another path.
    let other = through(&[0.0, 2.2, -0.7, 3.1, -3.9, 1.2, 0.2, 0.9], 23);
    let signed = |sign| {
        let options = ClassicalOptions { sign, ..of(ClassicalModel::PrandtlIshlinskii) };
        PrandtlIshlinskii::fit(&data, &options, &mut go_on).unwrap().law
    };
    for sign in [None, Some(Sign::NonNegative)] {
        let fitted = signed(sign);
        let error = nrmse(&outputs(&model, &other), &outputs(&fitted, &other));
        assert!(error < 1.0, "{error} %");
    }
    let wrong = signed(Some(Sign::NonPositive));
    assert!(wrong.weights().iter().all(|&w| w <= 0.0));
    assert!(nrmse(&outputs(&model, &other), &outputs(&wrong, &other)) > 10.0);
}

#[test]
fn a_fit_finds_a_virgin_curve() {
    let model = masing();
    let x = through(&[0.0, 2.5, -2.0, 1.5, -1.0, 0.6, 2.5, -2.5, 2.8, -2.8], 40);
    let data = Dataset::from_slices(&x, &outputs(&model, &x)).unwrap();
    let thresholds = Some(model.parts().thresholds.clone());
    let fitted =
        Masing::fit(&data, &ClassicalOptions { thresholds, ..of(ClassicalModel::Masing) }, &mut go_on)
            .unwrap()
            .law;
    for (found, exact) in fitted.parts().slopes.iter().zip(&model.parts().slopes) {
        assert!((found - exact).abs() < 1e-4, "{found} and {exact}");
    }
    assert!((fitted.virgin_curve(-1.1) + fitted.virgin_curve(1.1)).abs() < 1e-15);
}

#[test]
fn a_fit_finds_a_sheet_of_steel() {
    let sheet = |turning: &[f64]| {
        let h = through(turning, 40);
        let b = Ferromagnet::m330_50a().run(&h);
        (h, b)
    };
    let (h, mut b) = sheet(&[
        0.0, 60.0, -60.0, 120.0, -120.0, 200.0, -200.0, 300.0, 0.0, 150.0, -50.0, 80.0, -300.0, 30.0, -150.0,
        50.0, -90.0, 300.0, -40.0, 40.0, -80.0, 80.0, -20.0, 20.0,
    ]);
    b[70..90].fill(f64::NAN);
    let data = Dataset::from_slices(&h, &b).unwrap();
    let options = ClassicalOptions { operators: Some(24), ..of(ClassicalModel::Preisach) };
    let fitted = Preisach::fit(&data, &options, &mut go_on).unwrap().law;
    let (h, b) = sheet(&[0.0, 90.0, -90.0, 250.0, 60.0, 140.0, -30.0, 30.0, -250.0, -20.0, -100.0, 20.0]);
    let error = nrmse(&b, &outputs(&fitted, &h));
    assert!(error < 3.0, "{error} %");
    let options = ClassicalOptions { sign: Some(Sign::NonNegative), ..options };
    let signed = Preisach::fit(&data, &options, &mut go_on).unwrap().law;
    assert!(signed.weights().cells.iter().all(|&w| w >= 0.0));
}

#[test]
fn a_fit_finds_plays_behind_dead_zones() {
    let model = saturating();
    let x = through(&[0.0, 3.0, -2.5, 2.0, -1.5, 1.0, -0.5, 3.0, -3.0, 0.5, -0.5, 2.5], 40);
    let data = Dataset::from_slices(&x, &outputs(&model, &x)).unwrap();
    let other = through(&[0.0, 2.2, -0.7, 2.9, -2.8, 1.2, 0.2, 0.9], 23);
    let expected = outputs(&model, &other);
    let bent =
        ModifiedPrandtlIshlinskii::fit(&data, &of(ClassicalModel::ModifiedPrandtlIshlinskii), &mut go_on)
            .unwrap()
            .law;
    let error = nrmse(&expected, &outputs(&bent, &other));
    assert!(error < 1.5, "{error} %");
    assert!(bent.superposition().slopes().iter().all(|&slope| slope > 0.0));
    let straight =
        PrandtlIshlinskii::fit(&data, &of(ClassicalModel::PrandtlIshlinskii), &mut go_on).unwrap().law;
    assert!(nrmse(&expected, &outputs(&straight, &other)) > 3.0 * error);
}

#[test]
fn random_stops_are_a_network() {
    let x = through(&[0.0, 1.0, -1.0, 1.5, -1.5, 2.0, -2.0, 1.0, -1.0, 2.0, -0.5, 0.5], 40);
    let wearing = |r: f64| DeterioratingStop::new(r, 30.0).unwrap().run(&x);
    let y: Vec<f64> =
        wearing(0.4).iter().zip(wearing(1.1)).zip(&x).map(|((a, b), x)| 3.0 * a + b + 0.2 * x).collect();
    let data = Dataset::from_slices(&x, &y).unwrap();
    let options =
        ClassicalOptions { operators: Some(80), hidden: Some(10), ..of(ClassicalModel::RandomStops) };
    let fit = |options: &ClassicalOptions| fit_random_stops(&data, options, StopCheck::never());
    let fitted = fit(&options).unwrap();
    let drive = fitted.scaling.drive(&data.records()[0], fitted.network.architecture(), None).unwrap();
    let mut found = vec![0.0; x.len()];
    fitted.network.simulator().run(&[&drive.channels[0]], &[], &mut found);
    let found: Vec<f64> = found.iter().map(|y| fitted.scaling.output(*y)).collect();
    let error = nrmse(&y, &found);
    assert!(error < 5.0, "{error} %");
    assert_eq!(fit(&options).unwrap(), fitted);
    let other = fit(&ClassicalOptions { seed: 2, ..options.clone() }).unwrap();
    assert_ne!(other.network, fitted.network);
    let none = ClassicalOptions { operators: Some(0), ..options };
    assert!(matches!(fit(&none), Err(Error::Parts(_))));
}

#[test]
fn unusable_parameters_are_refused() {
    let plays = |r: Vec<f64>, w: Vec<f64>| PrandtlIshlinskii::new(0.0, 1.0, r, w);
    assert!(plays(vec![1.0, 1.0], vec![0.0; 2]).is_err());
    assert!(plays(vec![0.0], vec![1.0]).is_err());
    assert!(plays(vec![1.0], vec![f64::NAN]).is_err());
    assert!(plays(vec![1.0], vec![]).is_err());
    assert!(plays(vec![], vec![]).is_ok());
    assert!(Masing::new(MasingParts { constant: 0.0, thresholds: vec![1.0], slopes: vec![1.0] }).is_err());
    let zones = |thresholds: Vec<f64>, weights: Vec<f64>| {
        DeadZones::new(DeadZoneParts { constant: 0.0, linear: 1.0, thresholds, weights })
    };
    assert!(zones(vec![0.0], vec![0.1]).is_err());
    assert!(zones(vec![1.0], vec![-1.0]).is_err(), "a slope of 0");
    assert!(zones(vec![-1.0, 1.0], vec![2.0, -0.5]).is_ok());
    let plane = |lines: Vec<f64>, cells: usize| {
        let reversible = vec![0.0; lines.len().saturating_sub(1)];
        Preisach::new(PreisachWeights {
            constant: 0.0,
            slope: 0.0,
            lines,
            reversible,
            cells: vec![1.0; cells],
        })
    };
    assert!(plane(vec![0.0, 1.0, 2.0], 3).is_ok());
    assert!(plane(vec![0.0, 1.0, 2.0], 4).is_err());
    assert!(plane(vec![0.0, 0.0, 2.0], 3).is_err());
    assert!(plane(vec![0.0], 0).is_err());
}

/// A straight line is no hysteresis, but is fitted all the same.
#[test]
fn a_line_is_fitted() {
    let x = through(&[0.0, 1.0, -1.0, 0.5], 20);
    let options = ClassicalOptions { operators: Some(5), ..of(ClassicalModel::Preisach) };
    let line = Preisach::fit(&Dataset::from_slices(&x, &x).unwrap(), &options, &mut go_on).unwrap().law;
    assert!((last(&line, &[0.3]) - 0.3).abs() < 1e-3);
}

#[test]
fn outputs_are_finite_for_finite_inputs() {
    let x = [1e300, -1e300, 0.0, f64::MAX, f64::MIN, 1e-300, -0.0];
    assert!(outputs(&lecture_model(), &x).iter().all(|y| y.is_finite()));
    assert!(outputs(&saturating(), &x).iter().all(|y| y.is_finite()));
    assert!(outputs(&masing(), &x).iter().all(|y| y.is_finite()));
    assert!(outputs(&steel(steel_lines()), &x).iter().all(|y| y.is_finite()));
}

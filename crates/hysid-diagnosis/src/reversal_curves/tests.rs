//! Densities that are known in closed form.

use approx::assert_relative_eq;
use hysid_core::data::record::{ColumnNames, Dataset, Record};
use hysid_core::elementary::{cosh, powi, sin, square, tanh};
use hysid_core::random::uniform;

use super::*;

/// `E(x, r) = (tanh x - tanh r)²/2`, whose density is `sech² x sech² r`.
fn everett(x: f64, r: f64) -> f64 {
    0.5 * square(tanh(x) - tanh(r))
}

fn density(x: f64, r: f64) -> f64 {
    powi(cosh(x) * cosh(r), -2)
}

const END: f64 = 2.0;

/// The output at `x` of the curve from `r`, of the Preisach model with this Everett function.
fn output(r: f64, x: f64) -> f64 {
    1.0 - 2.0 * everett(END, r) + 2.0 * everett(x, r)
}

/// Down from the end to each reversal and back, in steps of 0.02; reversals 0.1 apart.
fn curves(noise: f64) -> Dataset {
    let (mut x, mut y) = (vec![END], vec![1.0]);
    let mut seed = 0;
    let mut normal = || {
        seed += 1;
        (0..12).map(|k| uniform(12 * seed + k) - 0.5).sum::<f64>()
    };
    for reversal in 1..=40 {
        let r = END - 0.1 * f64::from(reversal);
        let rows = 5 * reversal;
        let place = |row: i32| END - 0.02 * f64::from(row);
        for row in 1..=rows {
            x.push(place(row));
            y.push(1.0 - 2.0 * everett(END, place(row)) + noise * normal());
        }
        for row in (0..rows).rev() {
            x.push(place(row));
            y.push(output(r, place(row)) + noise * normal());
        }
    }
    Dataset::from_slices(&x, &y).unwrap()
}

fn found(data: &Dataset) -> ReversalCurves {
    ReversalCurves::of(data, &ReversalCurveOptions::default()).unwrap().expect("reversal curves")
}

#[test]
fn a_known_density_is_found_within_two_percent_of_its_largest_value() {
    let curves = found(&curves(0.0));
    assert!(curves.rising);
    assert_eq!((curves.curves.len(), curves.smoothing_factor), (40, 1));
    assert_relative_eq!(curves.step, 0.1, epsilon = 1e-9);
    assert_eq!(curves.nodes.len(), (1..=40).map(|k| k + 1).sum::<usize>());
    let mut known = 0;
    for node in &curves.nodes {
        let (x, r) = (node.input, node.reversal_input);
        assert_relative_eq!(node.everett, everett(x, r), epsilon = 1e-9);
        assert_relative_eq!(node.output, output(r, x), epsilon = 1e-9);
        if let Some(found) = node.density {
            known += 1;
            assert!((found - density(x, r)).abs() < 0.02, "{r} {x}: {found} {}", density(x, r));
        }
    }
    assert!(known as f64 > 0.94 * curves.nodes.len() as f64, "{known} of {}", curves.nodes.len());
}

/// Integral of the density over the other field, within the triangle that was measured, by the midpoint rule.
fn marginal(of: impl Fn(f64) -> (f64, f64)) -> f64 {
    let step = 1e-3;
    let places = (-4000..4000).map(|k| of((f64::from(k) + 0.5) * step));
    // dr dx = 2 dH_c dH_u
    places.filter(|(x, r)| *x >= *r && *x <= END && *r >= -END).map(|(x, r)| 2.0 * step * density(x, r)).sum()
}

#[test]
fn marginal_distributions_are_integrals_of_the_density() {
    let curves = found(&curves(0.0));
    let [coercivity, interaction] = curves.marginals();
    for value in coercivity.iter().filter(|value| (0.1..1.5).contains(&value.field)) {
        let exact = marginal(|u| (u + value.field, u - value.field));
        assert!((value.density - exact).abs() < 0.02, "{value:?} {exact}");
    }
    for value in interaction.iter().filter(|value| value.field.abs() < 1.5) {
        let exact = marginal(|c| (value.field + c, value.field - c));
        // The nodes on the diagonal stand for whole cells.
        assert!((value.density - exact).abs() < 0.15, "{value:?} {exact}");
    }
}

/// Single rows at 3, before each curve, whose outputs and those of the curves drift by 0.3 in all.
#[test]
fn calibration_points_are_left_out_and_their_drift_is_removed() {
    let (mut x, mut y) = (vec![], vec![]);
    for reversal in 1..=30 {
        let r = 1.0 - 0.1 * f64::from(reversal);
        let points = (0..=10 + reversal).map(|k| r + 0.1 * f64::from(k));
        for (input, own) in std::iter::once((3.0, 1.0)).chain(points.map(|x| (x, output(r, x)))) {
            x.push(input);
            y.push(own);
        }
    }
    x.push(3.0);
    y.push(1.0);
    let last = (x.len() - 1) as f64;
    let drifting = y.iter().enumerate().map(|(row, y)| y + 0.3 * row as f64 / last).collect::<Vec<f64>>();
    for (output, words) in [(&y, "show no drift"), (&drifting, "drift by 0.3")] {
        let data = Dataset::from_slices(&x, output).unwrap();
        let (cleaned, note) = without_calibration_points(&data).unwrap();
        assert!(note.starts_with("31 calibration points at 3") && note.contains(words), "{note}");
        let curves = found(&cleaned);
        assert_eq!(curves.curves.len(), 30);
        assert_relative_eq!(curves.end, 2.0, epsilon = 1e-9);
        for node in &curves.nodes {
            assert!(node.input <= 2.0 + 1e-9);
            assert_relative_eq!(node.everett, everett(node.input, node.reversal_input), epsilon = 1e-9);
        }
        assert!(without_calibration_points(&cleaned).is_none());
    }
}

#[test]
fn noise_chooses_more_smoothing_and_the_deviation_is_that_of_the_errors() {
    let curves = found(&curves(0.03));
    assert!(curves.smoothing_factor > 1, "{}", curves.smoothing_factor);
    let errors: Vec<f64> = curves
        .nodes
        .iter()
        .filter_map(|node| {
            let error = node.density? - density(node.input, node.reversal_input);
            Some(error / node.density_deviation?)
        })
        .collect();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    assert!((0.6..2.0).contains(&rms), "{rms}");
}

/// With noise, a smoothing factor that grows away from both axes has smaller errors there, and the same on the axes.
#[test]
fn a_growing_smoothing_factor_smooths_away_from_both_axes_only() {
    let data = curves(0.02);
    let of = |smoothing_growth| {
        let options =
            ReversalCurveOptions { smoothing_factor: Some(2), smoothing_growth, ..Default::default() };
        ReversalCurves::of(&data, &options).unwrap().unwrap()
    };
    let (even, growing) = (of(0.0), of(0.4));
    let error = |curves: &ReversalCurves, is_of: &dyn Fn(f64) -> bool| {
        let own = curves.nodes.iter().filter(|node| {
            let (coercivity, interaction) = curves.fields(node);
            is_of(coercivity.min(interaction.abs()))
        });
        let squares =
            own.filter_map(|node| Some(square(node.density? - density(node.input, node.reversal_input))));
        squares.sum::<f64>().sqrt()
    };
    let (near, away) = (|field: f64| field < 0.2, |field: f64| field > 0.3);
    assert_eq!(error(&even, &near), error(&growing, &near));
    assert!(
        error(&growing, &away) < 0.6 * error(&even, &away),
        "{} {}",
        error(&growing, &away),
        error(&even, &away)
    );
}

/// A density that is the same everywhere makes the output a parabola of both, which is fitted exactly.
#[test]
fn an_even_density_is_exact_also_for_curves_that_fall_and_for_records_of_single_curves() {
    let curve = |r: f64| -> (Vec<f64>, Vec<f64>) {
        let rows = ((r + 1.0) / 0.05).round() as i32;
        let x: Vec<f64> = (0..=rows).map(|row| r - 0.05 * f64::from(row)).collect();
        let y = x.iter().map(|x| 0.7 * square(r + 1.0) - 0.7 * square(r - x)).collect();
        (x, y)
    };
    let records = (0..12).map(|k| {
        let (x, y) = curve(1.0 - 0.1 * f64::from(k));
        Record::new(format!("curve {k}"), vec![x], y).unwrap()
    });
    let data = Dataset::new(ColumnNames::plain(1), records.collect()).unwrap();
    let curves = found(&data);
    assert!(!curves.rising);
    assert_relative_eq!(curves.end, -1.0, epsilon = 1e-12);
    assert_eq!(curves.curves.len(), 12);
    for node in &curves.nodes {
        let lag = node.reversal_input - node.input;
        assert_relative_eq!(node.everett, 0.35 * lag * lag, epsilon = 1e-9);
        node.density.iter().for_each(|density| assert_relative_eq!(*density, 0.7, epsilon = 1e-6));
    }
    assert!(curves.nodes.iter().filter(|node| node.density.is_some()).count() > 100);
}

#[test]
fn cycles_are_no_reversal_curves() {
    let cycles = |amplitude: &dyn Fn(usize) -> f64| {
        let x: Vec<f64> = (0..3000).map(|k| amplitude(k) * sin(0.02 * k as f64)).collect();
        let y: Vec<f64> = x.iter().map(|x| tanh(*x)).collect();
        let data = Dataset::from_slices(&x, &y).unwrap();
        ReversalCurves::of(&data, &ReversalCurveOptions::default()).unwrap()
    };
    assert_eq!(cycles(&|_| 2.0), None, "all alike");
    assert_eq!(cycles(&|k| k as f64), None, "growing");
    assert_eq!(cycles(&|k| 3000.0 - k as f64), None, "shrinking");
}

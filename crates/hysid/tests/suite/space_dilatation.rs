//! The minimiser of non-smooth functions, on functions whose minimum is known. The iterations allowed
//! are about those of an independent implementation, with room for another starting point.

use crate::scaffold::*;
use hysid::optimise::space_dilatation::{DilatationOptions, Minimum, SpaceDilatation};
use hysid_core::elementary::powf;

/// The lowest point found in so many iterations from `x`, and why the search ended by itself, if it did.
fn search(
    f: &mut impl FnMut(&[f64], &mut [f64]) -> f64,
    x: Vec<f64>,
    options: DilatationOptions,
    iterations: usize,
    target: f64,
) -> (Minimum, Option<Termination>) {
    let scales = vec![1.0; x.len()];
    let mut search = SpaceDilatation::new(x, scales, options, f).unwrap();
    for _ in 0..iterations {
        if search.best().value <= target {
            break;
        }
        if let Some(termination) = search.advance(f) {
            return (search.best().clone(), Some(termination));
        }
    }
    (search.best().clone(), None)
}

fn solve(
    mut f: impl FnMut(&[f64], &mut [f64]) -> f64,
    x: Vec<f64>,
    options: DilatationOptions,
    iterations: usize,
    target: f64,
) -> Minimum {
    search(&mut f, x, options, iterations, target).0
}

/// Σ κ^{i/(n-1)} f(x_i), of a function with its derivative.
fn weighted(condition: f64, f: fn(f64) -> (f64, f64)) -> impl FnMut(&[f64], &mut [f64]) -> f64 {
    move |x, g| {
        let n = x.len() as f64;
        let mut value = 0.0;
        for (i, (x, g)) in x.iter().zip(g).enumerate() {
            let weight = powf(condition, i as f64 / (n - 1.0));
            let (of_x, slope) = f(*x);
            value += weight * of_x;
            *g = weight * slope;
        }
        value
    }
}

/// Σ κ^{i/(n-1)} x_i²
fn quadratic(condition: f64) -> impl FnMut(&[f64], &mut [f64]) -> f64 {
    weighted(condition, |x| (x * x, 2.0 * x))
}

/// Σ κ^{i/(n-1)} |x_i|
fn absolute_values(condition: f64) -> impl FnMut(&[f64], &mut [f64]) -> f64 {
    weighted(condition, |x| (x.abs(), x.signum()))
}

/// max x_i²
fn largest_square(x: &[f64], g: &mut [f64]) -> f64 {
    let largest = (0..x.len()).max_by(|&i, &j| x[i].abs().total_cmp(&x[j].abs())).unwrap();
    g.fill(0.0);
    g[largest] = 2.0 * x[largest];
    x[largest] * x[largest]
}

fn rosenbrock(x: &[f64], g: &mut [f64]) -> f64 {
    let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
    g[0] = -2.0 * a - 400.0 * x[0] * b;
    g[1] = 200.0 * b;
    a * a + 100.0 * b * b
}

fn options(coefficient: f64, shrinkage: f64) -> DilatationOptions {
    DilatationOptions { coefficient, shrinkage, ..DilatationOptions::default() }
}

fn ramp(n: usize) -> Vec<f64> {
    (1..=n).map(|i| i as f64).collect()
}

/// It was asked the value at what is no point, and a network's least squares did not end there.
#[test]
fn a_function_is_only_asked_at_points() {
    let mut largest: f64 = 0.0;
    let mut falling = |x: &[f64], g: &mut [f64]| {
        assert!(x.iter().all(|x| x.is_finite()), "{x:?}");
        largest = largest.max(x[0].abs());
        g[0] = -1.0;
        -1e-200 * x[0]
    };
    let options = DilatationOptions { first_step: 1e100, growth: 10.0, ..DilatationOptions::default() };
    search(&mut falling, vec![0.0], options, 20, f64::NEG_INFINITY);
    assert!(largest > 1e300, "{largest}: the steps did not grow so far");
}

#[test]
fn a_quadratic_of_condition_one_million() {
    // theory.md section 3: an independent implementation took 356 iterations with these settings.
    let found = solve(quadratic(1e6), vec![1.0; 100], options(2.3, 0.95), 400, 1e-8);
    assert!(found.value <= 1e-8, "{} after {}", found.value, found.iterations);
    assert!(found.evaluations < 3 * found.iterations);
}

#[test]
fn rosenbrocks_valley_in_about_31_iterations() {
    let found = solve(rosenbrock, vec![-1.2, 1.0], options(2.5, 1.0), 40, 1e-8);
    assert!(found.value <= 1e-8, "{} after {}", found.value, found.iterations);
    assert!((found.x[0] - 1.0).abs() < 1e-3 && (found.x[1] - 1.0).abs() < 1e-3);
}

#[test]
fn kinks_need_steps_that_do_not_shrink() {
    for coefficient in [2.0, 2.3, 3.0] {
        let found = solve(absolute_values(1e3), vec![1.0; 100], options(coefficient, 1.0), 3000, 1e-6);
        assert!(found.value <= 1e-6, "α {coefficient}: {} after {}", found.value, found.iterations);
    }
    // Where the steps shrink faster than the space dilates, the search stands still far away.
    let stalled = solve(absolute_values(1e3), vec![1.0; 100], options(1.1, 0.5), 3000, 1e-6);
    assert!(stalled.value > 1.0, "{}", stalled.value);
}

#[test]
fn a_space_begun_anew_keeps_the_step_of_the_undilated_space() {
    // With the step of the dilated space the search stalls at 1e-3 (theory.md section 3).
    for coefficient in [2.3, 3.0, 4.0] {
        let found = solve(largest_square, ramp(50), options(coefficient, 1.0), 6000, 1e-19);
        assert!(found.value <= 1e-19, "α {coefficient}: {} after {}", found.value, found.iterations);
    }
}

#[test]
fn units_of_the_variables_do_not_matter_to_scaled_steps() {
    // The same problem in metres and in micrometres.
    let mut metres = |x: &[f64], g: &mut [f64]| rosenbrock(x, g);
    let mut micrometres = |x: &[f64], g: &mut [f64]| {
        let value = rosenbrock(&[1e-6 * x[0], x[1]], g);
        g[0] *= 1e-6;
        value
    };
    let options = DilatationOptions::default();
    let mut first = SpaceDilatation::new(vec![-1.2, 1.0], vec![1.0, 1.0], options, &mut metres).unwrap();
    let mut second =
        SpaceDilatation::new(vec![-1.2e6, 1.0], vec![1e6, 1.0], options, &mut micrometres).unwrap();
    for _ in 0..25 {
        first.advance(&mut metres);
        second.advance(&mut micrometres);
        let (a, b) = (first.best().value, second.best().value);
        assert!((a - b).abs() <= 1e-6 * a, "{a} and {b}");
    }
    assert!(first.best().value < 1e-2);
}

#[test]
fn it_says_why_it_ends() {
    let flat = |_: &[f64], g: &mut [f64]| {
        g.fill(0.0);
        1.0
    };
    let end = search(&mut { flat }, vec![1.0, 2.0], DilatationOptions::default(), 50, 0.0).1;
    assert_eq!(end, Some(Termination::GradientVanished));
    // A wall beyond which the function is no number: the search stays on this side.
    let wall: fn(&[f64], &mut [f64]) -> f64 = |x, g| {
        g.copy_from_slice(&[1.0, 2.0 * x[1]]);
        if x[0] < 0.5 { f64::NAN } else { x[0] + x[1] * x[1] }
    };
    let minimum = solve(wall, vec![1.0, 2.0], DilatationOptions::default(), 50, f64::NEG_INFINITY);
    assert!(minimum.x[0] >= 0.5 && minimum.value < 1.0, "{minimum:?}");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let refused = |x: Vec<f64>, options: DilatationOptions| {
        let scales = vec![1.0; x.len()];
        SpaceDilatation::new(x, scales, options, &mut rosenbrock).unwrap_err().to_string()
    };
    assert!(refused(vec![], options(2.0, 1.0)).contains("variables"));
    assert!(refused(vec![f64::NAN, 1.0], options(2.0, 1.0)).contains("finite"));
    assert!(refused(vec![1.0, 1.0], options(1.0, 1.0)).contains("dilatation"));
    assert!(refused(vec![1.0, 1.0], options(2.0, 1.5)).contains("shrinkage"));
    assert!(refused(vec![1e300, 1.0], options(2.0, 1.0)).contains("at the start"));
    let mut f = rosenbrock;
    assert!(SpaceDilatation::new(vec![1.0, 1.0], vec![1.0, 0.0], options(2.0, 1.0), &mut f).is_err());
}

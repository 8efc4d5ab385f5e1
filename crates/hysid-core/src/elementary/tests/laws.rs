//! Exact laws: values, symmetry, and order where pieces of the computation meet.

use super::*;

/// Numbers of both signs and all sizes up to 500.
fn numbers() -> impl Iterator<Item = f64> {
    (0..20_000).map(|k| {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        sign * 0.025 * f64::from(k) * powi(0.5, k % 37 % 20)
    })
}

#[test]
fn values_that_are_exact() {
    assert_eq!([exp(0.0), cos(0.0), powf(7.3, 0.0)], [1.0; 3]);
    assert_eq!([ln(1.0), exp_m1(0.0), ln_1p(0.0), sin(0.0), tanh(0.0), asinh(0.0), sinh(0.0)], [0.0; 7]);
    for k in -1074..=1023 {
        let power = powf(2.0, f64::from(k));
        assert_eq!(power, if k < -1022 { f64::from_bits(1 << (k + 1074)) } else { powi(2.0, k) });
        let expected = f64::from(k) * std::f64::consts::LN_2;
        assert!((ln(power) - expected).abs() <= expected.abs() * f64::EPSILON, "2^{k}");
    }
    for k in 0..=22 {
        assert_eq!(powf(10.0, f64::from(k)), powi(10.0, k));
        assert_eq!(powf(3.0, f64::from(k)), powi(3.0, k));
    }
    for x in numbers().map(f64::abs) {
        assert_eq!(powf(x, 1.0), x);
        assert!((powf(x, 2.0) - x * x).abs() <= f64::EPSILON * x * x);
        assert!((powf(x, 0.5) - x.sqrt()).abs() <= f64::EPSILON * x.sqrt());
    }
}

#[test]
fn symmetries_are_exact() {
    for x in numbers().chain([1e10, 1e100, f64::MAX]) {
        for odd in [sin, tanh, sinh, asinh] {
            assert_eq!(odd(-x).to_bits(), (-odd(x)).to_bits(), "{x}");
        }
        assert_eq!(cos(-x).to_bits(), cos(x).to_bits(), "{x}");
        assert_eq!(sin_cos(x), (sin(x), cos(x)));
        assert_eq!(hypot(x, 1.0), hypot(-1.0, x));
    }
}

#[test]
fn identities_hold_up_to_rounding() {
    let is_near = |a: f64, b: f64| (a - b).abs() <= 4.0 * f64::EPSILON * b.abs();
    for x in numbers() {
        let (sin, cos) = sin_cos(x);
        assert!(is_near(sin * sin + cos * cos, 1.0), "{x}");
        assert!(is_near(exp(x) * exp(-x), 1.0), "{x}");
        assert!(x == 0.0 || is_near(ln_1p(exp_m1(0.05 * x)), 0.05 * x) || x < -10.0, "{x}");
        assert!(is_near(sinh(asinh(x)), x), "{x}");
        assert!(tanh(x).abs() <= 1.0, "{x}");
    }
}

/// Order of neighbouring numbers on both sides of a seam.
fn rises(name: &str, function: Function, seam: f64) {
    const AROUND: i64 = 200;
    let at = |k: i64| {
        let bits = (seam.abs().to_bits() as i64 + k) as u64;
        function(f64::from_bits(bits).copysign(seam)) * 1f64.copysign(seam)
    };
    for k in -AROUND..AROUND {
        assert!(at(k) <= at(k + 1), "{name} falls at {seam:e}, step {k}");
    }
}

#[test]
fn functions_rise_where_pieces_meet() {
    let step = std::f64::consts::LN_2 / 64.0;
    for k in -3000..3000 {
        let seam = (f64::from(k) + 0.5) * step;
        rises("exp", exp, seam);
        rises("sinh", sinh, seam);
        rises("exp_m1", exp_m1, seam);
        rises("tanh", tanh, 0.5 * seam);
    }
    for i in 30..300 {
        let seam = (f64::from(i) + 0.5) / 64.0;
        rises("ln", |x| ln(x.abs()) * 1f64.copysign(x), seam);
        rises("ln_1p", ln_1p, seam);
    }
    for seam in [0.171875_f64, 3e-9, 5e-17, 20.0, 40.0, 50.0, 1e9, 1.0, 1e18] {
        rises("exp_m1", exp_m1, seam.min(700.0));
        rises("ln_1p", ln_1p, seam);
        rises("tanh", tanh, seam);
        rises("tanh", tanh, 0.5 * seam);
        rises("sinh", sinh, seam.min(700.0));
        rises("asinh", asinh, seam);
    }
    rises("sin", sin, std::f64::consts::FRAC_PI_4);
}

#[test]
fn powers_of_integers_multiply_in_a_fixed_order() {
    assert_eq!(powi(1.1, 5), (1.1 * ((1.1 * 1.1) * (1.1 * 1.1))));
    assert_eq!(powi(1.1, -3), 1.0 / (1.1 * (1.1 * 1.1)));
    assert_eq!(
        [powi(0.0, 0), powi(-2.0, 3), powi(2.0, 10), powi(0.0, -1)],
        [1.0, -8.0, 1024.0, f64::INFINITY]
    );
    assert_eq!(square(-1.5), 2.25);
}

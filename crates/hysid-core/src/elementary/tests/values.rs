//! Results against values of high precision.

use super::*;

/// Function, the bits of its arguments and of the nearest number to the result, and how far the result lies above that
/// one, in units in its last place. From mpmath with 1400 bits, at arguments of a seeded generator: 200 a function.
const VALUES: &str = include_str!("values.txt");

/// The unit in the last place of a number.
fn unit(y: f64) -> f64 {
    let above = f64::from_bits(y.abs().to_bits() + 1);
    if above.is_finite() { above - y.abs() } else { y.abs() - f64::from_bits(y.abs().to_bits() - 1) }
}

#[test]
fn the_error_is_below_one_unit_in_the_last_place() {
    let mut count = 0;
    for line in VALUES.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let numbers: Vec<f64> = words[1..words.len() - 1]
            .iter()
            .map(|word| f64::from_bits(u64::from_str_radix(word, 16).unwrap()))
            .collect();
        let found = match (words[0], &numbers[..]) {
            ("powf", &[a, b, _]) => powf(a, b),
            ("hypot", &[a, b, _]) => hypot(a, b),
            (name, &[a, _]) => FUNCTIONS.iter().find(|(other, _)| *other == name).unwrap().1(a),
            _ => panic!("{line}"),
        };
        let nearest = numbers[numbers.len() - 1];
        let above: f64 = words[words.len() - 1].parse().unwrap();
        let error = ((found - nearest) / unit(nearest) - above).abs();
        let bound = if matches!(words[0], "sin" | "cos") || nearest.abs() < 1e-307 { 0.8 } else { 0.67 };
        assert!(error < bound, "{line}: {found:e}, off by {error} units");
        count += 1;
    }
    assert_eq!(count, 200 * (FUNCTIONS.len() + 2));
}

#[test]
fn special_numbers_are_those_of_ieee_754() {
    use f64 as F;
    let (inf, nan) = (F::INFINITY, F::NAN);
    let same = |found: f64, expected: f64| {
        found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan())
    };
    for (name, x, expected) in [
        ("exp", inf, inf),
        ("exp", -inf, 0.0),
        ("exp", 709.782712893385, inf),
        ("exp", -745.1332191019412, 0.0),
        ("exp", -745.1332191019411, 5e-324),
        ("exp_m1", inf, inf),
        ("exp_m1", -inf, -1.0),
        ("exp_m1", -0.0, -0.0),
        ("exp_m1", 5e-324, 5e-324),
        ("ln", 0.0, -inf),
        ("ln", -0.0, -inf),
        ("ln", -1.0, nan),
        ("ln", -inf, nan),
        ("ln", inf, inf),
        ("ln_1p", -1.0, -inf),
        ("ln_1p", -1.5, nan),
        ("ln_1p", inf, inf),
        ("ln_1p", -0.0, -0.0),
        ("ln_1p", -5e-324, -5e-324),
        ("tanh", inf, 1.0),
        ("tanh", -inf, -1.0),
        ("tanh", -0.0, -0.0),
        ("sinh", inf, inf),
        ("sinh", -inf, -inf),
        ("sinh", -0.0, -0.0),
        ("asinh", inf, inf),
        ("asinh", -inf, -inf),
        ("asinh", -0.0, -0.0),
        ("sin", inf, nan),
        ("cos", -inf, nan),
        ("sin", -0.0, -0.0),
        ("cos", -0.0, 1.0),
    ] {
        let found = FUNCTIONS.iter().find(|(other, _)| *other == name).unwrap().1(x);
        assert!(same(found, expected), "{name}({x:e}) = {found:e}, not {expected:e}");
    }
    for (name, function) in FUNCTIONS {
        assert!(function(nan).is_nan(), "{name}");
    }
    for (x, y, expected) in [
        (nan, 0.0, 1.0),
        (1.0, nan, 1.0),
        (nan, 1.0, nan),
        (2.0, nan, nan),
        (-2.0, 3.0, -8.0),
        (-2.0, 2.0, 4.0),
        (-2.0, 0.5, nan),
        (-2.0, -3.0, -0.125),
        (0.0, 3.0, 0.0),
        (-0.0, 3.0, -0.0),
        (-0.0, 2.0, 0.0),
        (-0.0, -3.0, -inf),
        (0.0, -0.5, inf),
        (inf, -1.0, 0.0),
        (-inf, 3.0, -inf),
        (-inf, 2.0, inf),
        (-inf, -3.0, -0.0),
        (0.5, inf, 0.0),
        (0.5, -inf, inf),
        (-1.0, inf, 1.0),
        (2.0, inf, inf),
        (2.0, 1024.0, inf),
        (2.0, -1074.0, 5e-324),
        (2.0, -1076.0, 0.0),
        (5e-324, 1.0, 5e-324),
        (-5e-324, 1.0, -5e-324),
        (F::MAX, 1.0, F::MAX),
        (-1.0, 9_007_199_254_740_993.0, 1.0),
        (-1.0, 9_007_199_254_740_991.0, -1.0),
    ] {
        let found = powf(x, y);
        assert!(same(found, expected), "powf({x:e}, {y:e}) = {found:e}, not {expected:e}");
    }
    for (a, b, expected) in [
        (3.0, -4.0, 5.0),
        (inf, nan, inf),
        (nan, -inf, inf),
        (nan, 1.0, nan),
        (0.0, -0.0, 0.0),
        (5e-324, 0.0, 5e-324),
        (3e300, 4e300, 5e300),
        (F::MAX, F::MAX, inf),
    ] {
        let found = hypot(a, b);
        assert!(same(found, expected), "hypot({a:e}, {b:e}) = {found:e}, not {expected:e}");
    }
}

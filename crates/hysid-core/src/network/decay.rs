//! Decay of relaxation neurons without branches or table, so that loops over it become SIMD code.
//!
//! ```text
//! E = e^{-φ},   G = (1 - e^{-φ})/φ,   φ = h/τ                theory.md (1.11)
//!
//! -φ = k ln 2 + s,   m = e^s - 1 = s + s² q(s),   P = 2^k
//! E = P + P m,   1 - E = (1 - P) - P m
//! ```
//!
//! `k` is an integer and `|s| <= (ln 2)/2`. `1 - E` has no cancellation: it is `-m` for `k = 0`, and `P <= 1/2`
//! otherwise. For `φ < 700` the relative errors are below 5e-16; beyond, `E` is 0.

use pulp::Simd;

use crate::simd::{multiply_add, nearest_power};

/// `(e^s - 1 - s) / s²` by powers of `s`, highest first: Chebyshev interpolation of degree 10 on `|s| <= (ln 2)/2`,
/// computed with 70 digits; its relative error in `e^s - 1` is 5e-19.
pub const SQUARE_AND_UP: [f64; 11] = [
    2.09147553258932e-09,
    2.5105312729622103e-08,
    2.755727347871858e-07,
    2.755725517000089e-06,
    2.480158732567746e-05,
    0.0001984126987500228,
    0.0013888888888883711,
    0.008333333333326084,
    0.04166666666666667,
    0.1666666666666667,
    0.5,
];

/// ln 2 as a sum: the first part has so few digits that its products with `k` are exact.
pub const LN_2: [f64; 2] = [0.6931471801362932, 4.236521365809284e-10];

/// From this many relaxation times on, `E` is 0.
const LONGEST: f64 = 700.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Decay {
    /// `E`, the factor of the stress before the step.
    pub stress: f64,
    /// `G`, the factor of the increment of the input.
    pub increment: f64,
    /// `φE`, the derivative of `E` with respect to `ln τ`.
    pub by_ln_tau: f64,
}

/// The factors of a step of `phi` relaxation times, as [`crate::operator::relaxation::decay`] up to rounding.
#[inline(always)]
pub(crate) fn decay<S: Simd>(phi: f64) -> Decay {
    let phi = if phi > 0.0 { phi } else { 0.0 };
    let bounded = if phi < LONGEST { phi } else { LONGEST };
    let (k, power) = nearest_power::<S>(bounded, -std::f64::consts::LOG2_E);
    let s = multiply_add::<S>(-k, LN_2[1], multiply_add::<S>(-k, LN_2[0], -bounded));
    let mut square = SQUARE_AND_UP[0];
    for &coefficient in &SQUARE_AND_UP[1..] {
        square = multiply_add::<S>(square, s, coefficient);
    }
    let m = multiply_add::<S>(s * s, square, s);
    let left = multiply_add::<S>(power, m, power);
    let lost = multiply_add::<S>(-power, m, 1.0 - power);
    let stress = if phi < LONGEST { left } else { 0.0 };
    let increment = if phi > 0.0 { lost / phi } else { 1.0 };
    Decay { stress, increment, by_ln_tau: bounded * stress }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::powf;
    use crate::operator::relaxation;
    use crate::simd;

    struct AllDecays<'a>(&'a [f64]);

    impl pulp::WithSimd for AllDecays<'_> {
        type Output = Vec<Decay>;
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) -> Vec<Decay> {
            let empty = Decay { stress: f64::NAN, increment: f64::NAN, by_ln_tau: f64::NAN };
            let mut found = vec![empty; self.0.len()];
            for (phi, decay) in self.0.iter().zip(&mut found) {
                *decay = super::decay::<S>(*phi);
            }
            found
        }
    }

    #[test]
    fn agrees_with_the_operator() {
        let phi: Vec<f64> = (1..400_000)
            .map(|k| f64::from(k) * 1.7e-3)
            .chain((0..1200).map(|k| powf(10.0, f64::from(-k) / 4.0)))
            .chain([0.0, -0.0, -1.0, f64::NAN, 1e9, f64::INFINITY])
            .collect();
        let of_all = simd::run_with_all(|| AllDecays(&phi));
        assert!(of_all.iter().all(|found| *found == of_all[0]), "instruction sets differ");
        for (&phi, found) in phi.iter().zip(&of_all[0]) {
            let (stress, increment) = relaxation::decay(phi, 1.0);
            let is_near = |found: f64, exact: f64| (found - exact).abs() <= 5e-16 * exact + 1e-300;
            assert!(is_near(found.stress, stress), "E({phi}) = {}, not {stress}", found.stress);
            assert!(is_near(found.increment, increment), "G({phi}) = {}, not {increment}", found.increment);
            let by_ln_tau = if phi > 0.0 && phi < 1e6 { phi * stress } else { 0.0 };
            assert!(is_near(found.by_ln_tau, by_ln_tau), "{phi}: {} is not {by_ln_tau}", found.by_ln_tau);
        }
    }
}

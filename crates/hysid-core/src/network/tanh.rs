//! Hyperbolic tangent without branches or table, so that loops over it become SIMD code.
//!
//! ```text
//! a = k (ln 2)/2 + s,   t = tanh s,   P = 2^k
//!
//! tanh a = (P (1 + t) - (1 - t)) / (P (1 + t) + (1 - t)) = (P - 1 + (P + 1) t) / (P + 1 + (P - 1) t)
//! ```
//!
//! `k` is an integer and `|s| <= (ln 2)/4`. For `k = 0` the result is `t` itself, and for others neither sum cancels. The
//! relative error is below 5e-16 everywhere; the result is exactly odd and never above 1 in magnitude.

use pulp::Simd;

use crate::simd::{multiply_add, nearest_power};

/// `(tanh s / s - 1) / s²` by powers of `s²`, highest first: Chebyshev interpolation of degree 5 on `|s| <= (ln 2)/4`,
/// computed with 60 digits; its relative error in `tanh s` is 2e-17.
pub const CUBIC_AND_UP: [f64; 6] = [
    0.0034639177836130425,
    -0.008858936176728246,
    0.021869421825241465,
    -0.05396825349959849,
    0.13333333333212813,
    -0.3333333333333328,
];

/// tanh, for finite `x`.
#[inline(always)]
pub(crate) fn tanh<S: Simd>(x: f64) -> f64 {
    let (rest, power) = reduced::<S>(x);
    combined::<S>(tanh_of_rest::<S>(rest), power, x)
}

/// Replaces the numbers of a row, which must be finite, by their tanh; `rest` and `power` are room for intermediate results.
///
/// Three short loops, whose vectors wait less for each other's operations than those of a long one.
#[inline(always)]
pub(crate) fn tanh_of_row<S: Simd>(x: &mut [f64], rest: &mut [f64], power: &mut [f64]) {
    for ((&x, rest), power) in x.iter().zip(&mut *rest).zip(&mut *power) {
        let (s, power_of_k) = reduced::<S>(x);
        (*rest, *power) = (tanh_of_rest::<S>(s), power_of_k);
    }
    for ((x, &t), &power) in x.iter_mut().zip(&*rest).zip(&*power) {
        *x = combined::<S>(t, power, *x);
    }
}

/// `s` and `P`.
#[inline(always)]
fn reduced<S: Simd>(x: f64) -> (f64, f64) {
    let magnitude = x.abs();
    // tanh 20 rounds to 1.
    let a = if magnitude < 20.0 { magnitude } else { 20.0 };
    let (k, power) = nearest_power::<S>(a, 2.0 * std::f64::consts::LOG2_E);
    (multiply_add::<S>(-k, 0.5 * std::f64::consts::LN_2, a), power)
}

/// `t`.
#[inline(always)]
fn tanh_of_rest<S: Simd>(s: f64) -> f64 {
    let square = s * s;
    let mut cubic = CUBIC_AND_UP[0];
    for &coefficient in &CUBIC_AND_UP[1..] {
        cubic = multiply_add::<S>(cubic, square, coefficient);
    }
    multiply_add::<S>(square * s, cubic, s)
}

/// The quotient, with the sign of `x`.
#[inline(always)]
fn combined<S: Simd>(t: f64, power: f64, x: f64) -> f64 {
    let (less, more) = (power - 1.0, power + 1.0);
    (multiply_add::<S>(more, t, less) / multiply_add::<S>(less, t, more)).copysign(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::{self, powf};
    use crate::simd;

    struct AllTanh<'a>(&'a [f64]);

    impl pulp::WithSimd for AllTanh<'_> {
        type Output = Vec<f64>;
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) -> Vec<f64> {
            let mut y = vec![0.0; self.0.len()];
            for (x, y) in self.0.iter().zip(&mut y) {
                *y = tanh::<S>(*x);
            }
            y
        }
    }

    #[test]
    fn agrees_with_the_function_of_one_number() {
        let x: Vec<f64> = (-400_000..=400_000)
            .map(|k| k as f64 * 6.1e-5)
            .chain((0..1200).map(|k| powf(10.0, -k as f64 / 4.0)))
            .chain([0.0, 1e300, f64::MAX])
            .collect();
        let of_all = simd::run_with_all(|| AllTanh(&x));
        assert!(of_all.iter().all(|y| *y == of_all[0]), "instruction sets differ");
        let y = &of_all[0];
        for (&x, &y) in x.iter().zip(y) {
            let exact = elementary::tanh(x);
            assert!((y - exact).abs() <= 5e-16 * exact.abs(), "tanh({x}) = {y}, not {exact}");
            assert!(y.abs() <= 1.0);
        }
        let negative: Vec<f64> = x.iter().map(|x| -x).collect();
        let odd = simd::run(AllTanh(&negative));
        assert!(y.iter().zip(&odd).all(|(y, odd)| y.to_bits() == (-odd).to_bits()));
    }
}

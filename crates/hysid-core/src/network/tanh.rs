//! Hyperbolic tangent without branches or table, so that loops over it become SIMD code.
//!
//! ```text
//! tanh a = E / (E + 2),   E = e^{2a} - 1 = 2^k (e^r - 1) + (2^k - 1),   2a = k ln 2 + r
//! ```
//!
//! `k` is an integer and `|r| <= ln 2 / 2`, so neither sum cancels. The relative error is below 5e-16
//! everywhere; the result is exactly odd and never above 1 in magnitude.

use pulp::Simd;

use crate::simd::multiply_add;

/// `(e^r - 1 - r - r²/2) / r³` by powers of r, highest first: Chebyshev interpolation of degree 8 on
/// |r| <= ln 2 / 2, computed with 50 digits; its relative error in `e^r - 1` is 8e-17.
const CUBIC_AND_UP: [f64; 9] = [
    2.5095554677111112e-8,
    2.761380686153829e-7,
    2.755728006701698e-6,
    2.4801536388690766e-5,
    0.0001984126985433861,
    0.0013888888905881542,
    0.008333333333332155,
    0.04166666666665136,
    0.16666666666666666,
];

/// Adding this rounds to an integer and leaves it, plus the bias of the exponent, in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0 + 1023.0;

/// tanh, for finite `x`.
#[inline(always)]
pub(crate) fn tanh<S: Simd>(x: f64) -> f64 {
    let magnitude = x.abs();
    // tanh 20 rounds to 1.
    let a = if magnitude < 20.0 { magnitude } else { 20.0 };
    let rounded = multiply_add::<S>(a, 2.0 * std::f64::consts::LOG2_E, ROUND);
    let k = rounded - ROUND;
    let r = multiply_add::<S>(-k, std::f64::consts::LN_2, a + a);
    let mut cubic = CUBIC_AND_UP[0];
    for &coefficient in &CUBIC_AND_UP[1..] {
        cubic = multiply_add::<S>(cubic, r, coefficient);
    }
    let square_and_up = multiply_add::<S>(cubic, r, 0.5) * r;
    let exp_m1 = multiply_add::<S>(square_and_up, r, r);
    let power = f64::from_bits(rounded.to_bits() << 52);
    let e = multiply_add::<S>(power, exp_m1, power - 1.0);
    (e / (e + 2.0)).copysign(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd;

    struct All<'a>(&'a [f64], &'a mut [f64]);

    impl pulp::WithSimd for All<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            for (x, y) in self.0.iter().zip(self.1) {
                *y = tanh::<S>(*x);
            }
        }
    }

    fn check(dispatch: impl Fn(All)) {
        let x: Vec<f64> = (-400_000..=400_000)
            .map(|k| k as f64 * 6.1e-5)
            .chain((0..1200).map(|k| 10f64.powf(-k as f64 / 4.0)))
            .chain([0.0, 1e300, f64::MAX])
            .collect();
        let mut y = vec![0.0; x.len()];
        dispatch(All(&x, &mut y));
        for (&x, &y) in x.iter().zip(&y) {
            let exact = x.tanh();
            assert!((y - exact).abs() <= 5e-16 * exact.abs(), "tanh({x}) = {y}, not {exact}");
            assert!(y.abs() <= 1.0);
        }
        let negative: Vec<f64> = x.iter().map(|x| -x).collect();
        let mut odd = vec![0.0; x.len()];
        dispatch(All(&negative, &mut odd));
        assert!(y.iter().zip(&odd).all(|(y, odd)| y.to_bits() == (-odd).to_bits()));
    }

    #[test]
    fn agrees_with_the_standard_library() {
        check(|kernel| simd::run(kernel));
    }

    #[test]
    fn agrees_without_simd() {
        check(|kernel| pulp::WithSimd::with_simd(kernel, pulp::Scalar::new()));
    }
}

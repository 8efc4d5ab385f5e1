//! Sine and cosine.
//!
//! ```text
//! x = n π/2 + r,   |r| <= π/4
//! sin r = r + r³ S(r²),   cos r = 1 - r²/2 + r⁴ C(r²)
//! ```

use std::f64::consts::FRAC_PI_4;

use super::error_free::polynomial;
use super::quarter_turns::{FAR, ReducedAngle, turned_far, turned_near};

/// `S(z)`: Chebyshev interpolation of degree 6 on `z <= (π/4)²`, computed with 120 digits; its error is 1.2e-20.
const SINE: [f64; 7] = [
    -7.586691094197958e-13,
    1.6058531516797758e-10,
    -2.5052106231802837e-08,
    2.7557319219337312e-06,
    -0.00019841269841265063,
    0.008333333333333331,
    -0.16666666666666666,
];

/// `C(z)`: degree 5; its error is 1.3e-18.
const COSINE: [f64; 6] = [
    -1.1382623647474604e-11,
    2.087614614655861e-09,
    -2.7557317271145144e-07,
    2.480158729876456e-05,
    -0.0013888888888887398,
    0.041666666666666664,
];

/// Sine of an angle in radians; NaN for infinities.
pub fn sin(x: f64) -> f64 {
    if x.abs() <= FRAC_PI_4 {
        // Up to there x³/6 is less than a rounding error.
        if x.abs() < 1e-8 { x } else { sine(x, 0.0) }
    } else if x.abs() < FAR {
        of_turned(&turned_near(x), 0)
    } else {
        of_far(x, 0)
    }
}

/// Cosine of an angle in radians; NaN for infinities.
pub fn cos(x: f64) -> f64 {
    if x.abs() <= FRAC_PI_4 {
        cosine(x, 0.0)
    } else if x.abs() < FAR {
        of_turned(&turned_near(x), 1)
    } else {
        of_far(x, 1)
    }
}

/// [`sin`] and [`cos`] of one angle.
pub fn sin_cos(x: f64) -> (f64, f64) {
    (sin(x), cos(x))
}

/// The sine of an angle and some quarter turns more. Both functions are computed, which is quicker than a branch that
/// no processor can predict.
#[inline(always)]
fn of_turned(turned: &ReducedAngle, more: u64) -> f64 {
    let quarters = turned.quarters.wrapping_add(more);
    let (sine, cosine) = (sine(turned.r, turned.rest), cosine(turned.r, turned.rest));
    let is_odd = (quarters & 1).wrapping_neg();
    let magnitude = (sine.to_bits() & !is_odd) | (cosine.to_bits() & is_odd);
    f64::from_bits(magnitude ^ ((quarters & 2) << 62))
}

#[cold]
fn of_far(x: f64, more: u64) -> f64 {
    of_turned(&turned_far(x), more)
}

#[inline(always)]
fn sine(r: f64, rest: f64) -> f64 {
    let z = r * r;
    r + (r * z * polynomial(z, SINE) + rest * (1.0 - 0.5 * z))
}

#[inline(always)]
fn cosine(r: f64, rest: f64) -> f64 {
    let z = r * r;
    let half = 0.5 * z;
    let head = 1.0 - half;
    head + (((1.0 - head) - half) + (z * z * polynomial(z, COSINE) - r * rest))
}

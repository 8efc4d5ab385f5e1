//! Hyperbolic functions.
//!
//! ```text
//! tanh a = m/(m + 2),   m = e^(2a) - 1
//! sinh a = ((e^a - 1) - (e^-a - 1))/2
//! asinh a = ln(a + sqrt(1 + a²))
//! ```
//!
//! for `a = |x|`; all three are odd. The terms are sums of two numbers, so that only the last operation rounds much.

use super::error_free::{ordered_sum, product, sum};
use super::exponential::{parts_of_exp_m1, scaled_exp};
use super::logarithm::{exponent_and_fraction, ln_of_sum, reduced};
use super::square_root::root_of_squares;

/// Hyperbolic tangent.
pub fn tanh(x: f64) -> f64 {
    let a = x.abs();
    if a > 20.0 {
        return 1f64.copysign(x);
    }
    // Up to there x³/3 is less than a rounding error.
    if a.is_nan() || a <= 3e-9 {
        return x;
    }
    let (head, rest) = parts_of_exp_m1(2.0 * a);
    let (m, rest) = ordered_sum(head, rest);
    let (below, error) = sum(2.0, m);
    let quotient = m / below;
    let (found, error_found) = product(quotient, below);
    let missing = ((m - found) - error_found) + (rest - quotient * (error + rest));
    (quotient + missing / below).copysign(x)
}

/// Hyperbolic sine.
pub fn sinh(x: f64) -> f64 {
    let a = x.abs();
    if a.is_nan() || a <= 3e-9 {
        return x;
    }
    if a > 40.0 {
        return scaled_exp(a, 0.0, -1).copysign(x);
    }
    let (rising, falling) = (parts_of_exp_m1(a), parts_of_exp_m1(-a));
    let (head, error) = sum(rising.0, -falling.0);
    (0.5 * (head + (error + (rising.1 - falling.1)))).copysign(x)
}

/// Inverse hyperbolic sine.
pub fn asinh(x: f64) -> f64 {
    let a = x.abs();
    // Also NaN and infinities.
    if !(a > 3e-9 && a < f64::INFINITY) {
        return x;
    }
    if a > 1e9 {
        let (exponent, z) = exponent_and_fraction(a);
        return reduced(exponent + 1, z).ln().copysign(x);
    }
    let (root, rest) = if a > 1.0 { root_of_squares(a, 1.0) } else { root_of_squares(1.0, a) };
    let (head, error) = sum(a, root);
    let (head, rest) = ordered_sum(head, error + rest);
    ln_of_sum(head, rest).copysign(x)
}

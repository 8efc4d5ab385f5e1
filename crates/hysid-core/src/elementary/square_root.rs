//! Square roots of sums of squares.

use super::error_free::{ordered_sum, product};
use super::exponential::power_of_two;

/// `sqrt(a² + b²)` as a sum, for `|a| >= |b|`, whose squares must be far from overflow and underflow.
#[inline(always)]
pub(super) fn root_of_squares(a: f64, b: f64) -> (f64, f64) {
    let (square, error) = product(a, a);
    let (other, error_of_other) = product(b, b);
    let (sum, error_of_sum) = ordered_sum(square, other);
    let root = sum.sqrt();
    // One step of Newton's method.
    let (found, error_found) = product(root, root);
    let missing = (sum - found) - error_found + (error_of_sum + (error + error_of_other));
    (root, missing / (2.0 * root))
}

/// `sqrt(a² + b²)` without overflow or underflow on the way.
pub fn hypot(a: f64, b: f64) -> f64 {
    let (a, b) = (a.abs(), b.abs());
    if a == f64::INFINITY || b == f64::INFINITY {
        return f64::INFINITY;
    }
    let (large, small) = if a < b { (b, a) } else { (a, b) };
    let sum = large + small;
    if sum.is_nan() || small <= large * 1e-17 {
        return sum;
    }
    let exponent = if large > 1e150 {
        -600
    } else if small < 1e-130 {
        600
    } else {
        0
    };
    let scale = power_of_two(exponent);
    let (root, rest) = root_of_squares(large * scale, small * scale);
    (root + rest) * power_of_two(-exponent)
}

//! Powers.
//!
//! `x^y = e^(y ln x)`, with `ln x` as a sum of two numbers, whose relative error is about 2^-67.

use super::error_free::{halves, ordered_sum};
use super::exponential::{power_of_two, scaled_exp};
use super::logarithm::{LN_2, ReducedArgument, exponent_and_fraction, is_normal, reduced};

/// `g(u)` of the logarithm: Chebyshev interpolation of degree 6 on `|u| <= 0.0109`, computed with 120 digits; its error is
/// 3e-17.
const CUBE_AND_UP: [f64; 7] = [
    0.11112994726570408,
    -0.1250207197307405,
    0.1428571417421526,
    -0.16666666544018044,
    0.2000000000000165,
    -0.25000000000001815,
    0.3333333333333333,
];

/// `x²`
#[inline(always)]
pub fn square(x: f64) -> f64 {
    x * x
}

/// `x^n` by repeated squaring, from the lowest bit of `|n|`; the inverse of that for a negative `n`.
#[inline]
pub fn powi(x: f64, n: i32) -> f64 {
    let mut left = n.unsigned_abs();
    let (mut power, mut square) = (1.0, x);
    loop {
        if left & 1 == 1 {
            power *= square;
        }
        left >>= 1;
        if left == 0 {
            break;
        }
        square *= square;
    }
    if n < 0 { 1.0 / power } else { power }
}

/// `x^y`; NaN for a negative `x` unless `y` is an integer.
pub fn powf(x: f64, y: f64) -> f64 {
    if is_normal(x) && y.abs() < f64::INFINITY {
        return of_positive(exponent_and_fraction(x), y);
    }
    special(x, y)
}

/// Powers of what is not positive and normal, and with exponents that are not finite.
#[cold]
fn special(x: f64, y: f64) -> f64 {
    if y == 0.0 || x == 1.0 {
        return 1.0;
    }
    if x.is_nan() || y.is_nan() {
        return f64::NAN;
    }
    let magnitude = x.abs();
    if y.is_infinite() {
        return if magnitude == 1.0 {
            1.0
        } else if (magnitude > 1.0) == (y > 0.0) {
            f64::INFINITY
        } else {
            0.0
        };
    }
    let is_integer = y == y.floor();
    let is_odd = is_integer && 0.5 * y != (0.5 * y).floor();
    let power = if magnitude == 0.0 || magnitude == f64::INFINITY {
        if (magnitude == 0.0) == (y > 0.0) { 0.0 } else { f64::INFINITY }
    } else if is_normal(magnitude) && is_integer {
        of_positive(exponent_and_fraction(magnitude), y)
    } else if x > 0.0 || is_integer {
        let (exponent, z) = exponent_and_fraction(magnitude * power_of_two(54));
        of_positive((exponent - 54, z), y)
    } else {
        return f64::NAN;
    };
    if is_odd && x.is_sign_negative() { -power } else { power }
}

/// `(2^exponent z)^y`
#[inline(always)]
fn of_positive((exponent, z): (i64, f64), y: f64) -> f64 {
    let (ln_x, rest_of_ln_x) = accurate_ln(&reduced(exponent, z));
    let (leading_y, rest_of_y) = halves(y);
    // The first product is exact, because both factors have so few bits; or so large that no more is asked.
    scaled_exp(leading_y * ln_x, rest_of_y * ln_x + y * rest_of_ln_x, 0)
}

/// The logarithm as a sum: its leading 26 bits, and the rest.
#[inline(always)]
fn accurate_ln(reduced: &ReducedArgument) -> (f64, f64) {
    let (u_1, u_2) = reduced.u;
    let (head, error) = ordered_sum(reduced.exponent * LN_2[0] + reduced.ln_c[0], u_1);
    // u_1 has so few bits that its square is exact.
    let (head, error_of_square) = ordered_sum(head, -0.5 * (u_1 * u_1));
    let of_table = reduced.exponent * LN_2[1] + reduced.ln_c[1];
    // Short chains: what is known first is summed first, and a last bit of u changes no term of this size.
    let u = reduced.quotient;
    let rest = (of_table + u_2) + (cubic_and_up(u) - u_2 * (0.5 * (u_1 + u)));
    let rest = rest + (error + error_of_square);
    let (leading, _) = halves(head + rest);
    (leading, (head - leading) + rest)
}

/// `u³ g(u)`
#[inline(always)]
fn cubic_and_up(u: f64) -> f64 {
    let [g_6, g_5, g_4, g_3, g_2, g_1, g_0] = CUBE_AND_UP;
    let square = u * u;
    let low = (g_0 + g_1 * u) + square * (g_2 + g_3 * u);
    let high = (g_4 + g_5 * u) + square * g_6;
    (square * u) * (low + (square * square) * high)
}

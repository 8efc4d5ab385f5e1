//! `e^x` and `e^x - 1`.
//!
//! ```text
//! x = (64 k + j) (ln 2)/64 + s,   e^x = 2^k 2^(j/64) (1 + s + s² q(s))
//! ```
//!
//! `k` and `j` are integers, `0 <= j < 64` and `|s| <= (ln 2)/128`. A table holds `2^(j/64)`.

use super::error_free::{ROUND, polynomial, sum};
use super::tables::POWERS_OF_TWO;

/// `64 / ln 2`
const STEPS: f64 = 92.33248261689366;

/// `(ln 2)/64` as a sum: the first part is a multiple of 2^-42, so that its products with integers are exact.
const STEP: [f64; 2] = [0.010830424696223417, 2.572804622327669e-14];

/// `q(s) = (e^s - 1 - s)/s²`: Chebyshev interpolation of degree 4 on `|s| <= (ln 2)/128`, computed with 120 digits; its
/// error is 6e-17. Here and below the highest power is first.
const SQUARE_AND_UP: [f64; 5] =
    [0.001388889799826784, 0.008333340620837088, 0.041666666666659975, 0.16666666666661314, 0.5];

/// `(e^x - 1 - x)/x²`: degree 8 on `|x| <= 11/64`; its error is 1.3e-17.
const SQUARE_AND_UP_WIDE: [f64; 9] = [
    2.7571226596391114e-07,
    2.757400874947859e-06,
    2.4801584213900244e-05,
    0.00019841266135847287,
    0.0013888888889142775,
    0.008333333333638015,
    0.04166666666666661,
    0.166666666666666,
    0.5,
];

/// `e^x`.
pub fn exp(x: f64) -> f64 {
    if x.is_nan() { x } else { scaled_exp(x, 0.0, 0) }
}

/// `2^exponent e^(x + rest)`, for a `rest` far below `x` and a small `exponent`.
#[inline(always)]
pub(super) fn scaled_exp(x: f64, rest: f64, exponent: i64) -> f64 {
    if x > 711.0 {
        return f64::INFINITY;
    }
    if x < -746.0 {
        return 0.0;
    }
    let (power, head, rest) = parts_of_exp(x, rest);
    scaled(head + head * rest, power + exponent)
}

/// `k`, `h` and `r` of `e^(x + rest) = 2^k h (1 + r)`.
#[inline(always)]
fn parts_of_exp(x: f64, rest: f64) -> (i64, f64, f64) {
    let shifted = x * STEPS + ROUND;
    let steps = shifted - ROUND;
    let index = shifted.to_bits() as i64 - ROUND.to_bits() as i64;
    let s = (x - steps * STEP[0]) + (rest - steps * STEP[1]);
    let [head, tail] = POWERS_OF_TWO[(index & 63) as usize];
    (index >> 6, head, tail + (s + s * s * polynomial(s, SQUARE_AND_UP)))
}

/// `2^exponent y`, rounded once, for `y` near 1.
#[inline(always)]
fn scaled(y: f64, exponent: i64) -> f64 {
    match exponent {
        ..-1022 => y * power_of_two(exponent + 200) * power_of_two(-200),
        -1022..=1023 => y * power_of_two(exponent),
        1024.. => y * power_of_two(1023) * power_of_two(exponent - 1023),
    }
}

/// `2^exponent`, for an exponent of normal numbers.
#[inline(always)]
pub(super) fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// `e^x - 1`, accurate near 0.
pub fn exp_m1(x: f64) -> f64 {
    if x.is_nan() || x == 0.0 {
        return x;
    }
    if x > 50.0 {
        return exp(x);
    }
    let (minus_one, rest) = parts_of_exp_m1(x);
    minus_one + rest
}

/// `e^x - 1` as a sum, for `x <= 50`.
#[inline(always)]
pub(super) fn parts_of_exp_m1(x: f64) -> (f64, f64) {
    if x.abs() <= 0.171875 {
        return (x, x * x * polynomial(x, SQUARE_AND_UP_WIDE));
    }
    if x < -40.0 {
        return (-1.0, 0.0);
    }
    let (power, head, rest) = parts_of_exp(x, 0.0);
    let head = head * power_of_two(power);
    let (minus_one, error) = sum(head, -1.0);
    (minus_one, error + head * rest)
}

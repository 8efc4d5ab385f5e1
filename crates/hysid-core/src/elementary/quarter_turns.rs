//! Division of an angle by a quarter turn: `x = n π/2 + r`, `|r| <= π/4`.

use super::error_free::{ROUND, ordered_sum, product, sum};

/// An angle within an eighth of a turn of a multiple of quarter turns.
pub(super) struct ReducedAngle {
    /// `n`, up to multiples of 4
    pub quarters: u64,
    /// `r`, and what rounding to `r` left.
    pub r: f64,
    pub rest: f64,
}

/// Angles below this one, 2^20 quarter turns, are divided in double precision.
pub(super) const FAR: f64 = 1_647_099.0;

/// `2/π`
const INVERSE: f64 = std::f64::consts::FRAC_2_PI;

/// `π/2` as a sum. The first three parts have at most 33 bits, so that products with `n < 2^20` are exact.
const QUARTER: [f64; 4] =
    [1.5707963267341256, 6.077100509014471e-11, -2.5082788063426444e-20, 8.4784276603689e-32];

/// `π/2` as a sum of two numbers.
const ROUNDED_QUARTER: [f64; 2] = [std::f64::consts::FRAC_PI_2, 6.123233995736766e-17];

/// 64 zeros, and the binary digits of `2/π` behind the point, enough for the largest number.
static DIGITS: [u64; 21] = [
    0,
    0xa2f9_836e_4e44_1529,
    0xfc27_57d1_f534_ddc0,
    0xdb62_9599_3c43_9041,
    0xfe51_63ab_debb_c561,
    0xb724_6e3a_424d_d2e0,
    0x0649_2eea_09d1_921c,
    0xfe1d_eb1c_b129_a73e,
    0xe882_35f5_2ebb_4484,
    0xe99c_7026_b45f_7e41,
    0x3991_d639_8353_39f4,
    0x9c84_5f8b_bdf9_283b,
    0x1ff8_97ff_de05_980f,
    0xef2f_118b_5a0a_6d1f,
    0x6d36_7ecf_27cb_09b7,
    0x4f46_3f66_9e5f_ea2d,
    0x7527_bac7_ebe5_f17b,
    0x3d07_39f7_8a52_92ea,
    0x6bfb_5fb1_1f8d_5d08,
    0x5603_3046_fc7b_6bab,
    0xf0cf_bc20_9af4_361d,
];

/// Divides an angle below [`FAR`].
#[inline(always)]
pub(super) fn turned_near(x: f64) -> ReducedAngle {
    let shifted = x * INVERSE + ROUND;
    let n = shifted - ROUND;
    let (r, error) = sum(x - n * QUARTER[0], -n * QUARTER[1]);
    let (r, rest) = if r.abs() > 1e-9 {
        ordered_sum(r, error - n * QUARTER[2])
    } else {
        let (r, second_error) = sum(r, -n * QUARTER[2]);
        ordered_sum(r, error + second_error - n * QUARTER[3])
    };
    ReducedAngle { quarters: shifted.to_bits(), r, rest }
}

/// Divides any angle, with those digits of `2/π` whose products with `x` are neither multiples of 4 nor far below a
/// rounding error; `r` is NaN for an angle that is not finite.
pub(super) fn turned_far(x: f64) -> ReducedAngle {
    if !x.is_finite() {
        return ReducedAngle { quarters: 0, r: f64::NAN, rest: 0.0 };
    }
    let bits = x.to_bits();
    // |x| = mantissa 2^exponent
    let mantissa = (bits & 0x000f_ffff_ffff_ffff) | 0x0010_0000_0000_0000;
    let exponent = ((bits >> 52) & 0x7ff) as i64 - 1075;
    // The products with earlier digits are multiples of 4.
    let first = (64 + exponent - 2) as usize;
    let [high, middle, low] = [0, 64, 128].map(|place| digits(first + place));
    // The product modulo 2^192, without its last word: two digits before the point and 126 behind it.
    let of_low = (u128::from(mantissa) * u128::from(low)) >> 64;
    let of_middle = u128::from(mantissa) * u128::from(middle) + of_low;
    let of_high = mantissa.wrapping_mul(high).wrapping_add((of_middle >> 64) as u64);
    let product = (u128::from(of_high) << 64) | u128::from(of_middle as u64);
    let (whole, fraction) = ((product >> 126) as u64, product << 2);
    // Fractions from 1/2 on are those of the next quarter, minus 1.
    let is_above = fraction >> 127 == 1;
    let quarters = whole.wrapping_add(u64::from(is_above));
    let (r, rest) = angle(if is_above { fraction.wrapping_neg() } else { fraction });
    let is_negative = is_above != (x < 0.0);
    let quarters = if x < 0.0 { quarters.wrapping_neg() } else { quarters };
    if is_negative {
        ReducedAngle { quarters, r: -r, rest: -rest }
    } else {
        ReducedAngle { quarters, r, rest }
    }
}

/// 64 digits of `2/π` from a place on.
fn digits(place: usize) -> u64 {
    let (word, shift) = (place / 64, place % 64);
    match shift {
        0 => DIGITS[word],
        _ => (DIGITS[word] << shift) | (DIGITS[word + 1] >> (64 - shift)),
    }
}

/// `fraction 2^-128 π/2` as a sum.
fn angle(fraction: u128) -> (f64, f64) {
    let shift = fraction.leading_zeros().min(127);
    let digits = fraction << shift;
    let high = (digits >> 75) as f64;
    let low = ((digits >> 22) as u64 & 0x001f_ffff_ffff_ffff) as f64;
    let scale = f64::from_bits(u64::from(1023 - 53 - shift) << 52);
    let (high, low) = (high * scale, low * scale * f64::from_bits((1023 - 53) << 52));
    let (r, error) = product(high, ROUNDED_QUARTER[0]);
    ordered_sum(r, error + (high * ROUNDED_QUARTER[1] + low * ROUNDED_QUARTER[0]))
}

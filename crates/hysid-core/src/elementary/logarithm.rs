//! Natural logarithms.
//!
//! ```text
//! x = 2^k z,   z = c (1 + u),   ln x = k ln 2 + ln c + ln(1 + u)
//! ln(1 + u) = u - u²/2 + u³ g(u)
//! ```
//!
//! `z` lies between 45.5/64 and 91/64, `c` is the multiple of 1/64 next to it, and `|u| < 0.0109`. A table holds `1/c` and
//! `ln c`. The leading bits `u_1` of `u` are few, so that `z - c - c u_1` is exact; with the rest `u_2` the sum
//! `u = u_1 + u_2` has 78 bits.

use super::error_free::{halves, ordered_sum, polynomial, sum};
use super::exponential::power_of_two;
use super::tables::LOGARITHMS;

/// ln 2 as a sum: the first part is a multiple of 2^-42, as the first parts of the table are, so that sums are exact.
pub(super) const LN_2: [f64; 2] = [0.6931471805598903, 5.497923018708371e-14];

/// Bits of 45.5/64.
const LEAST: u64 = 0x3fe6_c000_0000_0000;

/// Adding this constant rounds to a multiple of 1/64, which the low bits of the sum count.
const ROUND: f64 = 105_553_116_266_496.0;

/// `g(u)`: Chebyshev interpolation of degree 5 on `|u| <= 0.0109`, computed with 120 digits; its error is 6e-15.
const CUBE_AND_UP: [f64; 6] = [
    -0.1250177595501851,
    0.1428768756508603,
    -0.16666666587822526,
    0.19999999912395627,
    -0.25000000000000516,
    0.3333333333333391,
];

/// Reduced argument of a logarithm.
pub(super) struct ReducedArgument {
    /// `k`
    pub exponent: f64,
    /// `ln c`, as a sum
    pub ln_c: [f64; 2],
    /// `u_1` and `u_2`
    pub u: (f64, f64),
    /// `u_1 + u_2` up to rounding, which is known before `u_2`
    pub quotient: f64,
    /// `1/c`
    inverse: f64,
}

/// Bits of the least normal number and of infinity.
const NORMAL: [u64; 2] = [0x0010_0000_0000_0000, 0x7ff0_0000_0000_0000];

/// True for positive numbers that are neither subnormal nor infinite.
#[inline(always)]
pub(super) fn is_normal(x: f64) -> bool {
    x.to_bits().wrapping_sub(NORMAL[0]) < NORMAL[1] - NORMAL[0]
}

/// `k` and `z` of a normal, positive number.
#[inline(always)]
pub(super) fn exponent_and_fraction(x: f64) -> (i64, f64) {
    let bits = x.to_bits();
    let exponent = (bits.wrapping_sub(LEAST) as i64) >> 52;
    (exponent, f64::from_bits(bits.wrapping_sub((exponent as u64) << 52)))
}

/// Reduces `2^exponent z` for its logarithm.
#[inline(always)]
pub(super) fn reduced(exponent: i64, z: f64) -> ReducedArgument {
    let shifted = z + ROUND;
    let c = shifted - ROUND;
    let [inverse, ln_c, rest] = LOGARITHMS[((shifted.to_bits() & 127) - 46) as usize];
    let difference = z - c;
    let quotient = difference * inverse;
    let (u, _) = halves(quotient);
    let rest_of_u = (difference - u * c) * inverse;
    ReducedArgument { exponent: exponent as f64, ln_c: [ln_c, rest], u: (u, rest_of_u), quotient, inverse }
}

impl ReducedArgument {
    #[inline(always)]
    pub fn ln(&self) -> f64 {
        let (u_1, u_2) = self.u;
        let u = u_1 + u_2;
        let (head, error) = ordered_sum(self.exponent * LN_2[0] + self.ln_c[0], u_1);
        let rest = (self.exponent * LN_2[1] + self.ln_c[1]) + (error + u_2);
        head + (rest + u * u * (u * polynomial(u, CUBE_AND_UP) - 0.5))
    }
}

/// Natural logarithm; NaN for negative numbers.
pub fn ln(x: f64) -> f64 {
    if is_normal(x) {
        let (exponent, z) = exponent_and_fraction(x);
        return reduced(exponent, z).ln();
    }
    if x > 0.0 && x < f64::INFINITY {
        let (exponent, z) = exponent_and_fraction(x * power_of_two(54));
        return reduced(exponent - 54, z).ln();
    }
    outside(x)
}

/// The logarithm of what is not positive and finite.
fn outside(x: f64) -> f64 {
    if x == 0.0 {
        f64::NEG_INFINITY
    } else if x > 0.0 {
        x
    } else {
        f64::NAN
    }
}

/// `ln(x + d)`, for a `d` that is at most a rounding error of a normal `x`, which lies far from the largest number.
#[inline(always)]
pub(super) fn ln_of_sum(x: f64, d: f64) -> f64 {
    let (exponent, z) = exponent_and_fraction(x);
    let mut reduced = reduced(exponent, z);
    reduced.u.1 += d * power_of_two(-exponent) * reduced.inverse;
    reduced.ln()
}

/// `ln(1 + x)`, accurate near 0.
pub fn ln_1p(x: f64) -> f64 {
    if !(x > -1.0 && x < 1e18) {
        return if x < 1e18 { outside(1.0 + x) } else { ln(x) };
    }
    if x.abs() < 5e-17 {
        return x;
    }
    let (sum, error) = sum(1.0, x);
    ln_of_sum(sum, error)
}

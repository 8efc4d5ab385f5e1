//! `a * b + c` in one rounding where the hardware has no such instruction.

use crate::elementary::error_free::sum;

/// `a * b + c` in one rounding, by sums and products that are not fused.
///
/// The product is split into its rounded value and the error of that (Dekker 1971); the three terms are added with the
/// last but one sum rounded to odd, so that the last rounding is right (Boldo and Melquiond, IEEE Transactions on Computers
/// 57, 2008, doi 10.1109/TC.2007.70819).
#[inline(always)]
pub(super) fn in_software(a: f64, b: f64, c: f64) -> f64 {
    /// Beyond these magnitudes the errors of sums and products are not exact.
    const LARGE: f64 = 1e290;
    const SMALL: f64 = 1e-270;
    /// `2^27 + 1` splits a number into two of 26 bits.
    const SPLIT: f64 = 134_217_729.0;
    let product = a * b;
    let is_common = a.abs() < LARGE && b.abs() < LARGE && product.abs() < LARGE && c.abs() < LARGE;
    if !(is_common && product.abs() > SMALL) {
        return if a == 0.0 || b == 0.0 { product + c } else { by_integers(a, b, c) };
    }
    let halves = |x: f64| {
        let scaled = SPLIT * x;
        let upper = scaled - (scaled - x);
        (upper, x - upper)
    };
    let ((a_upper, a_lower), (b_upper, b_lower)) = (halves(a), halves(b));
    let error = ((a_upper * b_upper - product) + a_upper * b_lower + a_lower * b_upper) + a_lower * b_lower;
    let (added, of_added) = sum(c, error);
    let (total, of_total) = sum(product, added);
    let (rest, of_rest) = sum(of_added, of_total);
    // To odd: if it is not exact and its last bit is 0, it is the neighbour on the side of the error. Without branches,
    // which would be taken at random.
    let bits = rest.to_bits();
    let goes = u64::from(of_rest != 0.0) & !bits & 1;
    let back = goes & u64::from((of_rest > 0.0) != (rest > 0.0));
    let odd = f64::from_bits(bits.wrapping_add(goes).wrapping_sub(2 * back));
    total + odd
}

/// `a * b + c` in one rounding for numbers of any size, as exported C has it (`fused.c.txt` of hysid-export).
///
/// Product and term are integers of 128 bits with their first bit at the same place. What the smaller one loses when it
/// is shifted to the exponent of the larger one sets its last bit, which is far behind the last one of the result.
#[cold]
fn by_integers(a: f64, b: f64, c: f64) -> f64 {
    const INFINITE: u64 = 0x7ff << 52;
    /// Exponents of the last bit of the smallest number, and of the smallest that has all 53 bits.
    const LEAST: i32 = -1074;
    let magnitude = |x: f64| x.to_bits() & !(1 << 63);
    if a == 0.0 || b == 0.0 || magnitude(a) >= INFINITE || magnitude(b) >= INFINITE {
        return a * b + c;
    }
    if magnitude(c) >= INFINITE {
        return c;
    }
    let parts = |x: f64| {
        let (digits, exponent) = (magnitude(x) & ((1 << 52) - 1), (magnitude(x) >> 52) as i32);
        if exponent == 0 { (digits, LEAST) } else { (digits | (1 << 52), exponent - 1 + LEAST) }
    };
    // The first bit comes to place 125, which leaves one for a carry.
    let aligned = |digits: u128, exponent: i32| {
        let by = digits.leading_zeros() as i32 - 2;
        (exponent - by, digits << by)
    };
    let ((a_digits, a_exponent), (b_digits, b_exponent), (c_digits, c_exponent)) =
        (parts(a), parts(b), parts(c));
    let product = aligned(u128::from(a_digits) * u128::from(b_digits), a_exponent + b_exponent);
    let term = if c == 0.0 { (product.0, 0) } else { aligned(c_digits.into(), c_exponent) };
    let is_negative = a.is_sign_negative() != b.is_sign_negative();
    let is_difference = is_negative != c.is_sign_negative();
    let (larger, smaller, is_negative) = match product >= term {
        true => (product, term, is_negative),
        false => (term, product, c.is_sign_negative()),
    };
    let (exponent, by) = (larger.0, (larger.0 - smaller.0).cast_unsigned().min(127));
    let shifted = smaller.1 >> by | u128::from(smaller.1 & ((1 << by) - 1) != 0);
    let total = if is_difference { larger.1 - shifted } else { larger.1 + shifted };
    if total == 0 {
        return 0.0;
    }
    let zeros = total.leading_zeros();
    let (exponent, total) = (exponent - zeros.cast_signed(), total << zeros);
    // The last of 53 bits, or of fewer for a small result.
    let last = (exponent + 75).max(LEAST);
    let dropped = (last - exponent).cast_unsigned();
    let (kept, rest) = match dropped {
        0..128 => (total >> dropped, total << (128 - dropped)),
        128 => (0, total),
        _ => (0, 1),
    };
    let is_above = rest > 1 << 127 || rest == 1 << 127 && kept & 1 == 1;
    let bits = kept as u64 + u64::from(is_above) + ((last - LEAST) as u64) * (1 << 52);
    f64::from_bits(bits.min(INFINITE) | u64::from(is_negative) << 63)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::mix;

    /// Compares with the instruction, or with the correctly rounded function of the system.
    #[allow(clippy::disallowed_methods, reason = "it is what we compare with")]
    fn must_round_once(a: f64, b: f64, c: f64) {
        let exact = a.mul_add(b, c);
        for found in [in_software(a, b, c), by_integers(a, b, c)] {
            let is_same = found.to_bits() == exact.to_bits() || found.is_nan() && exact.is_nan();
            assert!(is_same, "{a:e} * {b:e} + {c:e}: {found:e}, not {exact:e}");
        }
    }

    /// Terms that nearly cancel, that differ widely, and that are beside a tie.
    #[test]
    fn sums_of_common_sizes_are_rounded_once() {
        let mut state = 0;
        let mut next = || {
            state += 1;
            mix(state)
        };
        let mut number = |exponents: u64| {
            let (bits, exponent) = (next(), next());
            let exponent = 1023 - exponents / 2 + exponent % exponents;
            // Few bits in half of the cases, for ties.
            let mantissa = (bits >> 12) & if bits & 1 == 0 { u64::MAX } else { u64::MAX << 30 };
            f64::from_bits((bits & (1 << 63)) | (exponent << 52) | mantissa)
        };
        for round in 0..1_000_000_u32 {
            let [a, b] = [(); 2].map(|()| number(60));
            let c = match round % 4 {
                0 => number(120),
                1 => -(a * b),
                2 => -(a * b) * (1.0 + f64::EPSILON * f64::from(round % 64)),
                _ => number(8) * f64::EPSILON * (a * b),
            };
            must_round_once(a, b, c);
        }
    }

    /// Any bits; products below the smallest number that has all its digits.
    #[test]
    fn sums_of_all_sizes_are_rounded_once() {
        const DIGITS: u64 = (1 << 52) - 1;
        let mut bits = (0..).map(mix);
        let mut next = || bits.next().unwrap();
        for round in 0..1_000_000_u32 {
            let [a, b, c] = [(); 3].map(|()| f64::from_bits(next()));
            let mut with_exponent = |x: f64, least: u64| {
                f64::from_bits(x.to_bits() & (DIGITS | 1 << 63) | (least + next() % 60) << 52)
            };
            let [small_a, small_b] = [with_exponent(a, 490), with_exponent(b, 510)];
            let small_c = with_exponent(c, 0);
            match round % 5 {
                0 => must_round_once(a, b, c),
                1 => must_round_once(a, b, -(a * b)),
                2 => must_round_once(small_a, small_b, small_c * f64::EPSILON),
                3 => must_round_once(small_a, small_b, 0.0),
                _ => must_round_once(small_a, small_b, -(small_a * small_b)),
            }
        }
    }

    #[test]
    fn special_numbers_are_those_of_the_instruction() {
        let numbers = [
            0.0,
            -0.0,
            1.0,
            -1.5,
            5e-324,
            1e-200,
            1e-300,
            1e200,
            f64::MIN_POSITIVE,
            f64::MAX,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
        ];
        for a in numbers {
            for b in numbers {
                for c in numbers {
                    must_round_once(a, b, c);
                }
            }
        }
    }
}

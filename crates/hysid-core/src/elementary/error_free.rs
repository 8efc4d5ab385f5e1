//! Sums and products with their rounding errors: the result and the error are the exact value.

/// Adding this constant rounds to an integer, which the low bits of the sum hold.
pub(super) const ROUND: f64 = 6_755_399_441_055_744.0;

/// `a + b` and the rounding error of that sum.
#[inline(always)]
pub(crate) fn sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// As [`sum`], for `a = 0` or `|a| >= |b|`.
#[inline(always)]
pub(super) fn ordered_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, (a - sum) + b)
}

/// `a * b` and its rounding error, up to 2^-105 of the product. The product must be far from overflow and underflow.
#[inline(always)]
pub(super) fn product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let (a, b) = (halves(a), halves(b));
    (product, ((a.0 * b.0 - product) + a.0 * b.1 + a.1 * b.0) + a.1 * b.1)
}

/// The leading 26 bits of a number, and the rest.
#[inline(always)]
pub(super) fn halves(a: f64) -> (f64, f64) {
    let leading = f64::from_bits(a.to_bits() & !0x7ff_ffff);
    (leading, a - leading)
}

/// Sum of coefficients times powers of `x`, the highest power first. Even and odd powers are summed side by side.
#[inline(always)]
pub(super) fn polynomial<const N: usize>(x: f64, coefficients: [f64; N]) -> f64 {
    let square = x * x;
    let (mut one, mut other) = (coefficients[0], coefficients[1]);
    for k in (2..N - 1).step_by(2) {
        one = one * square + coefficients[k];
        other = other * square + coefficients[k + 1];
    }
    if N % 2 == 1 { (one * square + coefficients[N - 1]) + other * x } else { one * x + other }
}

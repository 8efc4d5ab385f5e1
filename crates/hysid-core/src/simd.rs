//! Run-time choice of the instruction set, from safe code, with one arithmetic for all of them.
//!
//! A kernel is one generic function: `run` compiles it once for each instruction set and calls the
//! widest that this machine has. Its results are the same to the last bit with each of them:
//!
//! - products are added in one rounding everywhere, in software where the hardware has no such instruction;
//! - sums over rows or columns have [`LANES`] partial sums, however long the vectors are, and [`sum_of_lanes`] adds these
//!   in one order;
//! - everything else is computed number by number.

use std::sync::OnceLock;

use pulp::{Arch, Simd, WithSimd};

/// Partial sums of a sum of products: those of the longest vectors.
pub(crate) const LANES: usize = 8;

static ARCH: OnceLock<Arch> = OnceLock::new();

fn arch() -> Arch {
    *ARCH.get_or_init(Arch::new)
}

/// Runs a kernel with the widest instruction set of this machine.
pub(crate) fn run<K: WithSimd>(kernel: K) -> K::Output {
    arch().dispatch(kernel)
}

/// Name of the instruction set in use, for benchmarks and reports.
pub fn instruction_set() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    match arch() {
        Arch::V4(_) => return "AVX-512",
        Arch::V3(_) => return "AVX2 and FMA",
        _ => {}
    }
    "baseline"
}

/// Uses a narrower instruction set than the machine has, to compare them: `AVX2` or `baseline`. False if the machine does
/// not have it, or if a kernel has run before.
pub fn narrow_to(name: &str) -> bool {
    let arch = match name {
        #[cfg(target_arch = "x86_64")]
        "AVX2" => pulp::x86::V3::try_new().map(Arch::V3),
        #[cfg(target_arch = "x86_64")]
        "baseline" => Some(Arch::Scalar),
        _ => None,
    };
    arch.is_some_and(|arch| ARCH.set(arch).is_ok())
}

/// Adding this constant rounds to an integer; the low bits of the sum are that integer plus the exponent bias 1023.
const ROUND: f64 = 6_755_399_441_055_744.0 + 1023.0;

/// The integer `k` next to `a * b`, whose magnitude is below 1023, and `2^k`.
#[inline(always)]
pub(crate) fn nearest_power<S: Simd>(a: f64, b: f64) -> (f64, f64) {
    let rounded = multiply_add::<S>(a, b, ROUND);
    (rounded - ROUND, f64::from_bits(rounded.to_bits() << 52))
}

/// `a * b + c` in one rounding.
#[inline(always)]
pub(crate) fn multiply_add<S: Simd>(a: f64, b: f64, c: f64) -> f64 {
    if S::IS_SCALAR || cfg!(target_family = "wasm") { fused_in_software(a, b, c) } else { a.mul_add(b, c) }
}

/// `a * b + c` in one rounding, lane by lane.
#[inline(always)]
pub(crate) fn multiply_add_lanes<S: Simd>(simd: S, a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
    if S::F64_LANES == 1 {
        let [a, b, c] = [a, b, c].map(|lane| simd.reduce_sum_f64s(lane));
        simd.splat_f64s(multiply_add::<S>(a, b, c))
    } else {
        simd.mul_add_f64s(a, b, c)
    }
}

/// The sum of partial sums, in the order of a vector that is halved three times.
#[inline(always)]
pub(crate) fn sum_of_lanes([a, b, c, d, e, f, g, h]: [f64; LANES]) -> f64 {
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// `a * b + c` in one rounding, by sums and products that are not fused.
///
/// The product is split into its rounded value and the error of that (Dekker 1971); the three terms are added with the
/// last but one sum rounded to odd, so that the last rounding is right (Boldo and Melquiond, IEEE Transactions on Computers
/// 57, 2008, doi 10.1109/TC.2007.70819).
#[inline(always)]
fn fused_in_software(a: f64, b: f64, c: f64) -> f64 {
    /// Beyond these magnitudes the errors of sums and products are not exact.
    const LARGE: f64 = 1e290;
    const SMALL: f64 = 1e-270;
    /// `2^27 + 1` splits a number into two of 26 bits.
    const SPLIT: f64 = 134_217_729.0;
    let product = a * b;
    let is_common = a.abs() < LARGE && b.abs() < LARGE && product.abs() < LARGE && c.abs() < LARGE;
    if !(is_common && (product.abs() > SMALL || a == 0.0 || b == 0.0)) {
        return a.mul_add(b, c);
    }
    let halves = |x: f64| {
        let scaled = SPLIT * x;
        let upper = scaled - (scaled - x);
        (upper, x - upper)
    };
    let ((a_upper, a_lower), (b_upper, b_lower)) = (halves(a), halves(b));
    let error = ((a_upper * b_upper - product) + a_upper * b_lower + a_lower * b_upper) + a_lower * b_lower;
    let (sum, of_sum) = sum_and_error(c, error);
    let (total, of_total) = sum_and_error(product, sum);
    let (rest, of_rest) = sum_and_error(of_sum, of_total);
    // To odd: if it is not exact and its last bit is 0, it is the neighbour on the side of the error.
    let bits = rest.to_bits();
    let away = (of_rest > 0.0) == (rest > 0.0);
    let is_even = bits & 1 == 0;
    let odd = match (of_rest != 0.0 && is_even, away) {
        (false, _) => rest,
        (true, true) => f64::from_bits(bits + 1),
        (true, false) => f64::from_bits(bits - 1),
    };
    total + odd
}

/// A rounded sum and its error (Knuth).
#[inline(always)]
fn sum_and_error(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// Runs a kernel with each instruction set that this machine has.
#[cfg(test)]
pub(crate) fn run_with_all<K: WithSimd>(kernel: impl Fn() -> K) -> Vec<K::Output> {
    let mut outputs = vec![Arch::Scalar.dispatch(kernel())];
    #[cfg(target_arch = "x86_64")]
    {
        outputs.extend(pulp::x86::V3::try_new().map(|simd| Arch::V3(simd).dispatch(kernel())));
        outputs.extend(pulp::x86::V4::try_new().map(|simd| Arch::V4(simd).dispatch(kernel())));
    }
    #[cfg(not(target_arch = "x86_64"))]
    outputs.push(Arch::new().dispatch(kernel()));
    outputs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::mix;

    /// Against the instruction, or the correctly rounded function of the system, for terms that nearly cancel, that
    /// differ widely, and of random bits.
    #[test]
    fn software_rounds_once() {
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
        for round in 0..2_000_000_u32 {
            let [a, b] = [(); 2].map(|()| number(60));
            let c = match round % 4 {
                0 => number(120),
                1 => -(a * b),
                2 => -(a * b) * (1.0 + f64::EPSILON * f64::from(round % 64)),
                _ => number(8) * f64::EPSILON * (a * b),
            };
            let (found, exact) = (fused_in_software(a, b, c), a.mul_add(b, c));
            assert_eq!(found.to_bits(), exact.to_bits(), "{a:e} * {b:e} + {c:e}: {found:e}, not {exact:e}");
        }
        let special =
            [0.0, -0.0, 1.0, -1.5, 5e-324, 1e-200, 1e-300, 1e200, f64::MAX, f64::INFINITY, f64::NAN];
        for a in special {
            for b in special {
                for c in special {
                    let (found, exact) = (fused_in_software(a, b, c), a.mul_add(b, c));
                    let is_same = found.to_bits() == exact.to_bits() || found.is_nan() && exact.is_nan();
                    assert!(is_same, "{a:e} * {b:e} + {c:e}: {found:e}, not {exact:e}");
                }
            }
        }
    }

    struct SumOfLanes([f64; LANES]);

    impl WithSimd for SumOfLanes {
        type Output = f64;
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> f64 {
            let lanes = S::as_simd_f64s(&self.0).0;
            if S::F64_LANES == LANES { simd.reduce_sum_f64s(lanes[0]) } else { sum_of_lanes(self.0) }
        }
    }

    #[test]
    fn lanes_are_summed_in_one_order() {
        for seed in 0..1000 {
            let lanes = std::array::from_fn(|l| mix(8 * seed + l as u64) as f64 / 2f64.powi(50 + l as i32));
            for sum in run_with_all(|| SumOfLanes(lanes)) {
                assert_eq!(sum.to_bits(), sum_of_lanes(lanes).to_bits());
            }
        }
    }
}

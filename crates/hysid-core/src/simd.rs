//! Run-time choice of the instruction set, from safe code, with one arithmetic for all of them.
//!
//! A kernel is one generic function: `run` compiles it once for each instruction set and calls the
//! widest that this machine has. Its results are the same to the last bit with each of them:
//!
//! - products are added in one rounding everywhere, in software where the hardware has no such instruction;
//! - sums over rows or columns have eight partial sums, however long the vectors are, which are added in one order;
//! - everything else is computed number by number.

mod fused;

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

/// `a * b + c` in one rounding, as kernels compute it, with any instruction set.
pub fn product_and_sum(a: f64, b: f64, c: f64) -> f64 {
    fused::in_software(a, b, c)
}

/// `a * b + c` in one rounding.
#[inline(always)]
#[allow(clippy::disallowed_methods, reason = "the instruction rounds as the software does")]
pub(crate) fn multiply_add<S: Simd>(a: f64, b: f64, c: f64) -> f64 {
    if S::IS_SCALAR || cfg!(target_family = "wasm") { fused::in_software(a, b, c) } else { a.mul_add(b, c) }
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
pub(crate) fn sum_of_lanes<S: Simd>(simd: S, lanes: &[f64; LANES]) -> f64 {
    if S::F64_LANES == LANES {
        return simd.reduce_sum_f64s(S::as_simd_f64s(lanes).0[0]);
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
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
    use crate::elementary::powi;
    use crate::random::mix;

    struct SumOfLanes([f64; LANES]);

    impl WithSimd for SumOfLanes {
        type Output = f64;
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> f64 {
            sum_of_lanes(simd, &self.0)
        }
    }

    #[test]
    fn lanes_are_summed_in_one_order() {
        for seed in 0..1000 {
            let lanes = std::array::from_fn(|l| mix(8 * seed + l as u64) as f64 / powi(2.0, 50 + l as i32));
            let sums = run_with_all(|| SumOfLanes(lanes));
            assert!(sums.iter().all(|sum| sum.to_bits() == sums[0].to_bits()));
        }
    }
}

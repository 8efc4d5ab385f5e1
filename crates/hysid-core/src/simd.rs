//! Run-time choice of the instruction set, from safe code.
//!
//! A kernel is one generic function: `run` compiles it once for each instruction set and calls the
//! widest that this machine has. Sums of products are fused where the hardware fuses them; results
//! therefore agree to the last bit on one machine, and to rounding between machines.

use std::sync::LazyLock;

use pulp::{Arch, Simd, WithSimd};

static ARCH: LazyLock<Arch> = LazyLock::new(Arch::new);

/// Runs a kernel with the widest instruction set of this machine.
pub(crate) fn run<K: WithSimd>(kernel: K) -> K::Output {
    ARCH.dispatch(kernel)
}

/// Name of the instruction set in use, for benchmarks and reports.
pub fn instruction_set() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    match *ARCH {
        Arch::V4(_) => return "AVX-512",
        Arch::V3(_) => return "AVX2 and FMA",
        _ => {}
    }
    "baseline"
}

/// Adding this constant rounds to an integer; the low bits of the sum are that integer plus the exponent bias 1023.
const ROUND: f64 = 6_755_399_441_055_744.0 + 1023.0;

/// The integer `k` next to `a * b`, whose magnitude is below 1023, and `2^k`.
#[inline(always)]
pub(crate) fn nearest_power<S: Simd>(a: f64, b: f64) -> (f64, f64) {
    let rounded = multiply_add::<S>(a, b, ROUND);
    (rounded - ROUND, f64::from_bits(rounded.to_bits() << 52))
}

/// `a * b + c`, in one rounding where the hardware fuses; elsewhere `f64::mul_add` would be very slow.
#[inline(always)]
pub(crate) fn multiply_add<S: Simd>(a: f64, b: f64, c: f64) -> f64 {
    if S::IS_SCALAR || cfg!(target_family = "wasm") { a * b + c } else { a.mul_add(b, c) }
}

//! Paths for the tests of laws.

use std::fmt::Debug;

use crate::law::Law;
use crate::law::series::{self, samples_of};

/// Numbers between -1 and 1, the same every time for a seed.
pub(super) fn numbers(seed: u64, count: usize) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    };
    (0..count).map(|_| next()).collect()
}

/// A path from 0 through turning points, with the same number of equal steps to each of them.
pub(super) fn refined(turning: &[f64], parts: u32) -> Vec<f64> {
    let mut from = 0.0;
    let mut path = Vec::new();
    for &to in turning {
        path.extend((1..=parts).map(|part| from + (to - from) * f64::from(part) / f64::from(parts)));
        from = to;
    }
    path
}

/// The outputs along a path without rate and time, from the virgin state.
pub(super) fn run<L: Law>(law: &L, path: &[f64]) -> Vec<f64> {
    series::run(law, &samples_of(path))
}

/// Checks that every output along a path is finite.
pub(super) fn assert_finite<L: Law + Debug>(law: &L, path: &[f64]) {
    assert!(run(law, path).iter().all(|y| y.is_finite()), "{law:?}");
}

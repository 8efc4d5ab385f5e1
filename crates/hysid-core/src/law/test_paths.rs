//! Paths for the tests of laws.

use std::fmt::Debug;

use crate::law::Law;
use crate::law::interval::Interval;
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

/// The outputs along a path without rate and time, from the virgin state.
pub(super) fn run<L: Law>(law: &L, path: &[f64]) -> Vec<f64> {
    series::run(law, &samples_of(path))
}

/// Checks that every output along a path is finite and within the bound of the law for inputs from this path and 0.
pub(super) fn assert_within_bound<L: Law + Debug>(law: &L, path: &[f64]) {
    let x = path.iter().fold(Interval(0.0, 0.0), |x, &v| Interval(x.0.min(v), x.1.max(v)));
    let bound = law.output_bound(x, Interval::point(0.0));
    for y in run(law, path) {
        let slack = 1e-9 * (bound.1 - bound.0).min(f64::MAX);
        assert!(y.is_finite() && y >= bound.0 - slack && y <= bound.1 + slack, "{law:?}: {y} {bound:?}");
    }
}

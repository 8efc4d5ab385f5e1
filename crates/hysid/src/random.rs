//! Random numbers.

pub(crate) use hysid_core::random::mix;
use rand::{Rng, RngExt};

/// A standard normal number, by Box and Muller.
pub(crate) fn normal(generator: &mut impl Rng) -> f64 {
    let (u, v): (f64, f64) = (generator.random(), generator.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

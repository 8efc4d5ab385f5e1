//! Random numbers.

use hysid_core::elementary::{cos, ln};
pub(crate) use hysid_core::random::mix;
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

pub(crate) fn normal(generator: &mut impl Rng) -> f64 {
    let (u, v): (f64, f64) = (generator.random(), generator.random());
    (-2.0 * ln(1.0 - u)).sqrt() * cos(std::f64::consts::TAU * v)
}

/// The seed of one of many draws: each has a generator of its own, so that it does not matter which thread draws first.
pub(crate) fn seed_of(seed: u64, draw: u64) -> u64 {
    seed ^ draw.wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

pub(crate) fn generator(seed: u64, draw: usize) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(seed_of(seed, draw as u64 + 1))
}

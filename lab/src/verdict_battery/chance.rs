//! Numbers by chance: the same names and seed give the same numbers.

use hysid_core::elementary::{cos, ln};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A stream of random numbers.
pub struct Chance(Xoshiro256PlusPlus);

impl Chance {
    /// The stream of this name and seed. Other names do not change it.
    pub fn of(seed: u64, name: &str) -> Self {
        // FNV-1a.
        let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        Self(Xoshiro256PlusPlus::seed_from_u64(hash ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)))
    }

    /// Evenly distributed over 0 ... 1.
    pub fn even(&mut self) -> f64 {
        self.0.random()
    }

    /// Normally distributed with deviation 1, by Box and Muller.
    pub fn normal(&mut self) -> f64 {
        (-2.0 * ln(1.0 - self.even())).sqrt() * cos(std::f64::consts::TAU * self.even())
    }
}

//! Random numbers of excitations.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::noise::normal;

pub(super) struct Draw(Xoshiro256PlusPlus);

impl Draw {
    /// Random numbers of the record with this number: independent of how many others there are.
    pub fn new(seed: u64, index: usize) -> Self {
        let mut of_seed = Xoshiro256PlusPlus::seed_from_u64(seed);
        let of_index = of_seed.random::<u64>().wrapping_add(index as u64);
        Self(Xoshiro256PlusPlus::seed_from_u64(of_index))
    }

    /// Evenly between two values.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// `N(0, 1)`
    pub fn normal(&mut self) -> f64 {
        normal(&mut self.0)
    }
}

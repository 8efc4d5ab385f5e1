//! Random numbers of the cases.

use hysid_core::elementary::{cos, exp, ln};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Deviation of the logarithm of a perturbed parameter.
const SPREAD: f64 = 0.2;

/// Normal numbers beyond are cut, so that no parameter leaves its meaning.
const LARGEST_NORMAL: f64 = 2.5;

/// Random numbers of a case.
pub(super) struct Draw(Xoshiro256PlusPlus);

impl Draw {
    /// Random numbers of the case with this number: independent of how many others there are.
    pub fn new(seed: u64, index: usize) -> Self {
        let mut of_seed = Xoshiro256PlusPlus::seed_from_u64(seed);
        let of_index = of_seed.random::<u64>().wrapping_add(index as u64);
        Self(Xoshiro256PlusPlus::seed_from_u64(of_index))
    }

    /// Evenly between two values.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Evenly between two positive values on a logarithmic scale.
    pub fn logarithmic(&mut self, low: f64, high: f64) -> f64 {
        exp(self.between(ln(low), ln(high)))
    }

    /// A whole number, both ends included.
    pub fn whole(&mut self, low: usize, high: usize) -> usize {
        self.0.random_range(low..=high)
    }

    /// `N(0, 1)`, by Box and Muller
    pub fn normal(&mut self) -> f64 {
        let (u, v): (f64, f64) = (self.0.random(), self.0.random());
        (-2.0 * ln(1.0 - u)).sqrt() * cos(std::f64::consts::TAU * v)
    }

    /// `e^{spread N(0, 1)}`
    pub fn factor(&mut self, spread: f64) -> f64 {
        exp(spread * self.normal().clamp(-LARGEST_NORMAL, LARGEST_NORMAL))
    }

    /// A parameter: the value times `e^{0.2 N(0, 1)}`.
    pub fn around(&mut self, value: f64) -> f64 {
        value * self.factor(SPREAD)
    }

    /// A seed for something else.
    pub fn seed(&mut self) -> u64 {
        self.0.random()
    }
}

//! What the user can choose of a fit.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::network::{Architecture, Family, Sizes};
use crate::rate::RateMethod;
use crate::record::Dataset;

/// What the user can choose; every field has the name of its command-line option.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitOptions {
    /// The network family.
    pub model: Family,
    /// Numbers of neurons.
    #[serde(flatten)]
    pub sizes: Sizes,
    /// Stops do not deteriorate, whatever the family.
    pub no_deterioration: bool,
    /// How the rate is found; `None` for no rate.
    pub rate: Option<RateMethod>,
    /// Random networks to start from.
    pub starts: usize,
    /// Levenberg-Marquardt iterations of each start; the best few get as many again on all data.
    pub epochs: usize,
    /// Seed of the random starts.
    pub seed: u64,
    /// Share of the data held out to choose among the starts.
    pub validation: f64,
    /// Penalties on the weights.
    #[serde(flatten)]
    pub regularisation: Regularisation,
    /// Scored rows that early iterations use at most; the memory runs through every row, and the last
    /// iterations see all.
    pub thin: usize,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            model: Family::XpnnPlus,
            sizes: Sizes::default(),
            no_deterioration: false,
            rate: None,
            starts: 8,
            epochs: 40,
            seed: 1,
            validation: 0.25,
            regularisation: Regularisation::default(),
            thin: 20_000,
        }
    }
}

impl FitOptions {
    /// The network that the options ask for on these data.
    ///
    /// # Errors
    /// Sizes or a number of inputs that the family does not have.
    pub fn architecture(&self, data: &Dataset) -> Result<Architecture> {
        let (inputs, rate) = (data.names().inputs.len(), self.rate.is_some());
        let mut architecture = Architecture::new(self.model, self.sizes, inputs, rate, data.has_time())?;
        architecture.deterioration &= !self.no_deterioration;
        Ok(architecture)
    }
}

/// Penalties on the weights, in scaled units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Regularisation {
    /// λ of theory.md (3.1), on the output weights.
    pub ridge: f64,
    /// κ of theory.md (3.1), on the weights of stops and tanh neurons.
    pub decay: f64,
}

impl Default for Regularisation {
    fn default() -> Self {
        Self { ridge: 1e-6, decay: 1e-7 }
    }
}

impl Regularisation {
    pub(crate) fn check(&self) -> Result<()> {
        for (name, value) in [("ridge", self.ridge), ("decay", self.decay)] {
            if !(0.0..=1e6).contains(&value) {
                return Err(Error::Option(format!("{name} {value} is not between 0 and 1e6")));
            }
        }
        Ok(())
    }
}

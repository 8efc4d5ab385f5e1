//! Names of models.

use serde::{Deserialize, Serialize};

use crate::data::rate::RateMethod;
use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::network::Family;
use crate::options::classical::ClassicalModel;

/// The name of the automatic model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Automatic {
    /// `auto`
    #[default]
    Auto,
}

/// The name of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ModelName {
    /// A network of the family.
    Network(Family),
    /// Another model.
    Classical(ClassicalModel),
    /// `auto`: the best of many models, chosen by cross-validation.
    Auto(Automatic),
}

impl ModelName {
    /// The automatic model.
    pub const AUTO: ModelName = ModelName::Auto(Automatic::Auto);

    /// All models, the networks first, without [`ModelName::AUTO`].
    pub fn all() -> impl Iterator<Item = ModelName> {
        Family::ALL
            .into_iter()
            .map(Self::Network)
            .chain(ClassicalModel::ALL.iter().copied().map(Self::Classical))
    }

    /// The name on the command line and in model files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Network(family) => family.name(),
            Self::Classical(rival) => rival.name(),
            Self::Auto(_) => "auto",
        }
    }

    /// True if the model can use the rate of the input.
    pub fn uses_rate(self) -> bool {
        match self {
            Self::Network(family) => family.uses_rate(),
            Self::Classical(rival) => rival.uses_rate(),
            Self::Auto(_) => true,
        }
    }

    /// True if the model always needs the rate.
    pub fn needs_rate(self) -> bool {
        matches!(self, Self::Classical(law) if law.needs_rate())
    }

    /// True if its internal states before each record can be found together with its parameters; for another model, the past
    /// of the input is.
    pub fn has_free_states(self) -> bool {
        match self {
            Self::Network(_) => false,
            Self::Classical(law) => law.facts().has_free_states || law.has_inertia(),
            Self::Auto(_) => true,
        }
    }

    /// True if it takes more than one input.
    pub fn takes_further_inputs(self) -> bool {
        match self {
            Self::Network(family) => family.takes_further_inputs(),
            Self::Classical(rival) => rival.takes_further_inputs(),
            Self::Auto(_) => true,
        }
    }

    /// Checks that the model can be fitted to the data.
    ///
    /// # Errors
    /// Several inputs for a model that takes one, or no rate or time for a law that needs it.
    pub fn check_data(self, data: &Dataset, rate: Option<RateMethod>) -> Result<()> {
        let found = data.names().inputs.len();
        if found > 1 && !self.takes_further_inputs() {
            return Err(Error::SeveralInputs { model: self.name(), found });
        }
        match self {
            Self::Classical(rival) if rival.needs_rate() && rate.is_none() => {
                Err(Error::RateNeeded(rival.name()))
            }
            Self::Classical(rival) if rival.needs_time() && !data.has_time() => {
                Err(Error::TimeNeeded(rival.name()))
            }
            _ => Ok(()),
        }
    }
}

impl std::str::FromStr for ModelName {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let known = if name == "epnn" { "xpnn" } else { name };
        let all = || std::iter::once(Self::AUTO).chain(Self::all());
        all().find(|model| model.name() == known).ok_or_else(|| {
            let known = all().map(Self::name).collect();
            Error::UnknownName { what: "model", name: name.into(), known }
        })
    }
}

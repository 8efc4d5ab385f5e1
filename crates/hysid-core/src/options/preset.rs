//! Default values of options, typed: what the code takes and what help, pages and the Python package print.

use std::fmt;

use crate::options::ModelName;
use crate::options::classical::{ClassicalOptions, FittedError};

/// The default of an option for one model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Preset {
    /// A number of things.
    Count(usize),
    /// A count, and another one with `degradation`.
    WithDegradation(usize, usize),
    /// A penalty, or nearly 0 where that lowers the cross-validation error.
    Penalty(f64),
    /// One of the option's names.
    Name(&'static str),
    /// True.
    On,
    /// Not given.
    Off,
    /// Cross-validation chooses.
    Chosen,
    /// Each candidate of `auto` has its own.
    ByCandidate,
    /// No held-out share: the folds of a cross-validation.
    Folds,
    /// The error of each record or of the rows, by the sizes of the records.
    BySizes,
}

impl fmt::Display for Preset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(count) => write!(f, "{count}"),
            Self::WithDegradation(plain, degrading) => write!(f, "{plain} ({degrading} with degradation)"),
            Self::Penalty(penalty) => {
                write!(f, "{penalty:e} (nearly 0 where that lowers the cross-validation error)")
            }
            Self::Name(name) => f.write_str(name),
            Self::On => f.write_str("true"),
            Self::Off => f.write_str("off"),
            Self::Chosen => f.write_str("chosen by cross-validation"),
            Self::ByCandidate => f.write_str("set by each candidate"),
            Self::Folds => f.write_str("the folds of a cross-validation"),
            Self::BySizes => write!(
                f,
                "{} with free initial states, or if the root mean squares of the records differ by more than {} times; \
                 otherwise {}",
                FittedError::Record.name(),
                ClassicalOptions::RATIO_OF_SIZES,
                FittedError::Row.name()
            ),
        }
    }
}

/// The default count of an option that laws and networks have: the law's own, or that of networks.
pub(super) fn count_of(model: ModelName, option: &str, of_networks: usize) -> Preset {
    let ModelName::Classical(law) = model else { return Preset::Count(of_networks) };
    let [plain, degrading] = [false, true].map(|degradation| law.facts().default_of(option, degradation));
    if plain == degrading { Preset::Count(plain) } else { Preset::WithDegradation(plain, degrading) }
}

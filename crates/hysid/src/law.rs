//! The classical models of hysteresis: those the paper describes, compares with or generates data from.
//!
//! Each is a law with a few parameters in the user's units and the field's symbols, one a file, equation
//! on top; its state is apart from it. They are fitted from the same records as the networks and run in
//! the same ways.

pub mod bouc_wen;
pub mod generalized_prandtl_ishlinskii;
pub mod jiles_atherton;
pub mod masing;
pub mod modified_prandtl_ishlinskii;
pub mod neuro_madelung;
pub(crate) mod play_weights;
pub mod prandtl_ishlinskii;
pub mod preisach;
pub mod rate_dependent_prandtl_ishlinskii;
pub mod series;
pub(crate) mod thresholds;
pub mod turning_point_stack;

use serde::{Deserialize, Serialize};

use crate::error::{Error, LARGEST_VALUE, Result};

/// What a law is told of one more sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The input.
    pub x: f64,
    /// Its rate; 0 for a law that does not ask for it.
    pub rate: f64,
    /// Time since the sample before; 0 at the first of a record.
    pub step: f64,
}

impl Sample {
    /// As a law takes it: values beyond [`LARGEST_VALUE`] are taken as that, so that nothing overflows.
    pub(crate) fn limited(self) -> Self {
        let limited = |value: f64| value.clamp(-LARGEST_VALUE, LARGEST_VALUE);
        Self { x: limited(self.x), rate: limited(self.rate), step: limited(self.step) }
    }
}

/// What every classical model can do.
pub trait Law {
    /// What it knows of the past.
    type State: Clone + std::fmt::Debug;

    /// The state before the first sample of a record.
    fn virgin(&self) -> Self::State;

    /// Takes one more sample and gives the output.
    fn step(&self, state: &mut Self::State, sample: Sample) -> f64;

    /// Its parameters, in the field's symbols.
    fn parameters(&self) -> Vec<Parameter>;
}

/// A parameter of a law.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// The field's symbol, such as `r_3`.
    pub symbol: String,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// Its value, in the user's units.
    pub value: f64,
    /// Smallest and largest value it may have.
    pub bounds: (f64, f64),
    /// Its unit.
    pub unit: Dimension,
}

impl Parameter {
    /// A parameter from its symbol, meaning, value, bounds and unit.
    pub fn new(
        symbol: impl Into<String>,
        meaning: &'static str,
        value: f64,
        bounds: (f64, f64),
        unit: Dimension,
    ) -> Self {
        Self { symbol: symbol.into(), meaning, value, bounds, unit }
    }

    /// Refuses a value that is not finite or out of bounds.
    pub(crate) fn check(&self, law: &str) -> Result<()> {
        let (low, high) = self.bounds;
        if self.value >= low && self.value <= high {
            return Ok(());
        }
        let Self { symbol, meaning, value, .. } = self;
        Err(Error::Option(format!(
            "{law}: {symbol} ({meaning}) is {value}, and must be from {low} to {high}"
        )))
    }
}

/// A unit as a product of powers of the data's units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Dimension {
    /// Power of the input's unit.
    pub input: i32,
    /// Power of the output's unit.
    pub output: i32,
    /// Power of the unit of time.
    pub time: i32,
}

impl Dimension {
    /// A pure number.
    pub const NONE: Self = Self { input: 0, output: 0, time: 0 };
    /// As the input.
    pub const INPUT: Self = Self { input: 1, output: 0, time: 0 };
    /// As the output.
    pub const OUTPUT: Self = Self { input: 0, output: 1, time: 0 };
    /// Output for input, as a stiffness.
    pub const SLOPE: Self = Self { input: -1, output: 1, time: 0 };

    /// The unit in words, such as `kN/mm`, from those of the data; empty for a pure number, and where a
    /// unit that it takes is not known.
    pub fn unit(self, input: Option<&str>, output: Option<&str>, time: Option<&str>) -> String {
        let powers = [(self.output, output), (self.input, input), (self.time, time)];
        if powers.iter().any(|(power, unit)| *power != 0 && unit.is_none()) {
            return String::new();
        }
        let factors = |above: bool| -> Vec<String> {
            let wanted = powers.iter().filter(|(power, _)| *power != 0 && (*power > 0) == above);
            let factor = |&(power, unit): &(i32, Option<&str>)| {
                let unit = unit.unwrap_or_default();
                // A unit that is a quotient itself is bracketed, so that it is read as one.
                let unit = if unit.contains('/') { format!("({unit})") } else { unit.to_string() };
                if power.abs() == 1 { unit } else { format!("{unit}^{}", power.abs()) }
            };
            wanted.map(factor).collect()
        };
        match (factors(true).join(" "), factors(false).join(" ")) {
            (above, below) if below.is_empty() => above,
            (above, below) if above.is_empty() => format!("1/{below}"),
            (above, below) => format!("{above}/{below}"),
        }
    }
}

impl Classical {
    /// The law, if its parameters are what they may be. Laws that are linear in their weights are checked
    /// when they are read.
    ///
    /// # Errors
    /// A parameter that is not finite or out of bounds.
    pub fn validated(self) -> Result<Self> {
        Ok(match self {
            Self::GeneralizedPrandtlIshlinskii(law) => law.validated()?.into(),
            Self::RateDependentPrandtlIshlinskii(law) => law.validated()?.into(),
            Self::NeuroMadelung(law) => law.validated()?.into(),
            Self::BoucWen(law) => law.validated()?.into(),
            Self::JilesAtherton(law) => law.validated()?.into(),
            checked @ (Self::Masing(_)
            | Self::PrandtlIshlinskii(_)
            | Self::ModifiedPrandtlIshlinskii(_)
            | Self::Preisach(_)) => checked,
        })
    }
}

/// Makes of the laws one type that is any of them.
macro_rules! any_of {
    ($($law:ident),* $(,)?) => {
        /// Any of the classical models.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum Classical {
            $(#[doc = concat!("See [`", stringify!($law), "`].")] $law($law),)*
        }

        /// The state of any of them.
        #[derive(Debug, Clone)]
        pub enum ClassicalState {
            $(#[doc = concat!("Of [`", stringify!($law), "`].")] $law(<$law as Law>::State),)*
        }

        impl Law for Classical {
            type State = ClassicalState;

            fn virgin(&self) -> ClassicalState {
                match self {
                    $(Self::$law(law) => ClassicalState::$law(law.virgin()),)*
                }
            }

            fn step(&self, state: &mut ClassicalState, sample: Sample) -> f64 {
                match (self, state) {
                    $((Self::$law(law), ClassicalState::$law(state)) => law.step(state, sample),)*
                    (law, state) => panic!("{state:?} is no state of {law:?}"),
                }
            }

            fn parameters(&self) -> Vec<Parameter> {
                match self {
                    $(Self::$law(law) => law.parameters(),)*
                }
            }
        }

        impl Classical {
            /// Free run from the virgin state.
            pub fn run(&self, samples: &[Sample]) -> Vec<f64> {
                match self {
                    $(Self::$law(law) => series::run(law, samples),)*
                }
            }
        }

        impl Classical {
            /// Runs on from a state of this law.
            pub(crate) fn run_on(&self, state: &mut ClassicalState, samples: &[Sample], outputs: &mut [f64]) {
                match (self, state) {
                    $((Self::$law(law), ClassicalState::$law(state)) => {
                        series::run_on(law, state, samples, outputs);
                    })*
                    (law, state) => panic!("{state:?} is no state of {law:?}"),
                }
            }
        }

        $(impl From<$law> for Classical {
            fn from(law: $law) -> Self {
                Self::$law(law)
            }
        })*
    };
}

use bouc_wen::BoucWen;
use generalized_prandtl_ishlinskii::GeneralizedPrandtlIshlinskii;
use jiles_atherton::JilesAtherton;
use masing::Masing;
use modified_prandtl_ishlinskii::ModifiedPrandtlIshlinskii;
use neuro_madelung::NeuroMadelung;
use prandtl_ishlinskii::PrandtlIshlinskii;
use preisach::Preisach;
use rate_dependent_prandtl_ishlinskii::RateDependentPrandtlIshlinskii;

any_of!(
    Masing,
    PrandtlIshlinskii,
    ModifiedPrandtlIshlinskii,
    GeneralizedPrandtlIshlinskii,
    RateDependentPrandtlIshlinskii,
    Preisach,
    NeuroMadelung,
    BoucWen,
    JilesAtherton,
);

//! The classical models of hysteresis: those the paper describes, compares with or generates data from.
//!
//! Each is a law with a few parameters in the user's units and the field's symbols, one a file, equation
//! on top; its state is apart from it. They are fitted from the same records as the networks and run in
//! the same ways.

pub mod bouc_wen;
pub mod facts;
pub mod generalized_prandtl_ishlinskii;
pub mod interval;
pub mod jiles_atherton;
pub mod lugre;
pub mod masing;
pub mod modified_prandtl_ishlinskii;
pub mod neuro_madelung;
pub mod play_weights;
pub mod prandtl_ishlinskii;
pub mod preisach;
pub mod properties;
pub mod rate_dependent_prandtl_ishlinskii;
pub mod series;
pub mod thresholds;
pub mod turning_point_stack;

use serde::{Deserialize, Serialize};

use crate::error::{Error, LARGEST_VALUE, Result};
use crate::law::facts::Facts;
use crate::law::interval::Interval;
use crate::property::Property;

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

/// A classical model, with all that is known of it: its equations, and what follows from them.
pub trait Law: Sized {
    /// What it knows of the past.
    type State: Clone + std::fmt::Debug;

    /// What is true of it whatever its parameters.
    const FACTS: Facts;

    /// The state before the first sample of a record.
    fn virgin(&self) -> Self::State;

    /// Takes one more sample and gives the output.
    fn step(&self, state: &mut Self::State, sample: Sample) -> f64;

    /// Its parameters, in the field's symbols.
    fn parameters(&self) -> Vec<Parameter>;

    /// The law itself if its parameters are what they may be. A law that can only be made of such parameters has
    /// nothing to check.
    ///
    /// # Errors
    /// A parameter that is not finite or out of bounds, or parts that do not belong together.
    fn validated(self) -> Result<Self> {
        Ok(self)
    }

    /// True if the output depends on the rate of the input.
    fn sees_rate(&self) -> bool {
        false
    }

    /// True if a move of the input in one direction gives the same in one sample as in many.
    fn is_step_free(&self) -> bool {
        !self.sees_rate()
    }

    /// Properties of its memory that the equations decide, whether it has each; where a property is about the output
    /// turned about 0, only with an input that is measured from 0. A property of memory is that at a vanishing rate.
    fn memory_properties(&self, about_origin: bool) -> Vec<(Property, bool)>;

    /// Outputs that are possible from the virgin state on, for inputs and rates within these: theory.md (10.42).
    fn output_bound(&self, x: Interval, rate: Interval) -> Interval;

    /// Slope `dy/dx` of the output where the input moves on from `state` at `x`, upwards for a positive direction
    /// and downwards for a negative one; at a vanishing rate.
    ///
    /// By a difference over a millionth of the largest parameter that has the unit of the input: exact to rounding
    /// for laws of pieces that are straight, but next to a kink.
    fn tangent(&self, state: &Self::State, x: f64, direction: f64) -> f64 {
        let has_unit_of_input = |parameter: &Parameter| parameter.unit == Dimension::INPUT;
        let scales =
            self.parameters().into_iter().filter(has_unit_of_input).map(|parameter| parameter.value.abs());
        let scale = scales.fold(0.0, f64::max);
        let by = direction.signum() * 1e-6 * if scale > 0.0 { scale } else { x.abs().max(1.0) };
        let mut state = state.clone();
        let mut at = |x: f64| self.step(&mut state, Sample { x, rate: 0.0, step: 0.0 });
        let (here, there) = (at(x), at(x + by));
        (there - here) / by
    }
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
    pub(crate) fn check(&self, law: &'static str) -> Result<()> {
        let (low, high) = self.bounds;
        if self.value >= low && self.value <= high {
            return Ok(());
        }
        let Self { symbol, meaning, value, .. } = self;
        Err(Error::Parameter { law, symbol: symbol.clone(), meaning, value: *value, low, high })
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

/// Methods of any law that are those of the law that it is.
macro_rules! each_law {
    ($($law:ident)*:) => {};
    ($($law:ident)*: $(#[$doc:meta])* $name:ident($($argument:ident: $of:ty),*) -> $result:ty; $($more:tt)*) => {
        $(#[$doc])*
        pub fn $name(&self $(, $argument: $of)*) -> $result {
            each_law!(@match self, $name($($argument),*), $($law)*)
        }

        each_law! { $($law)*: $($more)* }
    };
    (@match $self:ident, $name:ident $arguments:tt, $($law:ident)*) => {
        match $self {
            $(Self::$law(law) => each_law!(@call law, $name $arguments),)*
        }
    };
    (@call $law:ident, $name:ident ($($argument:ident),*)) => { $law.$name($($argument),*) };
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

        impl Classical {
            /// What is true of the law whatever its parameters.
            pub fn facts(&self) -> &'static Facts {
                match self {
                    $(Self::$law(_) => &<$law as Law>::FACTS,)*
                }
            }

            /// As [`Law::virgin`].
            pub fn virgin(&self) -> ClassicalState {
                match self {
                    $(Self::$law(law) => ClassicalState::$law(law.virgin()),)*
                }
            }

            /// As [`Law::step`].
            ///
            /// # Panics
            /// A state of another law.
            pub fn step(&self, state: &mut ClassicalState, sample: Sample) -> f64 {
                match (self, state) {
                    $((Self::$law(law), ClassicalState::$law(state)) => law.step(state, sample),)*
                    (law, state) => panic!("{state:?} is no state of {law:?}"),
                }
            }

            /// As [`Law::tangent`].
            ///
            /// # Panics
            /// A state of another law.
            pub fn tangent(&self, state: &ClassicalState, x: f64, direction: f64) -> f64 {
                match (self, state) {
                    $((Self::$law(law), ClassicalState::$law(state)) => law.tangent(state, x, direction),)*
                    (law, state) => panic!("{state:?} is no state of {law:?}"),
                }
            }

            /// As [`Law::validated`].
            ///
            /// # Errors
            /// As [`Law::validated`].
            pub fn validated(self) -> Result<Self> {
                Ok(match self {
                    $(Self::$law(law) => Self::$law(law.validated()?),)*
                })
            }

            each_law! { $($law)*:
                /// As [`Law::parameters`].
                parameters() -> Vec<Parameter>;
                /// As [`Law::sees_rate`].
                sees_rate() -> bool;
                /// As [`Law::is_step_free`].
                is_step_free() -> bool;
                /// As [`Law::memory_properties`].
                memory_properties(about_origin: bool) -> Vec<(Property, bool)>;
                /// As [`Law::output_bound`].
                output_bound(x: Interval, rate: Interval) -> Interval;
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
use lugre::Lugre;
use masing::Masing;
use modified_prandtl_ishlinskii::ModifiedPrandtlIshlinskii;
use neuro_madelung::NeuroMadelung;
use prandtl_ishlinskii::PrandtlIshlinskii;
use preisach::Preisach;
use rate_dependent_prandtl_ishlinskii::RateDependentPrandtlIshlinskii;

/// Calls a macro with every law: a new one is its file and a word here.
#[doc(hidden)]
#[macro_export]
macro_rules! for_each_law {
    ($macro:ident) => {
        $macro! {
            Masing,
            PrandtlIshlinskii,
            ModifiedPrandtlIshlinskii,
            GeneralizedPrandtlIshlinskii,
            RateDependentPrandtlIshlinskii,
            Preisach,
            NeuroMadelung,
            BoucWen,
            JilesAtherton,
            Lugre,
        }
    };
}

for_each_law!(any_of);

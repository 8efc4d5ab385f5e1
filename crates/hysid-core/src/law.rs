//! Classical models of hysteresis: laws with a few parameters in the user's units.
//!
//! | law | equation | memory |
//! |---|---|---|
//! | [`Masing`](masing::Masing) | `y = y* + 2 g((x - x*)/2)` from the turning point `(x*, y*)` | turning points |
//! | [`PrandtlIshlinskii`](prandtl_ishlinskii::PrandtlIshlinskii) | `y = c + w_0 x + Σ_i w_i p_{r_i}[x]`, plays `p` | plays |
//! | [`ModifiedPrandtlIshlinskii`](modified_prandtl_ishlinskii::ModifiedPrandtlIshlinskii) | `y = S(c + w_0 x + Σ_i w_i p_{r_i}[x])`, `S` a rising polygon | plays |
//! | [`GeneralizedPrandtlIshlinskii`](generalized_prandtl_ishlinskii::GeneralizedPrandtlIshlinskii) | plays between two curved envelopes | plays |
//! | [`RateDependentPrandtlIshlinskii`](rate_dependent_prandtl_ishlinskii::RateDependentPrandtlIshlinskii) | plays whose thresholds grow with the rate | plays |
//! | [`DynamicPrandtlIshlinskii`](dynamic_prandtl_ishlinskii::DynamicPrandtlIshlinskii) | plays between a lag, relaxation and a resonance | plays, stresses, motion |
//! | [`Preisach`](preisach::Preisach) | `y = c + k x + Σ_j v_j m_j(x) + Σ_ij w_ij R_ij[x]`, relays `R` | turning points |
//! | [`NeuroMadelung`](neuro_madelung::NeuroMadelung) | `y = y_t + (x - x_t) N(x, x_t, y_t, x')`, `N` a small network | turning points |
//! | [`BoucWen`](bouc_wen::BoucWen) | a spring in parallel with an element that yields, with degradation and pinching | `z`, energy |
//! | [`PeakOriented`](peak_oriented::PeakOriented) | reloading leads to the largest displacement so far, pinched; softening, deterioration | largest displacements, branch, work |
//! | [`MenegottoPinto`](menegotto_pinto::MenegottoPinto) | steel: curves between two straight lines, isotropic hardening | branches |
//! | [`RambergOsgood`](ramberg_osgood::RambergOsgood) | a power curve with Masing's rule | turning points |
//! | [`JilesAtherton`](jiles_atherton::JilesAtherton) | differential equation of the magnetisation | magnetisation |
//! | [`Lugre`](lugre::Lugre) | friction of bristles that bend before they slip | deflection |
//! | [`DuhemNn`](duhem_nn::DuhemNn) | recurrent network whose states move with the input and with time | states, plays |
//! | [`HystereticOscillator`](hysteretic_oscillator::HystereticOscillator) | masses on springs, dampers and hysteretic elements | motion, states, stops |
//! | [`HystereticStateSpace`](hysteretic_state_space::HystereticStateSpace) | a linear system with hysteretic elements | motion, states, stops |
//!
//! Each module gives the equations, the source and the properties of its law. The parameters have the field's
//! symbols. The state is separate from the law. Laws are fitted to the same records as networks, and
//! [`Classical`] is any one of them.

pub mod bouc_wen;
pub mod duhem_nn;
pub mod dynamic_prandtl_ishlinskii;
pub mod facts;
pub mod generalized_prandtl_ishlinskii;
mod gram_of_rows;
pub mod hysteretic_dynamics;
pub mod hysteretic_oscillator;
pub mod hysteretic_state_space;
pub mod jiles_atherton;
pub mod lugre;
pub mod masing;
pub mod menegotto_pinto;
pub mod modified_prandtl_ishlinskii;
pub mod neuro_madelung;
pub mod peak_oriented;
pub mod play_weights;
pub mod prandtl_ishlinskii;
pub mod preisach;
pub mod properties;
pub mod ramberg_osgood;
pub mod rate_dependent_prandtl_ishlinskii;
pub mod series;
mod state_search;
mod tanh_layer;
#[cfg(test)]
mod test_paths;
pub mod thresholds;
pub mod turning_point_stack;
mod yield_curve;

use serde::{Deserialize, Serialize};

use crate::elementary::exp;
use crate::error::{Error, LARGEST_VALUE, Result};
use crate::law::facts::Facts;
use crate::property::Property;

/// One sample of the input, as a law takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The input, in its unit.
    pub x: f64,
    /// The rate of the input, in its unit divided by that of time; 0 for a law that ignores it.
    pub rate: f64,
    /// Time since the previous sample, in the unit of time; 0 at the first of a record.
    pub step: f64,
}

impl Sample {
    /// The sample with values limited to the magnitude [`LARGEST_VALUE`], so that nothing overflows.
    pub(crate) fn limited(self) -> Self {
        let limited = |value: f64| value.clamp(-LARGEST_VALUE, LARGEST_VALUE);
        Self { x: limited(self.x), rate: limited(self.rate), step: limited(self.step) }
    }
}

/// A classical model: its equations and what follows from them.
pub trait Law: Sized {
    /// The state: the memory of the law between two samples.
    type State: Clone + std::fmt::Debug;

    /// Facts that hold for all parameters.
    const FACTS: Facts;

    /// The state before the first sample of a record.
    fn virgin(&self) -> Self::State;

    /// Advances the state to the next sample and returns the output there, in its unit.
    fn step(&self, state: &mut Self::State, sample: Sample) -> f64;

    /// Number of inputs beside the first.
    fn further_inputs(&self) -> usize {
        0
    }

    /// As [`Law::step`], with the inputs beside the first, in their units; a law without them ignores these.
    fn step_with(&self, state: &mut Self::State, sample: Sample, further: &[f64]) -> f64 {
        let _ = further;
        self.step(state, sample)
    }

    /// The states before the first of these samples, from the outputs there, NaN where they are not known; `None` for a law
    /// whose states follow from a past of the input. `further` has the columns of the inputs beside the first.
    fn found_states(&self, samples: &[Sample], further: &[&[f64]], known: &[f64]) -> Option<Vec<f64>> {
        let _ = (samples, further, known);
        None
    }

    /// The state before the first sample of a record with these [found states](Law::found_states).
    fn begun_with(&self, states: &[f64]) -> Self::State {
        let _ = states;
        self.virgin()
    }

    /// Rows within which the residual at the end of a known beginning falls to 1/e; 0 for a residual that does not remain.
    fn residual_rows(&self) -> f64 {
        0.0
    }

    /// The next input for `output`, from `state`; `None` without a closed inverse or where its conditions do not hold.
    fn input_for(&self, state: &Self::State, output: f64) -> Option<f64> {
        let _ = (state, output);
        None
    }

    /// Elementary operations of a row in which the input travels so far in so much time, roughly and at most.
    fn work_of_row(&self, travel: f64, time: f64) -> f64 {
        let _ = (travel, time);
        20.0 + 10.0 * self.parameters().len() as f64
    }

    /// The parameters, with the field's symbols.
    fn parameters(&self) -> Vec<Parameter>;

    /// The law itself, if its parameters are valid.
    ///
    /// # Errors
    /// A parameter that is not finite or out of bounds, or parts that cannot be used together.
    fn validated(self) -> Result<Self> {
        Ok(self)
    }

    /// True if the output depends on the rate of the input.
    fn sees_rate(&self) -> bool {
        false
    }

    /// True if the output depends on the time between samples, other than through the rate.
    fn needs_steps(&self) -> bool {
        false
    }

    /// True if it has a mass: its output responds later than by the next sample.
    fn has_inertia(&self) -> bool {
        false
    }

    /// The properties that follow from the equations at a vanishing rate, each with whether the law has it.
    /// `about_origin` is true for an input measured from 0, which odd symmetry needs.
    fn memory_properties(&self, about_origin: bool) -> Vec<(Property, bool)>;
}

/// Share of a residual that remains in the next row, for the rows within which it falls to 1/e; 0 for none.
pub fn remaining_share(residual_rows: f64) -> f64 {
    if residual_rows > 0.0 { exp(-1.0 / residual_rows) } else { 0.0 }
}

/// A parameter of a law.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// The field's symbol, such as `r_3`.
    pub symbol: String,
    /// Its meaning, in a few words.
    pub meaning: &'static str,
    /// Its value, in the user's units.
    pub value: f64,
    /// Smallest and largest valid value.
    pub bounds: (f64, f64),
    /// Its unit.
    pub unit: Dimension,
}

/// Symbol, meaning, value, bounds and unit.
type ParameterRow<'s> = (&'s str, &'static str, f64, (f64, f64), Dimension);

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

    pub(crate) fn table<const N: usize>(rows: [ParameterRow<'_>; N]) -> Vec<Self> {
        let of = |(symbol, meaning, value, bounds, unit)| Self::new(symbol, meaning, value, bounds, unit);
        rows.map(of).into()
    }

    /// One parameter for each value, its number in the symbol.
    pub(crate) fn numbered(
        symbol: &str,
        first: usize,
        values: &[f64],
        meaning: &'static str,
        bounds: (f64, f64),
        unit: Dimension,
    ) -> impl Iterator<Item = Self> {
        let numbers = (first..).zip(values);
        numbers.map(move |(i, &value)| Self::new(format!("{symbol}_{i}"), meaning, value, bounds, unit))
    }

    pub(crate) fn check_all(parameters: &[Self], law: &'static str) -> Result<()> {
        parameters.iter().try_for_each(|parameter| parameter.check(law))
    }

    fn check(&self, law: &'static str) -> Result<()> {
        let (low, high) = self.bounds;
        if self.value >= low && self.value <= high {
            return Ok(());
        }
        let Self { symbol, meaning, value, .. } = self;
        Err(Error::Parameter { law, symbol: symbol.clone(), meaning, value: *value, low, high })
    }
}

/// A unit: the product of these powers of the units of the data.
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
    /// The unit of the input.
    pub const INPUT: Self = Self { input: 1, output: 0, time: 0 };
    /// The unit of the output.
    pub const OUTPUT: Self = Self { input: 0, output: 1, time: 0 };
    /// The unit of the output divided by that of the input, as of a stiffness.
    pub const SLOPE: Self = Self { input: -1, output: 1, time: 0 };
    /// The unit of the input divided by that of the output, as of a compliance.
    pub const COMPLIANCE: Self = Self { input: 1, output: -1, time: 0 };

    /// The unit as text, such as `kN/mm`; empty for a pure number, and if a unit of the data is unknown.
    pub fn unit(self, input: Option<&str>, output: Option<&str>, time: Option<&str>) -> String {
        let powers = [(self.output, output), (self.input, input), (self.time, time)];
        if powers.iter().any(|(power, unit)| *power != 0 && unit.is_none()) {
            return String::new();
        }
        let is_alone = powers.iter().map(|(power, _)| power.abs()).sum::<i32>() == 1;
        let factors = |above: bool| -> Vec<String> {
            let wanted = powers.iter().filter(|(power, _)| *power != 0 && (*power > 0) == above);
            let factor = |&(power, unit): &(i32, Option<&str>)| {
                let unit = unit.unwrap_or_default();
                // A quotient among other factors, or below, is bracketed, so that it is read as one.
                let is_bracketed = unit.contains('/') && !(is_alone && above);
                let unit = if is_bracketed { format!("({unit})") } else { unit.to_string() };
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

/// Stores a law as its parts, which are checked when they are read.
macro_rules! stored_as {
    ($parts:ident of $law:ident in $field:ident) => {
        impl TryFrom<$parts> for $law {
            type Error = crate::error::Error;

            fn try_from(parts: $parts) -> crate::error::Result<Self> {
                Self::new(parts)
            }
        }

        impl From<$law> for $parts {
            fn from(law: $law) -> Self {
                law.$field
            }
        }
    };
}
pub(crate) use stored_as;

/// Makes of the laws one type that is any of them.
macro_rules! any_of {
    ($($module:ident::$law:ident),* $(,)?) => {
        /// Any one of the classical models.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum Classical {
            $(#[doc = concat!("See [`", stringify!($module), "::", stringify!($law), "`].")] $law($module::$law),)*
        }

        /// The state of any one of the classical models.
        #[derive(Debug, Clone)]
        pub enum ClassicalState {
            $(#[doc = concat!("Of [`", stringify!($module), "::", stringify!($law), "`].")] $law(<$module::$law as Law>::State),)*
        }

        impl Classical {
            /// Facts that hold for all parameters.
            pub fn facts(&self) -> &'static Facts {
                match self {
                    $(Self::$law(_) => &<$module::$law as Law>::FACTS,)*
                }
            }

            /// As [`Law::virgin`].
            pub fn virgin(&self) -> ClassicalState {
                match self {
                    $(Self::$law(law) => ClassicalState::$law(law.virgin()),)*
                }
            }

            /// As [`Law::step_with`].
            ///
            /// # Panics
            /// A state of another law.
            pub fn step(&self, state: &mut ClassicalState, sample: Sample, further: &[f64]) -> f64 {
                match (self, state) {
                    $((Self::$law(law), ClassicalState::$law(state)) => law.step_with(state, sample, further),)*
                    (law, state) => panic!("{state:?} is no state of {law:?}"),
                }
            }

            /// As [`Law::found_states`].
            pub fn found_states(&self, samples: &[Sample], further: &[&[f64]], known: &[f64]) -> Option<Vec<f64>> {
                match self {
                    $(Self::$law(law) => law.found_states(samples, further, known),)*
                }
            }

            /// As [`Law::begun_with`].
            pub fn begun_with(&self, states: &[f64]) -> ClassicalState {
                match self {
                    $(Self::$law(law) => ClassicalState::$law(law.begun_with(states)),)*
                }
            }

            /// As [`Law::residual_rows`].
            pub fn residual_rows(&self) -> f64 {
                match self {
                    $(Self::$law(law) => law.residual_rows(),)*
                }
            }

            /// As [`Law::further_inputs`].
            pub fn further_inputs(&self) -> usize {
                match self {
                    $(Self::$law(law) => law.further_inputs(),)*
                }
            }

            /// As [`Law::input_for`].
            ///
            /// # Panics
            /// A state of another law.
            pub fn input_for(&self, state: &ClassicalState, output: f64) -> Option<f64> {
                match (self, state) {
                    $((Self::$law(law), ClassicalState::$law(state)) => law.input_for(state, output),)*
                    (law, state) => panic!("{state:?} is no state of {law:?}"),
                }
            }

            /// As [`Law::validated`].
            pub fn validated(self) -> Result<Self> {
                Ok(match self {
                    $(Self::$law(law) => Self::$law(law.validated()?),)*
                })
            }

            /// As [`Law::parameters`].
            pub fn parameters(&self) -> Vec<Parameter> {
                match self {
                    $(Self::$law(law) => law.parameters(),)*
                }
            }

            /// As [`Law::work_of_row`].
            pub fn work_of_row(&self, travel: f64, time: f64) -> f64 {
                match self {
                    $(Self::$law(law) => law.work_of_row(travel, time),)*
                }
            }

            /// As [`Law::sees_rate`].
            pub fn sees_rate(&self) -> bool {
                match self {
                    $(Self::$law(law) => law.sees_rate(),)*
                }
            }

            /// As [`Law::needs_steps`].
            pub fn needs_steps(&self) -> bool {
                match self {
                    $(Self::$law(law) => law.needs_steps(),)*
                }
            }

            /// As [`Law::has_inertia`].
            pub fn has_inertia(&self) -> bool {
                match self {
                    $(Self::$law(law) => law.has_inertia(),)*
                }
            }

            /// As [`Law::memory_properties`].
            pub fn memory_properties(&self, about_origin: bool) -> Vec<(Property, bool)> {
                match self {
                    $(Self::$law(law) => law.memory_properties(about_origin),)*
                }
            }

            /// The output of each sample in a free run from the virgin state.
            pub fn run(&self, samples: &[Sample]) -> Vec<f64> {
                match self {
                    $(Self::$law(law) => series::run(law, samples),)*
                }
            }

            /// Continues a free run from a state of this law, with the columns of the inputs beside the first.
            pub(crate) fn run_on(
                &self,
                state: &mut ClassicalState,
                samples: &[Sample],
                further: &[&[f64]],
                outputs: &mut [f64],
            ) {
                match (self, state) {
                    $((Self::$law(law), ClassicalState::$law(state)) => {
                        series::run_on(law, state, samples, further, outputs);
                    })*
                    (law, state) => panic!("{state:?} is no state of {law:?}"),
                }
            }
        }

        $(impl From<$module::$law> for Classical {
            fn from(law: $module::$law) -> Self {
                Self::$law(law)
            }
        })*
    };
}

/// Calls a macro with every law, as its module and its type.
#[doc(hidden)]
#[macro_export]
macro_rules! for_each_law {
    ($macro:ident) => {
        $macro! {
            masing::Masing,
            prandtl_ishlinskii::PrandtlIshlinskii,
            modified_prandtl_ishlinskii::ModifiedPrandtlIshlinskii,
            generalized_prandtl_ishlinskii::GeneralizedPrandtlIshlinskii,
            rate_dependent_prandtl_ishlinskii::RateDependentPrandtlIshlinskii,
            dynamic_prandtl_ishlinskii::DynamicPrandtlIshlinskii,
            preisach::Preisach,
            neuro_madelung::NeuroMadelung,
            bouc_wen::BoucWen,
            peak_oriented::PeakOriented,
            menegotto_pinto::MenegottoPinto,
            ramberg_osgood::RambergOsgood,
            jiles_atherton::JilesAtherton,
            lugre::Lugre,
            duhem_nn::DuhemNn,
            hysteretic_oscillator::HystereticOscillator,
            hysteretic_state_space::HystereticStateSpace,
        }
    };
}

for_each_law!(any_of);

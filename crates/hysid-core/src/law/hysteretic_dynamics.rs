//! Vibrating modes with hysteretic elements between them: what a hysteretic oscillator and a hysteretic state space
//! model have in common.
//!
//! ```text
//! q_i'' + 2 ζ_i ω_i q_i' + ω_i² q_i = ω_i² f_i,   f_i = b_i u - Σ_e g_ei r_e             theory.md (15.1)
//! δ_e = Σ_i (D_ei q_i + V_ei p_i) + U_e u,   ν_e = Σ_i D_ei p_i,   p_i = q_i'/ω_i        theory.md (15.2)
//! y = y_0 + σ [d u + Σ_i (q_i + η_i p_i) + Σ_e μ_e r_e]                                  theory.md (15.5)
//! ```
//!
//! `u` is the input divided by its scale, `q_i` the displacement of a mode and `r_e` the force of an [`Element`],
//! which depends on the path of `δ_e`. The numbers of [`Mode`] and [`Element`] are these coefficients.
//!
//! A step follows the modes exactly under forces that go along straight lines, and finds the force `r_e` at its end
//! from the equation in which `δ_e` depends on it (theory.md (15.11)). A row of data is divided into equal steps no
//! longer than [`Dynamics::longest_step`], between which the input follows its [`Hold`].
//!
//! **The output is bounded** for a bounded input, any parameters and any time steps (theory.md (15.12)): the forces
//! of elements are bounded by their weights, `r_e` is limited to that bound even where its equation is not solved, and
//! a mode that is followed exactly under a bounded force cannot leave `|q| ≤ f̄ ∫|S|`, which is finite because `ω` and
//! `ζ` are positive.

mod element;
mod found_states;
mod hold;
#[cfg(test)]
mod instruction_sets;
mod parameters;
mod propagation;
mod sensitivities;
#[cfg(test)]
mod tests;
mod trial;

use pulp::{Simd, WithSimd};
use serde::{Deserialize, Serialize};

use crate::error::{Error, LARGEST_VALUE, Result};
use crate::law::{Dimension, Parameter, Sample};
use crate::simd;

pub use element::Element;
pub use hold::Hold;
pub use parameters::{DynamicsForm, DynamicsLayout};
pub use propagation::Propagation;
pub use sensitivities::{DynamicsDrive, DynamicsRun};
pub use trial::DynamicsMotion;

/// Largest number of modes, of elements and of states of an element.
pub const MOST_PARTS: usize = 10;

/// Largest number of tanh neurons, and of stops, of an element.
pub const MOST_NEURONS: usize = 60;

/// Scaled inputs are limited to this magnitude.
const LARGEST_INPUT: f64 = 1e6;

/// Largest magnitude of a weight.
pub const LARGEST_WEIGHT: f64 = 1e6;

/// Bounds of the damping ratio. From 1 on a mode does not vibrate but creeps.
pub const DAMPING_RATIOS: (f64, f64) = (1e-5, 1e3);

/// Steps that a row of data is divided into at most; after a longer gap they are longer.
pub(crate) const MOST_STEPS: usize = 64;

/// Evaluations of an element in a step, roughly.
const EVALUATIONS: usize = 5;

/// Steps of a quasi-static change of the input, such as that of a lead-in.
pub(crate) const STATIC_STEPS: usize = 16;

/// Options of a fit of a model made of modes and elements.
pub(crate) const FIT_OPTIONS: &[&str] =
    &["modes", "operators", "degradation", "hidden", "states", "starts", "epochs"];

/// Smallest and largest values of such options.
pub const LIMITS: &[(&str, usize, usize)] =
    &[("hidden", 1, MOST_NEURONS), ("operators", 0, MOST_NEURONS), ("states", 0, MOST_PARTS)];

/// A mode of vibration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mode {
    /// `ω > 0`: natural angular frequency, in radians per unit of time.
    pub frequency: f64,
    /// `ζ > 0`: damping ratio.
    pub damping: f64,
    /// `b`: displacement at rest under a unit of scaled input.
    pub gain: f64,
    /// `η`: share of its velocity `p` in the output.
    pub velocity_in_output: f64,
}

/// Numbers of the parts of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ElementShape {
    /// Stops.
    pub stops: usize,
    /// States that move along the path of the displacement.
    pub states: usize,
    /// Tanh neurons.
    pub neurons: usize,
    /// True if the stops deteriorate. The tanh neurons then have no constant, so that an element without states has
    /// opposite forces on opposite paths: a force with a preferred direction would drift through an earthquake.
    pub deteriorates: bool,
}

impl ElementShape {
    /// Number of inputs of the tanh layer, the constant included.
    pub fn inputs(self) -> usize {
        3 + self.stops + self.states
    }

    /// The first input of the tanh layer whose weights are free.
    pub(crate) fn first_free_input(self) -> usize {
        usize::from(self.deteriorates)
    }

    fn first_state(self) -> usize {
        3 + self.stops
    }
}

/// Modes and elements, in the user's units of input, output and time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dynamics {
    /// Divisor of the input, in its unit.
    pub input_scale: f64,
    /// `y_0`: output at rest without input, in its unit.
    pub output_offset: f64,
    /// `σ`: what a displacement of 1 is, in the unit of the output.
    pub output_scale: f64,
    /// `d`: share of the scaled input in the output.
    pub direct: f64,
    /// How the input goes from sample to sample.
    pub hold: Hold,
    /// Longest step of the integration, in the unit of time.
    pub longest_step: f64,
    /// True if a record begins at rest under its first input, false if at rest without input.
    pub begins_under_input: bool,
    /// The modes.
    pub modes: Vec<Mode>,
    /// The hysteretic elements.
    pub elements: Vec<Element>,
}

struct DynamicsStep<'a> {
    dynamics: &'a Dynamics,
    motion: &'a mut DynamicsMotion,
    sample: Sample,
}

impl WithSimd for DynamicsStep<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let Self { dynamics, motion, sample } = self;
        motion.row::<S>(dynamics, sample.x, sample.step);
        motion.output::<S>(dynamics)
    }
}

impl Dynamics {
    /// At rest before the first sample.
    pub(crate) fn virgin(&self) -> DynamicsMotion {
        DynamicsMotion::virgin(self)
    }

    /// Goes to the next sample and returns the output there, in its unit.
    pub(crate) fn step(&self, motion: &mut DynamicsMotion, sample: Sample) -> f64 {
        let y = simd::run(DynamicsStep { dynamics: self, motion, sample });
        self.output_offset + self.output_scale * y
    }

    #[inline(always)]
    fn scaled(&self, x: f64) -> f64 {
        (x / self.input_scale).clamp(-LARGEST_INPUT, LARGEST_INPUT)
    }

    /// Number of equal steps that a row is divided into.
    #[inline(always)]
    fn steps_of(&self, row: f64) -> usize {
        (row / self.longest_step - 1e-6).ceil().clamp(1.0, MOST_STEPS as f64) as usize
    }

    /// Elementary operations of a row of so much time, roughly and at most: each step evaluates the elements several times.
    pub(crate) fn work_of_row(&self, time: f64) -> f64 {
        let of_element = |element: &Element| {
            let ElementShape { neurons, .. } = element.shape();
            10 * self.modes.len() + 20 * (1 + neurons) + 2 * element.layer.len()
        };
        let of_step =
            30 * self.modes.len() + EVALUATIONS * self.elements.iter().map(of_element).sum::<usize>();
        (self.steps_of(time) * of_step) as f64
    }

    /// The free parameters in this form, with their symbols, in scaled units where they have no unit of their own.
    pub(crate) fn parameters(&self, form: DynamicsForm) -> Vec<Parameter> {
        let is_general = form == DynamicsForm::StateSpace;
        let is_coupled = is_general || self.modes.len() > 1;
        let any = (-LARGEST_WEIGHT, LARGEST_WEIGHT);
        let positive = (f64::MIN_POSITIVE, LARGEST_VALUE);
        let per_time = Dimension { input: 0, output: 0, time: -1 };
        let number =
            |symbol: String, meaning, value| Parameter::new(symbol, meaning, value, any, Dimension::NONE);
        let offset = (-LARGEST_VALUE, LARGEST_VALUE);
        let mut all = vec![
            Parameter::new("y0", "output at rest", self.output_offset, offset, Dimension::OUTPUT),
            number("d".into(), "share of the input in the output", self.direct),
        ];
        for (i, mode) in (1..).zip(&self.modes) {
            let frequency = "natural angular frequency of a mode";
            all.extend(Parameter::table([
                (&format!("ω_{i}"), frequency, mode.frequency, positive, per_time),
                (&format!("ζ_{i}"), "damping ratio of a mode", mode.damping, DAMPING_RATIOS, Dimension::NONE),
            ]));
            all.push(number(format!("b_{i}"), "displacement of a mode under a unit input", mode.gain));
            if is_general {
                let share = mode.velocity_in_output;
                all.push(number(format!("η_{i}"), "share of its velocity in the output", share));
            }
        }
        for (e, element) in (1..).zip(&self.elements) {
            let shape = element.shape();
            let free_layer = &element.layer[shape.first_free_input() * shape.neurons..];
            let rows: [(bool, &str, &'static str, &[f64]); 11] = [
                (
                    is_coupled,
                    "D",
                    "share of a mode in the displacement of an element",
                    &element.of_displacements,
                ),
                (is_general, "V", "share of its velocity there", &element.of_velocities),
                (is_general, "U", "share of the input there", &[element.of_input]),
                (is_coupled, "g", "displacement of a mode under a unit force", &element.compliances),
                (is_general, "μ", "share of a force in the output", &[element.in_output]),
                (true, "τ", "share of the velocity in what drives a stop", &element.stop_velocities),
                (true, "A", "weight of a tanh neuron", free_layer),
                (true, "W↑", "weight of a target where the displacement rises", &element.rising),
                (true, "W↓", "weight of a target where the displacement falls", &element.falling),
                (true, "s", "state before the first sample", &element.initial),
                (true, "v", "weight of the force of an element", &element.force),
            ];
            for (_, symbol, meaning, values) in rows.into_iter().filter(|row| row.0) {
                let numbered = (1..).zip(values);
                all.extend(numbered.map(|(k, &value)| number(format!("{symbol}_{e},{k}"), meaning, value)));
            }
            let least = f64::MIN_POSITIVE;
            let of_path = [
                ("ρ", "threshold of a stop", &element.thresholds, least),
                ("λ", "strength that a stop loses per unit of slip", &element.strength_losses, 0.0),
                ("γ", "leak along the path", &element.path_leaks, least),
            ];
            for (symbol, meaning, values, least) in of_path {
                let numbered = (1..).zip(values);
                let bounds = (least, LARGEST_WEIGHT);
                all.extend(numbered.map(|(k, &value)| {
                    Parameter::new(format!("{symbol}_{e},{k}"), meaning, value, bounds, Dimension::NONE)
                }));
            }
        }
        all
    }

    /// Rejects parameters that are out of bounds, and parts that do not go together.
    pub(crate) fn check(&self, law: &'static str) -> Result<()> {
        let refuse = |what: &str| Err(Error::Parts(format!("{law}: {what}")));
        let is_positive = |scale: f64| scale > 0.0 && scale <= LARGEST_VALUE;
        if ![self.input_scale, self.output_scale, self.longest_step].into_iter().all(is_positive) {
            return refuse("a scale or its longest step is not positive");
        }
        if !(1..=MOST_PARTS).contains(&self.modes.len()) || self.elements.len() > MOST_PARTS {
            return refuse("there are too many modes or elements, or none");
        }
        let is_sound = |element: &Element| {
            let shape = element.shape();
            element.is_consistent(shape, self.modes.len())
                && shape.states <= MOST_PARTS
                && shape.neurons.max(shape.stops) <= MOST_NEURONS
        };
        if !self.elements.iter().all(is_sound) {
            return refuse("the parts of an element have lengths that do not go together");
        }
        if self.elements.iter().any(Element::has_forbidden_constant) {
            return refuse(
                "the tanh neurons beside stops that deteriorate have a constant, whose weights must be 0",
            );
        }
        Parameter::check_all(&self.parameters(DynamicsForm::StateSpace), law)
    }
}

/// Makes a law of a type that holds [`Dynamics`]: its form, its default number of modes, its words in errors, its name
/// and its summary.
macro_rules! law_of_dynamics {
    ($law:ident, $form:expr, $modes:literal, $words:literal, $name:literal, $summary:literal, $advice:expr) => {
        impl $crate::law::Law for $law {
            type State = $crate::law::hysteretic_dynamics::DynamicsMotion;

            const FACTS: $crate::law::facts::Facts = $crate::law::facts::Facts {
                kind: $crate::law::facts::LawKind::Inertia,
                nests_modes: matches!($form, $crate::law::hysteretic_dynamics::DynamicsForm::StateSpace),
                advice: $advice,
                needs_time: true,
                limits: $crate::law::hysteretic_dynamics::LIMITS,
                defaults: &[("modes", $modes), ("states", 2), ("hidden", 8), ("starts", 4), ("epochs", 200)],
                // Deteriorating stops in place of memory states.
                defaults_with_degradation: &[("operators", 6), ("states", 0), ("hidden", 4)],
                ..$crate::law::facts::Facts::searched(
                    $name,
                    $summary,
                    $crate::law::hysteretic_dynamics::FIT_OPTIONS,
                    $crate::law::facts::ErrorsInside { softening: 0.6, sigmoid: 0.6, other: 0.6 },
                )
            };

            fn virgin(&self) -> Self::State {
                self.0.virgin()
            }

            fn step(&self, motion: &mut Self::State, sample: $crate::law::Sample) -> f64 {
                self.0.step(motion, sample)
            }

            fn found_states(
                &self,
                samples: &[$crate::law::Sample],
                _: &[&[f64]],
                known: &[f64],
            ) -> Option<Vec<f64>> {
                Some(self.0.found_states(samples, known))
            }

            fn begun_with(&self, states: &[f64]) -> Self::State {
                self.0.begun_with(states)
            }

            fn work_of_row(&self, _: f64, time: f64) -> f64 {
                self.0.work_of_row(time)
            }

            fn parameters(&self) -> Vec<$crate::law::Parameter> {
                self.0.parameters($form)
            }

            fn validated(self) -> $crate::error::Result<Self> {
                self.0.check($words)?;
                Ok(self)
            }

            fn needs_steps(&self) -> bool {
                true
            }

            fn has_inertia(&self) -> bool {
                true
            }

            fn memory_properties(&self, _: bool) -> Vec<($crate::property::Property, bool)> {
                Vec::new()
            }
        }
    };
}

pub(crate) use law_of_dynamics;

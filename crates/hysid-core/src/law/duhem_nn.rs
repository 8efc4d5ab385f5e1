//! Duhem neural network: a recurrent network whose states move only while the input moves or time passes.
//!
//! ```text
//! a_i = 1 - exp(-(c_i |x_k - x_{k-1}| + (t_k - t_{k-1})/τ_i))               theory.md (8.29)
//! h_j = tanh((1 + Σ_m α_jm m) (b_j + A_j [x, v, a, d, e, s_{k-1}]))         theory.md (8.30)
//! s_i = s_i,k-1 + a_i (q_i v + (1 + Σ_m β_im m) Σ_j W_ij h_j - s_i,k-1)     theory.md (8.31)
//! y_k = w · [1, x, v, a, d, e, s, h, m x, m v, m a]                         theory.md (8.32)
//! ```
//!
//! `x` is the input, `v` its rate and `y` the output, all scaled; `t` is the time. `s` are the states, with the
//! leak `c_i` along the path of the input and the relaxation times `τ_i`; `h` are tanh neurons and `e` stops of
//! threshold 1 with trained input weights. Without a rate there is no `v`, and without a rate or time no `τ`. Options
//! add the acceleration `a` of the input; further inputs are direct ones, `d`, or *modulating* ones, `m`, which change
//! the weights slowly, as a temperature does. An odd network has no constants: the opposite input gives the opposite
//! output.
//!
//! Properties: a state is a convex combination of its past and of a bounded target, so that it is bounded for
//! any parameters, inputs and time steps (theory.md (8.35)). The output depends on the rate, if there is one.
//! Minor loops do not close exactly: there is no return-point memory.
//!
//! With short steps the states follow `ds/dt = f(s, x, v)(c |v| + 1/τ)`. With `τ → ∞` this is a generalized Duhem
//! model, `ds/dt = f(s, x, v)|v|`, of which Bouc-Wen is a special case; with `c = 0` it is a layer of
//! relaxation elements. Source: Duhem; Oh and Bernstein, IEEE Transactions on Automatic Control 50 (2005)
//! 631-645, for the generalized Duhem model; the cell and its training are ours.

mod cell;
mod found_states;
#[cfg(test)]
mod instruction_sets;
mod parameters;
mod sensitivities;

use pulp::{Simd, WithSimd};
use serde::{Deserialize, Serialize};

use crate::error::{Error, LARGEST_VALUE, Result};
use crate::law::facts::{ErrorsInside, Facts, LawKind, Rate};
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::property::Property;
use crate::simd;

pub use cell::{ACCELERATION_GAIN, Cell, CellMemory, CellShape, Input, LARGEST_DERIVATIVE};
pub use found_states::StatePrior;
pub use parameters::CellLayout;
pub use sensitivities::CellRun;

/// Largest number of tanh neurons and of stops: the memory of a fit grows with the square of their product.
pub const MOST_NEURONS: usize = 100;

/// Largest number of states.
pub const MOST_STATES: usize = 20;

/// Scaled inputs are limited to this magnitude.
const LARGEST_INPUT: f64 = 1e6;

/// Largest magnitude of a weight: sums of products with scaled inputs stay finite.
pub const LARGEST_WEIGHT: f64 = 1e6;

/// A Duhem neural network in the user's units: its [`Cell`] with the scales of input and output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DuhemNn {
    /// Centre of the input in training, in its unit.
    pub input_centre: f64,
    /// Divisor of the input, in its unit.
    pub input_scale: f64,
    /// Divisor of the rate, in its unit; `None` for a model without rate.
    pub rate_scale: Option<f64>,
    /// Mean of the output in training, in its unit.
    pub output_mean: f64,
    /// Divisor of the output minus its mean, in its unit.
    pub output_scale: f64,
    /// The network, in scaled units; its relaxation times are in the unit of time.
    pub cell: Cell,
    /// Further inputs, in the order of the columns.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further: Vec<FurtherInput>,
    /// Distribution of the states at the beginning of a record; `None` if all records begin with the same states.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beginning: Option<StatePrior>,
}

/// An input of a Duhem neural network beside the first.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FurtherInput {
    /// Centre in training, in its unit.
    pub centre: f64,
    /// Divisor, in its unit.
    pub scale: f64,
    /// True if it is a direct input of the tanh layer and of the output.
    pub is_direct: bool,
    /// True if it modulates the weights.
    pub is_modulating: bool,
}

impl DuhemNn {
    /// A sample in scaled units.
    pub fn scaled(&self, sample: Sample) -> Input {
        let limited = |value: f64| value.clamp(-LARGEST_INPUT, LARGEST_INPUT);
        Input {
            x: limited((sample.x - self.input_centre) / self.input_scale),
            from_origin: limited(sample.x / self.input_scale),
            rate: self.rate_scale.map_or(0.0, |scale| limited(sample.rate / scale)),
            step: sample.step,
        }
    }

    /// Appends the scaled further inputs of a sample, first the direct, then the modulating ones.
    fn scale_further(&self, further: impl Iterator<Item = f64> + Clone, scaled: &mut Vec<f64>) {
        let all = || self.further.iter().zip(further.clone());
        let value = |(input, value): (&FurtherInput, f64)| {
            ((value - input.centre) / input.scale).clamp(-LARGEST_INPUT, LARGEST_INPUT)
        };
        scaled.extend(all().filter(|(input, _)| input.is_direct).map(value));
        scaled.extend(all().filter(|(input, _)| input.is_modulating).map(value));
    }

    /// The scaled further inputs of so many rows, row by row, from their columns, as [`CellRun::further`] has them.
    pub fn scaled_columns<F: AsRef<[f64]>>(&self, columns: &[F], rows: usize) -> Vec<f64> {
        let mut scaled = Vec::new();
        for row in 0..rows {
            self.scale_further(columns.iter().map(|column| column.as_ref()[row]), &mut scaled);
        }
        scaled
    }
}

struct CellStep<'a> {
    cell: &'a Cell,
    memory: &'a mut CellMemory,
    input: Input,
    further: &'a [f64],
}

impl WithSimd for CellStep<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        self.cell.advance::<S>(self.memory, self.input, self.further);
        self.cell.output::<S>(self.memory)
    }
}

impl Law for DuhemNn {
    type State = CellMemory;

    const FACTS: Facts = Facts {
        rate: Rate::Optional,
        kind: LawKind::Recurrent,
        takes_further_inputs: true,
        has_free_states: true,
        limits: &[("hidden", 1, MOST_NEURONS), ("operators", 0, MOST_NEURONS), ("states", 1, MOST_STATES)],
        ..Facts::searched(
            "duhem-nn",
            "recurrent network whose states move with the input and with time",
            &[
                "operators",
                "hidden",
                "states",
                "starts",
                "epochs",
                "rate_compression",
                "acceleration",
                "odd",
                "error",
            ],
            ErrorsInside { softening: 0.4, sigmoid: 0.4, other: 0.6 },
        )
        .with_defaults(&[
            ("operators", 6),
            ("hidden", 8),
            ("states", 3),
            ("starts", 6),
            ("epochs", 45),
        ])
    };

    fn virgin(&self) -> CellMemory {
        self.cell.memory()
    }

    fn step(&self, memory: &mut CellMemory, sample: Sample) -> f64 {
        let centres: Vec<f64> = self.further.iter().map(|input| input.centre).collect();
        self.step_with(memory, sample, &centres)
    }

    fn step_with(&self, memory: &mut CellMemory, sample: Sample, further: &[f64]) -> f64 {
        let input = self.scaled(sample);
        let mut scaled = std::mem::take(&mut memory.further);
        scaled.clear();
        self.scale_further(further.iter().copied(), &mut scaled);
        let y = simd::run(CellStep { cell: &self.cell, memory, input, further: &scaled });
        memory.further = scaled;
        self.output_mean + self.output_scale * y
    }

    fn further_inputs(&self) -> usize {
        self.further.len()
    }

    fn found_states(&self, samples: &[Sample], further: &[&[f64]], known: &[f64]) -> Option<Vec<f64>> {
        let prior = self.beginning.as_ref()?;
        let drive: Vec<Input> = samples.iter().map(|&sample| self.scaled(sample)).collect();
        let scaled = self.scaled_columns(further, samples.len());
        let output = |y: &f64| (y - self.output_mean) / self.output_scale;
        let mut outputs: Vec<f64> = known.iter().map(output).collect();
        outputs.iter_mut().take(self.cell.shape().rows_without_derivatives()).for_each(|y| *y = f64::NAN);
        Some(self.cell.found_states(prior, &drive, &scaled, &outputs))
    }

    fn begun_with(&self, states: &[f64]) -> CellMemory {
        self.cell.memory_with(states)
    }

    fn residual_rows(&self) -> f64 {
        self.beginning.as_ref().map_or(0.0, |prior| prior.residual_rows)
    }

    fn parameters(&self) -> Vec<Parameter> {
        let shape = self.cell.shape();
        let any = (-LARGEST_WEIGHT, LARGEST_WEIGHT);
        let positive = (f64::MIN_POSITIVE, LARGEST_VALUE);
        let number = |symbol: String, meaning, value: f64| {
            Parameter::new(symbol, meaning, value, any, Dimension::NONE)
        };
        let channels = ["x", "v"];
        let mut signals: Vec<String> = channels[..shape.channels].iter().map(ToString::to_string).collect();
        signals.extend(shape.has_acceleration.then(|| "a".into()));
        let mut inputs = vec![String::new(); shape.constants()];
        inputs.extend(signals.iter().cloned());
        inputs.extend((1..=shape.direct).map(|input| format!("d{input}")));
        inputs.extend((1..=shape.stops).map(|stop| format!("e{stop}")));
        inputs.extend((1..=shape.states).map(|state| format!("s{state}")));

        let mut parameters = Vec::new();
        for (index, &value) in self.cell.stops.iter().enumerate() {
            let (channel, stop) = (channels[index / shape.stops], index % shape.stops + 1);
            parameters.push(number(format!("w_{channel},{stop}"), "input weight of a stop", value));
        }
        for (input, column) in inputs.iter().zip(self.cell.hidden.chunks_exact(shape.neurons)) {
            for (neuron, &value) in (1..).zip(column) {
                parameters.push(match input.is_empty() {
                    true => number(format!("b_{neuron}"), "bias of a tanh neuron", value),
                    false => number(format!("A_{neuron},{input}"), "weight of a tanh neuron", value),
                });
            }
        }
        for (index, &value) in self.cell.layer_modulation.iter().enumerate() {
            let (input, neuron) = (index / shape.neurons + 1, index % shape.neurons + 1);
            parameters.push(number(format!("α_{neuron},{input}"), "modulation of a tanh neuron", value));
        }
        for (index, &value) in self.cell.target_modulation.iter().enumerate() {
            let (input, state) = (index / shape.states + 1, index % shape.states + 1);
            parameters.push(number(format!("β_{state},{input}"), "modulation of a target", value));
        }
        for (index, &value) in self.cell.targets.iter().enumerate() {
            let (state, neuron) = (index / shape.neurons + 1, index % shape.neurons + 1);
            parameters.push(number(format!("W_{state},{neuron}"), "weight of a target", value));
        }
        let time = Dimension { input: 0, output: 0, time: 1 };
        for (symbol, values, meaning, bounds, unit) in [
            ("q", &self.cell.rate_gains, "rate gain of a target", any, Dimension::NONE),
            ("s", &self.cell.initial, "initial value of a state", any, Dimension::NONE),
            ("c", &self.cell.path_leaks, "leak along the path", positive, Dimension::NONE),
            ("τ", &self.cell.relaxation_times, "relaxation time", positive, time),
        ] {
            parameters.extend(Parameter::numbered(symbol, 1, values, meaning, bounds, unit));
        }
        inputs[..shape.constants()].fill("0".into());
        inputs.extend((1..=shape.neurons).map(|neuron| format!("h{neuron}")));
        let modulated = |m| signals.iter().map(move |signal| format!("m{m} {signal}"));
        inputs.extend((1..=shape.modulators).flat_map(modulated));
        for (term, &value) in inputs.iter().zip(&self.cell.output) {
            parameters.push(number(format!("w_{term}"), "weight of the output", value));
        }
        parameters
    }

    fn validated(self) -> Result<Self> {
        let refuse = |what: &str| Err(Error::Parts(format!("Duhem neural network: {what}")));
        let positive = |scale: f64| scale > 0.0 && scale <= LARGEST_VALUE;
        if !(positive(self.input_scale)
            && positive(self.output_scale)
            && self.rate_scale.is_none_or(positive))
        {
            return refuse("a scale is not positive");
        }
        let further = &self.further;
        let is_known = |input: &FurtherInput| input.centre.abs() <= LARGEST_VALUE && positive(input.scale);
        let scales = further.iter().all(is_known) && self.cell.acceleration_scale.is_none_or(positive);
        let numbers = self.cell.shape();
        let direct = further.iter().filter(|input| input.is_direct).count();
        let modulating = further.iter().filter(|input| input.is_modulating).count();
        if !scales || (direct, modulating) != (numbers.direct, numbers.modulators) {
            return refuse("its further inputs do not go together with its network");
        }
        let is_value = |value: f64| value.abs() <= LARGEST_VALUE;
        if !(is_value(self.input_centre) && is_value(self.output_mean)) {
            return refuse("the centre of the input or the mean of the output is too large");
        }
        let shape = self.cell.shape();
        let has_rate = shape.channels == 2;
        if self.beginning.as_ref().is_some_and(|prior| !prior.is_sound(shape.states)) {
            return refuse("the states at the beginning of records are not as many as its states");
        }
        if !self.cell.is_consistent() || has_rate != self.rate_scale.is_some() || shape.has_time && !has_rate
        {
            return refuse("the parts of its network have lengths that do not go together");
        }
        Parameter::check_all(&self.parameters(), "Duhem neural network")?;
        Ok(self)
    }

    fn sees_rate(&self) -> bool {
        self.rate_scale.is_some()
    }

    fn needs_steps(&self) -> bool {
        self.cell.shape().has_time
    }

    fn memory_properties(&self, _: bool) -> Vec<(Property, bool)> {
        Vec::new()
    }
}

//! Neuro-Madelung model: every branch starts at its turning point, and a small network gives the slope of its
//! chord.
//!
//! ```text
//! y = y_t + (x - x_t) N(x, x_t, y_t[, x'])                                  theory.md (8.19)
//! N = c_0 + Σ_i c_i tanh(b_i + Σ_j U_ij u_j),   u the scaled x, x_t, y_t[, x']   theory.md (8.20)
//! ```
//!
//! `x` is the input, `x'` its rate (optional), `y` the output. `(x_t, y_t)` is the turning point at which the
//! present branch began; `y_t` is the model's own output there, so the output is continuous at reversals. The
//! stack of turning points follows Madelung's rules: a branch that passes the turning point before the last
//! closes a loop, and both points are deleted. Before the first turning point its place is taken by the
//! virgin point `(0, y_0)`.
//!
//! Properties: return-point memory by construction; loops need not be congruent. The output is limited to the
//! trained range, extended by its own width beyond either end.
//!
//! Source: Farrokh and Dizaji 2016 for the inputs of the network; its form, the factor `x - x_t` and the
//! training are ours.

use serde::{Deserialize, Serialize};

use crate::elementary::tanh;
use crate::error::{Error, LARGEST_VALUE, Result};
use crate::law::facts::{ErrorsInside, Facts, Rate};
use crate::law::turning_point_stack::TurningPointStack;
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::property::Property;

/// Widths of the trained range by which the output may leave it, because errors add from branch to branch.
const BEYOND: f64 = 1.0;

/// Scaled inputs of the network are limited to this: far outside of the data it is saturated anyway.
const LARGEST_INPUT: f64 = 1e6;

/// Largest number of tanh neurons: the memory of the search grows with its square.
pub const MOST_HIDDEN: usize = 100;

/// A neuro-Madelung model in the user's units: `y = y_t + (x - x_t) N(x, x_t, y_t[, x'])` (theory.md (8.19)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NeuroMadelung {
    /// Divisor of the input, in its unit.
    pub input_scale: f64,
    /// Divisor of the rate, in its unit; `None` for a model without rate.
    pub rate_scale: Option<f64>,
    /// Mean of the output in training, in its unit.
    pub output_mean: f64,
    /// Divisor of the output minus its mean, in its unit.
    pub output_scale: f64,
    /// Smallest and largest output in training, in its unit.
    pub output_range: (f64, f64),
    /// `b_i, U_i1, U_i2, ...` of each tanh neuron in turn.
    pub hidden: Vec<f64>,
    /// Output weights `c_0, c_1, ...` of the network.
    pub output: Vec<f64>,
    /// `y_0`, the scaled output of the virgin turning point.
    pub virgin_output: f64,
}

/// The network `N` with the limits of its inputs and output, in scaled units.
#[derive(Debug, Clone, Copy)]
pub struct BranchNetwork<'a> {
    /// Bias and weights of each tanh neuron in turn.
    pub hidden: &'a [f64],
    /// Constant and weights of the output.
    pub output: &'a [f64],
    /// Range of the output in training.
    low: f64,
    high: f64,
}

impl BranchNetwork<'_> {
    /// Number of values of one tanh neuron: its bias and weights.
    pub fn run(&self) -> usize {
        self.hidden.len() / (self.output.len() - 1).max(1)
    }

    /// The output on the branch that began at `(x_t, y_t)`; `inputs` is `x, x_t, y_t[, x']`.
    pub fn value(&self, inputs: &[f64]) -> f64 {
        let seen = self.seen(inputs);
        let seen = &seen[..inputs.len()];
        let mut slope = self.output[0];
        for (neuron, c) in self.hidden.chunks_exact(self.run()).zip(&self.output[1..]) {
            slope += c * tanh(argument(neuron, seen)); // (8.20)
        }
        self.limited(inputs[2] + (inputs[0] - inputs[1]) * slope) // (8.19)
    }

    /// The inputs, limited to the trained ranges: beyond them a branch keeps the slope of its chord.
    pub fn seen(&self, inputs: &[f64]) -> [f64; 4] {
        let rate = inputs.get(3).copied().unwrap_or(0.0);
        let unit = |value: f64| value.clamp(-1.0, 1.0);
        [unit(inputs[0]), unit(inputs[1]), inputs[2].clamp(self.low, self.high), unit(rate)]
    }

    /// Range of the output in training.
    pub fn range(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// The range that the law allows.
    pub fn limits(&self) -> (f64, f64) {
        let beyond = BEYOND * (self.high - self.low);
        (self.low - beyond, self.high + beyond)
    }

    /// The output, limited to the range that the law allows.
    pub fn limited(&self, y: f64) -> f64 {
        let (low, high) = self.limits();
        y.clamp(low, high)
    }
}

/// The argument of a tanh neuron: its bias and the weighted inputs.
pub fn argument(neuron: &[f64], inputs: &[f64]) -> f64 {
    neuron[0] + neuron[1..].iter().zip(inputs).map(|(weight, input)| weight * input).sum::<f64>()
}

impl NeuroMadelung {
    /// Number of inputs of the network: 3, or 4 with the rate.
    pub fn inputs(&self) -> usize {
        3 + usize::from(self.rate_scale.is_some())
    }

    /// The network with its limits.
    pub fn branch(&self) -> BranchNetwork<'_> {
        let scaled = |y: f64| (y - self.output_mean) / self.output_scale;
        let (low, high) = (scaled(self.output_range.0), scaled(self.output_range.1));
        BranchNetwork { hidden: &self.hidden, output: &self.output, low, high }
    }

    /// The scaled input and rate.
    pub fn scaled(&self, sample: Sample) -> (f64, f64) {
        let limited = |value: f64| value.clamp(-LARGEST_INPUT, LARGEST_INPUT);
        let rate = self.rate_scale.map_or(0.0, |scale| limited(sample.rate / scale));
        (limited(sample.x / self.input_scale), rate)
    }
}

impl Law for NeuroMadelung {
    /// Turning points, scaled.
    type State = TurningPointStack<f64>;

    const FACTS: Facts = Facts {
        rate: Rate::Optional,
        limits: &[("hidden", 1, MOST_HIDDEN)],
        ..Facts::searched(
            "neuro-madelung",
            "small network of the input and its last turning point",
            &["hidden", "starts", "epochs", "rate_compression"],
            ErrorsInside { softening: 0.6, sigmoid: 0.4, other: 0.6 },
        )
        .with_defaults(&[("hidden", 8), ("starts", 16), ("epochs", 60)])
    };

    fn virgin(&self) -> TurningPointStack<f64> {
        TurningPointStack::default()
    }

    fn step(&self, state: &mut TurningPointStack<f64>, sample: Sample) -> f64 {
        let (x, rate) = self.scaled(sample);
        state.advance(x, 0.0);
        let (x_t, y_t) =
            state.points().last().map_or((0.0, self.virgin_output), |point| (point.x, point.value));
        let y = self.branch().value(&[x, x_t, y_t, rate][..self.inputs()]);
        state.set_value(y);
        self.output_mean + self.output_scale * y
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (-LARGEST_WEIGHT, LARGEST_WEIGHT);
        let run = 1 + self.inputs();
        let hidden = self.hidden.iter().enumerate().map(|(index, &value)| {
            let (neuron, j) = (index / run + 1, index % run);
            if j == 0 {
                Parameter::new(format!("b_{neuron}"), "bias of a tanh neuron", value, any, Dimension::NONE)
            } else {
                let symbol = format!("U_{neuron},{j}");
                Parameter::new(symbol, "weight of a tanh neuron", value, any, Dimension::NONE)
            }
        });
        let output = self.output.iter().enumerate().map(|(index, &value)| {
            Parameter::new(format!("c_{index}"), "weight of the output", value, any, Dimension::NONE)
        });
        let virgin = Parameter::new("y_0", "virgin output, scaled", self.virgin_output, any, Dimension::NONE);
        hidden.chain(output).chain([virgin]).collect()
    }

    fn validated(self) -> Result<Self> {
        let refuse = |what: &str| Err(Error::Parts(format!("neuro-Madelung: {what}")));
        let positive = |scale: f64| scale > 0.0 && scale <= LARGEST_VALUE;
        if !(positive(self.input_scale)
            && positive(self.output_scale)
            && self.rate_scale.is_none_or(positive))
        {
            return refuse("a scale is not positive");
        }
        let (low, high) = self.output_range;
        let is_range = low <= high && low.abs() <= LARGEST_VALUE && high.abs() <= LARGEST_VALUE;
        if !is_range || self.output_mean.is_nan() || self.output_mean.abs() > LARGEST_VALUE {
            return refuse("the range of the output is none");
        }
        let neurons = self.output.len().saturating_sub(1);
        if neurons == 0 || self.hidden.len() != neurons * (1 + self.inputs()) {
            return refuse("the network has another shape than its inputs and neurons ask for");
        }
        Parameter::check_all(&self.parameters(), "neuro-Madelung")?;
        Ok(self)
    }

    fn sees_rate(&self) -> bool {
        self.rate_scale.is_some()
    }

    fn memory_properties(&self, _: bool) -> Vec<(Property, bool)> {
        vec![(Property::WipingOut, true)]
    }
}

/// Largest magnitude of a weight: sums of products with scaled inputs stay finite.
pub const LARGEST_WEIGHT: f64 = 1e6;

//! Neuro-Madelung model: every branch is a curve through the turning point where it began, and a small
//! network gives the slope of its chord.
//!
//! ```text
//! y = y_t + (x - x_t) N(x, x_t, y_t[, x'])                                  theory.md (8.19)
//! N = c_0 + Σ_i c_i tanh(b_i + Σ_j U_ij u_j),   u the scaled x, x_t, y_t[, x']   theory.md (8.20)
//! ```
//!
//! `(x_t, y_t)` is the turning point from which the present branch began, `y_t` being the model's own
//! output there, so that the output is continuous at reversals. Madelung's rules rule the stack of
//! turning points: a branch that passes the turning point before the last closes a loop, and both are
//! forgotten. So the model has return-point memory by construction, and loops need not be congruent.
//! Before any turning point stands the virgin one, `(0, y_0)`.
//!
//! Source: Farrokh and Dizaji 2016, of whom the inputs of the network are known; its form, the
//! factor `x - x_t` and the training are ours.

use serde::{Deserialize, Serialize};

use crate::error::{Error, LARGEST_VALUE, Result};
use crate::law::facts::{Facts, Identification, Origin, Rate};
use crate::law::interval::Interval;
use crate::law::turning_point_stack::TurningPointStack;
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::property::Property;

/// The output may leave the range that was trained on by so many of these ranges. A chain of wrong
/// branches, each beginning at the end of the one before, can otherwise grow beyond all bounds; a
/// hysteresis that is extrapolated sensibly stays well within.
const BEYOND: f64 = 1.0;

/// Scaled inputs of the network are limited to this: far outside of the data it is saturated anyway.
const LARGEST_INPUT: f64 = 1e6;

/// Most tanh neurons that can be asked for: the search takes the square of their number in memory.
pub const MOST_HIDDEN: usize = 100;

/// A neuro-Madelung model in the user's units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NeuroMadelung {
    /// What the input is divided by, in its unit.
    pub input_scale: f64,
    /// What the rate is divided by; `None` for a model without it.
    pub rate_scale: Option<f64>,
    /// Mean of the output in training, in its unit.
    pub output_mean: f64,
    /// What the output's distance from its mean is divided by.
    pub output_scale: f64,
    /// Smallest and largest output in training, in its unit.
    pub output_range: (f64, f64),
    /// `b_i, U_i1, U_i2, ...` of every tanh neuron, one after another.
    pub hidden: Vec<f64>,
    /// `c_0, c_1, ...`.
    pub output: Vec<f64>,
    /// `y_0`, scaled.
    pub virgin_output: f64,
}

/// The network and what surrounds it, as training sees it: all scaled.
#[derive(Debug, Clone, Copy)]
pub struct Branch<'a> {
    /// Bias and weights of the tanh neurons, one after another.
    pub hidden: &'a [f64],
    /// Constant and weights of the output.
    pub output: &'a [f64],
    /// Range of the output in training.
    low: f64,
    high: f64,
}

impl Branch<'_> {
    /// Bias and weights of a neuron.
    pub fn run(&self) -> usize {
        self.hidden.len() / (self.output.len() - 1).max(1)
    }

    /// The output on the branch that began at `(x_t, y_t)`; `inputs` is `x, x_t, y_t[, x']`.
    pub fn value(&self, inputs: &[f64]) -> f64 {
        let seen = self.seen(inputs);
        let seen = &seen[..inputs.len()];
        let mut slope = self.output[0];
        for (neuron, c) in self.hidden.chunks_exact(self.run()).zip(&self.output[1..]) {
            slope += c * argument(neuron, seen).tanh();
        }
        self.limited(inputs[2] + (inputs[0] - inputs[1]) * slope)
    }

    /// What the network sees: inputs within the ranges that it was trained on. Beyond them a branch goes
    /// on with the slope that its chord has at the edge.
    pub fn seen(&self, inputs: &[f64]) -> [f64; 4] {
        let rate = inputs.get(3).copied().unwrap_or(0.0);
        let unit = |value: f64| value.clamp(-1.0, 1.0);
        [unit(inputs[0]), unit(inputs[1]), inputs[2].clamp(self.low, self.high), unit(rate)]
    }

    /// An output within what the law can give.
    pub fn limited(&self, y: f64) -> f64 {
        let beyond = BEYOND * (self.high - self.low);
        y.clamp(self.low - beyond, self.high + beyond)
    }
}

/// The argument of a tanh neuron: its bias and the weighted inputs.
pub fn argument(neuron: &[f64], inputs: &[f64]) -> f64 {
    neuron[0] + neuron[1..].iter().zip(inputs).map(|(weight, input)| weight * input).sum::<f64>()
}

impl NeuroMadelung {
    /// Inputs of the network.
    pub fn inputs(&self) -> usize {
        3 + usize::from(self.rate_scale.is_some())
    }

    /// The network and what surrounds it.
    pub fn branch(&self) -> Branch<'_> {
        let scaled = |y: f64| (y - self.output_mean) / self.output_scale;
        let (low, high) = (scaled(self.output_range.0), scaled(self.output_range.1));
        Branch { hidden: &self.hidden, output: &self.output, low, high }
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
        name: "neuro-madelung",
        rate: Rate::Optional,
        origin: Origin::OfData,
        identification: Identification::Search,
        options: &["hidden", "starts", "epochs", "rate_companding"],
        limits: &[("hidden", MOST_HIDDEN)],
        variant: None,
        log_error_inside: 1.25,
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
        for parameter in self.parameters() {
            parameter.check("neuro-Madelung")?;
        }
        Ok(self)
    }

    fn sees_rate(&self) -> bool {
        self.rate_scale.is_some()
    }

    fn memory_properties(&self, _: bool) -> Vec<(Property, bool)> {
        vec![(Property::WipingOut, true)]
    }

    fn output_bound(&self, _: Interval, _: Interval) -> Interval {
        // theory.md (8.20): its own limit.
        let (low, high) = self.output_range;
        Interval(low - (high - low), high + (high - low))
    }
}

/// Weights may not be larger: products with scaled inputs and sums of them stay finite.
pub const LARGEST_WEIGHT: f64 = 1e6;

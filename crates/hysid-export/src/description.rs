//! From a model to the program of its step.
//!
//! The program does what [`Stepper::step`](hysid_core::model::Stepper::step) does, with the same operations in the same
//! order: the same outputs, to the last bit for those functions that round alike.

mod ensemble;
mod law;
mod network;

use hysid_core::elementary;
use hysid_core::error::LARGEST_VALUE;
use hysid_core::model::input_transform::InputTransform;
use hysid_core::model::{Model, Predictor};

use crate::program::expression::{Real, Truth};
use crate::program::{Array, Builder, Precision, Program};

/// How a model that needs the rate of its first input gets it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RateSource {
    /// From the input and the time step, by backward differences; 0 at the first step.
    #[default]
    Backward,
    /// As an argument of each step.
    Argument,
}

/// Argument of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Argument {
    /// The input with this index.
    Input(usize),
    /// The time since the step before; in the first step any finite number.
    TimeStep,
    /// The rate of the first input.
    Rate,
}

impl Argument {
    /// Its name in exported functions.
    pub(crate) fn name(self) -> String {
        match self {
            Self::Input(0) => "x".to_string(),
            Self::Input(input) => format!("x{}", input + 1),
            Self::TimeStep => "time_step".to_string(),
            Self::Rate => "rate".to_string(),
        }
    }
}

/// The program of a model's step, and what its arguments mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// The step.
    pub program: Program,
    /// The meaning of each argument, in their order: inputs, time step, rate.
    pub arguments: Vec<Argument>,
}

/// Inputs of a part of a model in one row: transformed inputs and rate, in their units.
#[derive(Debug, Clone)]
struct PartInputs {
    inputs: Vec<Real>,
    rate: Real,
    step: Real,
    /// True in the first row after the virgin state, which may be one of a lead-in.
    is_first: Truth,
}

impl Description {
    /// Describes a model.
    pub fn of(model: &Model, rate: RateSource, precision: Precision) -> Self {
        Self::with_band(model, rate, precision, None)
    }

    /// Describes a model with its prediction band: the state then has half its width at the last row, in an array
    /// [`HALF_WIDTH`]. `band` are the terms of `Band::terms`.
    pub(crate) fn with_band(
        model: &Model,
        rate: RateSource,
        precision: Precision,
        band: Option<(f64, f64, f64)>,
    ) -> Self {
        let parts = ModelParts::of(model);
        let inputs = model.names().inputs.len();
        let mut arguments: Vec<Argument> = (0..inputs).map(Argument::Input).collect();
        let has_rate = parts.has_rate();
        let has_differences = has_rate && rate == RateSource::Backward;
        if parts.needs_steps() || has_differences {
            arguments.push(Argument::TimeStep);
        }
        if has_rate && rate == RateSource::Argument {
            arguments.push(Argument::Rate);
        }
        let mut builder = Builder::new(arguments.len(), 1, precision);
        let place = |wanted: Argument| arguments.iter().position(|argument| *argument == wanted);

        let started = builder.state("started", vec![0.0]);
        let is_first = builder.value(started.at(0_usize)).equals(0.0);
        let inputs: Vec<Real> = (0..inputs).map(|input| builder.argument(input)).collect();
        let step = match place(Argument::TimeStep) {
            Some(index) => builder.value(is_first.clone().choose(0.0, builder.argument(index))),
            None => Real::Constant(0.0),
        };
        let rate = match place(Argument::Rate) {
            Some(index) => builder.argument(index),
            None if has_differences => {
                let last = builder.state("last_input", vec![0.0]);
                let rate = (&inputs[0] - last.at(0_usize)) / &step;
                let rate = builder.value(step.above(0.0).choose(rate, 0.0));
                // A slope by so short a time step could overflow: it leaves out what the rate adds.
                let rate = builder.value(step.above(1.0 / LARGEST_VALUE).choose(&rate, rate.detached()));
                builder.set(last, 0_usize, &inputs[0]);
                rate
            }
            None => Real::Constant(0.0),
        };
        let row = InputRow { inputs: &inputs, rate, step, is_first, band };
        let output = parts.step(&mut builder, model, &row, started);
        builder.output(0, output);
        Self { program: builder.finish(), arguments }
    }
}

struct InputRow<'a> {
    inputs: &'a [Real],
    rate: Real,
    step: Real,
    is_first: Truth,
    band: Option<(f64, f64, f64)>,
}

/// Name of the array of the state with half the width of the band.
pub const HALF_WIDTH: &str = "half_width";

/// Models that a model consists of: itself, or its members.
struct ModelParts<'m>(Vec<&'m Model>);

impl<'m> ModelParts<'m> {
    fn of(model: &'m Model) -> Self {
        match model.predictor() {
            Predictor::Ensemble(ensemble) => Self(ensemble.members().iter().collect()),
            Predictor::Network { .. } | Predictor::Law(_) => Self(vec![model]),
        }
    }

    fn has_rate(&self) -> bool {
        self.0.iter().any(|model| model.rate().is_some())
    }

    fn needs_steps(&self) -> bool {
        self.0.iter().any(|model| match model.predictor() {
            Predictor::Network { network, .. } => network.architecture().relaxation > 0,
            Predictor::Law(law) => law.needs_steps(),
            Predictor::Ensemble(_) => false,
        })
    }

    /// Writes a step of the whole, with the lead-in before the first.
    fn step(&self, builder: &mut Builder, model: &Model, row: &InputRow<'_>, started: Array) -> Real {
        let lead_in = model.lead_in();
        let histories: Vec<Vec<Real>> =
            self.0.iter().map(|part| history(builder, part.input_transform(), row, lead_in)).collect();
        let outputs = builder.scratch("member_output", self.0.len());
        let outside = match model.predictor() {
            Predictor::Ensemble(ensemble) => {
                Some(ensemble::excursion(builder, ensemble.range(), &row.inputs[0]))
            }
            Predictor::Network { .. } | Predictor::Law(_) => row
                .band
                .map(|_| ensemble::excursion(builder, model.trained_ranges().inputs[0], &row.inputs[0])),
        };
        let members = |builder: &mut Builder, x: &Real, rate: &Real, step: &Real, is_first: &Truth| {
            for (index, (part, history)) in self.0.iter().zip(&histories).enumerate() {
                let transform = part.input_transform();
                let mut inputs = vec![transformed(builder, transform, 0, x)];
                for (input, x) in row.inputs.iter().enumerate().skip(1) {
                    inputs.push(transformed(builder, transform, input, x));
                }
                inputs.extend(history.iter().cloned());
                let rate =
                    part.rate().map_or(Real::Constant(0.0), |_| transformed_rate(builder, transform, rate));
                let sample = PartInputs { inputs, rate, step: step.clone(), is_first: is_first.clone() };
                let name = if self.0.len() == 1 { "network".into() } else { format!("member_{}", index + 1) };
                builder.remark(format!("{}: {}", name.replace('_', " "), part.name().name()));
                let output = match part.predictor() {
                    Predictor::Network { network, scaling } => {
                        network::step(builder, &name, network, scaling, &sample)
                    }
                    Predictor::Law(law) => law::step(builder, &name, law, &sample),
                    Predictor::Ensemble(_) => unreachable!("members are networks or laws"),
                };
                builder.set(outputs, index, output);
            }
            builder.set(started, 0_usize, 1.0);
        };
        if lead_in.is_empty() {
            members(builder, &row.inputs[0], &row.rate, &row.step, &row.is_first);
        } else {
            // The rows of the lead-in, then the input of the first row in a state of rest, then the row itself.
            let turns = builder.constants("lead_in", lead_in.to_vec());
            let count = lead_in.len();
            let first = builder.whole_variable(count + 1);
            builder.when(row.is_first.clone(), |builder| builder.assign_whole(first, 0_usize));
            builder.each(first, count + 2, |builder, k| {
                let x = builder.variable(&row.inputs[0]);
                let rate = builder.variable(0.0);
                let step = builder.variable(f64::INFINITY);
                builder.when(k.below(count), |builder| builder.assign(x, turns.at(&k)));
                builder.when(k.above(count), |builder| {
                    builder.assign(rate, &row.rate);
                    builder.assign(step, &row.step);
                });
                let is_first = builder.value(started.at(0_usize)).equals(0.0);
                members(builder, &x.into(), &rate.into(), &step.into(), &is_first);
            });
        }
        if let (Some((inside, far_outside, floor)), Some(outside)) = (row.band, &outside) {
            let disagreement = match model.predictor() {
                Predictor::Ensemble(ensemble) => ensemble::disagreement(builder, ensemble, outside, outputs),
                Predictor::Network { .. } | Predictor::Law(_) => Real::Constant(0.0),
            };
            let half_width = builder.state(HALF_WIDTH, vec![0.0]);
            let factor = inside + outside * (far_outside - inside);
            builder.set(half_width, 0_usize, factor * Real::Constant(floor).hypot(disagreement));
        }
        match (model.predictor(), outside) {
            (Predictor::Ensemble(ensemble), Some(outside)) => {
                ensemble::output(builder, ensemble.group(), &outside, outputs)
            }
            _ => outputs.at(0_usize),
        }
    }
}

/// Largest magnitude of a value of the user's in single precision.
const LARGEST_SINGLE: f64 = 1e12;

/// A value of the user's, limited as the library limits it.
fn limited(builder: &mut Builder, value: &Real) -> Real {
    let largest = match builder.precision() {
        Precision::Double => LARGEST_VALUE,
        Precision::Single => LARGEST_SINGLE,
    };
    let value = builder.value(value);
    let value = value.clamp(-largest, largest);
    builder.value(value)
}

fn transformed(builder: &mut Builder, transform: &InputTransform, input: usize, x: &Real) -> Real {
    let x = limited(builder, x);
    let x = if transform.origins.is_empty() { x } else { builder.value(x - transform.origin(input)) };
    match transform.compression {
        Some(scale) if input == 0 => builder.value((x / scale).asinh()),
        _ => x,
    }
}

fn transformed_rate(builder: &mut Builder, transform: &InputTransform, rate: &Real) -> Real {
    let rate = limited(builder, rate);
    match transform.rate_compression {
        Some(scale) => builder.value((rate / scale).asinh()),
        None => rate,
    }
}

/// The inputs that represent the past: the largest magnitude so far and the path so far (theory.md (11.2)).
fn history(
    builder: &mut Builder,
    transform: &InputTransform,
    row: &InputRow<'_>,
    lead_in: &[f64],
) -> Vec<Real> {
    let Some((largest_scale, longest)) = transform.history else { return Vec::new() };
    let largest = builder.state("largest", vec![0.0]);
    let path = builder.state("path", vec![0.0]);
    let last = builder.state("path_input", vec![0.0]);
    let has_last = builder.state("path_begun", vec![0.0]);
    let take = |builder: &mut Builder, x: Real| {
        let x = builder.value(x);
        let magnitude = builder.value(x.abs());
        let before = builder.value(largest.at(0_usize));
        builder.set(largest, 0_usize, before.max(&magnitude));
        builder.when(has_last.at(0_usize).above(0.0), |builder| {
            builder.set(path, 0_usize, path.at(0_usize) + (&x - last.at(0_usize)).abs());
        });
        builder.set(last, 0_usize, &x);
        builder.set(has_last, 0_usize, 1.0);
    };
    let origin = transform.origin(0);
    if !lead_in.is_empty() {
        let turns = builder.constants("lead_in_path", lead_in.iter().map(|x| x - origin).collect());
        builder.when(row.is_first.clone(), |builder| {
            builder.each(0_usize, lead_in.len(), |builder, k| take(builder, turns.at(&k)));
        });
    }
    let x = limited(builder, &row.inputs[0]);
    take(builder, x - origin);
    let m = builder.value(largest.at(0_usize) / largest_scale);
    let p = builder.value((10.0 * path.at(0_usize) / longest).ln_1p() / elementary::ln(11.0));
    vec![m, p]
}

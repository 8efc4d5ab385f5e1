//! A model run sample by sample.

use crate::classical::{ClassicalState, Law, Sample};
use crate::error::{Error, Result};
use crate::model::ensemble::{Council, Ensemble, Excursion};
use crate::model::{Body, Model};
use crate::network::Simulator;
use crate::preprocessing::Past;

/// A model that is run sample by sample. Fed with the rates that [`Model::simulate`] would use, it
/// gives the same outputs to the last bit.
#[derive(Debug, Clone)]
pub struct Stepper<'m> {
    model: &'m Model,
    memory: Memory<'m>,
    past: Past,
    /// Inputs of the last sample as the model saw them.
    seen: Vec<f64>,
    /// Time and first input of the last sample.
    last: Option<(f64, f64)>,
}

/// What a stepper knows of the past.
#[derive(Debug, Clone)]
enum Memory<'m> {
    /// A network's simulator, and room for its channels.
    Network(Box<Simulator>, Vec<f64>),
    Law(ClassicalState),
    Ensemble(Jury<'m>),
}

/// The members of an ensemble on their way.
#[derive(Debug, Clone)]
struct Jury<'m> {
    members: Vec<Stepper<'m>>,
    excursion: Excursion,
    outputs: Vec<f64>,
    council: Council,
}

impl Memory<'_> {
    fn virgin(body: &Body) -> Memory<'_> {
        match body {
            Body::Network { network, .. } => {
                Memory::Network(Box::new(network.simulator()), vec![0.0; network.architecture().channels()])
            }
            Body::Law(law) => Memory::Law(law.virgin()),
            Body::Ensemble(ensemble) => Memory::Ensemble(Jury {
                members: ensemble.members().iter().map(|member| member.stepper()).collect(),
                excursion: Excursion::beyond(ensemble.range()),
                outputs: Vec::with_capacity(ensemble.members().len()),
                council: Council::new(ensemble),
            }),
        }
    }
}

impl<'m> Stepper<'m> {
    pub(super) fn new(model: &'m Model) -> Self {
        Self {
            model,
            memory: Memory::virgin(&model.body),
            past: Past::default(),
            seen: Vec::with_capacity(model.inputs() + model.preprocessing.added_inputs()),
            last: None,
        }
    }

    /// The next sample: inputs and time in the user's units, `time` of no matter for a model that
    /// needs none. `rate` is that of the first input, for a model with one; without it a backward
    /// difference is taken (0 at the first sample).
    ///
    /// # Errors
    /// Another number of inputs, a value that is not finite, or time that does not advance.
    pub fn step(&mut self, inputs: &[f64], time: f64, rate: Option<f64>) -> Result<f64> {
        let expected = self.model.inputs();
        if inputs.len() != expected {
            return Err(Error::Option(format!("{} inputs where the model has {expected}", inputs.len())));
        }
        let elapsed = match self.last {
            Some((before, _)) => time - before,
            None => 0.0,
        };
        if self.model.needs_time() && !(time.is_finite() && (self.last.is_none() || elapsed > 0.0)) {
            return Err(Error::Option(format!("time {time} does not come after the last sample's")));
        }
        let rate = self.model.rate.map(|_| {
            let backward = self.last.map_or(0.0, |(_, before)| (inputs[0] - before) / elapsed);
            rate.unwrap_or(backward)
        });
        if let Some(bad) = inputs.iter().chain(&rate).find(|value| !value.is_finite()) {
            return Err(Error::Option(format!("an input or its rate is {bad}, not a finite number")));
        }
        let seen_rate = rate.map(|rate| self.model.preprocessing.rate(rate));
        self.model.preprocessing.sample(inputs, &mut self.past, &mut self.seen);
        let y = match (&self.model.body, &mut self.memory) {
            (Body::Network { scaling, .. }, Memory::Network(simulator, u)) => {
                let mut channels = u.iter_mut();
                for (input, (&x, &scale)) in self.seen.iter().zip(&scaling.inputs).enumerate() {
                    *channels.next().expect("a channel for each input") = x * (1.0 / scale);
                    if input == 0
                        && let Some((rate, scale)) = seen_rate.zip(scaling.rate)
                    {
                        *channels.next().expect("a channel for the rate") = rate * (1.0 / scale);
                    }
                }
                if let Some(bad) = u.iter().find(|u| !u.is_finite()) {
                    return Err(Error::Option(format!("an input or its rate is {bad}, not a finite number")));
                }
                scaling.output(simulator.step(u, elapsed))
            }
            (Body::Law(law), Memory::Law(state)) => {
                let step = if self.model.needs_time() { elapsed } else { 0.0 };
                law.step(state, Sample { x: self.seen[0], rate: seen_rate.unwrap_or(0.0), step })
            }
            (Body::Ensemble(ensemble), Memory::Ensemble(jury)) => jury.step(ensemble, inputs, time, rate)?,
            _ => unreachable!("the memory was made for the body"),
        };
        self.last = Some((time, inputs[0]));
        Ok(y)
    }

    /// Back to the virgin state.
    pub fn reset(&mut self) {
        match (&self.model.body, &mut self.memory) {
            (Body::Network { .. }, Memory::Network(simulator, _)) => simulator.reset(),
            (Body::Ensemble(ensemble), Memory::Ensemble(jury)) => {
                jury.members.iter_mut().for_each(Stepper::reset);
                jury.excursion = Excursion::beyond(ensemble.range());
            }
            (body, memory) => *memory = Memory::virgin(body),
        }
        self.past = Past::default();
        self.last = None;
    }
}

impl Jury<'_> {
    fn step(&mut self, ensemble: &Ensemble, inputs: &[f64], time: f64, rate: Option<f64>) -> Result<f64> {
        let outside = self.excursion.take(inputs[0]);
        self.outputs.clear();
        for stepper in &mut self.members {
            self.outputs.push(stepper.step(inputs, time, rate)?);
        }
        Ok(self.council.output(ensemble.group(), outside, |member| self.outputs[member]))
    }
}

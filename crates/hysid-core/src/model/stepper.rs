//! Simulation of a model sample by sample.

mod snapshot;
mod tracking;
mod trial;

use std::borrow::Cow;

use crate::data::initial_state::InitialState;
use crate::data::record::{FadingResidual, MemberState, RecordState};
use crate::error::{Error, LARGEST_VALUE, Result, SampleError};
use crate::law::series::lead_in_samples;
use crate::law::{ClassicalState, Sample};
use crate::model::band::{BandLevel, disagreement};
use crate::model::ensemble::{Excursion, MedianBuffers};
use crate::model::input_transform::{InputPast, SeenLeadIn, limited};
use crate::model::{Model, Predictor};
use crate::network::Simulator;

use tracking::Tracker;

pub use snapshot::Snapshot;
pub use tracking::{ADAPTATION_ROWS, Tracking};

/// A sample-by-sample simulation. With the rates that [`Model::simulate`] uses, its outputs are the same to
/// the last bit, unless measured outputs [correct](Stepper::correct) or [adapt](Stepper::adapt) them.
#[derive(Debug, Clone)]
pub struct Stepper<'m> {
    model: Cow<'m, Model>,
    state: StepperState,
    /// The state before the last trial, if that is not committed.
    committed: Option<Snapshot>,
    /// State before the first sample: one of all members of an ensemble, or one of each.
    beginning: Vec<MemberState>,
}

#[derive(Debug, Clone)]
struct StepperState {
    memory: StepperMemory,
    past: InputPast,
    /// Inputs of the last sample as the model saw them.
    seen: Vec<f64>,
    last: Option<LastSample>,
    /// How far outside the trained range the input has been; `None` without a band, and in a member of an ensemble.
    excursion: Option<Excursion>,
    /// Residual at the end of a known beginning, if it remains.
    residual: Option<FadingResidual>,
    /// Corrections by measured outputs, once there are any.
    tracker: Option<Box<Tracker>>,
}

#[derive(Debug, Clone, Copy)]
struct LastSample {
    time: f64,
    /// First input.
    input: f64,
    /// Output without corrections by measured outputs.
    output: f64,
}

#[derive(Debug, Clone)]
enum StepperMemory {
    /// A network's simulator, and room for its channels.
    Network(Box<Simulator>, Vec<f64>),
    Law(Box<ClassicalState>),
    Ensemble(Box<EnsembleMemory>),
}

/// The members of an ensemble on their way.
#[derive(Debug, Clone)]
struct EnsembleMemory {
    members: Vec<StepperState>,
    excursion: Excursion,
    outputs: Vec<f64>,
    medians: MedianBuffers,
}

impl StepperMemory {
    fn virgin(body: &Predictor) -> Self {
        match body {
            Predictor::Network { network, .. } => {
                Self::Network(Box::new(network.simulator()), vec![0.0; network.architecture().channels()])
            }
            Predictor::Law(law) => Self::Law(Box::new(law.virgin())),
            Predictor::Ensemble(ensemble) => Self::Ensemble(Box::new(EnsembleMemory {
                members: ensemble.members().iter().map(StepperState::virgin).collect(),
                excursion: Excursion::beyond(ensemble.range()),
                outputs: Vec::with_capacity(ensemble.members().len()),
                medians: MedianBuffers::new(ensemble.group()),
            })),
        }
    }
}

impl<'m> Stepper<'m> {
    pub(super) fn new(model: Cow<'m, Model>) -> Self {
        let mut state = StepperState::virgin(&model);
        state.excursion = excursion(&model);
        Self { state, committed: None, beginning: vec![MemberState::Past(model.lead_in.clone())], model }
    }

    /// The model that is simulated.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Advances to the next sample and returns the output there, in the user's unit. A trial that is not committed is
    /// forgotten.
    ///
    /// `inputs` has one value for each input and `time` is the time of the sample, in the user's units;
    /// `time` is ignored by a model that needs none (see [`Model::needs_time`]), and may then be NaN. `rate` is that of the first input, for a model with one;
    /// `None` stands for a backward difference (0 at the first sample).
    ///
    /// # Errors
    /// Another number of inputs, a value that is not finite, a time that is missing or does not increase. The memory
    /// is then unchanged.
    pub fn step(&mut self, inputs: &[f64], time: f64, rate: Option<f64>) -> Result<f64> {
        self.revert();
        self.advance(inputs, time, rate)
    }

    /// Half the width of the prediction band at the last trial or step, in the unit of the output.
    ///
    /// # Errors
    /// A model without a band, or a level that no band is calibrated for.
    pub fn half_width(&mut self, level: BandLevel) -> Result<f64> {
        level.check()?;
        let band = self.model.band().ok_or(Error::NoBand(self.model.name().name()))?;
        let outside = self.state.excursion.map_or(0.0, |excursion| excursion.outside());
        let disagreement = disagreement_at(&self.model, &mut self.state.memory, outside);
        Ok(band.half_width(level, disagreement, outside))
    }

    fn advance(&mut self, inputs: &[f64], time: f64, rate: Option<f64>) -> Result<f64> {
        self.state.check(&self.model, inputs, time, rate)?;
        if self.state.last.is_none() {
            self.state.begin_in(&self.model, &self.beginning, inputs);
        }
        let mut output = self.state.advance(&self.model, inputs, time, rate);
        if let (Some(residual), Some(last)) = (&mut self.state.residual, &mut self.state.last) {
            output = residual.corrected(output);
            last.output = output;
        }
        Ok(self.state.tracker.as_mut().map_or(output, |tracker| tracker.step(output)))
    }

    /// Returns to the initial state of the model, without corrections by measured outputs.
    pub fn reset(&mut self) {
        self.begin(vec![MemberState::Past(self.model.lead_in.clone())]);
    }

    /// Returns to another initial state, without corrections by measured outputs.
    ///
    /// # Errors
    /// An unknown state. The stepper is then unchanged.
    pub fn reset_to(&mut self, state: InitialState) -> Result<()> {
        self.begin(vec![MemberState::Past(self.model.lead_in_of(state)?)]);
        Ok(())
    }

    /// Returns to the state before the first row of a record ([`Model::find_state`]), without corrections by measured outputs.
    /// The next samples are those of the record from its first row on.
    ///
    /// # Errors
    /// A state that another model has found. The stepper is then unchanged.
    pub fn reset_to_record(&mut self, state: &RecordState) -> Result<()> {
        self.model.check_state(state)?;
        self.begin(state.members.clone());
        self.state.residual = state.residual;
        Ok(())
    }

    fn begin(&mut self, beginning: Vec<MemberState>) {
        self.beginning = beginning;
        self.committed = None;
        self.state.reset(&self.model);
        self.state.excursion = excursion(&self.model);
    }
}

/// Disagreement of the members after their last sample, where `outside` is how far the record has been outside.
fn disagreement_at(model: &Model, memory: &mut StepperMemory, outside: f64) -> f64 {
    match (&model.body, memory) {
        (Predictor::Ensemble(ensemble), StepperMemory::Ensemble(memory)) if !memory.outputs.is_empty() => {
            let EnsembleMemory { outputs, medians, .. } = &mut **memory;
            disagreement(medians.predictions(ensemble.group(), outside, |member| outputs[member]))
        }
        _ => 0.0,
    }
}

/// For a model with a band: at the beginning of a record.
fn excursion(model: &Model) -> Option<Excursion> {
    model.band().map(|_| Excursion::beyond(model.first_input_range()))
}

impl StepperState {
    fn virgin(model: &Model) -> Self {
        Self {
            memory: StepperMemory::virgin(&model.body),
            past: InputPast::default(),
            seen: Vec::with_capacity(model.inputs() + model.preprocessing.added_inputs()),
            last: None,
            excursion: None,
            residual: None,
            tracker: None,
        }
    }

    fn check(&self, model: &Model, inputs: &[f64], time: f64, rate: Option<f64>) -> Result<()> {
        let expected = model.inputs();
        if inputs.len() != expected {
            return Err(SampleError::Inputs { expected, found: inputs.len() }.into());
        }
        let elapsed = self.elapsed(time);
        if model.needs_time() {
            if !time.is_finite() {
                return Err(SampleError::NoTime { needed_by: "the model" }.into());
            }
            if self.last.is_some() && elapsed <= 0.0 {
                return Err(SampleError::Time(time).into());
            }
        }
        let rate = self.rate(model, inputs, elapsed, rate);
        if let Some(bad) = inputs.iter().chain(&rate).find(|value| !value.is_finite()) {
            return Err(SampleError::NotFinite(*bad).into());
        }
        if let Some(large) = inputs.iter().chain(&rate).find(|value| value.abs() > LARGEST_VALUE) {
            return Err(SampleError::TooLarge(*large).into());
        }
        if let (Predictor::Ensemble(ensemble), StepperMemory::Ensemble(memory)) = (&model.body, &self.memory)
        {
            let mut members = memory.members.iter().zip(ensemble.members());
            return members.try_for_each(|(state, member)| state.check(member, inputs, time, rate));
        }
        Ok(())
    }

    fn elapsed(&self, time: f64) -> f64 {
        self.last.map_or(0.0, |before| time - before.time)
    }

    /// The rate of the first input: that which is given, or a backward difference; `None` for a model without.
    fn rate(&self, model: &Model, inputs: &[f64], elapsed: f64, given: Option<f64>) -> Option<f64> {
        let backward = || self.last.map_or(0.0, |before| (inputs[0] - before.input) / elapsed);
        model.rate.map(|_| given.unwrap_or_else(backward))
    }

    /// Begins before the first sample in one state of all members of an ensemble, or one of each.
    fn begin_in(&mut self, model: &Model, beginning: &[MemberState], first_row: &[f64]) {
        match (&model.body, &mut self.memory, beginning) {
            (Predictor::Ensemble(ensemble), StepperMemory::Ensemble(memory), _) => {
                let members = memory.members.iter_mut().zip(ensemble.members());
                for ((state, member), beginning) in members.zip(beginning.chunks(1).cycle()) {
                    state.begin_in(member, beginning, first_row);
                }
            }
            (Predictor::Law(law), StepperMemory::Law(state), [MemberState::Free(states), ..]) => {
                **state = law.begun_with(states);
            }
            (_, _, [MemberState::Past(past), ..]) if !past.is_empty() => self.lead_in(model, past, first_row),
            _ => {}
        }
    }

    /// Drives the memory of a single model along a lead-in and to the first input of the first sample.
    fn lead_in(&mut self, model: &Model, lead_in: &[f64], first_row: &[f64]) {
        let rows: Vec<f64> = lead_in.iter().chain(&first_row[..1]).copied().collect();
        let SeenLeadIn { first, others } = model.preprocessing.lead_in(&rows, first_row, &mut self.past);
        match (&model.body, &mut self.memory) {
            (Predictor::Network { scaling, .. }, StepperMemory::Network(simulator, u)) => {
                let mut channels: Vec<[f64; 1]> = vec![[0.0]; u.len()];
                for x in first {
                    scaling.fill_lead_in(&[x], &others, &mut channels);
                    u.iter_mut().zip(&channels).for_each(|(u, [channel])| *u = *channel);
                    simulator.step(u, f64::INFINITY);
                }
            }
            (Predictor::Law(law), StepperMemory::Law(state)) => {
                for sample in lead_in_samples(&first) {
                    law.step(state, sample, &others);
                }
            }
            _ => unreachable!("the memory was made for the body"),
        }
    }

    fn advance(&mut self, model: &Model, inputs: &[f64], time: f64, rate: Option<f64>) -> f64 {
        let elapsed = self.elapsed(time);
        let rate = self.rate(model, inputs, elapsed, rate);
        let seen_rate = rate.map(|rate| model.preprocessing.rate(limited(rate)));
        model.preprocessing.sample(inputs, &mut self.past, &mut self.seen);
        let y = match (&model.body, &mut self.memory) {
            (Predictor::Network { scaling, .. }, StepperMemory::Network(simulator, u)) => {
                let mut channels = u.iter_mut();
                for (input, (&x, &scale)) in self.seen.iter().zip(&scaling.inputs).enumerate() {
                    *channels.next().expect("a channel for each input") = x * (1.0 / scale);
                    if input == 0
                        && let Some((rate, scale)) = seen_rate.zip(scaling.rate)
                    {
                        *channels.next().expect("a channel for the rate") = rate * (1.0 / scale);
                    }
                }
                scaling.output(simulator.step(u, elapsed))
            }
            (Predictor::Law(law), StepperMemory::Law(state)) => {
                let step = if model.needs_time() { elapsed } else { 0.0 };
                let sample = Sample { x: self.seen[0], rate: seen_rate.unwrap_or(0.0), step };
                law.step(state, sample, &self.seen[1..])
            }
            (Predictor::Ensemble(ensemble), StepperMemory::Ensemble(memory)) => {
                let EnsembleMemory { members, excursion, outputs, medians } = &mut **memory;
                let outside = excursion.take(inputs[0]);
                outputs.clear();
                for (state, member) in members.iter_mut().zip(ensemble.members()) {
                    outputs.push(state.advance(member, inputs, time, rate));
                }
                medians.output(ensemble.group(), outside, |member| outputs[member])
            }
            _ => unreachable!("the memory was made for the body"),
        };
        self.last = Some(LastSample { time, input: inputs[0], output: y });
        if let Some(excursion) = &mut self.excursion {
            excursion.take(inputs[0]);
        }
        y
    }

    fn reset(&mut self, model: &Model) {
        match (&model.body, &mut self.memory) {
            (Predictor::Network { .. }, StepperMemory::Network(simulator, _)) => simulator.reset(),
            (Predictor::Ensemble(ensemble), StepperMemory::Ensemble(memory)) => {
                for (state, member) in memory.members.iter_mut().zip(ensemble.members()) {
                    state.reset(member);
                }
                memory.excursion = Excursion::beyond(ensemble.range());
            }
            (body, memory) => *memory = StepperMemory::virgin(body),
        }
        self.past = InputPast::default();
        self.last = None;
        (self.residual, self.tracker) = (None, None);
    }
}

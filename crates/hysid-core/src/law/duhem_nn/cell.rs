//! The recurrent cell in scaled units: stops, a layer of tanh neurons and states with a leak.
//!
//! ```text
//! a_i = 1 - exp(-(c_i |x_k - x_{k-1}| + (t_k - t_{k-1})/τ_i))               theory.md (8.29)
//! h_k = tanh(b + A [x_k, v_k, e_k, s_{k-1}])                                theory.md (8.30)
//! s_i,k = s_i,k-1 + a_i (q_i v_k + Σ_j W_ij h_j,k - s_i,k-1)                theory.md (8.31)
//! y_k = w · [1, x_k, v_k, e_k, s_k, h_k]                                    theory.md (8.32)
//! ```
//!
//! The leak is computed as `1 - e^{-z} = 2 t/(1 + t)` with `t = tanh(z/2)`, which has no cancellation at small
//! `z` and is at most 1.

use pulp::Simd;
use serde::{Deserialize, Serialize};

use crate::law::tanh_layer::{layer, product};
use crate::network::tanh::tanh;
use crate::operator::{play, stop};
use crate::simd::multiply_add;

/// The parameters of the cell; the symbols are those of the [module page](super).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cell {
    /// Weights of the stops' input: `w_x` of each stop, then `w_v` of each if there is a rate.
    pub stops: Vec<f64>,
    /// `b_1, b_2, ...`, then for each input of the layer (`x`, `v`, stops, states) its weight in every neuron.
    pub hidden: Vec<f64>,
    /// `W_i1, W_i2, ...` of each state in turn.
    pub targets: Vec<f64>,
    /// `q_i` of each state; empty without a rate.
    pub rate_gains: Vec<f64>,
    /// `s_i` before the first sample.
    pub initial: Vec<f64>,
    /// `c_i > 0` of each state: leak per scaled input.
    pub path_leaks: Vec<f64>,
    /// `τ_i > 0` of each state, in the unit of time; empty without time.
    pub relaxation_times: Vec<f64>,
    /// `w`: the constant, then the weights of `x`, `v`, stops, states and neurons.
    pub output: Vec<f64>,
}

/// Numbers of the parts of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellShape {
    /// Inputs: 1, or 2 with the rate.
    pub channels: usize,
    /// Stops.
    pub stops: usize,
    /// States.
    pub states: usize,
    /// Tanh neurons.
    pub neurons: usize,
    /// True if the states relax in time.
    pub has_time: bool,
}

impl CellShape {
    /// Number of inputs of the tanh layer, the constant included.
    pub fn inputs(self) -> usize {
        1 + self.channels + self.stops + self.states
    }

    /// Number of output weights.
    pub fn terms(self) -> usize {
        self.inputs() + self.neurons
    }

    /// Place of the first state among the terms of the output.
    pub(super) fn first_state(self) -> usize {
        1 + self.channels + self.stops
    }
}

/// A sample in scaled units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// The input about the centre of its range.
    pub x: f64,
    /// The input about its origin, at which the stops are virgin.
    pub from_origin: f64,
    /// The rate; 0 for a cell without.
    pub rate: f64,
    /// Time since the previous sample, in the unit of time.
    pub step: f64,
}

/// The state of a cell, with the intermediate results of the last sample.
#[derive(Debug, Clone, PartialEq)]
pub struct CellMemory {
    /// Factors of the output weights: `1, x, v, e, s, h`.
    pub(super) terms: Vec<f64>,
    pub(super) plays: Vec<f64>,
    pub(super) plays_before: Vec<f64>,
    pub(super) states_before: Vec<f64>,
    /// `a_i` of the last sample.
    pub(super) leaks: Vec<f64>,
    /// Distance of each state from its target at the last sample.
    pub(super) pulls: Vec<f64>,
    /// `|x_k - x_{k-1}|` and `t_k - t_{k-1}`; 0 at the first sample.
    pub(super) moved: f64,
    pub(super) elapsed: f64,
    /// The input of the last sample; `None` before the first.
    x: Option<f64>,
}

impl Cell {
    /// The numbers of its parts.
    #[inline(always)]
    pub fn shape(&self) -> CellShape {
        let has_rate = !self.rate_gains.is_empty();
        let channels = if has_rate { 2 } else { 1 };
        let stops = if has_rate { self.stops.len() / 2 } else { self.stops.len() };
        let states = self.initial.len();
        let neurons = self.output.len().saturating_sub(1 + channels + stops + states);
        CellShape { channels, stops, states, neurons, has_time: !self.relaxation_times.is_empty() }
    }

    /// True if all parts have the lengths that go together.
    pub(super) fn is_consistent(&self) -> bool {
        let shape = self.shape();
        let CellShape { channels, stops, states, neurons, has_time } = shape;
        states > 0
            && neurons > 0
            && self.stops.len() == channels * stops
            && self.hidden.len() == shape.inputs() * neurons
            && self.targets.len() == states * neurons
            && self.rate_gains.len() == if channels == 2 { states } else { 0 }
            && self.path_leaks.len() == states
            && self.relaxation_times.len() == if has_time { states } else { 0 }
            && self.output.len() == shape.terms()
    }

    /// The memory before the first sample.
    pub fn memory(&self) -> CellMemory {
        let shape = self.shape();
        let mut terms = vec![0.0; shape.terms()];
        terms[0] = 1.0;
        terms[shape.first_state()..shape.inputs()].copy_from_slice(&self.initial);
        CellMemory {
            terms,
            plays: vec![0.0; shape.stops],
            plays_before: vec![0.0; shape.stops],
            states_before: self.initial.clone(),
            leaks: vec![0.0; shape.states],
            pulls: vec![0.0; shape.states],
            moved: 0.0,
            elapsed: 0.0,
            x: None,
        }
    }

    #[inline(always)]
    pub(super) fn advance<S: Simd>(&self, memory: &mut CellMemory, input: Input) {
        let shape = self.shape();
        (memory.moved, memory.elapsed) = match memory.x {
            Some(before) => ((input.x - before).abs(), if input.step > 0.0 { input.step } else { 0.0 }),
            None => (0.0, 0.0),
        };
        memory.x = Some(input.x);
        memory.terms[1] = input.x;
        if shape.channels == 2 {
            memory.terms[2] = input.rate;
        }
        self.advance_stops::<S>(shape, memory, input);
        let (inputs, neurons) = memory.terms.split_at_mut(shape.inputs());
        layer::<S>(&self.hidden, inputs, neurons); // (8.30)
        let states = &mut inputs[shape.first_state()..];
        self.leaks::<S>(memory.moved, memory.elapsed, &mut memory.leaks); // (8.29)
        memory.states_before.copy_from_slice(states);
        let rows = self.targets.chunks_exact(shape.neurons);
        for (i, (state, row)) in states.iter_mut().zip(rows).enumerate() {
            let mut target = product::<S>(row, neurons);
            if shape.channels == 2 {
                target = multiply_add::<S>(self.rate_gains[i], input.rate, target);
            }
            memory.pulls[i] = target - *state;
            *state = multiply_add::<S>(memory.leaks[i], memory.pulls[i], *state); // (8.31)
        }
    }

    #[inline(always)]
    fn advance_stops<S: Simd>(&self, shape: CellShape, memory: &mut CellMemory, input: Input) {
        let CellMemory { terms, plays, plays_before, .. } = memory;
        let elongations = &mut terms[1 + shape.channels..][..shape.stops];
        let (of_x, of_rate) = self.stops.split_at(shape.stops);
        plays_before.copy_from_slice(plays);
        for (index, (elongation, play)) in elongations.iter_mut().zip(plays).enumerate() {
            let mut drive = of_x[index] * input.from_origin;
            if shape.channels == 2 {
                drive = multiply_add::<S>(of_rate[index], input.rate, drive);
            }
            *play = play::follow(*play, drive, 1.0);
            // Rounding of a huge drive would leave the stop's range.
            *elongation = stop::elongation(drive, *play).clamp(-1.0, 1.0);
        }
    }

    #[inline(always)]
    fn leaks<S: Simd>(&self, moved: f64, elapsed: f64, leaks: &mut [f64]) {
        for (leak, c) in leaks.iter_mut().zip(&self.path_leaks) {
            *leak = c * moved;
        }
        for (leak, tau) in leaks.iter_mut().zip(&self.relaxation_times) {
            *leak += elapsed / tau;
        }
        for leak in leaks {
            let t = tanh::<S>(0.5 * *leak);
            *leak = 2.0 * t / (1.0 + t); // (8.29): 1 - exp(-leak)
        }
    }

    #[inline(always)]
    pub(super) fn output<S: Simd>(&self, memory: &CellMemory) -> f64 {
        product::<S>(&self.output, &memory.terms) // (8.32)
    }
}

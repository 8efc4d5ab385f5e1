//! The recurrent cell in scaled units: stops, a layer of tanh neurons and states with a leak.
//!
//! ```text
//! a_i = 1 - exp(-(c_i |x_k - x_{k-1}| + (t_k - t_{k-1})/τ_i))               theory.md (8.29)
//! h_j = tanh((1 + Σ_m α_jm m) (b_j + A_j [x, v, a, d, e, s_{k-1}]))         theory.md (8.30)
//! s_i = s_i,k-1 + a_i (q_i v + (1 + Σ_m β_im m) Σ_j W_ij h_j - s_i,k-1)     theory.md (8.31)
//! y_k = w · [1, x, v, a, d, e, s, h, m x, m v, m a]                         theory.md (8.32)
//! a   = 0.4 asinh(x'' / ς),   x'' by backward differences                   theory.md (8.61)
//! ```
//!
//! Without a row index, a quantity is that of row `k`. The acceleration `a`, the direct further inputs `d` and the
//! modulating ones `m` are optional. An odd cell has neither the constant nor `b`.
//!
//! The leak is computed as `1 - e^{-z} = 2 t/(1 + t)` with `t = tanh(z/2)`, which has no cancellation at small
//! `z` and is at most 1.

use pulp::Simd;
use serde::{Deserialize, Serialize};

use crate::elementary::asinh;
use crate::law::tanh_layer::{add_columns, layer, product};
use crate::network::tanh::tanh;
use crate::operator::{play, stop};
use crate::simd::multiply_add;

/// The parameters of the cell; the symbols are those of the [module page](super).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
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
    /// `w`: the constant, then the weights of `x`, `v`, `a`, `d`, stops, states and neurons, and for each modulating
    /// input those of `m x`, `m v` and `m a`.
    pub output: Vec<f64>,
    /// `ς`: scale of the second derivative of the input, in scaled units; `None` for a cell without acceleration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration_scale: Option<f64>,
    /// Number of direct further inputs.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub direct_inputs: usize,
    /// `α`: for each modulating input its weight in every neuron.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layer_modulation: Vec<f64>,
    /// `β`: for each modulating input its weight in the target of every state.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub target_modulation: Vec<f64>,
    /// True for a cell without constants: the opposite input gives the opposite output.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_odd: bool,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Factor of the compressed acceleration, which is about 1 at five times its scale. Designed.
pub const ACCELERATION_GAIN: f64 = 0.4;

/// Largest magnitude of a derivative of the input in scaled units, also in single precision.
pub const LARGEST_DERIVATIVE: f64 = 1e30;

/// Numbers of the parts of a cell.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
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
    /// True if the second derivative of the input is an input.
    pub has_acceleration: bool,
    /// Direct further inputs.
    pub direct: usize,
    /// Modulating further inputs.
    pub modulators: usize,
    /// True without constants.
    pub is_odd: bool,
}

impl CellShape {
    /// Number of constants among the inputs of the tanh layer: 1, or 0 for an odd cell.
    pub fn constants(self) -> usize {
        usize::from(!self.is_odd)
    }

    /// Rows at the beginning of a record that is cut out of a longer one whose derivatives of the input are not known.
    pub fn rows_without_derivatives(self) -> usize {
        match (self.channels, self.has_acceleration) {
            (1, _) => 0,
            (_, false) => 1,
            (_, true) => 2,
        }
    }

    /// Number of the inputs that modulating inputs multiply: `x`, `v` and `a`.
    pub(super) fn modulated(self) -> usize {
        self.channels + usize::from(self.has_acceleration)
    }

    /// Place of the first stop among the terms of the output.
    pub fn first_stop(self) -> usize {
        self.constants() + self.modulated() + self.direct
    }

    /// Number of inputs of the tanh layer, the constant included.
    pub fn inputs(self) -> usize {
        self.first_state() + self.states
    }

    /// Number of output weights.
    pub fn terms(self) -> usize {
        self.inputs() + self.neurons + self.modulators * self.modulated()
    }

    /// Place of the first state among the terms of the output.
    pub fn first_state(self) -> usize {
        self.first_stop() + self.stops
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
    /// `b + A [x, v, a, d, e, s_{k-1}]` of a cell with modulating inputs.
    pub(super) sums: Vec<f64>,
    /// `1 + Σ_m α_jm m` and `1 + Σ_m β_im m`; 1 without modulating inputs.
    pub(super) layer_factors: Vec<f64>,
    pub(super) target_factors: Vec<f64>,
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
    /// Scaled further inputs of the last sample.
    pub(super) further: Vec<f64>,
    /// First derivative of the input at the last sample, and whether there is one.
    velocity: f64,
    has_velocity: bool,
}

impl CellMemory {
    /// The states.
    pub fn states(&self, shape: CellShape) -> &[f64] {
        &self.terms[shape.first_state()..shape.inputs()]
    }
}

impl Cell {
    /// The numbers of its parts.
    #[inline(always)]
    pub fn shape(&self) -> CellShape {
        let has_rate = !self.rate_gains.is_empty();
        let channels = if has_rate { 2 } else { 1 };
        let stops = if has_rate { self.stops.len() / 2 } else { self.stops.len() };
        let states = self.initial.len();
        let without_neurons = CellShape {
            channels,
            stops,
            states,
            neurons: 0,
            has_time: !self.relaxation_times.is_empty(),
            has_acceleration: self.acceleration_scale.is_some(),
            direct: self.direct_inputs,
            modulators: self.target_modulation.len() / states.max(1),
            is_odd: self.is_odd,
        };
        let neurons = self.output.len().saturating_sub(without_neurons.terms());
        CellShape { neurons, ..without_neurons }
    }

    /// True if all parts have the lengths that go together.
    pub(super) fn is_consistent(&self) -> bool {
        let shape = self.shape();
        let CellShape { channels, stops, states, neurons, has_time, modulators, .. } = shape;
        states > 0
            && neurons > 0
            && self.stops.len() == channels * stops
            && self.hidden.len() == shape.inputs() * neurons
            && self.targets.len() == states * neurons
            && self.rate_gains.len() == if channels == 2 { states } else { 0 }
            && self.path_leaks.len() == states
            && self.relaxation_times.len() == if has_time { states } else { 0 }
            && self.output.len() == shape.terms()
            && self.layer_modulation.len() == modulators * neurons
            && self.target_modulation.len() == modulators * states
            && (!shape.has_acceleration || has_time)
    }

    /// The memory before the first sample.
    pub fn memory(&self) -> CellMemory {
        self.memory_with(&self.initial)
    }

    /// The memory before the first sample, with these states.
    pub fn memory_with(&self, states: &[f64]) -> CellMemory {
        let shape = self.shape();
        let mut terms = vec![0.0; shape.terms()];
        terms[..shape.constants()].fill(1.0);
        terms[shape.first_state()..shape.inputs()].copy_from_slice(states);
        CellMemory {
            terms,
            sums: vec![0.0; shape.neurons],
            layer_factors: vec![1.0; shape.neurons],
            target_factors: vec![1.0; shape.states],
            plays: vec![0.0; shape.stops],
            plays_before: vec![0.0; shape.stops],
            states_before: states.to_vec(),
            leaks: vec![0.0; shape.states],
            pulls: vec![0.0; shape.states],
            moved: 0.0,
            elapsed: 0.0,
            x: None,
            further: Vec::new(),
            velocity: 0.0,
            has_velocity: false,
        }
    }

    /// To the next sample; `further` has its scaled further inputs, first the direct, then the modulating ones.
    #[inline(always)]
    pub(super) fn advance<S: Simd>(&self, memory: &mut CellMemory, input: Input, further: &[f64]) {
        let shape = self.shape();
        let change = memory.x.map_or(0.0, |before| input.x - before);
        (memory.moved, memory.elapsed) = match memory.x {
            Some(_) => (change.abs(), if input.step > 0.0 { input.step } else { 0.0 }),
            None => (0.0, 0.0),
        };
        memory.x = Some(input.x);
        let first = shape.constants();
        memory.terms[first] = input.x;
        if shape.channels == 2 {
            memory.terms[first + 1] = input.rate;
        }
        if let Some(scale) = self.acceleration_scale {
            memory.terms[first + shape.channels] = acceleration(memory, change, scale); // (8.61)
        }
        let (direct, modulating) = further.split_at(shape.direct);
        memory.terms[first + shape.modulated()..][..shape.direct].copy_from_slice(direct);
        self.advance_stops::<S>(shape, memory, input);
        self.advance_layer::<S>(shape, memory, modulating); // (8.30)
        let (inputs, neurons) = memory.terms.split_at_mut(shape.inputs());
        let neurons = &neurons[..shape.neurons];
        let states = &mut inputs[shape.first_state()..];
        self.leaks::<S>(memory.moved, memory.elapsed, &mut memory.leaks); // (8.29)
        memory.states_before.copy_from_slice(states);
        let rows = self.targets.chunks_exact(shape.neurons);
        for (i, (state, row)) in states.iter_mut().zip(rows).enumerate() {
            let mut target = product::<S>(row, neurons);
            if shape.modulators > 0 {
                target *= memory.target_factors[i];
            }
            if shape.channels == 2 {
                target = multiply_add::<S>(self.rate_gains[i], input.rate, target);
            }
            memory.pulls[i] = target - *state;
            *state = multiply_add::<S>(memory.leaks[i], memory.pulls[i], *state); // (8.31)
        }
    }

    /// The tanh neurons, and what modulating inputs multiply.
    #[inline(always)]
    fn advance_layer<S: Simd>(&self, shape: CellShape, memory: &mut CellMemory, modulating: &[f64]) {
        let CellMemory { terms, sums, layer_factors, target_factors, .. } = memory;
        let (inputs, rest) = terms.split_at_mut(shape.inputs());
        let (neurons, modulated) = rest.split_at_mut(shape.neurons);
        if modulating.is_empty() && !shape.is_odd {
            return layer::<S>(&self.hidden, inputs, neurons);
        }
        for (factors, weights) in
            [(&mut *layer_factors, &self.layer_modulation), (&mut *target_factors, &self.target_modulation)]
        {
            factors.fill(1.0);
            add_columns::<S>(weights, modulating, factors);
        }
        sums.fill(0.0);
        add_columns::<S>(&self.hidden, inputs, sums);
        for (neuron, (sum, factor)) in neurons.iter_mut().zip(sums.iter().zip(layer_factors)) {
            *neuron = tanh::<S>(*factor * sum);
        }
        let signals = &inputs[shape.constants()..][..shape.modulated()];
        for (products, m) in modulated.chunks_exact_mut(signals.len()).zip(modulating) {
            products.iter_mut().zip(signals).for_each(|(product, signal)| *product = m * signal);
        }
    }

    #[inline(always)]
    fn advance_stops<S: Simd>(&self, shape: CellShape, memory: &mut CellMemory, input: Input) {
        let CellMemory { terms, plays, plays_before, .. } = memory;
        let elongations = &mut terms[shape.first_stop()..][..shape.stops];
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

/// The compressed second derivative of the input (theory.md (8.61)), after a change of the input in the elapsed time.
fn acceleration(memory: &mut CellMemory, change: f64, scale: f64) -> f64 {
    let elapsed = memory.elapsed;
    let is_step = elapsed > 0.0;
    let velocity = if is_step { limited(change / elapsed) } else { 0.0 };
    let before = std::mem::replace(&mut memory.velocity, velocity);
    let is_second = is_step && memory.has_velocity;
    memory.has_velocity = is_step;
    if is_second { ACCELERATION_GAIN * asinh(limited((velocity - before) / elapsed / scale)) } else { 0.0 }
}

/// A derivative in scaled units, which a tiny time step does not make infinite.
fn limited(derivative: f64) -> f64 {
    derivative.clamp(-LARGEST_DERIVATIVE, LARGEST_DERIVATIVE)
}

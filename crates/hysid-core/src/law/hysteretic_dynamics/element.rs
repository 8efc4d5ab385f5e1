//! A hysteretic element: a force that depends on the path of a displacement.
//!
//! ```text
//! ε̂_i = ε_i,0 + δ - δ_0 + τ_i (ν - ν_0),   ε_i = max(-ρ_i, min(ρ_i, ε̂_i))
//! Λ_i = Λ_i,0 + |ε̂_i - ε_i|,   z_i = ε_i max(0, 1 - λ_i Λ_i)                   theory.md (15.6)
//! φ   = tanh(A [1, δ, ν, z, s])                                                theory.md (15.7)
//! T   = W↑ φ  where δ rises,  W↓ φ  where it falls                             theory.md (15.8)
//! s   = χ s_0 + w_0 T_0 + w_1 T_1,   l = γ |δ - δ_0|                           theory.md (15.9)
//! χ   = exp(-l),   w_1 = 1 - (1 - χ)/l,   w_0 = 1 - χ - w_1
//! r   = v [z, s, φ]                                                            theory.md (15.10)
//! ```
//!
//! `δ` is the displacement of the element, `ν` its velocity over the frequency, `r` its force; `ε` is the elongation of
//! a stop, `ε̂` the one that it would have without its threshold, `Λ` its slip, `z` its output, `s` a state and `φ` a
//! tanh neuron. Index 0 is the beginning of the step. A stop is driven by displacement and velocity and deteriorates as
//! it slips, as the [deteriorating stop](crate::operator::deteriorating_stop) does. (15.9) integrates
//! `ds/d|δ| = γ (T - s)` to second order: `T_1` is taken at the end of the step, with the states that follow from `T_0`
//! alone. The weights are not negative and sum to 1, so a state stays among its targets whatever the step.

use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::ElementShape;
use crate::law::tanh_layer::{layer, product};
use crate::network::tanh::tanh;
use crate::simd::multiply_add;

/// The parameters of a hysteretic element, with the symbols of theory.md (15.2) to (15.10).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Element {
    /// `D`: how the displacement of the element follows from the displacement of each mode.
    pub of_displacements: Vec<f64>,
    /// `V`: how it follows from the velocity of each mode.
    pub of_velocities: Vec<f64>,
    /// `U`: how it follows from the input.
    pub of_input: f64,
    /// `g`: displacement of each mode at rest under a unit force of the element.
    pub compliances: Vec<f64>,
    /// `μ`: share of the force in the output.
    pub in_output: f64,
    /// `ρ > 0`: thresholds of the stops.
    pub thresholds: Vec<f64>,
    /// `τ`: share of the velocity in what drives each stop.
    pub stop_velocities: Vec<f64>,
    /// `λ ≥ 0`: the strength that each stop loses per unit of its slip. Empty for stops that do not deteriorate.
    pub strength_losses: Vec<f64>,
    /// `A`: for each input of the layer (1, `δ`, `ν`, stops, states) its weight in every neuron.
    pub layer: Vec<f64>,
    /// `W↑`: a row of weights of the neurons for each state.
    pub rising: Vec<f64>,
    /// `W↓`, in the same form.
    pub falling: Vec<f64>,
    /// `γ > 0` of each state: its leak along the path.
    pub path_leaks: Vec<f64>,
    /// States before the first sample.
    pub initial: Vec<f64>,
    /// `v`: weights of stops, states and neurons in the force.
    pub force: Vec<f64>,
}

impl Element {
    pub(super) fn is_consistent(&self, shape: ElementShape, modes: usize) -> bool {
        let ElementShape { stops, states, neurons, deteriorates } = shape;
        neurons > 0
            && self.of_displacements.len() == modes
            && self.of_velocities.len() == modes
            && self.compliances.len() == modes
            && self.thresholds.len() == stops
            && self.stop_velocities.len() == stops
            && self.strength_losses.len() == if deteriorates { stops } else { 0 }
            && self.layer.len() == shape.inputs() * neurons
            && self.rising.len() == states * neurons
            && self.falling.len() == states * neurons
            && self.path_leaks.len() == states
            && self.initial.len() == states
            && self.force.len() == stops + states + neurons
    }

    /// True if the tanh neurons have a constant where they may have none.
    pub(super) fn has_forbidden_constant(&self) -> bool {
        let shape = self.shape();
        self.layer[..shape.first_free_input() * shape.neurons].iter().any(|weight| *weight != 0.0)
    }

    /// Numbers of its parts.
    pub fn shape(&self) -> ElementShape {
        let (stops, states) = (self.thresholds.len(), self.path_leaks.len());
        let neurons = self.force.len().saturating_sub(stops + states);
        ElementShape { stops, states, neurons, deteriorates: !self.strength_losses.is_empty() }
    }

    /// Bounds of the magnitudes of the force and of each state, which is an average of past and targets.
    pub fn bounds(&self) -> (f64, Vec<f64>) {
        let ElementShape { stops, states, neurons, .. } = self.shape();
        let size = |weights: &[f64]| weights.iter().map(|w| w.abs()).sum::<f64>();
        let of_state = |i: usize| {
            let row = i * neurons..(i + 1) * neurons;
            self.initial[i].abs().max(size(&self.rising[row.clone()])).max(size(&self.falling[row]))
        };
        let of_states: Vec<f64> = (0..states).map(of_state).collect();
        let largest =
            self.thresholds.iter().chain(&of_states).copied().chain(std::iter::repeat_n(1.0, neurons));
        let force = self.force.iter().zip(largest).map(|(weight, bound)| weight.abs() * bound).sum();
        debug_assert_eq!(self.force.len(), stops + states + neurons);
        (force, of_states)
    }
}

/// An element at a point of its path: displacement, velocity, memory and force.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PathPoint {
    /// `1, δ, ν, z, s`.
    pub inputs: Vec<f64>,
    pub neurons: Vec<f64>,
    pub force: f64,
    /// `ε` and `Λ` of each stop.
    pub elongations: Vec<f64>,
    pub slips: Vec<f64>,
}

/// A step of an element along its path, from one point to another, with what its derivatives need.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PathStep {
    pub end: PathPoint,
    /// The inputs of the layer for `T_1`, and the neurons there.
    pub inputs_ahead: Vec<f64>,
    pub neurons_ahead: Vec<f64>,
    pub targets: Vec<f64>,
    pub targets_ahead: Vec<f64>,
    /// `l`, `χ`, `w_0` and `w_1` of each state.
    pub weights: Vec<StateWeights>,
    /// `δ - δ_0`.
    pub moved: f64,
    /// Of each stop that ends at its threshold its elongation, otherwise 0.
    pub at_threshold: Vec<f64>,
    /// `max(0, 1 - λ Λ)` of each stop.
    pub strengths: Vec<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct StateWeights {
    pub travel: f64,
    pub kept: f64,
    pub first: f64,
    pub last: f64,
}

/// Travel below which the mean decay is that of a straight line, to rounding.
const LEAST_TRAVEL: f64 = 1e-8;

impl StateWeights {
    #[inline(always)]
    fn of<S: Simd>(travel: f64) -> Self {
        // 1 - e^-l = 2 t/(1 + t) with t = tanh(l/2), which has no cancellation.
        let t = tanh::<S>(0.5 * travel);
        let left = 2.0 * t / (1.0 + t);
        let mean = if travel > LEAST_TRAVEL { left / travel } else { 1.0 - 0.5 * travel };
        let kept = 1.0 - left;
        Self { travel, kept, first: (mean - kept).max(0.0), last: 1.0 - mean }
    }

    /// Derivative of `first` and of `last` by the travel; that of `kept` is `-kept`.
    #[inline(always)]
    pub fn slopes(self) -> (f64, f64) {
        let mean = 1.0 - self.last;
        let slope =
            if self.travel > 1e-4 { (self.kept - mean) / self.travel } else { self.travel / 3.0 - 0.5 };
        (slope + self.kept, -slope)
    }
}

impl PathPoint {
    fn zero(shape: ElementShape) -> Self {
        Self {
            inputs: vec![0.0; shape.inputs()],
            neurons: vec![0.0; shape.neurons],
            force: 0.0,
            elongations: vec![0.0; shape.stops],
            slips: vec![0.0; shape.stops],
        }
    }

    /// Where an element is before the first sample, without its force.
    pub fn virgin(element: &Element) -> Self {
        let shape = element.shape();
        let mut point = Self::zero(shape);
        point.inputs[0] = 1.0;
        point.inputs[shape.first_state()..].copy_from_slice(&element.initial);
        point
    }

    /// Neurons and force from the inputs of the layer.
    #[inline(always)]
    pub fn finish<S: Simd>(&mut self, element: &Element) {
        layer::<S>(&element.layer, &self.inputs, &mut self.neurons); // (15.7)
        let (of_memory, of_neurons) = element.force.split_at(self.inputs.len() - 3);
        // (15.10)
        self.force = product::<S>(of_memory, &self.inputs[3..]) + product::<S>(of_neurons, &self.neurons);
    }

    pub fn copy_from(&mut self, other: &Self) {
        self.inputs.copy_from_slice(&other.inputs);
        self.neurons.copy_from_slice(&other.neurons);
        self.force = other.force;
        self.elongations.copy_from_slice(&other.elongations);
        self.slips.copy_from_slice(&other.slips);
    }
}

impl PathStep {
    pub fn new(element: &Element) -> Self {
        let shape = element.shape();
        let end = PathPoint::zero(shape);
        Self {
            inputs_ahead: end.inputs.clone(),
            neurons_ahead: end.neurons.clone(),
            targets: vec![0.0; shape.states],
            targets_ahead: vec![0.0; shape.states],
            weights: vec![StateWeights::default(); shape.states],
            moved: 0.0,
            at_threshold: vec![0.0; shape.stops],
            strengths: vec![1.0; shape.stops],
            end,
        }
    }

    /// The weights of the targets in the direction of this step.
    #[inline(always)]
    pub fn targets_of<'e>(&self, element: &'e Element) -> &'e [f64] {
        if self.moved < 0.0 { &element.falling } else { &element.rising }
    }

    /// Takes the step from a point to a displacement and velocity.
    #[inline(always)]
    pub fn take<S: Simd>(&mut self, element: &Element, from: &PathPoint, displacement: f64, velocity: f64) {
        let shape = element.shape();
        let (stops, first_state) = (shape.stops, shape.first_state());
        self.moved = displacement - from.inputs[1];
        let rows = self.targets_of(element);
        let path = self.moved.abs();
        let PathPoint { inputs, elongations, slips, .. } = &mut self.end;
        (inputs[0], inputs[1], inputs[2]) = (1.0, displacement, velocity);
        let of_velocity = velocity - from.inputs[2];
        for i in 0..stops {
            let driven = multiply_add::<S>(element.stop_velocities[i], of_velocity, self.moved);
            let (free, threshold) = (from.elongations[i] + driven, element.thresholds[i]); // (15.6): ε̂
            let elongation = free.clamp(-threshold, threshold); // (15.6): ε
            elongations[i] = elongation;
            slips[i] = from.slips[i] + (free - elongation).abs(); // (15.6): Λ
            let loss = element.strength_losses.get(i).copied().unwrap_or(0.0);
            self.strengths[i] = (1.0 - loss * slips[i]).max(0.0);
            self.at_threshold[i] = if elongation == free { 0.0 } else { elongation };
            inputs[3 + i] = elongation * self.strengths[i]; // (15.6): z
        }
        let inputs = &mut self.end.inputs;
        self.inputs_ahead[..first_state].copy_from_slice(&inputs[..first_state]);
        for (i, before) in from.inputs[first_state..].iter().enumerate() {
            let weights = StateWeights::of::<S>(element.path_leaks[i] * path);
            // (15.8): T_0
            let target = product::<S>(&rows[i * shape.neurons..][..shape.neurons], &from.neurons);
            self.inputs_ahead[first_state + i] =
                multiply_add::<S>(1.0 - weights.kept, target - before, *before);
            (self.weights[i], self.targets[i]) = (weights, target);
        }
        layer::<S>(&element.layer, &self.inputs_ahead, &mut self.neurons_ahead);
        for (i, before) in from.inputs[first_state..].iter().enumerate() {
            let StateWeights { kept, first, last, .. } = self.weights[i];
            // (15.8): T_1
            let ahead = product::<S>(&rows[i * shape.neurons..][..shape.neurons], &self.neurons_ahead);
            self.targets_ahead[i] = ahead;
            // (15.9)
            self.end.inputs[first_state + i] =
                multiply_add::<S>(kept, *before, multiply_add::<S>(first, self.targets[i], last * ahead));
        }
        self.end.finish::<S>(element);
    }
}

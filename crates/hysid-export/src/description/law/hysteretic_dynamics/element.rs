//! A hysteretic element: its step to a displacement, and the force there.

use hysid_core::law::hysteretic_dynamics::{Dynamics, Element, ElementShape};

use crate::description::law::tanh_layer::{Slice, layer, partial_sums, product};
use crate::description::network::tanh;
use crate::program::expression::{Real, Whole, fused};
use crate::program::{Array, Builder};

/// Travel below which the mean decay is that of a straight line, to rounding.
const LEAST_TRAVEL: f64 = 1e-8;

/// The constant, which is the only input of the tanh layer that is not remembered.
const FORGOTTEN: usize = 1;

/// Positions of the velocity and of the first stop or state among what is remembered.
const VELOCITY: usize = 1;
const MEMORY: usize = 2;

/// The arrays of the stops of an element.
struct StopParts {
    thresholds: Array,
    velocities: Array,
    /// Those of stops that deteriorate.
    strength_losses: Option<Array>,
    /// All `ε`, then all `Λ` of stops that deteriorate, where the element is and where it goes.
    point: Array,
    ahead: Array,
    length: usize,
}

impl StopParts {
    /// `None` for an element without stops.
    fn new(builder: &mut Builder, name: &impl Fn(&str) -> String, element: &Element) -> Option<Self> {
        let ElementShape { stops, deteriorates, .. } = element.shape();
        if stops == 0 {
            return None;
        }
        let mut constants = |what: &str, values: &[f64]| builder.constants(&name(what), values.to_vec());
        let thresholds = constants("threshold", &element.thresholds);
        let velocities = constants("stop_velocity", &element.stop_velocities);
        let strength_losses = deteriorates.then(|| constants("strength_loss", &element.strength_losses));
        let length = if deteriorates { 2 * stops } else { stops };
        let point = builder.state(&name("stop"), vec![0.0; length]);
        let ahead = builder.scratch(&name("stop_ahead"), length);
        Some(Self { thresholds, velocities, strength_losses, point, ahead, length })
    }
}

pub(super) struct ElementParts<'l> {
    element: &'l Element,
    shape: ElementShape,
    index: usize,
    /// How its displacement follows from displacement and velocity of each mode.
    of_displacements: Array,
    of_velocities: Array,
    stops: Option<StopParts>,
    /// `W↑`, then `W↓`.
    targets: Array,
    leaks: Array,
    layer: Array,
    /// `v`
    weights: Array,
    /// `δ, ν, z, s` and the neurons, where the element is.
    point: Array,
    point_neurons: Array,
    /// `1, δ, ν, z, s` and the neurons, where it goes.
    inputs: Array,
    neurons: Array,
    /// `χ`, `w_0`, `w_1` and `T_0` of each state, in the step from one to the other.
    path_step: Array,
    sums: Array,
    following: Array,
}

impl<'l> ElementParts<'l> {
    /// Those of all elements; their forces are in `following`.
    pub fn all(builder: &mut Builder, name: &str, law: &'l Dynamics, following: Array) -> Vec<Self> {
        let sums = partial_sums(builder, name);
        let elements = law.elements.iter().enumerate();
        elements.map(|(index, element)| Self::new(builder, name, index, element, (sums, following))).collect()
    }

    fn new(
        builder: &mut Builder,
        name: &str,
        index: usize,
        element: &'l Element,
        (sums, following): (Array, Array),
    ) -> Self {
        let shape = element.shape();
        let name = |what: &str| format!("{name}_element_{}_{what}", index + 1);
        let stops = StopParts::new(builder, &name, element);
        let mut constants = |what: &str, values: &[f64]| builder.constants(&name(what), values.to_vec());
        let targets = [element.rising.as_slice(), &element.falling].concat();
        let of_displacements = constants("of_displacement", &element.of_displacements);
        let of_velocities = constants("of_velocity", &element.of_velocities);
        let targets = constants("target", &targets);
        let leaks = constants("leak", &element.path_leaks);
        let layer = constants("layer", &element.layer);
        let weights = constants("weight", &element.force);
        let mut point = vec![0.0; MEMORY + shape.stops];
        point.extend(&element.initial);
        Self {
            element,
            shape,
            index,
            of_displacements,
            of_velocities,
            stops,
            targets,
            leaks,
            layer,
            weights,
            point: builder.state(&name("point"), point),
            point_neurons: builder.state(&name("neuron"), vec![0.0; shape.neurons]),
            inputs: builder.scratch(&name("input"), shape.inputs()),
            neurons: builder.scratch(&name("neuron_ahead"), shape.neurons),
            path_step: builder.scratch(&name("path_step"), 4 * shape.states),
            sums,
            following,
        }
    }

    /// Number of stops and states.
    fn memory(&self) -> usize {
        self.shape.stops + self.shape.states
    }

    /// The neurons and the force of the virgin element.
    pub fn begin(&self, builder: &mut Builder) {
        builder.set(self.inputs, 0_usize, 1.0);
        builder.each(0_usize, MEMORY + self.memory(), |builder, i| {
            builder.set(self.inputs, &i + FORGOTTEN, self.point.at(&i));
        });
        if let Some(stops) = &self.stops {
            builder
                .each(0_usize, stops.length, |builder, i| builder.set(stops.ahead, &i, stops.point.at(&i)));
        }
        self.finish(builder);
        self.arrive(builder);
    }

    /// Remembers where the element went.
    pub fn arrive(&self, builder: &mut Builder) {
        builder.each(0_usize, MEMORY + self.memory(), |builder, i| {
            builder.set(self.point, &i, self.inputs.at(&i + FORGOTTEN));
        });
        if let Some(stops) = &self.stops {
            builder
                .each(0_usize, stops.length, |builder, i| builder.set(stops.point, &i, stops.ahead.at(&i)));
        }
        builder.each(0_usize, self.shape.neurons, |builder, i| {
            builder.set(self.point_neurons, &i, self.neurons.at(&i));
        });
    }

    /// The step to where displacements and velocities of the modes and the scaled input are.
    pub fn go(&self, builder: &mut Builder, (displacements, velocities): (Array, Array), input: &Real) {
        let displacement = builder.variable(self.element.of_input * input);
        let velocity = builder.variable(0.0);
        builder.each(0_usize, self.element.of_displacements.len(), |builder, i| {
            let (q, p) = (displacements.at(&i), builder.value(velocities.at(&i)));
            let of_displacement = builder.value(self.of_displacements.at(&i));
            builder.assign(displacement, fused(&of_displacement, q, displacement));
            builder.assign(displacement, fused(self.of_velocities.at(&i), &p, displacement));
            builder.assign(velocity, fused(of_displacement, p, velocity));
        });
        let moved = builder.value(Real::from(displacement) - self.point.at(0_usize));
        builder.set(self.inputs, 0_usize, 1.0);
        builder.set(self.inputs, 1_usize, displacement);
        builder.set(self.inputs, 2_usize, velocity);
        self.stops(builder, &moved, &Real::from(velocity));
        if self.shape.states > 0 {
            self.states(builder, &moved);
        }
        self.finish(builder);
    }

    fn stops(&self, builder: &mut Builder, moved: &Real, velocity: &Real) {
        let Some(parts) = &self.stops else { return };
        let stops = self.shape.stops;
        let of_velocity = builder.value(velocity - self.point.at(VELOCITY));
        builder.each(0_usize, stops, |builder, i| {
            let driven = builder.value(fused(parts.velocities.at(&i), &of_velocity, moved));
            let free = builder.value(parts.point.at(&i) + driven);
            let threshold = builder.value(parts.thresholds.at(&i));
            let elongation = builder.value(free.clone().clamp(-&threshold, &threshold));
            builder.set(parts.ahead, &i, &elongation);
            let output = match parts.strength_losses {
                Some(losses) => {
                    let slip = builder.value(parts.point.at(&i + stops) + (free - &elongation).abs());
                    builder.set(parts.ahead, &i + stops, &slip);
                    elongation * (1.0 - losses.at(&i) * slip).max(0.0)
                }
                None => elongation,
            };
            builder.set(self.inputs, &i + 3_usize, output);
        });
    }

    fn states(&self, builder: &mut Builder, moved: &Real) {
        let ElementShape { stops, states, neurons, .. } = self.shape;
        let path = builder.value(moved.abs());
        let rows = builder.whole_variable(0_usize);
        builder.when(moved.below(0.0), |builder| builder.assign_whole(rows, states * neurons));
        let zero = Whole::from(0_usize);
        let target = |builder: &mut Builder, i: &Whole, of: Array| {
            let row = Whole::from(builder.whole_variable(Whole::from(rows) + i * neurons));
            product(builder, (self.targets, &row), (of, &zero), (neurons, self.sums))
        };
        let entry = |what: usize, i: &Whole| i + what * states;
        builder.each(0_usize, states, |builder, i| {
            let travel = builder.value(self.leaks.at(&i) * &path);
            let half = builder.value(0.5 * &travel);
            let t = tanh(builder, &half);
            let left = builder.value(2.0 * &t / (1.0 + &t));
            let is_far = travel.above(LEAST_TRAVEL);
            let mean = builder.value(is_far.choose(&left / &travel, 1.0 - 0.5 * &travel));
            let kept = builder.value(1.0 - left);
            let first = builder.value(&mean - &kept);
            let target = target(builder, &i, self.point_neurons);
            let before = builder.value(self.point.at(&i + (MEMORY + stops)));
            let ahead = fused(1.0 - &kept, &target - &before, &before);
            builder.set(self.inputs, &i + (3 + stops), ahead);
            builder.set(self.path_step, entry(0, &i), kept);
            builder.set(self.path_step, entry(1, &i), first.max(0.0));
            builder.set(self.path_step, entry(2, &i), 1.0 - mean);
            builder.set(self.path_step, entry(3, &i), target);
        });
        self.layer(builder);
        builder.each(0_usize, states, |builder, i| {
            let ahead = target(builder, &i, self.neurons);
            let [kept, first, last, target] = [0, 1, 2, 3].map(|what| self.path_step.at(entry(what, &i)));
            let before = self.point.at(&i + (MEMORY + stops));
            builder.set(
                self.inputs,
                &i + (3 + stops),
                fused(kept, before, fused(first, target, last * ahead)),
            );
        });
    }

    fn layer(&self, builder: &mut Builder) {
        let neurons = (Slice(self.neurons, 0), self.shape.neurons);
        layer(builder, self.layer, (self.inputs, self.shape.inputs()), neurons);
    }

    /// Neurons and force from the inputs of the layer.
    fn finish(&self, builder: &mut Builder) {
        self.layer(builder);
        let (zero, three) = (Whole::from(0_usize), Whole::from(3_usize));
        let memory = self.memory();
        let of_memory = match memory {
            0 => Real::Constant(0.0),
            _ => product(builder, (self.weights, &zero), (self.inputs, &three), (memory, self.sums)),
        };
        let behind = Whole::from(memory);
        let lengths = (self.shape.neurons, self.sums);
        let of_neurons = product(builder, (self.weights, &behind), (self.neurons, &zero), lengths);
        builder.set(self.following, self.index, of_memory + of_neurons);
    }
}

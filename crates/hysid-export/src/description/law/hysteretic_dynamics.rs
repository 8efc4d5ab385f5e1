//! Vibrating modes with hysteretic elements: hysteretic oscillators and hysteretic state space models.

mod element;
mod forces;
mod input;
mod propagation;

use hysid_core::law::hysteretic_dynamics::Dynamics;

use crate::description::PartInputs;
use crate::program::expression::{Real, Whole, fused};
use crate::program::{Array, Builder};
use element::ElementParts;
use input::Steps;
pub(super) use propagation::ModeFactors;

/// Scaled inputs are limited to this magnitude, as in the library.
const LARGEST_INPUT: f64 = 1e6;

/// theory.md (15.1) to (15.11)
pub(super) fn step(builder: &mut Builder, name: &str, law: &Dynamics, sample: &PartInputs) -> Real {
    let u = builder.value(&sample.inputs[0] / law.input_scale);
    let u = builder.value(u.clamp(-LARGEST_INPUT, LARGEST_INPUT));
    let parts = DynamicsParts::new(builder, name, law);
    builder.when(sample.is_first.clone(), |builder| parts.start(builder));
    let steps = Steps::of_row(builder, name, law, &u, sample);
    builder.when(Whole::from(steps.count).above(0_usize), |builder| {
        parts.factors.set(builder, &steps.length.into());
        builder.each(1_usize, Whole::from(steps.count) + 1_usize, |builder, k| {
            let before = builder.value(steps.reached());
            let input = steps.go(builder, &k);
            parts.advance(builder, &before, &input);
        });
    });
    let y = parts.output(builder, &steps.newest());
    builder.value(law.output_offset + law.output_scale * y)
}

/// The arrays of a model.
struct DynamicsParts<'l> {
    law: &'l Dynamics,
    modes: usize,
    /// Displacement `q` and velocity `p` of each mode.
    displacements: Array,
    velocities: Array,
    /// Displacements without the forces at the end of a step.
    displacements_alone: Array,
    velocities_alone: Array,
    gains: Array,
    factors: ModeFactors,
    elements: Option<DynamicsElements<'l>>,
}

struct DynamicsElements<'l> {
    each: Vec<ElementParts<'l>>,
    /// For each mode the displacement under a unit force of each element, with its sign in the equation of motion.
    compliances: Array,
    /// Forces as they act on the modes, at the end and at the beginning of a step.
    forces: Array,
    forces_before: Array,
    following: Array,
    /// Bounds of the forces.
    largest: Array,
    /// `∂R/∂r` of each element.
    slopes: Array,
    /// The last force that was assumed, and the one that followed.
    tried: Array,
    tried_following: Array,
    /// `∂R/∂r` where the force was found, for derivatives.
    probed: Array,
}

impl<'l> DynamicsElements<'l> {
    fn new(builder: &mut Builder, name: &str, law: &'l Dynamics) -> Option<Self> {
        let count = law.elements.len();
        if count == 0 {
            return None;
        }
        let by_mode = (0..law.modes.len()).flat_map(|i| law.elements.iter().map(move |e| -e.compliances[i]));
        let largest = law.elements.iter().map(|element| element.bounds().0).collect();
        let following = builder.scratch(&format!("{name}_following_force"), count);
        Some(Self {
            compliances: builder.constants(&format!("{name}_compliance"), by_mode.collect()),
            forces: builder.state(&format!("{name}_force"), vec![0.0; count]),
            forces_before: builder.state(&format!("{name}_force_before"), vec![0.0; count]),
            following,
            largest: builder.constants(&format!("{name}_largest_force"), largest),
            slopes: builder.state(&format!("{name}_slope"), vec![0.0; count]),
            tried: builder.scratch(&format!("{name}_tried"), count),
            tried_following: builder.scratch(&format!("{name}_tried_following"), count),
            probed: builder.scratch(&format!("{name}_probed_slope"), count),
            each: ElementParts::all(builder, name, law, following),
        })
    }

    fn count(&self) -> usize {
        self.each.len()
    }
}

impl<'l> DynamicsParts<'l> {
    fn new(builder: &mut Builder, name: &str, law: &'l Dynamics) -> Self {
        let modes = law.modes.len();
        let gains = law.modes.iter().map(|mode| mode.gain).collect();
        Self {
            law,
            modes,
            displacements: builder.state(&format!("{name}_displacement"), vec![0.0; modes]),
            velocities: builder.state(&format!("{name}_velocity"), vec![0.0; modes]),
            displacements_alone: builder.scratch(&format!("{name}_displacement_alone"), modes),
            velocities_alone: builder.scratch(&format!("{name}_velocity_alone"), modes),
            gains: builder.constants(&format!("{name}_gain"), gains),
            factors: ModeFactors::new(builder, name, &law.modes),
            elements: DynamicsElements::new(builder, name, law),
        }
    }

    /// The forces of virgin elements, before the first sample.
    fn start(&self, builder: &mut Builder) {
        let Some(elements) = &self.elements else { return };
        for (e, element) in elements.each.iter().enumerate() {
            element.begin(builder);
            builder.set(elements.forces, e, elements.following.at(e));
            builder.set(elements.forces_before, e, elements.following.at(e));
        }
    }

    /// One step of a row, between these scaled inputs.
    fn advance(&self, builder: &mut Builder, before: &Real, input: &Real) {
        self.move_alone(builder, before, input);
        match &self.elements {
            None => self.move_modes(builder),
            Some(elements) => {
                self.find_forces(builder, elements, input);
                elements.each.iter().for_each(|element| element.arrive(builder));
            }
        }
    }

    /// `force` with the forces of the elements on a mode.
    fn with_elements(&self, builder: &mut Builder, mode: &Whole, force: impl Into<Real>) -> Real {
        let force = builder.variable(force);
        if let Some(elements) = &self.elements {
            let count = elements.count();
            builder.each(0_usize, count, |builder, e| {
                let place = if count == 1 { mode.clone() } else { mode * count + &e };
                let sum = fused(elements.compliances.at(place), elements.forces.at(&e), force);
                builder.assign(force, sum);
            });
        }
        force.into()
    }

    /// The modes without the forces at the end of the step.
    fn move_alone(&self, builder: &mut Builder, before: &Real, input: &Real) {
        builder.each(0_usize, self.modes, |builder, i| {
            let q = builder.value(self.displacements.at(&i));
            let p = builder.value(self.velocities.at(&i));
            let force = self.with_elements(builder, &i, self.gains.at(&i) * before);
            let ahead = builder.value(self.gains.at(&i) * input);
            let moved = |of: usize| {
                let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.factors.at(of + k, &i));
                fused(a, &q, fused(b, &p, fused(c, &force, d * &ahead)))
            };
            builder.set(self.displacements_alone, &i, moved(0));
            builder.set(self.velocities_alone, &i, moved(4));
        });
    }

    /// The modes under the forces at the end of the step.
    fn move_modes(&self, builder: &mut Builder) {
        builder.each(0_usize, self.modes, |builder, i| {
            let force = self.with_elements(builder, &i, 0.0);
            let q = fused(self.factors.at(3, &i), &force, self.displacements_alone.at(&i));
            let p = fused(self.factors.at(7, &i), &force, self.velocities_alone.at(&i));
            builder.set(self.displacements, &i, q);
            builder.set(self.velocities, &i, p);
        });
    }

    fn output(&self, builder: &mut Builder, newest: &Real) -> Real {
        let y = builder.variable(self.law.direct * newest);
        for (i, mode) in self.law.modes.iter().enumerate() {
            let of_mode = fused(mode.velocity_in_output, self.velocities.at(i), self.displacements.at(i));
            builder.assign(y, Real::from(y) + of_mode);
        }
        if let Some(elements) = &self.elements {
            for (e, element) in self.law.elements.iter().enumerate() {
                builder.assign(y, fused(element.in_output, elements.forces.at(e), y));
            }
        }
        y.into()
    }
}

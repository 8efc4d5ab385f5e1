//! Exact derivatives of the output by every parameter, carried forward along a record, and their Gram matrix for
//! least squares.
//!
//! A step is differentiated as a whole (theory.md (15.13)): first the motion without the forces at its end, then those
//! forces, which depend on the displacements that they cause, by solving `(1 - ∂R/∂r) ∂r = ∂R`, then what follows
//! from them. The local derivatives of an element by the ends of its step come from sweeps backwards through its layer,
//! one for each state and one for the force.

mod stops;

use pulp::{Simd, WithSimd};
use stops::{StopSensitivities, add_by_end};

use super::element::{Element, PathPoint, PathStep};
use super::parameters::{DIRECT, DynamicsLayout, ElementLayout, OFFSET};
use super::propagation::PropagationSlopes;
use super::trial::DynamicsMotion;
use super::{Dynamics, ElementShape};
use crate::law::gram_of_rows::{GramOfRows, RowUse};
use crate::law::tanh_layer::{LANES, add_multiple, add_multiples, add_two, product};
use crate::linear_algebra::Gram;
use crate::simd;
use crate::stop_check::{Pace, StopCheck};

/// Smallest divisor of a force by which it depends on itself.
const LEAST_PIVOT: f64 = 0.01;

/// A record as it drives a model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DynamicsDrive {
    /// The input, in its unit.
    pub x: Vec<f64>,
    /// Time since the row before, in the unit of time; infinite in a lead-in.
    pub steps: Vec<f64>,
    /// The output divided by its scale; NaN where it is not compared.
    pub targets: Vec<f64>,
    /// Weight of each row; the square root of the number of rows that it stands for.
    pub weights: Vec<f64>,
}

impl DynamicsDrive {
    /// Number of rows that are compared, with those that they stand for.
    pub fn rows(&self) -> f64 {
        let compared = self.targets.iter().zip(&self.weights).filter(|(target, _)| !target.is_nan());
        compared.map(|(_, weight)| weight * weight).sum()
    }
}

/// A model and the records that it is run over.
#[derive(Debug, Clone, Copy)]
pub struct DynamicsRun<'a> {
    /// The model.
    pub dynamics: &'a Dynamics,
    /// The records.
    pub drives: &'a [DynamicsDrive],
    /// Of each record the displacements of the modes at its first row, beside those at rest, and then the velocities;
    /// empty if all begin at rest.
    pub beginnings: &'a [f64],
    /// True if records begin in mid-motion. The rows of each are then preceded by the forces of the virgin elements on
    /// the modes, as errors: without input the model is in equilibrium.
    pub is_in_motion: bool,
    /// Stops the computation early.
    pub stop: StopCheck<'a>,
}

impl<'a> DynamicsRun<'a> {
    /// A run over records that begin at rest.
    pub fn from_rest(dynamics: &'a Dynamics, drives: &'a [DynamicsDrive], stop: StopCheck<'a>) -> Self {
        Self { dynamics, drives, beginnings: &[], is_in_motion: false, stop }
    }

    /// Half the sum of squares of the weighted errors, in scaled units; `None` once stopped.
    pub fn half_square(self) -> Option<f64> {
        match self.sweep(None, RowUse::HalfSquare(0.0))? {
            RowUse::HalfSquare(sum) => Some(sum),
            _ => None,
        }
    }

    /// The Gram matrix of the derivatives by the parameters of the layout and of the error, each row weighted; `None`
    /// once stopped. The columns of the beginning are those of each record in turn.
    pub fn gram(self, layout: &DynamicsLayout) -> Option<Gram> {
        let rows = GramOfRows::new(layout.count() + 1, self.stop);
        match self.sweep(Some(layout), RowUse::Gram(rows))? {
            RowUse::Gram(rows) => Some(rows.gram),
            _ => None,
        }
    }

    /// The columns of [`DynamicsRun::gram`] themselves, row by row; `None` once stopped.
    pub fn rows(self, layout: &DynamicsLayout) -> Option<Vec<Vec<f64>>> {
        match self.sweep(Some(layout), RowUse::Rows(Vec::new()))? {
            RowUse::Rows(rows) => Some(rows),
            _ => None,
        }
    }

    /// The entries of [`DynamicsRun::gram`] with each instruction set of the machine.
    #[cfg(test)]
    pub(super) fn grams_of_all(self, layout: &DynamicsLayout) -> Vec<Vec<f64>> {
        let rows = || RowUse::Gram(GramOfRows::new(layout.count() + 1, self.stop));
        let grams = simd::run_with_all(|| DynamicsSweep { run: self, layout: Some(layout), rows: rows() });
        grams.into_iter().flatten().filter_map(RowUse::entries).collect()
    }

    /// The rows as they were used; `None` once stopped.
    fn sweep(self, layout: Option<&DynamicsLayout>, rows: RowUse<'a>) -> Option<RowUse<'a>> {
        simd::run(DynamicsSweep { run: self, layout, rows })
    }
}

struct DynamicsSweep<'a, 'l> {
    run: DynamicsRun<'a>,
    layout: Option<&'l DynamicsLayout>,
    rows: RowUse<'a>,
}

impl<'a> WithSimd for DynamicsSweep<'a, '_> {
    type Output = Option<RowUse<'a>>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> Option<RowUse<'a>> {
        let DynamicsRun { dynamics, drives, beginnings, is_in_motion, stop } = self.run;
        let mut pace = Pace::new(stop);
        let offset = dynamics.output_offset / dynamics.output_scale;
        let mut sensitivities = self.layout.map(|layout| MotionSensitivities::new(dynamics, layout));
        let columns = self.layout.map_or(0, DynamicsLayout::count);
        let per_step = 400 + 40 * columns;
        let mut row = vec![0.0; columns + 1];
        let modes = dynamics.modes.len();
        for (index, drive) in drives.iter().enumerate() {
            let beginning = beginnings.get(2 * modes * index..2 * modes * (index + 1));
            let mut motion = DynamicsMotion::virgin(dynamics);
            motion.start::<S>(dynamics);
            if let Some(sensitivities) = &mut sensitivities {
                sensitivities.begin::<S>(dynamics, &motion);
            }
            if is_in_motion && !dynamics.begins_under_input {
                // One row counts as much as all that are compared.
                let weight = drive.rows().sqrt();
                for mode in 0..modes {
                    if let Some(sensitivities) = &mut sensitivities {
                        sensitivities.of_rest::<S>(dynamics, &motion, mode, weight, &mut row[..columns]);
                    }
                    row[columns] = weight * motion.force_on::<S>(dynamics, mode, 0.0);
                    self.rows.take(simd, &row);
                }
            }
            for k in 0..drive.x.len() {
                let steps = motion.begin_row::<S>(dynamics, drive.x[k], drive.steps[k]);
                for step in 1..=steps.count {
                    if pace.is_over(per_step) {
                        return None;
                    }
                    let input = motion.input_at(dynamics, step, steps);
                    if let Some(sensitivities) = &mut sensitivities {
                        sensitivities.remember(&motion);
                    }
                    motion.advance::<S>(dynamics, input, steps.length);
                    if let Some(sensitivities) = &mut sensitivities {
                        sensitivities.advance::<S>(dynamics, &motion);
                    }
                }
                if k == 0
                    && let Some((displacements, velocities)) = beginning.map(|both| both.split_at(modes))
                {
                    motion.displace::<S>(dynamics, displacements, velocities);
                    if let Some(sensitivities) = &mut sensitivities {
                        sensitivities.displace::<S>(dynamics, &motion, displacements, velocities);
                    }
                }
                let (target, weight) = (drive.targets[k], drive.weights[k]);
                if target.is_nan() {
                    continue;
                }
                if let Some(sensitivities) = &mut sensitivities {
                    sensitivities.of_output::<S>(dynamics, &motion, weight, &mut row[..columns]);
                }
                row[columns] = weight * (offset + motion.output::<S>(dynamics) - target);
                self.rows.take(simd, &row);
            }
        }
        self.rows.end(simd);
        (!stop.is_asked()).then_some(self.rows)
    }
}

/// Derivatives of the motion, carried forward along a record. A row has one number for each parameter, in whole groups.
struct MotionSensitivities<'l> {
    layout: &'l DynamicsLayout,
    width: usize,
    /// `∂q` of each mode, then `∂p`.
    modes: Vec<f64>,
    /// The same without the forces at the end of the step.
    alone: Vec<f64>,
    /// `∂r` of each element.
    forces: Vec<f64>,
    /// Forces without their own influence, then the new `∂r`.
    new_forces: Vec<f64>,
    elements: Vec<ElementSensitivities>,
    /// `∂δ` and `∂ν` at the end of the step.
    ends: Vec<f64>,
    slopes: Vec<PropagationSlopes>,
    step: f64,
    /// `(1 - ∂R/∂r)` and its inverse, row by row.
    matrix: Vec<f64>,
    inverse: Vec<f64>,
    of_output: Vec<f64>,
}

struct ElementSensitivities {
    /// At its point of the path: `∂δ`, `∂ν`, `∂z` of each stop, `∂s` of each state.
    point: Vec<f64>,
    /// Of the outputs of stops and of the states at the end of a step, without those of `δ` and `ν` there.
    memory: Vec<f64>,
    stops: StopSensitivities,
    of_states: Vec<Local>,
    of_force: Local,
    /// Where the step began.
    from: Option<PathPoint>,
    scratch: Scratch,
}

/// Derivatives of one number at the end of a step.
#[derive(Clone)]
struct Local {
    /// By `δ`, `ν`, stops and states at its beginning; empty for the force.
    by_start: Vec<f64>,
    /// By the stops at its end, and of the force by the states there too.
    by_memory: Vec<f64>,
    by_displacement: f64,
    by_velocity: f64,
}

/// Vectors of a sweep backwards.
struct Scratch {
    back: Vec<f64>,
    back_ahead: Vec<f64>,
    by_inputs: Vec<f64>,
    on_targets: Vec<f64>,
}

impl ElementSensitivities {
    fn new(shape: ElementShape, width: usize) -> Self {
        let memory = shape.stops + shape.states;
        let local = Local {
            by_start: vec![0.0; 2 + memory],
            by_memory: vec![0.0; memory],
            by_displacement: 0.0,
            by_velocity: 0.0,
        };
        Self {
            point: vec![0.0; (2 + memory) * width],
            memory: vec![0.0; memory * width],
            stops: StopSensitivities::new(shape, width),
            of_states: vec![local.clone(); shape.states],
            of_force: Local { by_start: Vec::new(), ..local },
            from: None,
            scratch: Scratch {
                back: vec![0.0; shape.neurons],
                back_ahead: vec![0.0; shape.neurons],
                by_inputs: vec![0.0; shape.inputs()],
                on_targets: vec![0.0; shape.states],
            },
        }
    }
}

impl<'l> MotionSensitivities<'l> {
    fn new(dynamics: &Dynamics, layout: &'l DynamicsLayout) -> Self {
        let width = layout.count().next_multiple_of(LANES);
        let (modes, elements) = (dynamics.modes.len(), dynamics.elements.len());
        let rows = |count: usize| vec![0.0; count * width];
        Self {
            layout,
            width,
            modes: rows(2 * modes),
            alone: rows(2 * modes),
            forces: rows(elements),
            new_forces: rows(elements),
            elements: (0..elements).map(|_| ElementSensitivities::new(layout.shape, width)).collect(),
            ends: rows(2 * elements),
            slopes: vec![PropagationSlopes::new(1.0, 1.0, 1.0); modes],
            step: f64::NAN,
            matrix: vec![0.0; elements * elements],
            inverse: vec![0.0; elements * elements],
            of_output: rows(1),
        }
    }

    /// Before the first sample of a record only initial states, and forces in them, depend on parameters.
    #[inline(always)]
    fn begin<S: Simd>(&mut self, dynamics: &Dynamics, motion: &DynamicsMotion) {
        let (width, shape) = (self.width, self.layout.shape);
        self.modes.fill(0.0);
        self.forces.fill(0.0);
        for (e, element) in self.elements.iter_mut().enumerate() {
            let layout = &self.layout.elements[e];
            element.point.fill(0.0);
            element.stops.begin();
            for (i, place) in layout.initial.clone().enumerate() {
                element.point[(2 + shape.stops + i) * width + place] = 1.0;
            }
        }
        self.forces_at_points::<S>(dynamics, motion);
    }

    /// After [`DynamicsMotion::displace`].
    #[inline(always)]
    fn displace<S: Simd>(
        &mut self,
        dynamics: &Dynamics,
        motion: &DynamicsMotion,
        displacements: &[f64],
        velocities: &[f64],
    ) {
        let (width, modes) = (self.width, dynamics.modes.len());
        for (row, place) in self.layout.beginning.clone().enumerate() {
            self.modes[row * width + place] += 1.0;
        }
        for (e, own) in self.elements.iter_mut().enumerate() {
            let (element, layout) = (&dynamics.elements[e], &self.layout.elements[e]);
            let (displacement, rest) = own.point.split_at_mut(width);
            let velocity = &mut rest[..width];
            for i in 0..modes {
                let (by_displacement, by_velocity) = (element.of_displacements[i], element.of_velocities[i]);
                if let Some(place) = layout.of_displacements.clone().nth(i) {
                    displacement[place] += displacements[i];
                    velocity[place] += velocities[i];
                }
                if let Some(place) = layout.of_velocities.clone().nth(i) {
                    displacement[place] += velocities[i];
                }
                if let Some(place) = self.layout.beginning.clone().nth(i) {
                    displacement[place] += by_displacement;
                    displacement[place + modes] += by_velocity;
                    velocity[place + modes] += by_displacement;
                }
            }
        }
        self.forces_at_points::<S>(dynamics, motion);
    }

    /// `∂r` where the elements are, from what describes their points.
    #[inline(always)]
    fn forces_at_points<S: Simd>(&mut self, dynamics: &Dynamics, motion: &DynamicsMotion) {
        let width = self.width;
        for (e, own) in self.elements.iter_mut().enumerate() {
            let force = &mut self.forces[e * width..(e + 1) * width];
            own.force::<S>(&dynamics.elements[e], &self.layout.elements[e], &motion.points[e], force);
            let Local { by_displacement, by_velocity, .. } = own.of_force;
            add_multiples::<S>(force, &[by_displacement, by_velocity], &own.point);
            add_multiples::<S>(force, &own.of_force.by_memory, &own.point[2 * width..]);
        }
    }

    #[inline(always)]
    fn remember(&mut self, motion: &DynamicsMotion) {
        for (element, point) in self.elements.iter_mut().zip(&motion.points) {
            match &mut element.from {
                Some(from) => from.copy_from(point),
                none => *none = Some(point.clone()),
            }
        }
    }

    /// To the end of the step that the motion has just made.
    #[inline(always)]
    fn advance<S: Simd>(&mut self, dynamics: &Dynamics, motion: &DynamicsMotion) {
        if motion.step != self.step {
            self.step = motion.step;
            for (slopes, mode) in self.slopes.iter_mut().zip(&dynamics.modes) {
                *slopes = PropagationSlopes::new(mode.frequency, mode.damping, self.step);
            }
        }
        self.modes_alone::<S>(dynamics, motion);
        self.displacements_alone::<S>(dynamics, motion);
        for e in 0..self.elements.len() {
            self.element::<S>(dynamics, motion, e);
        }
        self.solve::<S>(dynamics);
        self.finish::<S>(dynamics);
    }

    /// `∂q` and `∂p` at the end of the step with the forces there held.
    #[inline(always)]
    fn modes_alone<S: Simd>(&mut self, dynamics: &Dynamics, motion: &DynamicsMotion) {
        let (width, modes) = (self.width, dynamics.modes.len());
        let mut factors = [0.0; super::MOST_PARTS];
        for i in 0..modes {
            let (mode, slopes, layout) = (&dynamics.modes[i], &self.slopes[i], &self.layout.modes[i]);
            let state = [motion.displacements_before[i], motion.velocities_before[i]];
            let force = |input: f64, forces: &[f64]| {
                let of_elements = dynamics.elements.iter().zip(forces);
                mode.gain * input - of_elements.map(|(element, r)| element.compliances[i] * r).sum::<f64>()
            };
            let first = force(motion.input_before, &motion.forces_before);
            let last = force(motion.input, &motion.forces);
            let parts = [
                (
                    0,
                    slopes.of.displacement,
                    slopes.by_ln_frequency.displacement,
                    slopes.by_ln_damping.displacement,
                ),
                (modes, slopes.of.velocity, slopes.by_ln_frequency.velocity, slopes.by_ln_damping.velocity),
            ];
            for (offset, by, by_ln_frequency, by_ln_damping) in parts {
                let row = &mut self.alone[(offset + i) * width..][..width];
                row.fill(0.0);
                // (15.3), (15.4)
                let along = |[a, b, c, d]: [f64; 4]| a * state[0] + b * state[1] + c * first + d * last;
                row[layout.ln_frequency] = along(by_ln_frequency);
                row[layout.ln_damping] = along(by_ln_damping);
                row[layout.gain] = by[2] * motion.input_before + by[3] * motion.input;
                for (e, element) in self.layout.elements.iter().enumerate() {
                    if let Some(place) = element.compliances.clone().nth(i) {
                        row[place] = -by[2] * motion.forces_before[e] - by[3] * motion.forces[e];
                    }
                    factors[e] = -by[2] * dynamics.elements[e].compliances[i];
                }
                let [q, p] = [i, modes + i].map(|k| &self.modes[k * width..][..width]);
                add_two::<S>(row, [by[0], by[1]], [q, p]);
                add_multiples::<S>(row, &factors[..self.elements.len()], &self.forces);
            }
        }
    }

    /// `∂δ` and `∂ν` at the end of the step, from those modes.
    #[inline(always)]
    fn displacements_alone<S: Simd>(&mut self, dynamics: &Dynamics, motion: &DynamicsMotion) {
        let (width, modes) = (self.width, dynamics.modes.len());
        for (e, element) in dynamics.elements.iter().enumerate() {
            let layout = &self.layout.elements[e];
            let (displacement, velocity) = self.ends[2 * e * width..][..2 * width].split_at_mut(width);
            displacement.fill(0.0);
            velocity.fill(0.0);
            for (i, place) in layout.of_displacements.clone().enumerate() {
                displacement[place] = motion.displacements[i];
                velocity[place] = motion.velocities[i];
            }
            for (i, place) in layout.of_velocities.clone().enumerate() {
                displacement[place] = motion.velocities[i];
            }
            if let Some(place) = layout.of_input.clone().next() {
                displacement[place] = motion.input;
            }
            let (q, p) = self.alone.split_at(modes * width);
            add_multiples::<S>(displacement, &element.of_displacements, q);
            add_multiples::<S>(displacement, &element.of_velocities, p);
            add_multiples::<S>(velocity, &element.of_displacements, p);
        }
    }

    /// States and force of an element without `∂δ` and `∂ν` at the end of the step, and their derivatives by these.
    #[inline(always)]
    fn element<S: Simd>(&mut self, dynamics: &Dynamics, motion: &DynamicsMotion, e: usize) {
        let (width, shape) = (self.width, self.layout.shape);
        let (element, layout) = (&dynamics.elements[e], &self.layout.elements[e]);
        let step = &motion.path_steps[e];
        let own = &mut self.elements[e];
        let from = own.from.as_ref().expect("the beginning of a step is remembered");
        let ends = ElementEnds { element, layout, shape, from, step };
        let (outputs, states) = own.memory.split_at_mut(shape.stops * width);
        own.stops.take::<S>(ends, &own.point, outputs);
        for (k, local) in own.of_states.iter_mut().enumerate() {
            let row = &mut states[k * width..(k + 1) * width];
            ends.of_state::<S>(k, &mut own.scratch, local, row);
            local.through_stops(&own.stops.outputs);
            add_multiples::<S>(row, &local.by_start, &own.point);
            add_multiples::<S>(row, &local.by_memory[..shape.stops], outputs);
        }
        let row = &mut self.new_forces[e * width..(e + 1) * width];
        own.force::<S>(element, layout, &step.end, row);
        own.of_force.through_stops(&own.stops.outputs);
        for (local, by) in own.of_states.iter().zip(&own.of_force.by_memory[shape.stops..]) {
            own.of_force.by_displacement += by * local.by_displacement;
            own.of_force.by_velocity += by * local.by_velocity;
        }
        add_multiples::<S>(row, &own.of_force.by_memory, &own.memory);
        let ends = [2 * e, 2 * e + 1].map(|k| &self.ends[k * width..][..width]);
        add_two::<S>(row, [own.of_force.by_displacement, own.of_force.by_velocity], ends);
    }

    /// `∂δ/∂r` and `∂ν/∂r` at the end of a step: of element `e` by the force of element `f`.
    fn influence(&self, dynamics: &Dynamics, e: usize, f: usize) -> (f64, f64) {
        let (of, by) = (&dynamics.elements[e], &dynamics.elements[f]);
        let (mut displacement, mut velocity) = (0.0, 0.0);
        for (i, slopes) in self.slopes.iter().enumerate() {
            let (alpha, beta) = (slopes.of.displacement[3], slopes.of.velocity[3]);
            displacement -= (of.of_displacements[i] * alpha + of.of_velocities[i] * beta) * by.compliances[i];
            velocity -= of.of_displacements[i] * beta * by.compliances[i];
        }
        (displacement, velocity)
    }

    /// `∂r` from `(1 - ∂R/∂r) ∂r = ∂R`.
    #[inline(always)]
    fn solve<S: Simd>(&mut self, dynamics: &Dynamics) {
        let (width, count) = (self.width, self.elements.len());
        for e in 0..count {
            for f in 0..count {
                let (displacement, velocity) = self.influence(dynamics, e, f);
                let Local { by_displacement, by_velocity, .. } = self.elements[e].of_force;
                let own = by_displacement * displacement + by_velocity * velocity;
                self.matrix[e * count + f] = if e == f { 1.0 } else { 0.0 } - own; // (15.13): 1 - ∂R/∂r
            }
        }
        invert(&mut self.matrix, &mut self.inverse, count);
        for e in 0..count {
            let row = &mut self.forces[e * width..(e + 1) * width];
            row.fill(0.0);
            // (15.13)
            add_multiples::<S>(row, &self.inverse[e * count..(e + 1) * count], &self.new_forces);
        }
    }

    /// Everything else at the end of the step, from `∂r` there.
    #[inline(always)]
    fn finish<S: Simd>(&mut self, dynamics: &Dynamics) {
        let (width, modes) = (self.width, dynamics.modes.len());
        let count = self.elements.len();
        let mut factors = [0.0; super::MOST_PARTS];
        for e in 0..count {
            let (mut of_displacement, mut of_velocity) = ([0.0; super::MOST_PARTS], [0.0; super::MOST_PARTS]);
            for f in 0..count {
                (of_displacement[f], of_velocity[f]) = self.influence(dynamics, e, f);
            }
            let (displacement, velocity) = self.ends[2 * e * width..][..2 * width].split_at_mut(width);
            add_multiples::<S>(displacement, &of_displacement[..count], &self.forces);
            add_multiples::<S>(velocity, &of_velocity[..count], &self.forces);
            self.elements[e].end::<S>(displacement, velocity);
        }
        std::mem::swap(&mut self.modes, &mut self.alone);
        for i in 0..modes {
            for (offset, weight) in
                [(0, self.slopes[i].of.displacement[3]), (modes, self.slopes[i].of.velocity[3])]
            {
                for (factor, element) in factors.iter_mut().zip(&dynamics.elements) {
                    *factor = -weight * element.compliances[i];
                }
                let row = &mut self.modes[(offset + i) * width..][..width];
                add_multiples::<S>(row, &factors[..count], &self.forces);
            }
        }
    }

    /// The derivative of [`DynamicsMotion::force_on`] a mode, weighted.
    #[inline(always)]
    fn of_rest<S: Simd>(
        &mut self,
        dynamics: &Dynamics,
        motion: &DynamicsMotion,
        mode: usize,
        weight: f64,
        jacobian: &mut [f64],
    ) {
        let row = &mut self.of_output;
        row.fill(0.0);
        for (e, element) in dynamics.elements.iter().enumerate() {
            if let Some(place) = self.layout.elements[e].compliances.clone().nth(mode) {
                row[place] -= motion.forces[e];
            }
            add_multiple::<S>(row, -element.compliances[mode], &self.forces[e * self.width..][..self.width]);
        }
        for (to, value) in jacobian.iter_mut().zip(row) {
            *to = weight * *value;
        }
    }

    /// The derivative of the output, weighted.
    #[inline(always)]
    fn of_output<S: Simd>(
        &mut self,
        dynamics: &Dynamics,
        motion: &DynamicsMotion,
        weight: f64,
        jacobian: &mut [f64],
    ) {
        let (width, modes) = (self.width, dynamics.modes.len());
        let row = &mut self.of_output;
        row.fill(0.0);
        row[OFFSET] = 1.0;
        row[DIRECT] = motion.newest_input();
        let (q, p) = self.modes.split_at(modes * width);
        for (i, mode) in dynamics.modes.iter().enumerate() {
            if let Some(place) = self.layout.modes[i].velocity_in_output.clone().next() {
                row[place] = motion.velocities[i];
            }
            let motion = [q, p].map(|rows| &rows[i * width..][..width]);
            add_two::<S>(row, [1.0, mode.velocity_in_output], motion);
        }
        for (e, element) in dynamics.elements.iter().enumerate() {
            if let Some(place) = self.layout.elements[e].in_output.clone().next() {
                row[place] = motion.forces[e];
            }
            add_multiple::<S>(row, element.in_output, &self.forces[e * width..][..width]);
        }
        for (to, value) in jacobian.iter_mut().zip(row) {
            *to = weight * *value;
        }
    }
}

impl ElementSensitivities {
    /// Of the force at a point of the path: by `δ`, `ν` and memory there, and in `row` by its own parameters.
    #[inline(always)]
    fn force<S: Simd>(
        &mut self,
        element: &Element,
        layout: &ElementLayout,
        point: &PathPoint,
        row: &mut [f64],
    ) {
        let Scratch { back, by_inputs, .. } = &mut self.scratch;
        let first_free = element.shape().first_free_input();
        let memory = point.inputs.len() - 3;
        let (of_memory, of_neurons) = element.force.split_at(memory);
        for ((back, weight), phi) in back.iter_mut().zip(of_neurons).zip(&point.neurons) {
            *back = weight * (1.0 - phi * phi);
        }
        through_layer::<S>(element, back, by_inputs);
        let local = &mut self.of_force;
        (local.by_displacement, local.by_velocity) = (by_inputs[1], by_inputs[2]);
        for ((by, own), through) in local.by_memory.iter_mut().zip(of_memory).zip(&by_inputs[3..]) {
            *by = own + through;
        }
        row.fill(0.0);
        let (own_memory, own_neurons) = row[layout.force.clone()].split_at_mut(memory);
        own_memory.copy_from_slice(&point.inputs[3..]);
        own_neurons.copy_from_slice(&point.neurons);
        add_of_layer(&point.inputs[first_free..], back, &mut row[layout.layer.clone()]);
    }

    /// To the end of the step, from `∂δ` and `∂ν` there.
    #[inline(always)]
    fn end<S: Simd>(&mut self, displacement: &[f64], velocity: &[f64]) {
        let width = displacement.len();
        let (ends, memory) = self.point.split_at_mut(2 * width);
        self.stops.end::<S>(displacement, velocity);
        memory.copy_from_slice(&self.memory);
        let (outputs, states) = memory.split_at_mut(self.stops.outputs.len() * width);
        add_by_end::<S>(outputs, &self.stops.outputs, displacement, velocity);
        for (row, local) in states.chunks_exact_mut(width).zip(&self.of_states) {
            add_by_end::<S>(row, &[[local.by_displacement, local.by_velocity]], displacement, velocity);
        }
        ends[..width].copy_from_slice(displacement);
        ends[width..].copy_from_slice(velocity);
    }
}

impl Local {
    /// Adds what depends on `δ` and `ν` at the end of a step through the stops there.
    #[inline(always)]
    fn through_stops(&mut self, outputs: &[[f64; 2]]) {
        for (by, [of_displacement, of_velocity]) in self.by_memory.iter().zip(outputs) {
            self.by_displacement += by * of_displacement;
            self.by_velocity += by * of_velocity;
        }
    }
}

/// A step of an element and its ends.
#[derive(Clone, Copy)]
pub(super) struct ElementEnds<'a> {
    element: &'a Element,
    layout: &'a ElementLayout,
    shape: ElementShape,
    from: &'a PathPoint,
    step: &'a PathStep,
}

impl ElementEnds<'_> {
    /// Derivatives of state `k` at the end of the step by its ends, and in `row` by the parameters of the element.
    #[inline(always)]
    fn of_state<S: Simd>(&self, k: usize, scratch: &mut Scratch, local: &mut Local, row: &mut [f64]) {
        let Self { element, layout, shape, from, step } = *self;
        let Scratch { back, back_ahead, by_inputs, on_targets } = scratch;
        let (neurons, first_state, first_free) =
            (shape.neurons, shape.first_state(), shape.first_free_input());
        let rows = step.targets_of(element);
        let of_targets = if step.moved < 0.0 { layout.falling.start } else { layout.rising.start };
        let last = step.weights[k].last;
        local.by_start.fill(0.0);
        local.by_memory.fill(0.0);
        row.fill(0.0);

        // T_1, taken with the states ahead.
        for ((back, weight), phi) in back_ahead.iter_mut().zip(&rows[k * neurons..]).zip(&step.neurons_ahead)
        {
            *back = last * weight * (1.0 - phi * phi);
        }
        through_layer::<S>(element, back_ahead, by_inputs);
        for (to, phi) in row[of_targets + k * neurons..].iter_mut().zip(&step.neurons_ahead) {
            *to += last * phi;
        }
        add_of_layer(&step.inputs_ahead[first_free..], back_ahead, &mut row[layout.layer.clone()]);
        (local.by_displacement, local.by_velocity) = (by_inputs[1], by_inputs[2]);
        local.by_memory[..shape.stops].copy_from_slice(&by_inputs[3..first_state]);

        // The states ahead, and the weights of the targets, follow from the travel.
        let mut by_path = 0.0;
        for (j, weights) in step.weights.iter().enumerate() {
            let (before, ahead) = (from.inputs[first_state + j], by_inputs[first_state + j]);
            let mut by_travel = weights.kept * (step.targets[j] - before) * ahead;
            local.by_start[2 + shape.stops + j] = weights.kept * ahead;
            on_targets[j] = (1.0 - weights.kept) * ahead;
            if j == k {
                let (of_first, of_last) = weights.slopes();
                by_travel +=
                    of_first * step.targets[k] + of_last * step.targets_ahead[k] - weights.kept * before;
                local.by_start[2 + shape.stops + j] += weights.kept;
                on_targets[j] += weights.first;
            }
            row[layout.ln_path_leaks.start + j] = by_travel * weights.travel;
            by_path += by_travel * element.path_leaks[j];
        }
        let by_moved = if step.moved < 0.0 { -by_path } else { by_path };
        local.by_displacement += by_moved;
        local.by_start[0] -= by_moved;

        // T_0, taken at the beginning.
        back.fill(0.0);
        for (j, on_target) in on_targets.iter().enumerate() {
            let own = rows[j * neurons..].iter().zip(&from.neurons);
            let places = row[of_targets + j * neurons..].iter_mut();
            for ((back, to), (weight, phi)) in back.iter_mut().zip(places).zip(own) {
                *back += on_target * weight * (1.0 - phi * phi);
                *to += on_target * phi;
            }
        }
        through_layer::<S>(element, back, by_inputs);
        for (by, through) in local.by_start.iter_mut().zip(&by_inputs[1..]) {
            *by += through;
        }
        add_of_layer(&from.inputs[first_free..], back, &mut row[layout.layer.clone()]);
    }
}

/// Derivatives by the inputs of the layer, from those by the arguments of its neurons.
#[inline(always)]
fn through_layer<S: Simd>(element: &Element, back: &[f64], by_inputs: &mut [f64]) {
    for (by, column) in by_inputs.iter_mut().zip(element.layer.chunks_exact(back.len())) {
        *by = product::<S>(back, column);
    }
}

/// Adds the derivatives by the weights of the layer, from those by the arguments of its neurons.
#[inline(always)]
fn add_of_layer(inputs: &[f64], back: &[f64], row: &mut [f64]) {
    for (row, input) in row.chunks_exact_mut(back.len()).zip(inputs) {
        for (to, back) in row.iter_mut().zip(back) {
            *to += input * back;
        }
    }
}

/// The inverse of a matrix of few rows by elimination, with pivots that are not small.
fn invert(matrix: &mut [f64], inverse: &mut [f64], count: usize) {
    inverse.fill(0.0);
    (0..count).for_each(|i| inverse[i * count + i] = 1.0);
    for i in 0..count {
        let pivot = matrix[i * count + i];
        let pivot = if pivot.abs() < LEAST_PIVOT { LEAST_PIVOT.copysign(pivot) } else { pivot };
        for k in 0..count {
            matrix[i * count + k] /= pivot;
            inverse[i * count + k] /= pivot;
        }
        for j in (0..count).filter(|j| *j != i) {
            let factor = matrix[j * count + i];
            for k in 0..count {
                matrix[j * count + k] -= factor * matrix[i * count + k];
                inverse[j * count + k] -= factor * inverse[i * count + k];
            }
        }
    }
}

//! A free run: trial steps of modes and elements until the forces at the end of a step fit the displacements there,
//! and what is committed then.

use pulp::Simd;

use super::element::{PathPoint, PathStep};
use super::hold::{Hold, RecentSamples};
use super::propagation::Propagation;
use super::{Dynamics, STATIC_STEPS};
use crate::simd::multiply_add;

/// Trials of a step at most.
const MOST_TRIALS: usize = 40;

/// Trials after which the force of a single element is enclosed, because the secant has not found it.
const TRIALS_IN_HASTE: usize = 6;

/// Difference of two trials, relative to the largest force, below which rounding hides the slope.
const LEAST_DIFFERENCE: f64 = 1e-9;

/// Bounds of the slope `∂R/∂r` that is used: at 1 the force would not be determined.
const LARGEST_SLOPE: f64 = 1e3;
const STEEPEST_SLOPE: f64 = 0.9;

/// Mismatch of a force that is neglected, relative to its size.
const TOLERANCE: f64 = 1e-12;

/// The state of modes and elements, with the intermediate results of the last step.
#[derive(Debug, Clone, PartialEq)]
pub struct DynamicsMotion {
    /// Displacement `q` and velocity `p` of each mode.
    pub(super) displacements: Vec<f64>,
    pub(super) velocities: Vec<f64>,
    /// The same before the last step.
    pub(super) displacements_before: Vec<f64>,
    pub(super) velocities_before: Vec<f64>,
    /// Displacements and velocities of the modes after a step without the forces at its end.
    displacements_alone: Vec<f64>,
    velocities_alone: Vec<f64>,
    pub(super) points: Vec<PathPoint>,
    pub(super) path_steps: Vec<PathStep>,
    /// Forces of the elements at the beginning and at the end of the last step, as they act on the modes.
    pub(super) forces_before: Vec<f64>,
    pub(super) forces: Vec<f64>,
    /// Bounds of the forces.
    largest: Vec<f64>,
    /// `∂R/∂r` of each element, from the newest trials that showed it.
    slopes: Vec<f64>,
    /// The last force that was assumed, and the one that followed.
    tried: Vec<(f64, f64)>,
    /// Scaled input at the beginning and at the end of the last step.
    pub(super) input_before: f64,
    pub(super) input: f64,
    pub(super) recent: RecentSamples,
    /// Displacements and then velocities of the modes at the first sample, beside those at rest; empty from rest, and once it
    /// is taken.
    pub(super) beginning: Vec<f64>,
    /// Length of the steps that `propagations` are of.
    pub(super) step: f64,
    propagations: Vec<Propagation>,
    has_begun: bool,
}

/// The equal steps of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RowSteps {
    pub count: usize,
    /// In the unit of time; infinite for a quasi-static change.
    pub length: f64,
}

impl DynamicsMotion {
    pub(super) fn virgin(dynamics: &Dynamics) -> Self {
        let (modes, elements) = (dynamics.modes.len(), &dynamics.elements);
        let points: Vec<PathPoint> = elements.iter().map(PathPoint::virgin).collect();
        Self {
            displacements: vec![0.0; modes],
            velocities: vec![0.0; modes],
            displacements_before: vec![0.0; modes],
            velocities_before: vec![0.0; modes],
            displacements_alone: vec![0.0; modes],
            velocities_alone: vec![0.0; modes],
            path_steps: elements.iter().map(PathStep::new).collect(),
            forces_before: vec![0.0; elements.len()],
            forces: vec![0.0; elements.len()],
            largest: elements.iter().map(|element| element.bounds().0).collect(),
            slopes: vec![0.0; elements.len()],
            tried: vec![(0.0, 0.0); elements.len()],
            points,
            input_before: 0.0,
            input: 0.0,
            recent: RecentSamples::default(),
            beginning: Vec::new(),
            step: f64::NAN,
            propagations: vec![Propagation::new(1.0, 1.0, 0.0); modes],
            has_begun: false,
        }
    }

    /// The forces of the elements where they are, such as those of virgin elements before the first sample.
    #[inline(always)]
    pub(super) fn start<S: Simd>(&mut self, dynamics: &Dynamics) {
        for (e, (point, element)) in self.points.iter_mut().zip(&dynamics.elements).enumerate() {
            point.finish::<S>(element);
            (self.forces[e], self.forces_before[e]) = (point.force, point.force);
        }
    }

    /// Moves the modes by displacements and velocities, as at the beginning of a record in mid-motion.
    #[inline(always)]
    pub(super) fn displace<S: Simd>(
        &mut self,
        dynamics: &Dynamics,
        displacements: &[f64],
        velocities: &[f64],
    ) {
        for i in 0..dynamics.modes.len() {
            self.displacements[i] += displacements[i];
            self.velocities[i] += velocities[i];
        }
        for (point, element) in self.points.iter_mut().zip(&dynamics.elements) {
            for (i, (q, p)) in displacements.iter().zip(velocities).enumerate() {
                point.inputs[1] += element.of_displacements[i] * q + element.of_velocities[i] * p;
                point.inputs[2] += element.of_displacements[i] * p;
            }
        }
        self.start::<S>(dynamics);
    }

    /// Takes the next sample of the input, and returns into which steps its row is divided.
    #[inline(always)]
    pub(super) fn begin_row<S: Simd>(&mut self, dynamics: &Dynamics, x: f64, row: f64) -> RowSteps {
        let u = dynamics.scaled(x);
        let is_first = !self.has_begun;
        if is_first {
            self.has_begun = true;
            self.start::<S>(dynamics);
        }
        let is_static = row == f64::INFINITY || is_first && dynamics.begins_under_input;
        if is_static {
            self.recent.add(u, f64::INFINITY);
            return RowSteps { count: STATIC_STEPS, length: f64::INFINITY };
        }
        // Before the first sample the motion is at rest, and while no time passes nothing moves.
        if is_first || row.is_nan() || row <= 0.0 {
            if is_first {
                self.recent = RecentSamples::at_rest(u);
            } else {
                self.recent.values[0] = u;
            }
            self.input = u;
            return RowSteps { count: 0, length: 0.0 };
        }
        self.recent.add(u, row);
        if dynamics.hold == Hold::Constant {
            self.input = self.recent.values[1];
        }
        let count = dynamics.steps_of(row);
        RowSteps { count, length: row / count as f64 }
    }

    #[inline(always)]
    pub(super) fn input_at(&self, dynamics: &Dynamics, step: usize, steps: RowSteps) -> f64 {
        let hold = if steps.length == f64::INFINITY { Hold::Linear } else { dynamics.hold };
        hold.at(step as f64 / steps.count as f64, &self.recent)
    }

    #[inline(always)]
    pub(super) fn row<S: Simd>(&mut self, dynamics: &Dynamics, x: f64, row: f64) {
        let steps = self.begin_row::<S>(dynamics, x, row);
        for k in 1..=steps.count {
            let input = self.input_at(dynamics, k, steps);
            self.advance::<S>(dynamics, input, steps.length);
        }
        if !self.beginning.is_empty() {
            let beginning = std::mem::take(&mut self.beginning);
            let (displacements, velocities) = beginning.split_at(dynamics.modes.len());
            self.displace::<S>(dynamics, displacements, velocities);
        }
    }

    #[inline(always)]
    pub(super) fn newest_input(&self) -> f64 {
        self.recent.values[0]
    }

    #[inline(always)]
    pub(super) fn output<S: Simd>(&self, dynamics: &Dynamics) -> f64 {
        // (15.5), without y_0 and σ
        let mut y = dynamics.direct * self.newest_input();
        for (i, mode) in dynamics.modes.iter().enumerate() {
            y += multiply_add::<S>(mode.velocity_in_output, self.velocities[i], self.displacements[i]);
        }
        for (element, force) in dynamics.elements.iter().zip(&self.forces) {
            y = multiply_add::<S>(element.in_output, *force, y);
        }
        y
    }

    /// Another force on a mode and that of the elements, as the displacement that they would hold at rest.
    #[inline(always)]
    pub(super) fn force_on<S: Simd>(&self, dynamics: &Dynamics, mode: usize, other: f64) -> f64 {
        let mut force = other;
        for (element, r) in dynamics.elements.iter().zip(&self.forces) {
            force = multiply_add::<S>(-element.compliances[mode], *r, force); // (15.1): f_i
        }
        force
    }

    #[inline(always)]
    pub(super) fn advance<S: Simd>(&mut self, dynamics: &Dynamics, input: f64, step: f64) {
        if step != self.step {
            self.step = step;
            for (propagation, mode) in self.propagations.iter_mut().zip(&dynamics.modes) {
                *propagation = Propagation::new(mode.frequency, mode.damping, step);
            }
        }
        (self.input_before, self.input) = (self.input, input);
        self.move_alone::<S>(dynamics);
        self.find_forces::<S>(dynamics);
        for (point, step) in self.points.iter_mut().zip(&self.path_steps) {
            point.copy_from(&step.end);
        }
    }

    /// The modes without the forces at the end of the step.
    #[inline(always)]
    fn move_alone<S: Simd>(&mut self, dynamics: &Dynamics) {
        self.displacements_before.copy_from_slice(&self.displacements);
        self.velocities_before.copy_from_slice(&self.velocities);
        for (i, (mode, by)) in dynamics.modes.iter().zip(&self.propagations).enumerate() {
            let (q, p) = (self.displacements[i], self.velocities[i]);
            let force = self.force_on::<S>(dynamics, i, mode.gain * self.input_before);
            let ahead = mode.gain * self.input;
            self.displacements_alone[i] = sum::<S>(by.displacement, [q, p, force, ahead]); // (15.3)
            self.velocities_alone[i] = sum::<S>(by.velocity, [q, p, force, ahead]); // (15.4)
        }
    }

    /// The modes under the forces at the end of the step.
    #[inline(always)]
    fn move_modes<S: Simd>(&mut self, dynamics: &Dynamics) {
        for (i, by) in self.propagations.iter().enumerate() {
            let force = self.force_on::<S>(dynamics, i, 0.0);
            // (15.3): α_1 f_1
            self.displacements[i] = multiply_add::<S>(by.displacement[3], force, self.displacements_alone[i]);
            // (15.4): β_1 f_1
            self.velocities[i] = multiply_add::<S>(by.velocity[3], force, self.velocities_alone[i]);
        }
    }

    /// Tries the step of an element to where the modes are.
    #[inline(always)]
    fn try_step<S: Simd>(&mut self, dynamics: &Dynamics, index: usize) {
        let element = &dynamics.elements[index];
        // (15.2)
        let (mut displacement, mut velocity) = (element.of_input * self.input, 0.0);
        for (i, (q, p)) in self.displacements.iter().zip(&self.velocities).enumerate() {
            displacement = multiply_add::<S>(element.of_displacements[i], *q, displacement);
            displacement = multiply_add::<S>(element.of_velocities[i], *p, displacement);
            velocity = multiply_add::<S>(element.of_displacements[i], *p, velocity);
        }
        self.path_steps[index].take::<S>(element, &self.points[index], displacement, velocity);
    }

    /// Finds forces `r` with `R(r) = r`, where `R` follows from the displacements under `r` (theory.md (15.11)).
    ///
    /// Each force is moved by its mismatch over `1 - ∂R/∂r`, with the slope between the last two trials. A single
    /// force is enclosed as well, because `R(r) - r` changes its sign between its bounds.
    #[inline(always)]
    fn find_forces<S: Simd>(&mut self, dynamics: &Dynamics) {
        let count = dynamics.elements.len();
        for e in 0..count {
            let (before, here) = (self.forces_before[e], self.forces[e]);
            self.forces_before[e] = here;
            self.forces[e] = (2.0 * here - before).clamp(-self.largest[e], self.largest[e]);
        }
        let mut enclosed = (count == 1).then(|| (-self.largest[0], self.largest[0]));
        for trial in 1..=MOST_TRIALS {
            self.move_modes::<S>(dynamics);
            for e in 0..count {
                self.try_step::<S>(dynamics, e);
            }
            let is_found = |e: usize| self.mismatch(e).abs() <= TOLERANCE * self.largest[e];
            if trial == MOST_TRIALS || (0..count).all(is_found) {
                return;
            }
            for e in 0..count {
                self.forces[e] = self.next_force(e, trial > 1);
            }
            if let Some(enclosed) = &mut enclosed {
                self.forces[0] = self.within(enclosed, trial);
            }
        }
    }

    /// The force of a single element to assume next, within what encloses it after the last trial.
    #[inline(always)]
    fn within(&self, enclosed: &mut (f64, f64), trial: usize) -> f64 {
        let ((assumed, follows), next) = (self.tried[0], self.forces[0]);
        if follows - assumed > 0.0 {
            enclosed.0 = assumed;
        } else {
            enclosed.1 = assumed;
        }
        let is_inside = next > enclosed.0 && next < enclosed.1;
        let is_in_haste = trial <= TRIALS_IN_HASTE || trial % 2 == 1;
        if is_inside && is_in_haste { next } else { 0.5 * (enclosed.0 + enclosed.1) }
    }

    /// Difference of the force that follows from the one that is assumed.
    #[inline(always)]
    fn mismatch(&self, e: usize) -> f64 {
        self.path_steps[e].end.force - self.forces[e]
    }

    /// The force to assume next.
    #[inline(always)]
    fn next_force(&mut self, e: usize, was_tried: bool) -> f64 {
        let (assumed, follows, largest) = (self.forces[e], self.path_steps[e].end.force, self.largest[e]);
        let (assumed_before, followed_before) = self.tried[e];
        let by = assumed - assumed_before;
        if was_tried && by.abs() > LEAST_DIFFERENCE * largest {
            self.slopes[e] = ((follows - followed_before) / by).clamp(-LARGEST_SLOPE, STEEPEST_SLOPE);
        }
        self.tried[e] = (assumed, follows);
        (assumed + (follows - assumed) / (1.0 - self.slopes[e])).clamp(-largest, largest)
    }
}

/// Scalar product of four factors.
#[inline(always)]
fn sum<S: Simd>([a, b, c, d]: [f64; 4], [q, p, first, last]: [f64; 4]) -> f64 {
    multiply_add::<S>(a, q, multiply_add::<S>(b, p, multiply_add::<S>(c, first, d * last)))
}

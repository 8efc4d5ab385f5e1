//! One start of a search on its way: Levenberg-Marquardt within a box, theory.md (8.3).

use rayon::prelude::*;

use crate::linear_algebra::{Symmetric, dot};
use crate::stop_check::StopCheck;
use crate::termination::Termination;

use super::projection::Projection;
use super::{Family, Objective};

/// Step of a finite difference in `u`.
const DIFFERENCE: f64 = 1e-5;
const FIRST_DAMPING: f64 = 1e-2;
const SMALLEST_DAMPING: f64 = 1e-10;
/// Damping at which the walk gives up.
const LARGEST_DAMPING: f64 = 1e10;
/// Smallest curvature assumed, as a share of the largest of all directions: a direction without slope
/// is not run along.
const LEAST_CURVATURE: f64 = 1e-6;
/// Relative fall of the squared residual that counts as none.
const STALL: f64 = 1e-5;
/// Iterations in a row without a noticeable fall that end the walk.
const PATIENCE: usize = 3;

/// Where a start is.
#[derive(Debug, Clone)]
pub(crate) struct Descent {
    pub u: Vec<f64>,
    pub value: Projection,
    pub evaluations: usize,
    pub ended: Option<Termination>,
    damping: f64,
    growth: f64,
    stalled: usize,
}

impl Descent {
    pub fn new(u: Vec<f64>, value: Projection) -> Self {
        Self { u, value, evaluations: 0, ended: None, damping: FIRST_DAMPING, growth: 2.0, stalled: 0 }
    }

    /// One iteration, which lowers the residual unless there is no way on.
    pub fn advance<F: Family>(&mut self, objective: &Objective<'_, F>) {
        if self.ended.is_some() {
            return;
        }
        if self.u.is_empty() {
            self.ended = Some(Termination::Converged);
            return;
        }
        let jacobian = self.jacobian(objective);
        self.evaluations += jacobian.len();
        if objective.stop.is_asked() {
            return;
        }
        let gradient: Vec<f64> = jacobian.iter().map(|column| dot(column, &self.value.residual)).collect();
        let matrix = Symmetric::from_fn(jacobian.len(), |i, j| dot(&jacobian[i], &jacobian[j]));
        let largest = (0..gradient.len()).map(|i| matrix.diagonal(i)).fold(0.0, f64::max);
        if largest == 0.0 {
            self.ended = Some(Termination::GradientVanished);
            return;
        }
        let floor = LEAST_CURVATURE * largest;
        while self.damping < LARGEST_DAMPING && !objective.stop.is_asked() {
            if let Some((u, foretold)) = self.candidate(&matrix, &gradient, floor) {
                let value = objective.value(&u);
                self.evaluations += 1;
                let fall = self.value.square_residual - value.square_residual;
                if fall > 0.0 {
                    // Nielsen's rule.
                    let quality = if foretold > 0.0 { (fall / foretold).min(2.0) } else { 0.5 };
                    self.damping *= (1.0 - (2.0 * quality - 1.0).powi(3)).max(1.0 / 3.0);
                    self.damping = self.damping.max(SMALLEST_DAMPING);
                    self.growth = 2.0;
                    let noticed = fall > STALL * self.value.square_residual;
                    self.stalled = if noticed { 0 } else { self.stalled + 1 };
                    (self.u, self.value) = (u, value);
                    self.ended = (self.stalled == PATIENCE).then_some(Termination::Converged);
                    return;
                }
            }
            self.damping *= self.growth;
            self.growth *= 2.0;
        }
        self.ended = Some(Termination::NoFurtherImprovement);
    }

    /// Derivatives of the residual by each `u_j`, inwards where `u_j` is near its bound.
    fn jacobian<F: Family>(&self, objective: &Objective<'_, F>) -> Vec<Vec<f64>> {
        (0..self.u.len())
            .into_par_iter()
            .map(|j| {
                let by = if self.u[j] + DIFFERENCE > 1.0 { -DIFFERENCE } else { DIFFERENCE };
                let mut u = self.u.clone();
                u[j] += by;
                let mut column = objective.value(&u).residual;
                for (there, here) in column.iter_mut().zip(&self.value.residual) {
                    *there = (*there - here) / by;
                }
                column
            })
            .collect()
    }

    /// The damped step, kept in the box, and the fall of the squared residual that it foretells. What
    /// stands at its bound and would leave stays there, and the others step without it.
    fn candidate(&self, matrix: &Symmetric, gradient: &[f64], floor: f64) -> Option<(Vec<f64>, f64)> {
        let mut moving: Vec<usize> = (0..gradient.len()).collect();
        loop {
            let scale = |i: usize| matrix.diagonal(i).max(floor);
            let damped = Symmetric::from_fn(moving.len(), |a, b| {
                let (i, j) = (moving[a], moving[b]);
                matrix.at(i, j) + if i == j { self.damping * scale(i) } else { 0.0 }
            });
            let mut step: Vec<f64> = moving.iter().map(|&i| -gradient[i]).collect();
            damped.cholesky(StopCheck::never())?.solve(&mut step);
            let leaves = |i: usize, by: f64| self.u[i] <= 0.0 && by < 0.0 || self.u[i] >= 1.0 && by > 0.0;
            let staying: Vec<usize> =
                moving.iter().zip(&step).filter(|(i, by)| !leaves(**i, **by)).map(|(i, _)| *i).collect();
            if staying.is_empty() {
                return None;
            }
            if staying.len() < moving.len() {
                moving = staying;
                continue;
            }
            let foretold = moving
                .iter()
                .zip(&step)
                .map(|(&i, by)| by * (self.damping * scale(i) * by - gradient[i]))
                .sum();
            let mut u = self.u.clone();
            for (&i, by) in moving.iter().zip(&step) {
                u[i] = (u[i] + by).clamp(0.0, 1.0);
            }
            return Some((u, foretold));
        }
    }
}

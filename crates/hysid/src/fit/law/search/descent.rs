//! One start of a search: Levenberg-Marquardt within bounds, `(JᵀJ + μ D) du = -Jᵀ r` (theory.md (8.3)).

use std::cmp::Ordering;

use crate::linear_algebra::Symmetric;
use crate::optimise::levenberg_marquardt::{
    DescentSettings, LeastSquaresProblem, LevenbergMarquardt, Slope, step_within,
};
use crate::optimise::multi_start::SearchStart;
use crate::optimise::parallel;
use crate::stop_check::StopCheck;
use crate::termination::Termination;

use super::projection::Projection;
use super::{LawObjective, SIDE_BY_SIDE};

/// Step of a finite difference in `u`.
const DIFFERENCE: f64 = 1e-5;

#[derive(Debug, Clone)]
pub(crate) struct Descent {
    search: LevenbergMarquardt<Projection>,
    ended: Option<Termination>,
}

impl Descent {
    pub fn new(u: Vec<f64>, value: Projection) -> Self {
        Self { search: LevenbergMarquardt::at(u, value), ended: None }
    }

    /// Where it is in the box.
    pub fn u(&self) -> &[f64] {
        self.search.parameters()
    }

    /// The best weights there.
    pub fn value(&self) -> &Projection {
        self.search.known_value().expect("a descent begins at a known value")
    }

    /// One iteration, which lowers the residual unless there is no way on.
    pub fn advance(&mut self, objective: &LawObjective<'_>) {
        if self.ended.is_none() {
            self.ended = self.search.advance(objective);
        }
    }
}

impl SearchStart for Descent {
    fn order(&self, other: &Self) -> Ordering {
        self.value().square_residual.total_cmp(&other.value().square_residual)
    }

    fn evaluations(&self) -> usize {
        self.search.evaluations()
    }

    fn ended(&self) -> Option<Termination> {
        self.ended
    }
}

impl LeastSquaresProblem for LawObjective<'_> {
    type Value = Projection;
    type Curvature = Symmetric;
    const RULES: DescentSettings = DescentSettings::KINKED;

    fn value(&self, u: &[f64]) -> Projection {
        self.value(u)
    }

    fn objective(value: &Projection) -> f64 {
        0.5 * value.square_residual
    }

    /// By finite differences, inwards where `u_j` is near its bound.
    fn slope(&self, u: &[f64], here: &Projection) -> Option<Slope<Symmetric>> {
        let by = |j: usize| if u[j] + DIFFERENCE > 1.0 { -DIFFERENCE } else { DIFFERENCE };
        let beside = |j: usize| {
            let mut beside = u.to_vec();
            beside[j] += by(j);
            beside
        };
        let columns = |group: usize| -> Vec<Vec<f64>> {
            let first = group * SIDE_BY_SIDE;
            let indices = first..u.len().min(first + SIDE_BY_SIDE);
            let points: Vec<Vec<f64>> = indices.clone().map(beside).collect();
            let mut columns: Vec<Vec<f64>> =
                self.values(&points).into_iter().map(|value| value.residual).collect();
            for (column, j) in columns.iter_mut().zip(indices) {
                for (there, here) in column.iter_mut().zip(&here.residual) {
                    *there = (*there - here) / by(j);
                }
            }
            columns
        };
        let jacobian = parallel::numbered(u.len().div_ceil(SIDE_BY_SIDE), columns).concat();
        (!self.stop.is_asked())
            .then(|| Slope { evaluations: jacobian.len(), ..Slope::of_residual(&jacobian, &here.residual) })
    }

    fn step(&self, slope: &Slope<Symmetric>, u: &[f64], damping: &[f64]) -> Option<Vec<f64>> {
        let leaves = |i: usize, by: f64| u[i] <= 0.0 && by < 0.0 || u[i] >= 1.0 && by > 0.0;
        step_within(&slope.curvature, &slope.gradient, damping, leaves, StopCheck::never()) // (8.3)
    }

    fn limit(&self, u: &mut [f64]) {
        u.iter_mut().for_each(|u| *u = u.clamp(0.0, 1.0));
    }

    fn stop(&self) -> StopCheck<'_> {
        self.stop
    }
}

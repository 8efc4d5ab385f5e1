//! Levenberg-Marquardt descent with variable projection, theory.md (3.5).
//!
//! The output weights are never searched: each value of the objective already has the best ones, and
//! the Gauss-Newton matrix (3.4) knows that they follow.

use std::ops::ControlFlow;

use crate::error::Result;
use crate::network::{Architecture, Network};
use crate::training::history::HistoryPoint;
use crate::training::objective::{Objective, Slope, Value};
use crate::training::termination::Termination;

/// First damping μ, relative to the curvature.
const FIRST_DAMPING: f64 = 1e-2;
/// Damping at which the search gives up.
const LARGEST_DAMPING: f64 = 1e12;
const SMALLEST_DAMPING: f64 = 1e-12;
/// Relative fall of the objective that counts as none.
const STALL: f64 = 1e-6;
/// Iterations in a row without a noticeable fall that end the search.
const PATIENCE: usize = 3;

/// Where a descent ended.
#[derive(Debug, Clone)]
pub struct Descent {
    /// The parameters found by search.
    pub parameters: Vec<f64>,
    /// Their output weights.
    pub output: Vec<f64>,
    /// The objective there, theory.md (3.1).
    pub objective: f64,
    /// Error after each iteration.
    pub history: Vec<HistoryPoint>,
    /// Why it ended.
    pub termination: Termination,
    /// Evaluations of the objective, gradients included.
    pub evaluations: usize,
}

impl Descent {
    pub(crate) fn network(&self, architecture: &Architecture) -> Result<Network> {
        Network::new(*architecture, self.parameters.clone(), self.output.clone())
    }
}

/// Descends from `parameters` for at most `epochs` iterations. `told` gets the iteration and the error
/// in percent of the standard deviation, and may break.
pub fn descend(
    objective: &Objective,
    parameters: Vec<f64>,
    epochs: usize,
    mut told: impl FnMut(usize, f64) -> ControlFlow<()>,
) -> Descent {
    let mut value = objective.value(&parameters);
    let mut descent = Descent {
        output: value.output_weights().to_vec(),
        parameters,
        objective: value.objective,
        history: vec![point(0, &value)],
        termination: Termination::EpochsUsed,
        evaluations: 1,
    };
    let mut damping = Damping::new();
    let mut stalled = 0;
    for epoch in 1..=epochs {
        let slope = objective.slope(&descent.parameters, &value);
        descent.evaluations += 1;
        damping.see(&slope);
        if slope.gradient.iter().all(|g| g.abs() < 1e-14) {
            descent.termination = Termination::GradientVanished;
            break;
        }
        let Some((parameters, better)) =
            damping.step(objective, &slope, &descent.parameters, &value, &mut descent.evaluations)
        else {
            descent.termination = Termination::NoFurtherImprovement;
            break;
        };
        let fall = (value.objective - better.objective) / value.objective;
        descent.parameters = parameters;
        value = better;
        descent.output.copy_from_slice(value.output_weights());
        descent.objective = value.objective;
        let point = point(epoch, &value);
        descent.history.push(point);
        if told(epoch, point.train_nrmse_percent).is_break() {
            descent.termination = Termination::Stopped;
            break;
        }
        stalled = if fall < STALL { stalled + 1 } else { 0 };
        if stalled == PATIENCE {
            descent.termination = Termination::Converged;
            break;
        }
    }
    descent
}

fn point(epoch: usize, value: &Value) -> HistoryPoint {
    HistoryPoint { epoch, train_nrmse_percent: 100.0 * value.mean_square.sqrt() }
}

/// μ and D of theory.md (3.5). D is the largest curvature seen in each direction (Moré), so that a
/// parameter that matters little now is not thrown far away.
struct Damping {
    mu: f64,
    growth: f64,
    scale: Vec<f64>,
}

impl Damping {
    fn new() -> Self {
        Self { mu: FIRST_DAMPING, growth: 2.0, scale: Vec::new() }
    }

    fn see(&mut self, slope: &Slope) {
        self.scale.resize(slope.gradient.len(), 0.0);
        for (index, scale) in self.scale.iter_mut().enumerate() {
            *scale = scale.max(slope.matrix.diagonal(index));
        }
        let floor = 1e-6 * self.scale.iter().copied().fold(0.0, f64::max) + 1e-30;
        for scale in &mut self.scale {
            *scale = scale.max(floor);
        }
    }

    /// Raises the damping until a step lowers the objective; then sets it for the next by how well
    /// the quadratic model foretold the fall (Nielsen's rule). `None` if no step does.
    fn step(
        &mut self,
        objective: &Objective,
        slope: &Slope,
        parameters: &[f64],
        value: &Value,
        evaluations: &mut usize,
    ) -> Option<(Vec<f64>, Value)> {
        while self.mu < LARGEST_DAMPING {
            if let Some(candidate) = self.candidate(objective, slope, parameters) {
                let found = objective.value(&candidate.parameters);
                *evaluations += 1;
                let fall = value.objective - found.objective;
                if fall > 0.0 {
                    let quality = fall / candidate.foretold_fall;
                    self.mu *= (1.0 - (2.0 * quality - 1.0).powi(3)).max(1.0 / 3.0);
                    self.mu = self.mu.max(SMALLEST_DAMPING);
                    self.growth = 2.0;
                    return Some((candidate.parameters, found));
                }
            }
            self.mu *= self.growth;
            self.growth *= 2.0;
        }
        None
    }

    /// The damped step, kept within bounds, and the fall that the quadratic model foretells for it.
    fn candidate(&self, objective: &Objective, slope: &Slope, parameters: &[f64]) -> Option<Candidate> {
        let mut damped = slope.matrix.clone();
        for (index, scale) in self.scale.iter().enumerate() {
            damped.add_to_diagonal(index, self.mu * scale);
        }
        let mut step: Vec<f64> = slope.gradient.iter().map(|g| -g).collect();
        damped.cholesky()?.solve(&mut step);
        let foretold_fall = 0.5
            * step
                .iter()
                .zip(&slope.gradient)
                .zip(&self.scale)
                .map(|((d, g), scale)| d * (self.mu * scale * d - g))
                .sum::<f64>();
        let mut candidate: Vec<f64> = parameters.iter().zip(&step).map(|(p, d)| p + d).collect();
        objective.layout().clamp(&mut candidate);
        (foretold_fall > 0.0).then_some(Candidate { parameters: candidate, foretold_fall })
    }
}

struct Candidate {
    parameters: Vec<f64>,
    foretold_fall: f64,
}

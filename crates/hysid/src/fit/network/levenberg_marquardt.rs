//! Levenberg-Marquardt descent with variable projection, theory.md (3.5).
//!
//! The output weights are never searched: each value of the objective already has the best ones, and
//! the Gauss-Newton matrix (3.4) knows that they follow.

use serde::{Deserialize, Serialize};

use crate::fit::network::objective::{Objective, Slope, Value};
use crate::fit::network::soundness::{Frame, MOST_COUNTED};
use crate::termination::Termination;

/// First damping μ, relative to the curvature.
const FIRST_DAMPING: f64 = 1e-2;
/// Damping at which the search gives up.
const LARGEST_DAMPING: f64 = 1e12;
const SMALLEST_DAMPING: f64 = 1e-12;
/// Share of the largest curvature seen that is left after an iteration.
const MEMORY_OF_CURVATURE: f64 = 0.9;
/// Smallest curvature assumed, as a share of the largest of all directions.
const LEAST_CURVATURE: f64 = 1e-4;
/// Relative fall of the objective that counts as none.
const STALL: f64 = 1e-6;
/// Iterations in a row without a noticeable fall that end the search.
const PATIENCE: usize = 3;

/// The state of a descent. It can be stored and taken up again, to the last bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct LevenbergMarquardt {
    parameters: Vec<f64>,
    /// The objective at the parameters; computed anew after a descent was stored.
    #[serde(skip)]
    value: Option<Value>,
    damping: Damping,
    stalled: usize,
    evaluations: usize,
}

impl LevenbergMarquardt {
    /// Begins at `parameters`.
    pub fn new(objective: &Objective, parameters: Vec<f64>) -> Self {
        let value = Some(objective.value(&parameters));
        Self { parameters, value, damping: Damping::new(), stalled: 0, evaluations: 1 }
    }

    /// True if a descent can go on from here.
    pub(super) fn is_sound(&self, frame: &Frame) -> bool {
        let Damping { mu, growth, scale } = &self.damping;
        frame.are_parameters(&self.parameters)
            && (SMALLEST_DAMPING..=1e20 * LARGEST_DAMPING).contains(mu)
            && (2.0..=1e100).contains(growth)
            && (scale.is_empty() || frame.is_vector(scale) && scale.iter().all(|scale| *scale > 0.0))
            && self.stalled <= PATIENCE
            && self.evaluations <= MOST_COUNTED
    }

    /// Where the descent is.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Evaluations of the objective so far, gradients included.
    pub fn evaluations(&self) -> usize {
        self.evaluations
    }

    /// The objective where the descent is.
    pub fn value(&mut self, objective: &Objective) -> &Value {
        self.value.get_or_insert_with(|| objective.value(&self.parameters))
    }

    /// One iteration, which lowers the objective unless it tells that there is no way on.
    pub fn advance(&mut self, objective: &Objective) -> Option<Termination> {
        let value = self.value(objective).clone();
        // Broken off, the iteration is thrown away.
        let slope = objective.slope(&self.parameters, &value)?;
        self.evaluations += 1;
        self.damping.see(&slope);
        if slope.gradient.iter().all(|g| g.abs() < 1e-14) {
            return Some(Termination::GradientVanished);
        }
        let found = self.damping.step(objective, &slope, &self.parameters, &value, &mut self.evaluations);
        let Some((parameters, better)) = found else {
            return Some(Termination::NoFurtherImprovement);
        };
        let fall = (value.objective - better.objective) / value.objective;
        self.parameters = parameters;
        self.value = Some(better);
        self.stalled = if fall < STALL { self.stalled + 1 } else { 0 };
        (self.stalled == PATIENCE).then_some(Termination::Converged)
    }
}

/// μ and D of theory.md (3.5). D is the largest curvature seen lately in each direction (Moré), so that a
/// parameter that matters little now is not thrown far away; it fades, because curvature seen far away
/// would hold the parameter for ever.
#[derive(Debug, Clone, Serialize, Deserialize)]
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
            *scale = (MEMORY_OF_CURVATURE * *scale).max(slope.curvature.diagonal(index));
        }
        let floor = LEAST_CURVATURE * self.scale.iter().copied().fold(0.0, f64::max) + 1e-30;
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
        while self.mu < LARGEST_DAMPING && !objective.stop().is_asked() {
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
        let damping: Vec<f64> = self.scale.iter().map(|scale| self.mu * scale).collect();
        let step = slope.curvature.step(&slope.gradient, &damping, objective.stop())?;
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

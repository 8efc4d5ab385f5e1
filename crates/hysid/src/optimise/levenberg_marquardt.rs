//! Levenberg-Marquardt descent, for networks, laws found by search, neuro-Madelung and modified
//! Prandtl-Ishlinskii models.
//!
//! ```text
//! (B + μD) δ = -g,    F(w + δ) < F(w) or μ increases;    D_i = max(m D_i, B_ii, s max B)      theory.md (3.5)
//! ```
//!
//! `F` is half a mean or a sum of squares of the parameters `w`, `g` its gradient, `B` its Gauss-Newton
//! matrix, `δ` the step, `μ` the damping and `D` a positive diagonal scaling; `m` and `s` are
//! [`DescentSettings::curvature_memory`] and [`DescentSettings::least_curvature`].
//!
//! A [`LeastSquaresProblem`] gives `F`, `g` and `B`, and solves for the step within its bounds. The descent controls the
//! damping.

use hysid_core::elementary::powi;
use serde::{Deserialize, Serialize};

use crate::linear_algebra::{Symmetric, dot};
use crate::optimise::MOST_COUNTED;
use crate::stop_check::StopCheck;
use crate::termination::Termination;

/// First damping μ, relative to the curvature.
const FIRST_DAMPING: f64 = 1e-2;
/// Iterations in a row without a noticeable fall that end the search.
const PATIENCE: usize = 3;

/// Settings of a descent.
#[derive(Debug, Clone, Copy)]
pub struct DescentSettings {
    /// Smallest damping, and the damping at which the search ends.
    pub damping: (f64, f64),
    /// `m`: share of the largest earlier curvature that is kept after an iteration; 0 for the present one only.
    pub curvature_memory: f64,
    /// `s`: least curvature in any direction, as a share of the largest.
    pub least_curvature: f64,
    /// Largest component of a gradient that counts as 0.
    pub least_gradient: f64,
    /// Relative decrease of the function that counts as none.
    pub stall: f64,
}

impl DescentSettings {
    /// For smooth functions of many parameters: earlier curvature limits the steps, and small decreases
    /// count.
    pub const SMOOTH: Self = Self {
        damping: (1e-12, 1e12),
        curvature_memory: 0.9,
        least_curvature: 1e-4,
        least_gradient: 1e-14,
        stall: 1e-6,
    };

    /// For laws with kinks and regions without slope, in any unit: earlier curvature is not used.
    pub const KINKED: Self = Self {
        damping: (1e-10, 1e10),
        curvature_memory: 0.0,
        least_curvature: 1e-6,
        least_gradient: 0.0,
        stall: 1e-5,
    };
}

/// Gradient and curvature at a point.
pub struct Slope<C> {
    /// Gradient of the function.
    pub gradient: Vec<f64>,
    /// Diagonal of the curvature.
    pub diagonal: Vec<f64>,
    /// The Gauss-Newton matrix, in the form of the problem.
    pub curvature: C,
    /// Number of evaluations for it.
    pub evaluations: usize,
}

impl Slope<Symmetric> {
    /// Of half a sum of squares, from the derivatives of the residual by each parameter.
    pub fn of_residual(jacobian: &[Vec<f64>], residual: &[f64]) -> Self {
        let curvature = Symmetric::from_fn(jacobian.len(), |i, j| dot(&jacobian[i], &jacobian[j]));
        Self {
            gradient: jacobian.iter().map(|column| dot(column, residual)).collect(),
            diagonal: (0..jacobian.len()).map(|i| curvature.diagonal(i)).collect(),
            curvature,
            evaluations: 1,
        }
    }
}

/// A function to be minimised.
pub trait LeastSquaresProblem {
    /// The function at a point, with what its slope can be computed from.
    type Value;
    /// The curvature at a point.
    type Curvature;
    /// How the descent goes.
    const RULES: DescentSettings;

    /// The function at a point; infinite if the evaluation was stopped.
    fn value(&self, parameters: &[f64]) -> Self::Value;

    /// The number to be minimised: half a mean or a sum of squares.
    fn objective(value: &Self::Value) -> f64;

    /// Gradient and curvature at a point with its value; `None` once stopped.
    fn slope(&self, parameters: &[f64], value: &Self::Value) -> Option<Slope<Self::Curvature>>;

    /// The step to the minimum of the damped quadratic model; `None` if there is none, or once stopped.
    fn step(&self, slope: &Slope<Self::Curvature>, parameters: &[f64], damping: &[f64]) -> Option<Vec<f64>>;

    /// Moves parameters into their bounds.
    fn limit(&self, parameters: &mut [f64]);

    /// The check whether to stop.
    fn stop(&self) -> StopCheck<'_>;
}

/// The step without bounds: `(B + damping) δ = -g`. `None` unless positive definite, and once stopped.
pub fn damped_step(
    matrix: &Symmetric,
    gradient: &[f64],
    damping: &[f64],
    stop: StopCheck<'_>,
) -> Option<Vec<f64>> {
    let mut damped = matrix.clone();
    damping.iter().enumerate().for_each(|(index, &value)| damped.add_to_diagonal(index, value));
    let mut step: Vec<f64> = gradient.iter().map(|g| -g).collect();
    damped.cholesky(stop)?.solve(&mut step);
    Some(step)
}

/// The step with bounds: a parameter at a bound that the step would cross stays there, and the step of the
/// others is solved without it. `leaves` is true for a parameter and a step that would cross a bound. `None`
/// as for [`damped_step`], and if no parameter can move.
pub fn step_within(
    matrix: &Symmetric,
    gradient: &[f64],
    damping: &[f64],
    leaves: impl Fn(usize, f64) -> bool,
    stop: StopCheck<'_>,
) -> Option<Vec<f64>> {
    let mut moving: Vec<usize> = (0..gradient.len()).collect();
    loop {
        let mut damped = matrix.select(&moving);
        moving.iter().enumerate().for_each(|(place, &i)| damped.add_to_diagonal(place, damping[i]));
        let mut step: Vec<f64> = moving.iter().map(|&i| -gradient[i]).collect();
        damped.cholesky(stop)?.solve(&mut step);
        let stays = |&(&i, &by): &(&usize, &f64)| !leaves(i, by);
        let staying: Vec<usize> = moving.iter().zip(&step).filter(stays).map(|(i, _)| *i).collect();
        if staying.len() == moving.len() {
            let mut all = vec![0.0; gradient.len()];
            moving.iter().zip(step).for_each(|(&i, by)| all[i] = by);
            return Some(all);
        }
        if staying.is_empty() {
            return None;
        }
        moving = staying;
    }
}

/// The state of a descent. It can be stored and resumed, to the last bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct LevenbergMarquardt<V> {
    parameters: Vec<f64>,
    /// The function at the parameters; computed anew after a descent was stored.
    #[serde(skip)]
    value: Option<V>,
    damping: Damping,
    stalled: usize,
    evaluations: usize,
}

impl<V> LevenbergMarquardt<V> {
    /// Begins at `parameters`.
    pub fn new<P: LeastSquaresProblem<Value = V>>(problem: &P, parameters: Vec<f64>) -> Self {
        let value = problem.value(&parameters);
        Self { evaluations: 1, ..Self::at(parameters, value) }
    }

    /// Begins at parameters whose value is known; its evaluation is not counted.
    pub fn at(parameters: Vec<f64>, value: V) -> Self {
        Self { parameters, value: Some(value), damping: Damping::new(), stalled: 0, evaluations: 0 }
    }

    /// True if a descent with these rules can continue from this state, which may have been read from a file.
    pub(crate) fn is_sound(&self, rules: &DescentSettings, are_parameters: impl Fn(&[f64]) -> bool) -> bool {
        let Damping { mu, growth, scale } = &self.damping;
        let (smallest, largest) = rules.damping;
        let is_scale = |scale: &f64| scale.is_finite() && *scale > 0.0;
        are_parameters(&self.parameters)
            && (smallest..=1e20 * largest).contains(mu)
            && (2.0..=1e100).contains(growth)
            && (scale.is_empty() || scale.len() == self.parameters.len() && scale.iter().all(is_scale))
            && self.stalled <= PATIENCE
            && self.evaluations <= MOST_COUNTED
    }

    /// The present parameters.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Evaluations of the function so far, including those for gradients.
    pub fn evaluations(&self) -> usize {
        self.evaluations
    }

    /// The function at the present parameters.
    pub fn value<P: LeastSquaresProblem<Value = V>>(&mut self, problem: &P) -> &V {
        self.value.get_or_insert_with(|| problem.value(&self.parameters))
    }

    /// The function at the present parameters; `None` in a state that was stored.
    pub fn known_value(&self) -> Option<&V> {
        self.value.as_ref()
    }

    /// One iteration. It decreases the function, or returns why the descent ends.
    pub fn advance<P: LeastSquaresProblem<Value = V>>(&mut self, problem: &P) -> Option<Termination> {
        let Self { parameters, value, damping, stalled, evaluations } = self;
        let here = value.get_or_insert_with(|| problem.value(parameters));
        // Broken off, the iteration is thrown away.
        let slope = problem.slope(parameters, here)?;
        *evaluations += slope.evaluations;
        damping.see(&P::RULES, &slope.diagonal);
        if slope.gradient.iter().all(|g| g.abs() <= P::RULES.least_gradient) {
            return Some(Termination::GradientVanished);
        }
        let objective = P::objective(here);
        let Some((better, there)) = damping.step(problem, &slope, parameters, objective, evaluations) else {
            return Some(Termination::NoFurtherImprovement);
        };
        let fall = (objective - P::objective(&there)) / objective;
        (*parameters, *here) = (better, there);
        *stalled = if fall < P::RULES.stall { *stalled + 1 } else { 0 };
        (*stalled == PATIENCE).then_some(Termination::Converged)
    }
}

/// Damping `μ` and scaling `D` of the step `(B + μD) δ = -g` (theory.md (3.5)). `D` is the largest recent
/// curvature in each direction (Moré), which limits the step in a parameter of little present influence. It
/// decays, because curvature far away would limit the parameter without end.
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

    fn see(&mut self, rules: &DescentSettings, diagonal: &[f64]) {
        self.scale.resize(diagonal.len(), 0.0);
        for (scale, &curvature) in self.scale.iter_mut().zip(diagonal) {
            *scale = (rules.curvature_memory * *scale).max(curvature);
        }
        let largest = self.scale.iter().copied().fold(0.0, f64::max);
        let floor = rules.least_curvature * largest + f64::MIN_POSITIVE;
        for scale in &mut self.scale {
            *scale = scale.max(floor);
        }
    }

    /// Raises the damping until a step lowers the function, then resets it by Nielsen's rule; `None` if no step does.
    fn step<P: LeastSquaresProblem>(
        &mut self,
        problem: &P,
        slope: &Slope<P::Curvature>,
        parameters: &[f64],
        objective: f64,
        evaluations: &mut usize,
    ) -> Option<(Vec<f64>, P::Value)> {
        let (smallest, largest) = P::RULES.damping;
        while self.mu < largest && !problem.stop().is_asked() {
            if let Some(candidate) = self.candidate(problem, slope, parameters) {
                let found = problem.value(&candidate.parameters);
                *evaluations += 1;
                let fall = objective - P::objective(&found);
                if fall > 0.0 {
                    let quality = fall / candidate.predicted_fall;
                    self.mu *= (1.0 - powi(2.0 * quality - 1.0, 3)).max(1.0 / 3.0);
                    self.mu = self.mu.max(smallest);
                    self.growth = 2.0;
                    return Some((candidate.parameters, found));
                }
            }
            self.mu *= self.growth;
            self.growth *= 2.0;
        }
        None
    }

    /// The damped step, kept within bounds, and the fall that the quadratic model predicts for it.
    fn candidate<P: LeastSquaresProblem>(
        &self,
        problem: &P,
        slope: &Slope<P::Curvature>,
        parameters: &[f64],
    ) -> Option<TrialStep> {
        let damping: Vec<f64> = self.scale.iter().map(|scale| self.mu * scale).collect();
        let step = problem.step(slope, parameters, &damping)?;
        let predicted_fall = 0.5
            * step
                .iter()
                .zip(&slope.gradient)
                .zip(&damping)
                .map(|((d, g), damping)| d * (damping * d - g))
                .sum::<f64>();
        let mut candidate: Vec<f64> = parameters.iter().zip(&step).map(|(p, d)| p + d).collect();
        problem.limit(&mut candidate);
        (predicted_fall > 0.0).then_some(TrialStep { parameters: candidate, predicted_fall })
    }
}

struct TrialStep {
    parameters: Vec<f64>,
    predicted_fall: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley as residuals `10 (y - x²)` and `1 - x`, with `x` at most at a bound.
    struct Valley {
        most: f64,
    }

    impl LeastSquaresProblem for Valley {
        type Value = [f64; 2];
        type Curvature = Symmetric;
        const RULES: DescentSettings = DescentSettings::SMOOTH;

        fn value(&self, p: &[f64]) -> [f64; 2] {
            [10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]
        }

        fn objective(r: &[f64; 2]) -> f64 {
            0.5 * (r[0] * r[0] + r[1] * r[1])
        }

        fn slope(&self, p: &[f64], r: &[f64; 2]) -> Option<Slope<Symmetric>> {
            let jacobian = [vec![-20.0 * p[0], -1.0], vec![10.0, 0.0]];
            Some(Slope::of_residual(&jacobian, r))
        }

        fn step(&self, slope: &Slope<Symmetric>, p: &[f64], damping: &[f64]) -> Option<Vec<f64>> {
            let leaves = |i: usize, by: f64| i == 0 && p[0] >= self.most && by > 0.0;
            step_within(&slope.curvature, &slope.gradient, damping, leaves, self.stop())
        }

        fn limit(&self, p: &mut [f64]) {
            p[0] = p[0].min(self.most);
        }

        fn stop(&self) -> StopCheck<'_> {
            StopCheck::never()
        }
    }

    fn descend(problem: &Valley) -> LevenbergMarquardt<[f64; 2]> {
        let mut search = LevenbergMarquardt::new(problem, vec![-1.2, 1.0]);
        let mut last = Valley::objective(search.value(problem));
        for _ in 0..200 {
            let ended = search.advance(problem);
            let now = Valley::objective(search.value(problem));
            assert!(now < last || ended.is_some(), "{now} after {last}");
            last = now;
            assert!(search.is_sound(&Valley::RULES, |p| p.iter().all(|p| p.is_finite())));
            if ended.is_some() {
                return search;
            }
        }
        panic!("no end in 200 iterations");
    }

    #[test]
    fn a_bent_valley_is_followed_to_its_end() {
        let search = descend(&Valley { most: 5.0 });
        for p in search.parameters() {
            assert!((p - 1.0).abs() < 1e-6, "{p}");
        }
    }

    #[test]
    fn a_bound_holds_and_the_rest_is_lowest_beside_it() {
        let search = descend(&Valley { most: 0.5 });
        assert_eq!(search.parameters()[0], 0.5);
        assert!((search.parameters()[1] - 0.25).abs() < 1e-6);
    }
}

//! What a start is trained on: the error of the free run over records, with a penalty on weights.

use crate::error::LARGEST_VALUE;
use crate::law::hysteretic_dynamics::{DAMPING_RATIOS, Drive, Dynamics, LARGEST_WEIGHT, Layout, Run};
use crate::linear_algebra::Symmetric;
use crate::optimise::levenberg_marquardt::{Problem, Rules, Slope, step_within};
use crate::stop_check::StopCheck;

/// Bounds of the leak along the path, in standard deviations of the displacement. States that move more slowly would
/// drift over long records without having been seen to.
const PATH_LEAKS: (f64, f64) = (0.13, 1e3);

/// A model may change its frequencies by this factor.
const LARGEST_SHIFT: f64 = 30.0;

/// Records, and the parameters that are searched.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub layout: &'a Layout,
    /// What is not searched.
    pub template: &'a Dynamics,
    pub drives: &'a [Drive],
    /// `N`.
    pub rows: f64,
    penalty: f64,
    stop: StopCheck<'a>,
}

/// The objective at a point; infinite if it was broken off.
#[derive(Debug, Clone, Copy)]
pub(super) struct Value {
    pub objective: f64,
    pub mean_square: f64,
    /// κ.
    pub penalty: f64,
}

impl Value {
    pub fn nrmse_percent(&self) -> f64 {
        100.0 * self.mean_square.sqrt()
    }
}

impl<'a> Task<'a> {
    pub fn new(layout: &'a Layout, template: &'a Dynamics, drives: &'a [Drive], stop: StopCheck<'a>) -> Self {
        let rows = |drive: &Drive| -> f64 {
            let compared = drive.targets.iter().zip(&drive.weights).filter(|(target, _)| !target.is_nan());
            compared.map(|(_, weight)| weight * weight).sum()
        };
        let rows = drives.iter().map(rows).sum::<f64>().max(1.0);
        Self { layout, template, drives, rows, penalty: 0.0, stop }
    }

    pub fn with_penalty(self, penalty: f64) -> Self {
        Self { penalty, ..self }
    }

    /// Mean square of the scaled error; `None` once stopped.
    pub fn mean_square(&self, parameters: &[f64]) -> Option<f64> {
        let dynamics = self.layout.dynamics(parameters, self.template);
        let run = Run { dynamics: &dynamics, drives: self.drives, stop: self.stop };
        run.half_square().map(|half| 2.0 * half / self.rows)
    }

    fn penalised(&self) -> impl Iterator<Item = usize> {
        (0..self.layout.count()).filter(|&index| self.layout.has_decay(index))
    }

    fn bounds(&self, index: usize) -> (f64, f64) {
        let of_ln = |(low, high): (f64, f64)| (low.ln(), high.ln());
        if let Some(place) = self.layout.modes.iter().position(|mode| mode.ln_frequency == index) {
            let ln = self.template.modes[place].frequency.ln();
            return (ln - LARGEST_SHIFT.ln(), ln + LARGEST_SHIFT.ln());
        }
        if self.layout.modes.iter().any(|mode| mode.ln_damping == index) {
            return of_ln(DAMPING_RATIOS);
        }
        if self.layout.elements.iter().any(|element| element.ln_path_leaks.contains(&index)) {
            return of_ln(PATH_LEAKS);
        }
        if self.layout.elements.iter().any(|element| element.strength_losses.contains(&index)) {
            return (0.0, LARGEST_WEIGHT);
        }
        if self.layout.is_logarithm(index) {
            return of_ln((1.0 / LARGEST_WEIGHT, LARGEST_WEIGHT));
        }
        (-LARGEST_WEIGHT, LARGEST_WEIGHT)
    }
}

impl Problem for Task<'_> {
    type Value = Value;
    type Curvature = Symmetric;
    const RULES: Rules = Rules::SMOOTH;

    fn value(&self, parameters: &[f64]) -> Value {
        let mean_square = self.mean_square(parameters).filter(|square| *square < LARGEST_VALUE);
        let mean_square = mean_square.unwrap_or(f64::INFINITY);
        let decay: f64 = self.penalised().map(|index| parameters[index] * parameters[index]).sum();
        let objective = 0.5 * mean_square + 0.5 * self.penalty * decay;
        Value { objective, mean_square, penalty: self.penalty }
    }

    fn objective(value: &Value) -> f64 {
        value.objective
    }

    fn slope(&self, parameters: &[f64], _: &Value) -> Option<Slope<Symmetric>> {
        let dynamics = self.layout.dynamics(parameters, self.template);
        let run = Run { dynamics: &dynamics, drives: self.drives, stop: self.stop };
        let gram = run.gram(self.layout)?;
        let count = self.layout.count();
        let mut gradient: Vec<f64> = (0..count).map(|i| gram.at(count, i) / self.rows).collect();
        let mut curvature = Symmetric::from_fn(count, |i, j| gram.at(i, j) / self.rows);
        for index in self.penalised() {
            gradient[index] += self.penalty * parameters[index];
            curvature.add_to_diagonal(index, self.penalty);
        }
        let diagonal = (0..count).map(|index| curvature.diagonal(index)).collect();
        Some(Slope { gradient, diagonal, curvature, evaluations: 1 })
    }

    fn step(&self, slope: &Slope<Symmetric>, parameters: &[f64], damping: &[f64]) -> Option<Vec<f64>> {
        let leaves = |i: usize, by: f64| {
            let (low, high) = self.bounds(i);
            parameters[i] <= low && by < 0.0 || parameters[i] >= high && by > 0.0
        };
        step_within(&slope.curvature, &slope.gradient, damping, leaves, self.stop)
    }

    fn limit(&self, parameters: &mut [f64]) {
        for (index, parameter) in parameters.iter_mut().enumerate() {
            let (low, high) = self.bounds(index);
            *parameter = parameter.clamp(low, high);
        }
    }

    fn stop(&self) -> StopCheck<'_> {
        self.stop
    }
}

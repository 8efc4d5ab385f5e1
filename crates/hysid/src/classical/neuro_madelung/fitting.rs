//! Training of a neuro-Madelung model: from random networks, first with the measured output at every
//! turning point (teacher forcing), then in free run, where the model's own errors at the turning points
//! go on into the branches.
//!
//! ```text
//! dy/dθ = (x - x_t) ∂N/∂θ + [1 + (x - x_t) ∂N/∂y_t] dy_t/dθ                 theory.md (8.21)
//! ```
//!
//! `dy_t/dθ` is stored with each turning point, so the derivative of the free run is exact.

use std::ops::ControlFlow;

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use crate::classical::search::{Effort, Identified, Memory, SearchObserver, SearchProgress, spread, thinned};
use crate::classical::series::Series;
use crate::error::{Error, Result};
use crate::linear_algebra::{Symmetric, dot};
use crate::rate::RateMethod;
use crate::record::Dataset;
use crate::training::{FEWEST_ROWS, Termination, start::normal};

use super::{Branch, NeuroMadelung, TurningPointMemory, argument};

/// Weight of the squared parameters beside the mean square error of the scaled output.
const DECAY: f64 = 1e-5;
const FIRST_DAMPING: f64 = 1e-2;
const LARGEST_DAMPING: f64 = 1e8;
/// Relative fall of the objective that counts as none, and how many in a row end a phase.
const STALL: f64 = 1e-5;
const PATIENCE: usize = 3;
/// After so many epochs of free run half of the starts are given up, and again after as many more.
const EPOCHS_TO_PROVE_ITSELF: usize = 8;
/// Most tanh neurons.
const MOST_NEURONS: usize = 100;

/// How a neuro-Madelung model is trained.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NeuroMadelungOptions {
    /// Tanh neurons.
    pub hidden: usize,
    /// How the rate is found; without it the model is rate independent.
    pub rate: Option<RateMethod>,
    /// Random networks to start from.
    pub starts: usize,
    /// Epochs of each at most, half of them teacher forced.
    pub epochs: usize,
    /// Seed of the random networks.
    pub seed: u64,
}

impl Default for NeuroMadelungOptions {
    fn default() -> Self {
        Self { hidden: 8, rate: None, starts: 8, epochs: 60, seed: 0 }
    }
}

impl NeuroMadelung {
    /// Trains a model.
    ///
    /// # Errors
    /// Data that nothing can be identified from, a rate that cannot be computed, no neuron or no start.
    pub fn fit(
        data: &Dataset,
        options: &NeuroMadelungOptions,
        observer: &mut SearchObserver<'_>,
    ) -> Result<Identified<Self>> {
        data.check_identifiable(FEWEST_ROWS)?;
        let NeuroMadelungOptions { hidden, starts, epochs, seed, .. } = *options;
        if hidden == 0 || hidden > MOST_NEURONS {
            return Err(Error::Option(format!("hidden must be from 1 to {MOST_NEURONS}")));
        }
        Effort { starts, epochs, seed }.validated()?;
        // The rate is an input of the network and no part of the memory.
        let mut series = thinned(Series::all(data, options.rate)?, Memory::TurningPoints);
        let empty = frame(data, &series, options);
        for series in &mut series {
            for sample in &mut series.samples {
                (sample.x, sample.rate) = empty.scaled(*sample);
            }
            for y in &mut series.output {
                *y = (*y - empty.output_mean) / empty.output_scale;
            }
        }
        let task = Task { frame: &empty, series: &series, hidden };

        let mut walks: Vec<Walk> =
            (0..starts).into_par_iter().map(|start| Walk::new(&task, seed, start)).collect();
        let mut given_up = 0;
        let mut termination = Termination::EpochsUsed;
        let forced = epochs / 2;
        for epoch in 1..=epochs {
            if epoch == forced + 1 {
                walks.par_iter_mut().for_each(|walk| walk.set_free(&task));
            }
            walks.par_iter_mut().for_each(|walk| walk.advance(&task));
            walks.sort_by(|a, b| a.objective.total_cmp(&b.objective));
            if epoch > forced && (epoch - forced) % EPOCHS_TO_PROVE_ITSELF == 0 {
                let keep = walks.len().div_ceil(2);
                given_up += walks.drain(keep..).map(|walk| walk.evaluations).sum::<usize>();
            }
            let progress = SearchProgress {
                round: epoch,
                rounds: epochs,
                evaluations: given_up + walks.iter().map(|walk| walk.evaluations).sum::<usize>(),
                train_nrmse_percent: 100.0 * walks[0].mean_square.sqrt(),
            };
            if observer(progress) == ControlFlow::Break(()) {
                termination = Termination::Stopped;
                break;
            }
            if epoch > forced && walks.iter().all(|walk| walk.ended.is_some()) {
                termination = walks[0].ended.unwrap_or(Termination::Converged);
                break;
            }
        }
        // Whatever phase they were in, the free run decides.
        walks.par_iter_mut().for_each(|walk| walk.set_free(&task));
        walks.sort_by(|a, b| a.objective.total_cmp(&b.objective));
        let evaluations = given_up + walks.iter().map(|walk| walk.evaluations).sum::<usize>();
        let train_nrmse_percent = 100.0 * walks[0].mean_square.sqrt();
        let law = task.law(&walks[0].parameters).validated()?;
        Ok(Identified { law, train_nrmse_percent, evaluations, termination })
    }
}

/// A model with its scales and without a network.
fn frame(data: &Dataset, series: &[Series], options: &NeuroMadelungOptions) -> NeuroMadelung {
    let (low, high) = data.input_range(0);
    let measured: Vec<f64> =
        series.iter().flat_map(|series| series.output.iter().copied().filter(|y| !y.is_nan())).collect();
    let (output_mean, output_scale) = spread(&measured);
    let samples = || series.iter().flat_map(|series| &series.samples);
    let rate = samples().map(|sample| sample.rate.abs()).fold(1e-100, f64::max);
    NeuroMadelung {
        input_scale: low.abs().max(high.abs()),
        rate_scale: options.rate.map(|_| rate),
        output_mean,
        output_scale,
        output_range: data.output_range(),
        hidden: Vec::new(),
        output: Vec::new(),
        virgin_output: 0.0,
    }
}

/// What all starts are trained on: scaled records.
struct Task<'a> {
    frame: &'a NeuroMadelung,
    series: &'a [Series],
    hidden: usize,
}

/// A turning point: the output there and its derivatives by all parameters.
#[derive(Debug, Clone)]
struct Reached {
    y: f64,
    by_parameters: Vec<f64>,
}

/// Residuals, and the derivatives by each parameter if asked for.
struct Sweep {
    residual: Vec<f64>,
    jacobian: Vec<Vec<f64>>,
}

impl Task<'_> {
    fn inputs(&self) -> usize {
        self.frame.inputs()
    }

    /// `hidden`, `output` and `y_0` within the parameters.
    fn split<'p>(&self, parameters: &'p [f64]) -> (&'p [f64], &'p [f64], f64) {
        let weights = self.hidden * (1 + self.inputs());
        let output = weights + 1 + self.hidden;
        (&parameters[..weights], &parameters[weights..output], parameters[output])
    }

    fn law(&self, parameters: &[f64]) -> NeuroMadelung {
        let (hidden, output, virgin_output) = self.split(parameters);
        NeuroMadelung {
            hidden: hidden.to_vec(),
            output: output.to_vec(),
            virgin_output,
            ..self.frame.clone()
        }
    }

    fn random(&self, seed: u64, start: usize) -> Vec<f64> {
        let mixed = seed ^ (start as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut generator = Xoshiro256PlusPlus::seed_from_u64(mixed);
        let mut parameters: Vec<f64> =
            (0..self.hidden * (1 + self.inputs())).map(|_| normal(&mut generator)).collect();
        parameters.extend((0..=self.hidden).map(|_| 0.3 * normal(&mut generator)));
        parameters.push(self.output_near_zero());
        parameters
    }

    /// The measured output where the input is nearest to 0, earliest in its record.
    fn output_near_zero(&self) -> f64 {
        let rows = self.series.iter().flat_map(|series| series.samples.iter().zip(&series.output));
        let measured = rows.filter(|(_, y)| !y.is_nan());
        measured.min_by(|a, b| a.0.x.abs().total_cmp(&b.0.x.abs())).map_or(0.0, |(_, y)| *y)
    }

    /// Runs over all records; `forced` takes the measured output at turning points where there is one.
    fn sweep(&self, parameters: &[f64], forced: bool, slopes: bool) -> Sweep {
        let law = self.law(parameters);
        let branch = law.branch();
        let n = parameters.len();
        let mut sweep =
            Sweep { residual: Vec::new(), jacobian: vec![Vec::new(); if slopes { n } else { 0 }] };
        let width = if slopes { n } else { 0 };
        for series in self.series {
            let mut by_parameters = vec![0.0; width];
            if let Some(last) = by_parameters.last_mut() {
                *last = 1.0; // of y_0 itself
            }
            let mut memory = TurningPointMemory::new(Reached { y: law.virgin_output, by_parameters });
            for (sample, &measured) in series.samples.iter().zip(&series.output) {
                let (x_t, reached) = memory.advance(sample.x);
                let inputs = [sample.x, *x_t, reached.y, sample.rate];
                let inputs = &inputs[..self.inputs()];
                let mut here = if slopes {
                    derivatives(branch, inputs, &reached.by_parameters)
                } else {
                    Reached { y: branch.value(inputs), by_parameters: Vec::new() }
                };
                if !measured.is_nan() {
                    sweep.residual.push(here.y - measured);
                    for (column, slope) in sweep.jacobian.iter_mut().zip(&here.by_parameters) {
                        column.push(*slope);
                    }
                    if forced {
                        here.y = measured;
                        here.by_parameters.fill(0.0);
                    }
                }
                memory.arrived(here);
            }
        }
        sweep
    }
}

/// The output and its derivatives, theory.md (8.21).
fn derivatives(branch: Branch<'_>, inputs: &[f64], at_turning_point: &[f64]) -> Reached {
    let run = branch.run();
    let neurons = branch.output.len() - 1;
    let along = inputs[0] - inputs[1];
    let mut all = vec![0.0; at_turning_point.len()];
    let (hidden, rest) = all.split_at_mut(neurons * run);
    let mut slope = branch.output[0];
    let mut by_y_t = 0.0;
    rest[0] = along;
    for (index, neuron) in branch.hidden.chunks_exact(run).enumerate() {
        let h = argument(neuron, inputs).tanh();
        let c = branch.output[1 + index];
        slope += c * h;
        rest[1 + index] = along * h;
        let back = c * (1.0 - h * h);
        by_y_t += back * neuron[3];
        let weights = &mut hidden[index * run..(index + 1) * run];
        weights[0] = along * back;
        for (weight, input) in weights[1..].iter_mut().zip(inputs) {
            *weight = along * back * input;
        }
    }
    let free = inputs[2] + along * slope;
    let y = free.clamp(branch.low, branch.high);
    if y != free {
        all.fill(0.0);
        return Reached { y, by_parameters: all };
    }
    let carried = 1.0 + along * by_y_t;
    for (slope, before) in all.iter_mut().zip(at_turning_point) {
        *slope += carried * before;
    }
    Reached { y, by_parameters: all }
}

/// A start on its way: Levenberg-Marquardt.
struct Walk {
    parameters: Vec<f64>,
    objective: f64,
    mean_square: f64,
    forced: bool,
    damping: f64,
    growth: f64,
    stalled: usize,
    evaluations: usize,
    ended: Option<Termination>,
}

impl Walk {
    fn new(task: &Task<'_>, seed: u64, start: usize) -> Self {
        let mut walk = Self {
            parameters: task.random(seed, start),
            objective: 0.0,
            mean_square: 0.0,
            forced: true,
            damping: FIRST_DAMPING,
            growth: 2.0,
            stalled: 0,
            evaluations: 0,
            ended: None,
        };
        (walk.objective, walk.mean_square) = walk.value(task, &walk.parameters);
        walk
    }

    /// From teacher forcing to free run.
    fn set_free(&mut self, task: &Task<'_>) {
        if self.forced {
            self.forced = false;
            (self.damping, self.growth, self.stalled, self.ended) = (FIRST_DAMPING, 2.0, 0, None);
            (self.objective, self.mean_square) = self.value(task, &self.parameters);
            self.evaluations += 1;
        }
    }

    /// The objective, which weighs the parameters as well, and the mean square error.
    fn value(&self, task: &Task<'_>, parameters: &[f64]) -> (f64, f64) {
        let residual = task.sweep(parameters, self.forced, false).residual;
        let mean_square = dot(&residual, &residual) / residual.len() as f64;
        (mean_square + DECAY * dot(parameters, parameters), mean_square)
    }

    fn advance(&mut self, task: &Task<'_>) {
        if self.ended.is_some() {
            return;
        }
        let Sweep { residual, jacobian } = task.sweep(&self.parameters, self.forced, true);
        self.evaluations += 1;
        let n = self.parameters.len();
        let rows = residual.len() as f64;
        let gradient: Vec<f64> =
            (0..n).map(|i| dot(&jacobian[i], &residual) / rows + DECAY * self.parameters[i]).collect();
        let matrix = Symmetric::from_fn(n, |i, j| {
            dot(&jacobian[i], &jacobian[j]) / rows + if i == j { DECAY } else { 0.0 }
        });
        while self.damping < LARGEST_DAMPING {
            let mut damped = matrix.clone();
            for i in 0..n {
                damped.add_to_diagonal(i, self.damping * (matrix.diagonal(i) + 1e-6));
            }
            let mut step: Vec<f64> = gradient.iter().map(|g| -g).collect();
            if let Some(factor) = damped.cholesky() {
                factor.solve(&mut step);
                let foretold: f64 = (0..n)
                    .map(|i| step[i] * (self.damping * (matrix.diagonal(i) + 1e-6) * step[i] - gradient[i]))
                    .sum();
                let limit = super::LARGEST_WEIGHT;
                let there: Vec<f64> =
                    self.parameters.iter().zip(&step).map(|(p, by)| (p + by).clamp(-limit, limit)).collect();
                let (objective, mean_square) = self.value(task, &there);
                self.evaluations += 1;
                let fall = self.objective - objective;
                if fall > 0.0 {
                    let quality = (fall / foretold).clamp(0.0, 2.0);
                    self.damping *= (1.0 - (2.0 * quality - 1.0).powi(3)).max(1.0 / 3.0);
                    self.damping = self.damping.max(1e-12);
                    self.growth = 2.0;
                    self.stalled = if fall > STALL * self.objective { 0 } else { self.stalled + 1 };
                    (self.parameters, self.objective, self.mean_square) = (there, objective, mean_square);
                    self.ended = (self.stalled == PATIENCE).then_some(Termination::Converged);
                    return;
                }
            }
            self.damping *= self.growth;
            self.growth *= 2.0;
        }
        self.ended = Some(Termination::NoFurtherImprovement);
    }
}

//! Identification of a Duhem neural network from random starts: output weights by ridge least squares, all other
//! parameters by Levenberg-Marquardt with exact derivatives of the free run (theory.md (8.33), (8.34)).
//!
//! ```text
//! F(θ) = min_w [ ½ Σ_k (y_k - ŷ_k)²/N + ½ λ |w|² ] + ½ κ |θ|²               theory.md (8.36)
//! ```
//!
//! `ŷ` is the measured output, scaled, at the `N` rows that are compared; the memory runs through all rows. The
//! constant and the logarithms of leaks and relaxation times bear no penalty.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use rand::RngExt;
use rayon::prelude::*;
use serde_json::json;

use crate::data::FEWEST_ROWS;
use crate::data::record::Dataset;
use crate::error::{Error, OptionError, Result};
use crate::fit::law::Identify;
use crate::fit::law::search::{
    Effort, Identified, Memory, SearchObserver, SearchProgress, spread, thinned_to,
};
use crate::fit::network::least_squares::{OutputProblem, OutputSolution};
use crate::law::Law;
use crate::law::duhem_nn::{DuhemNn, Input, LARGEST_WEIGHT, Layout, MOST_NEURONS, Run, Shape};
use crate::law::series::Series;
use crate::linear_algebra::{Gram, Symmetric};
use crate::model::input_transform::common_magnitude;
use crate::optimise::levenberg_marquardt::{LevenbergMarquardt, Problem, Rules, Slope, step_within};
use crate::optimise::multi_start::{MultiStart, Plan, Start};
use crate::optimise::random::{generator, normal};
use crate::options::classical::ClassicalOptions;
use crate::options::table::check;
use crate::stop_check::StopCheck;
use crate::termination::Termination;

/// Default number of stops.
pub(crate) const STOPS: usize = 6;

/// Default number of tanh neurons.
pub(crate) const HIDDEN: usize = 8;

/// Default number of states.
pub(crate) const STATES: usize = 3;

/// Default number of starts of the search.
const STARTS: usize = 6;

/// Default number of iterations of each start.
const EPOCHS: usize = 45;

/// λ: penalty on the squared output weights.
const RIDGE: f64 = 1e-5;

/// κ: penalty on the other squared parameters, except logarithms.
const DECAY: f64 = 1e-6;

/// Rows compared with the measured output at most.
const MOST_COMPARED: usize = 1000;

/// After so many epochs half of the starts are given up, and again after as many more.
const EPOCHS_TO_PROVE_ITSELF: usize = 12;

/// Bounds of `c`.
const PATH_LEAKS: (f64, f64) = (1e-3, 1e3);

/// First path constants `1/c`, as shares of half the range of the input.
const FIRST_PATHS: (f64, f64) = (0.03, 1.0);

/// First thresholds of the stops, as shares of half the range of the input.
const FIRST_THRESHOLDS: (f64, f64) = (0.02, 1.0);

impl Identify for DuhemNn {
    fn identify(
        data: &Dataset,
        options: &ClassicalOptions,
        observer: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<Identified<Self>> {
        data.check_identifiable(FEWEST_ROWS)?;
        let effort = Effort::of(options, STARTS, EPOCHS).validated()?;
        let task = Task::new(data, options, stop)?;
        let walk = |start| Walk::new(&task, task.random(effort.seed, start));
        let walks: Vec<Walk> = (0..effort.starts).into_par_iter().map(walk).collect();
        let mut walks = MultiStart::new(walks);
        walks.sort();
        if walks.best().value().objective == f64::INFINITY {
            return Err(Error::Stopped);
        }
        let plan =
            Plan { rounds: effort.epochs, spared: 0, to_prove_itself: EPOCHS_TO_PROVE_ITSELF, finalists: 1 };
        let tell = |walks: &MultiStart<Walk>, round| {
            let told = observer(SearchProgress {
                round,
                rounds: effort.epochs,
                evaluations: walks.evaluations(),
                train_nrmse_percent: walks.best().nrmse_percent(),
            });
            if stop.is_asked() { ControlFlow::Break(()) } else { told }
        };
        let termination = walks.run(plan, |walk, _| walk.advance(&task), tell);
        let best = walks.best();
        Ok(Identified {
            law: task.law(best.search.parameters(), &best.value().solution).validated()?,
            train_nrmse_percent: best.nrmse_percent(),
            evaluations: walks.evaluations(),
            termination,
        })
    }
}

/// The numbers of parts that are asked for.
fn shape(options: &ClassicalOptions, has_time: bool) -> Result<Shape> {
    let states = options.states.unwrap_or(STATES);
    check([("states", json!(states))])?;
    let neurons = options.hidden.unwrap_or(HIDDEN);
    if neurons == 0 || neurons > MOST_NEURONS {
        return Err(OptionError::value("hidden", neurons, format!("choose 1 to {MOST_NEURONS}")).into());
    }
    let stops = options.operators.unwrap_or(STOPS);
    if stops > MOST_NEURONS {
        return Err(OptionError::value("operators", stops, format!("choose 0 to {MOST_NEURONS}")).into());
    }
    let channels = if options.rate.is_some() { 2 } else { 1 };
    Ok(Shape { channels, stops, states, neurons, has_time: has_time && channels == 2 })
}

/// What a network is fitted to: scaled records.
struct Task<'a> {
    /// The scales, without a network.
    frame: DuhemNn,
    layout: Layout,
    /// Bounds of each parameter.
    bounds: Vec<(f64, f64)>,
    drives: Vec<Vec<Input>>,
    targets: Vec<Vec<f64>>,
    rows: usize,
    /// Mean time step and duration of the longest record.
    times: (f64, f64),
    /// Breaks evaluations off.
    stop: StopCheck<'a>,
}

impl<'a> Task<'a> {
    fn new(data: &Dataset, options: &ClassicalOptions, stop: StopCheck<'a>) -> Result<Self> {
        let series = Series::all(data, options.rate)?;
        let times = time_scales(&series);
        let layout = Layout::new(shape(options, times.1 > 0.0)?);
        let (low, high) = data.input_range(0);
        let measured = || series.iter().flat_map(|series| series.output.iter().filter(|y| !y.is_nan()));
        let (output_mean, output_scale) = spread(&measured().copied().collect::<Vec<f64>>());
        let rates = series.iter().flat_map(|series| &series.samples).map(|sample| sample.rate.abs());
        let frame = DuhemNn {
            input_centre: 0.5 * (low + high),
            input_scale: 0.5 * (high - low),
            rate_scale: options.rate.map(|_| common_magnitude(rates.collect())),
            output_mean,
            output_scale,
            cell: layout.cell(&vec![0.0; layout.count()], vec![0.0; layout.shape.terms()]),
        };
        let series = thinned_to(series, Memory::EveryRow, MOST_COMPARED);
        let scaled = |series: &Series| series.samples.iter().map(|&sample| frame.scaled(sample)).collect();
        let target = |series: &Series| {
            series.output.iter().map(|y| (y - frame.output_mean) / frame.output_scale).collect()
        };
        let drives: Vec<Vec<Input>> = series.iter().map(scaled).collect();
        let targets: Vec<Vec<f64>> = series.iter().map(target).collect();
        let rows = targets.iter().flatten().filter(|y| !y.is_nan()).count();
        let bounds = (0..layout.count()).map(|index| bounds(&layout, index, times)).collect();
        Ok(Self { frame, layout, bounds, drives, targets, rows, times, stop })
    }

    fn random(&self, seed: u64, start: usize) -> Vec<f64> {
        let mut generator = generator(seed, start);
        let Layout { shape, .. } = self.layout;
        let mut parameters = vec![0.0; self.layout.count()];
        let spread = 1.2 / (shape.inputs() as f64).sqrt();
        for place in self.layout.hidden.clone() {
            parameters[place] = spread * normal(&mut generator);
        }
        for place in self.layout.targets.clone() {
            parameters[place] = 0.1 * normal(&mut generator);
        }
        parameters[self.layout.rate_gains.clone()].fill(1.0);
        for (i, place) in self.layout.ln_path_leaks.clone().enumerate() {
            parameters[place] = -spaced(FIRST_PATHS, i, shape.states).ln();
        }
        let (step, duration) = self.times;
        let (shortest, longest) = ((2.0 * step).ln(), (0.25 * duration).max(4.0 * step).ln());
        for place in self.layout.ln_relaxation_times.clone() {
            parameters[place] = shortest + (longest - shortest) * generator.random::<f64>();
        }
        for (i, place) in self.layout.stops.clone().enumerate() {
            parameters[place] = match i < shape.stops {
                true => 1.0 / spaced(FIRST_THRESHOLDS, i, shape.stops),
                false => 0.5 * normal(&mut generator),
            };
        }
        parameters
    }

    fn law(&self, parameters: &[f64], solution: &OutputSolution) -> DuhemNn {
        let cell = self.layout.cell(parameters, solution.weights.clone());
        DuhemNn { cell, ..self.frame.clone() }
    }

    /// The Gram matrix of the terms of the output and the target, and of the Jacobian for given output weights.
    fn gram(&self, parameters: &[f64], output: Option<&[f64]>) -> Option<Gram> {
        let weights = output.map_or_else(|| vec![0.0; self.layout.shape.terms()], <[f64]>::to_vec);
        let run = Run {
            cell: &self.layout.cell(parameters, weights),
            drives: &self.drives,
            targets: &self.targets,
            with_jacobian: output.is_some(),
            stop: self.stop,
        };
        run.gram()
    }

    fn output_problem<'g>(&'g self, gram: &'g Gram) -> OutputProblem<'g> {
        OutputProblem {
            gram,
            features: self.layout.shape.terms(),
            rows: self.rows as f64,
            ridge: RIDGE,
            constant: true,
            stop: self.stop,
        }
    }

    /// The parameters with a penalty.
    fn weights<'p>(&'p self, parameters: &'p [f64]) -> impl Iterator<Item = (usize, &'p f64)> {
        parameters.iter().enumerate().filter(|(index, _)| !self.layout.is_logarithm(*index))
    }
}

/// Mean time step and duration of the longest record; 0 without time stamps.
fn time_scales(series: &[Series]) -> (f64, f64) {
    let durations = series.iter().map(|series| series.samples.iter().map(|sample| sample.step).sum::<f64>());
    let steps: usize = series.iter().map(|series| series.samples.len() - 1).sum();
    (durations.clone().sum::<f64>() / steps.max(1) as f64, durations.fold(0.0, f64::max))
}

/// Number `index` of `count` between two bounds, logarithmically spaced; a single one lies in the middle.
fn spaced((low, high): (f64, f64), index: usize, count: usize) -> f64 {
    let share = if count == 1 { 0.5 } else { index as f64 / (count - 1) as f64 };
    low * (high / low).powf(share)
}

fn bounds(layout: &Layout, index: usize, (step, duration): (f64, f64)) -> (f64, f64) {
    if layout.ln_path_leaks.contains(&index) {
        (PATH_LEAKS.0.ln(), PATH_LEAKS.1.ln())
    } else if layout.ln_relaxation_times.contains(&index) {
        ((0.1 * step).ln(), (100.0 * duration).ln())
    } else {
        (-LARGEST_WEIGHT, LARGEST_WEIGHT)
    }
}

/// The objective at a point, with the output weights there; infinite if it was broken off.
#[derive(Debug, Clone)]
struct Value {
    objective: f64,
    mean_square: f64,
    solution: OutputSolution,
}

impl Problem for Task<'_> {
    type Value = Value;
    type Curvature = Symmetric;
    const RULES: Rules = Rules::SMOOTH;

    fn value(&self, parameters: &[f64]) -> Value {
        let solution = match self.gram(parameters, None) {
            Some(gram) => self.output_problem(&gram).solve(),
            None => OutputSolution::broken_off(self.layout.shape.terms()),
        };
        let decay: f64 = self.weights(parameters).map(|(_, w)| w * w).sum();
        let objective = solution.objective + 0.5 * DECAY * decay;
        Value { objective, mean_square: solution.mean_square, solution }
    }

    fn objective(value: &Value) -> f64 {
        value.objective
    }

    fn slope(&self, parameters: &[f64], value: &Value) -> Option<Slope<Symmetric>> {
        let gram = self.gram(parameters, Some(&value.solution.weights))?;
        let (mut gradient, mut curvature) =
            self.output_problem(&gram).linearise(&value.solution, parameters.len());
        for (index, weight) in self.weights(parameters) {
            gradient[index] += DECAY * weight;
            curvature.add_to_diagonal(index, DECAY);
        }
        let diagonal = (0..gradient.len()).map(|index| curvature.diagonal(index)).collect();
        (!self.stop.is_asked()).then_some(Slope { gradient, diagonal, curvature, evaluations: 1 })
    }

    fn step(&self, slope: &Slope<Symmetric>, parameters: &[f64], damping: &[f64]) -> Option<Vec<f64>> {
        let leaves = |i: usize, by: f64| {
            let (low, high) = self.bounds[i];
            parameters[i] <= low && by < 0.0 || parameters[i] >= high && by > 0.0
        };
        step_within(&slope.curvature, &slope.gradient, damping, leaves, self.stop)
    }

    fn limit(&self, parameters: &mut [f64]) {
        for (parameter, &(low, high)) in parameters.iter_mut().zip(&self.bounds) {
            *parameter = parameter.clamp(low, high);
        }
    }

    fn stop(&self) -> StopCheck<'_> {
        self.stop
    }
}

/// A start on its way.
struct Walk {
    search: LevenbergMarquardt<Value>,
    ended: Option<Termination>,
}

impl Walk {
    fn new(task: &Task<'_>, parameters: Vec<f64>) -> Self {
        Self { search: LevenbergMarquardt::new(task, parameters), ended: None }
    }

    fn advance(&mut self, task: &Task<'_>) {
        if self.ended.is_none() {
            self.ended = self.search.advance(task);
        }
    }

    fn value(&self) -> &Value {
        self.search.known_value().expect("a walk begins at a known value")
    }

    fn nrmse_percent(&self) -> f64 {
        100.0 * self.value().mean_square.sqrt()
    }
}

impl Start for Walk {
    fn order(&self, other: &Self) -> Ordering {
        self.value().objective.total_cmp(&other.value().objective)
    }

    fn evaluations(&self) -> usize {
        self.search.evaluations()
    }

    fn ended(&self) -> Option<Termination> {
        self.ended
    }
}

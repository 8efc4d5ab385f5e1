//! Identification of a neuro-Madelung model, from random networks: first with the measured output at every
//! turning point (teacher forcing), then in free run, in which errors at turning points propagate into the
//! branches. The error of a free run on held-out data selects the start, because a network with a small
//! training error may amplify such errors. The best is trained on all data for a few further epochs.
//!
//! ```text
//! dy/dθ = (x - x_t) ∂N/∂θ + [1 + (x - x_t) ∂N/∂y_t] dy_t/dθ                 theory.md (8.21)
//! ```
//!
//! `θ` are the parameters, `N` the network and `(x_t, y_t)` the turning point at which the branch began.
//! `dy_t/dθ` is stored with each turning point, so the derivative of the free run is exact.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use hysid_core::elementary::tanh;

use crate::data::FEWEST_ROWS;
use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::law::Identify;
use crate::fit::law::grids::check_count;
use crate::fit::law::search::{IdentifiedLaw, MemoryKind, check_effort, measured, spread, thinned};
use crate::fit::progress::{PartialLaw, SearchObserver, SearchProgress};
use crate::law::neuro_madelung::{BranchNetwork, LARGEST_WEIGHT, MOST_HIDDEN, NeuroMadelung, argument};
use crate::law::series::Series;
use crate::law::turning_point_stack::{TurningPoint, TurningPointStack};
use crate::law::{Classical, Law};
use crate::linear_algebra::{Symmetric, dot};
use crate::optimise::levenberg_marquardt::{
    DescentSettings, LeastSquaresProblem, LevenbergMarquardt, Slope, damped_step,
};
use crate::optimise::multi_start::{MultiStart, RoundPlan, SearchStart};
use crate::optimise::parallel;
use crate::optimise::random::{generator, normal};
use crate::options::classical::ClassicalOptions;
use crate::stop_check::{Pace, StopCheck};
use crate::termination::Termination;

/// Weight of the squared parameters beside the mean square error of the scaled output.
const DECAY: f64 = 1e-5;
/// Share of the data that the starts are validated on.
const HELD_OUT: f64 = 0.25;
/// Epochs of free run after which half of the starts are given up, and again after as many more.
const EPOCHS_TO_PROVE_ITSELF: usize = 8;

impl Identify for NeuroMadelung {
    fn identify(
        data: &Dataset,
        options: &ClassicalOptions,
        observer: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<IdentifiedLaw<Self>> {
        data.check_identifiable(FEWEST_ROWS)?;
        check_count("hidden", options.hidden(), MOST_HIDDEN)?;
        check_effort(options)?;
        let frame = frame(data, options)?;
        let whole = MadelungTask::new(&frame, data, options, stop)?;
        let Some((kept, held)) = data.split_for_validation(HELD_OUT) else {
            return MadelungTraining::new(&whole, &whole, options).run(&whole, observer);
        };
        let (kept, held) = (
            MadelungTask::new(&frame, &kept, options, stop)?,
            MadelungTask::new(&frame, &held, options, stop)?,
        );
        MadelungTraining::new(&kept, &held, options).run(&whole, observer)
    }
}

struct MadelungTraining<'a> {
    /// Training and validation data.
    kept: &'a MadelungTask<'a>,
    held: &'a MadelungTask<'a>,
    walks: MultiStart<MadelungWalk>,
    epochs: usize,
}

impl<'a> MadelungTraining<'a> {
    fn new(kept: &'a MadelungTask<'a>, held: &'a MadelungTask<'a>, options: &ClassicalOptions) -> Self {
        let walks =
            parallel::numbered(options.starts(), |start| MadelungWalk::new(kept, options.seed, start));
        Self { kept, held, walks: MultiStart::new(walks), epochs: options.epochs() }
    }

    fn run(
        mut self,
        whole: &MadelungTask<'_>,
        observer: &mut SearchObserver<'_>,
    ) -> Result<IdentifiedLaw<NeuroMadelung>> {
        self.walks.sort();
        if self.walks.best().value().objective == f64::INFINITY {
            return Err(Error::Stopped);
        }
        let last = (self.epochs / 6).max(1);
        let rounds = self.epochs + last;
        let mut termination = self.epochs(rounds, whole.stop, observer);
        // A training that was stopped early has not judged any free run; there may be no time for it.
        for walk in self.walks.starts_mut().iter_mut().filter(|walk| walk.best.is_none()) {
            if !whole.stop.is_asked() {
                walk.set_free(self.kept);
                walk.judge(self.held);
            }
        }
        self.walks.sort();
        // What was held out is learnt from where it was judged best, in few epochs.
        let mut walk = MadelungWalk::at(whole, self.walks.best().best_parameters().to_vec());
        for epoch in 1..=last {
            if termination == Termination::Stopped {
                break;
            }
            walk.advance(whole);
            let law = || whole.so_far(walk.parameters());
            let told = SearchProgress {
                train_nrmse_percent: walk.nrmse_percent(),
                law: PartialLaw(Some(&law)),
                ..progress(&self.walks, self.epochs + epoch, rounds)
            };
            if observer(told) == ControlFlow::Break(()) || whole.stop.is_asked() {
                termination = Termination::Stopped;
            }
            if let Some(ended) = walk.ended {
                termination = ended;
                break;
            }
        }
        let law = whole.law(walk.parameters()).validated()?;
        let evaluations = self.walks.evaluations() + walk.evaluations();
        let train_nrmse_percent = walk.nrmse_percent();
        Ok(IdentifiedLaw { law, train_nrmse_percent, evaluations, termination, searched: Vec::new() })
    }

    /// Half of the epochs teacher forced, then the others in free run; the observer is called for `rounds` in all.
    fn epochs(
        &mut self,
        rounds: usize,
        stop: StopCheck<'_>,
        observer: &mut SearchObserver<'_>,
    ) -> Termination {
        let Self { kept, held, ref mut walks, epochs } = *self;
        let forced = epochs / 2;
        let plan = RoundPlan {
            rounds: epochs,
            spared: forced,
            to_prove_itself: EPOCHS_TO_PROVE_ITSELF,
            finalists: 1,
        };
        let advance = |walk: &mut MadelungWalk, epoch| {
            if epoch == forced + 1 {
                walk.set_free(kept);
            }
            walk.advance(kept);
            if epoch > forced {
                walk.judge(held);
            }
        };
        let tell = |walks: &MultiStart<MadelungWalk>, epoch| {
            let law = || kept.so_far(walks.best().best_parameters());
            let mut told = SearchProgress { law: PartialLaw(Some(&law)), ..progress(walks, epoch, rounds) };
            if epoch <= forced {
                // With the measured output at every turning point it is no error of a free run.
                (told.train_nrmse_percent, told.law) = (f64::NAN, PartialLaw(None));
            }
            let flow = observer(told);
            if stop.is_asked() { ControlFlow::Break(()) } else { flow }
        };
        match walks.run(plan, advance, tell) {
            Termination::Stopped => Termination::Stopped,
            // How the whole ends, what follows tells.
            _ => Termination::EpochsUsed,
        }
    }
}

fn progress(walks: &MultiStart<MadelungWalk>, round: usize, rounds: usize) -> SearchProgress<'static> {
    let train_nrmse_percent = walks.best().nrmse_percent();
    let evaluations = walks.evaluations();
    SearchProgress { round, rounds, evaluations, train_nrmse_percent, law: PartialLaw(None) }
}

/// A model with its scales and without a network.
fn frame(data: &Dataset, options: &ClassicalOptions) -> Result<NeuroMadelung> {
    let (low, high) = data.input_range(0);
    let series = Series::all(data, options.rate)?;
    let (output_mean, output_scale) = spread(&measured(&series));
    let samples = series.iter().flat_map(|series| &series.samples);
    let rate = samples.map(|sample| sample.rate.abs()).fold(1e-100, f64::max);
    Ok(NeuroMadelung {
        input_scale: low.abs().max(high.abs()),
        rate_scale: options.rate.map(|_| rate),
        output_mean,
        output_scale,
        output_range: data.output_range(),
        hidden: Vec::new(),
        output: Vec::new(),
        virgin_output: 0.0,
    })
}

/// Scaled records that a start is trained or validated on.
struct MadelungTask<'a> {
    frame: &'a NeuroMadelung,
    series: Vec<Series>,
    hidden: usize,
    stop: StopCheck<'a>,
}

/// A turning point: the output there and its derivatives by all parameters.
#[derive(Debug, Clone)]
struct ReachedTurn {
    y: f64,
    by_parameters: Vec<f64>,
}

/// Residuals, and the derivatives by each parameter on request.
struct MadelungSweep {
    residual: Vec<f64>,
    jacobian: Vec<Vec<f64>>,
    /// It ran over all rows.
    is_complete: bool,
}

impl<'a> MadelungTask<'a> {
    fn new(
        frame: &'a NeuroMadelung,
        data: &Dataset,
        options: &ClassicalOptions,
        stop: StopCheck<'a>,
    ) -> Result<Self> {
        // The rate is an input of the network and no part of the memory.
        let mut series = thinned(Series::all(data, options.rate)?, MemoryKind::TurningPoints);
        for series in &mut series {
            for sample in &mut series.samples {
                (sample.x, sample.rate) = frame.scaled(*sample);
            }
            for y in &mut series.output {
                *y = (*y - frame.output_mean) / frame.output_scale;
            }
        }
        Ok(Self { frame, series, hidden: options.hidden(), stop })
    }

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

    fn so_far(&self, parameters: &[f64]) -> Option<Classical> {
        self.law(parameters).validated().ok().map(Into::into)
    }

    fn random(&self, seed: u64, start: usize) -> Vec<f64> {
        let mut generator = generator(seed, start);
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

    /// Runs over all records, unless stopped; `forced` takes the measured output at turning points where there is one.
    fn sweep(&self, parameters: &[f64], forced: bool, slopes: bool) -> MadelungSweep {
        let law = self.law(parameters);
        let branch = law.branch();
        let n = parameters.len();
        let jacobian = vec![Vec::new(); if slopes { n } else { 0 }];
        let mut sweep = MadelungSweep { residual: Vec::new(), jacobian, is_complete: false };
        let mut pace = Pace::new(self.stop);
        let operations = if slopes { 10 * n } else { 30 * self.hidden };
        let width = if slopes { n } else { 0 };
        for series in &self.series {
            let mut by_parameters = vec![0.0; width];
            if let Some(last) = by_parameters.last_mut() {
                *last = 1.0; // of y_0 itself
            }
            let virgin = TurningPoint { x: 0.0, value: ReachedTurn { y: law.virgin_output, by_parameters } };
            let mut memory = TurningPointStack::default();
            for (sample, &measured) in series.samples.iter().zip(&series.output) {
                if pace.is_over(operations) {
                    return sweep;
                }
                // What is reached there follows from the branch.
                memory.advance(sample.x, ReachedTurn { y: 0.0, by_parameters: Vec::new() });
                let TurningPoint { x: x_t, value: reached } = memory.points().last().unwrap_or(&virgin);
                let inputs = [sample.x, *x_t, reached.y, sample.rate];
                let inputs = &inputs[..self.inputs()];
                let mut here = if slopes {
                    derivatives(branch, inputs, &reached.by_parameters)
                } else {
                    ReachedTurn { y: branch.value(inputs), by_parameters: Vec::new() }
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
                memory.set_value(here);
            }
        }
        sweep.is_complete = true;
        sweep
    }
}

/// The output and its derivatives, `dy/dθ = (x - x_t) ∂N/∂θ + [1 + (x - x_t) ∂N/∂y_t] dy_t/dθ` (theory.md
/// (8.21)).
fn derivatives(branch: BranchNetwork<'_>, inputs: &[f64], at_turning_point: &[f64]) -> ReachedTurn {
    let run = branch.run();
    let neurons = branch.output.len() - 1;
    let along = inputs[0] - inputs[1];
    let mut all = vec![0.0; at_turning_point.len()];
    let (hidden, rest) = all.split_at_mut(neurons * run);
    let mut slope = branch.output[0];
    let seen = branch.seen(inputs);
    let seen = &seen[..inputs.len()];
    let mut by_y_t = 0.0;
    rest[0] = along;
    for (index, neuron) in branch.hidden.chunks_exact(run).enumerate() {
        let h = tanh(argument(neuron, seen));
        let c = branch.output[1 + index];
        slope += c * h; // (8.20)
        rest[1 + index] = along * h;
        let back = c * (1.0 - h * h);
        by_y_t += back * neuron[3];
        let weights = &mut hidden[index * run..(index + 1) * run];
        weights[0] = along * back;
        for (weight, input) in weights[1..].iter_mut().zip(seen) {
            *weight = along * back * input; // (8.21): (x - x_t) ∂N/∂U
        }
    }
    let free = inputs[2] + along * slope; // (8.19)
    let y = branch.limited(free);
    if y != free {
        all.fill(0.0);
        return ReachedTurn { y, by_parameters: all };
    }
    let by_y_t = if seen[2] == inputs[2] { by_y_t } else { 0.0 };
    let carried = 1.0 + along * by_y_t; // (8.21): 1 + (x - x_t) ∂N/∂y_t
    for (slope, before) in all.iter_mut().zip(at_turning_point) {
        *slope += carried * before; // (8.21)
    }
    ReachedTurn { y, by_parameters: all }
}

/// The error of a task as a function of the parameters, which count as well.
struct MadelungObjective<'a, 't> {
    task: &'a MadelungTask<'t>,
    /// With the measured output at every turning point.
    forced: bool,
}

/// The objective at a point; infinite if it was broken off.
#[derive(Debug, Clone, Copy)]
struct MadelungValue {
    objective: f64,
    mean_square: f64,
}

impl LeastSquaresProblem for MadelungObjective<'_, '_> {
    type Value = MadelungValue;
    type Curvature = Symmetric;
    const RULES: DescentSettings = DescentSettings { damping: (1e-12, 1e8), ..DescentSettings::KINKED };

    fn value(&self, parameters: &[f64]) -> MadelungValue {
        let broken_off = MadelungValue { objective: f64::INFINITY, mean_square: f64::INFINITY };
        if self.task.stop.is_asked() {
            return broken_off;
        }
        let MadelungSweep { residual, is_complete, .. } = self.task.sweep(parameters, self.forced, false);
        if !is_complete {
            return broken_off;
        }
        let mean_square = dot(&residual, &residual) / residual.len() as f64;
        let objective = 0.5 * (mean_square + DECAY * dot(parameters, parameters));
        MadelungValue { objective, mean_square }
    }

    fn objective(value: &MadelungValue) -> f64 {
        value.objective
    }

    fn slope(&self, parameters: &[f64], _: &MadelungValue) -> Option<Slope<Symmetric>> {
        let MadelungSweep { residual, jacobian, is_complete } =
            self.task.sweep(parameters, self.forced, true);
        if !is_complete {
            return None;
        }
        let n = parameters.len();
        let rows = residual.len() as f64;
        let curvature = Symmetric::from_fn(n, |i, j| {
            dot(&jacobian[i], &jacobian[j]) / rows + if i == j { DECAY } else { 0.0 }
        });
        Some(Slope {
            gradient: (0..n).map(|i| dot(&jacobian[i], &residual) / rows + DECAY * parameters[i]).collect(),
            diagonal: (0..n).map(|i| curvature.diagonal(i)).collect(),
            curvature,
            evaluations: 1,
        })
    }

    fn step(&self, slope: &Slope<Symmetric>, _: &[f64], damping: &[f64]) -> Option<Vec<f64>> {
        damped_step(&slope.curvature, &slope.gradient, damping, StopCheck::never())
    }

    fn limit(&self, parameters: &mut [f64]) {
        parameters.iter_mut().for_each(|p| *p = p.clamp(-LARGEST_WEIGHT, LARGEST_WEIGHT));
    }

    fn stop(&self) -> StopCheck<'_> {
        self.task.stop
    }
}

struct MadelungWalk {
    search: LevenbergMarquardt<MadelungValue>,
    forced: bool,
    /// Evaluations of what was held out, and of the search before this one.
    further_evaluations: usize,
    ended: Option<Termination>,
    /// Smallest error of a free run on what was held out, and where it was.
    best: Option<(f64, Vec<f64>)>,
}

impl MadelungWalk {
    fn new(task: &MadelungTask<'_>, seed: u64, start: usize) -> Self {
        Self::from(task, task.random(seed, start), true)
    }

    /// In free run from the beginning.
    fn at(task: &MadelungTask<'_>, parameters: Vec<f64>) -> Self {
        Self::from(task, parameters, false)
    }

    fn from(task: &MadelungTask<'_>, parameters: Vec<f64>, forced: bool) -> Self {
        let search = LevenbergMarquardt::new(&MadelungObjective { task, forced }, parameters);
        Self { search, forced, further_evaluations: 0, ended: None, best: None }
    }

    /// From teacher forcing to free run.
    fn set_free(&mut self, task: &MadelungTask<'_>) {
        if self.forced {
            self.further_evaluations = SearchStart::evaluations(self);
            let parameters = self.parameters().to_vec();
            self.search = LevenbergMarquardt::new(&MadelungObjective { task, forced: false }, parameters);
            (self.forced, self.ended) = (false, None);
        }
    }

    /// Remembers the parameters if they do better than any before on what was held out.
    fn judge(&mut self, held: &MadelungTask<'_>) {
        let MadelungSweep { residual, is_complete, .. } = held.sweep(self.parameters(), false, false);
        if !is_complete {
            return;
        }
        let error = dot(&residual, &residual) / residual.len() as f64;
        self.further_evaluations += 1;
        if self.best.as_ref().is_none_or(|(best, _)| error < *best) {
            self.best = Some((error, self.parameters().to_vec()));
        }
    }

    fn advance(&mut self, task: &MadelungTask<'_>) {
        if self.ended.is_none() {
            self.ended = self.search.advance(&MadelungObjective { task, forced: self.forced });
        }
    }

    fn parameters(&self) -> &[f64] {
        self.search.parameters()
    }

    fn value(&self) -> &MadelungValue {
        self.search.known_value().expect("a walk begins at a known value")
    }

    /// Where a free run over held-out data has the smallest error; the present place if it was not validated.
    fn best_parameters(&self) -> &[f64] {
        self.best.as_ref().map_or(self.parameters(), |(_, parameters)| parameters)
    }

    fn nrmse_percent(&self) -> f64 {
        100.0 * self.value().mean_square.sqrt()
    }
}

impl SearchStart for MadelungWalk {
    /// By the error on held-out data once there is one.
    fn order(&self, other: &Self) -> Ordering {
        let rank =
            |walk: &MadelungWalk| walk.best.as_ref().map_or(walk.value().objective, |(error, _)| *error);
        let is_judged = |walk: &MadelungWalk| walk.best.is_some();
        is_judged(other).cmp(&is_judged(self)).then(rank(self).total_cmp(&rank(other)))
    }

    fn evaluations(&self) -> usize {
        self.search.evaluations() + self.further_evaluations
    }

    fn ended(&self) -> Option<Termination> {
        self.ended
    }
}

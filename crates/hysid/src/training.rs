//! Identification: from a data set to a fitted network.
//!
//! [`fit`] is the whole of it: scale, start from several random networks, let each descend, judge
//! them on data that were held out, and train the best on everything.

pub mod least_squares;
pub mod levenberg_marquardt;
pub mod objective;
pub mod start;
pub mod termination;

use std::ops::ControlFlow;
use std::sync::Mutex;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::metrics::{ErrorSums, Errors};
use crate::model::{Model, Provenance};
use crate::network::{Architecture, Family, Network, Sizes};
use crate::rate::RateMethod;
use crate::record::Dataset;
use crate::scaling::Scaling;
use levenberg_marquardt::Descent;
use objective::{Objective, Regularisation};
pub use termination::Termination;

/// Fewest rows with an output that a model is identified from.
pub const FEWEST_ROWS: usize = 10;

/// Most iterations of a start.
const MOST_EPOCHS: usize = 1_000_000;

/// What the user can choose; every field has the name of its command-line option.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitOptions {
    /// The network family.
    pub model: Family,
    /// Numbers of neurons.
    #[serde(flatten)]
    pub sizes: Sizes,
    /// Stops do not deteriorate, whatever the family.
    pub no_deterioration: bool,
    /// How the rate is found; `None` for no rate.
    pub rate: Option<RateMethod>,
    /// Random networks to start from.
    pub starts: usize,
    /// Levenberg-Marquardt iterations of each start; the winner gets as many again on all data.
    pub epochs: usize,
    /// Seed of the random starts.
    pub seed: u64,
    /// Share of the data held out to choose among the starts.
    pub validation: f64,
    /// Penalties on the weights.
    #[serde(flatten)]
    pub regularisation: Regularisation,
    /// Scored rows that early iterations use at most; the memory runs through every row, and the last
    /// iterations see all.
    pub thin: usize,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            model: Family::XpnnPlus,
            sizes: Sizes::default(),
            no_deterioration: false,
            rate: None,
            starts: 8,
            epochs: 40,
            seed: 1,
            validation: 0.25,
            regularisation: Regularisation::default(),
            thin: 20_000,
        }
    }
}

/// Where a fit is, told to the observer after every iteration.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// What is being done.
    pub phase: Phase,
    /// Start, counted from 0; the chosen one in the last phase.
    pub start: usize,
    /// Iterations done by this start in this phase.
    pub epoch: usize,
    /// Error on the training rows, in percent of the output's standard deviation.
    pub train_nrmse_percent: f64,
    /// Share of the work done, 0 to 1, if every start takes all its iterations.
    pub done: f64,
}

/// A part of the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// The random starts, on the training part.
    Starts,
    /// The chosen start, on all data.
    Refit,
}

/// One point of a training history.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HistoryPoint {
    /// Iteration.
    pub epoch: usize,
    /// Error on the training rows, in percent of the output's standard deviation.
    pub train_nrmse_percent: f64,
}

/// What became of one start, or of the refit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Which part of the fit it is.
    pub phase: Phase,
    /// Start, counted from 0.
    pub start: usize,
    /// Error after each iteration.
    pub history: Vec<HistoryPoint>,
    /// Why it ended.
    pub termination: Termination,
    /// Error on the data held out, in percent of their standard deviation.
    pub validation_nrmse_percent: Option<f64>,
}

/// A fitted model and how it came about.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The model.
    pub model: Model,
    /// Evaluations of the objective, all starts together.
    pub evaluations: usize,
}

/// Identifies a network.
///
/// `observer` is told of every iteration and may stop the fit by breaking: the best model so far is
/// then returned, with [`Termination::Stopped`]. The result depends on data, options and seed only,
/// not on the number of threads.
///
/// # Errors
/// Data that nothing can be identified from, or options outside their meaning.
pub fn fit(
    data: &Dataset,
    options: &FitOptions,
    observer: &mut (dyn FnMut(&Progress) -> ControlFlow<()> + Send),
) -> Result<Fit> {
    data.check_identifiable(FEWEST_ROWS)?;
    let architecture = architecture(data, options)?;
    let scaling = Scaling::of(data, options.rate)?;
    let watch = Watch { observer: Mutex::new(observer), options, finished: Mutex::new(0) };

    let split =
        data.split_for_validation(options.validation).filter(|(kept, _)| kept.scored() >= FEWEST_ROWS);
    let (kept, held_out) = match &split {
        Some((kept, held_out)) => (kept, Some(held_out)),
        None => (data, None),
    };
    let objective = Objective::new(kept, &scaling, architecture, options)?;
    let judged: Vec<Judged> = (0..options.starts)
        .into_par_iter()
        .map(|start| {
            let parameters = start::random(&objective, options.seed, start);
            let descent = watch.descend(&objective.thinned(options.thin), Phase::Starts, start, parameters);
            let network = descent.network(&architecture)?;
            let validation = match held_out {
                Some(held_out) => errors_of(&network, held_out, &scaling, options.rate)?,
                None => errors_of(&network, kept, &scaling, options.rate)?,
            };
            Ok(Judged { start, descent, validation })
        })
        .collect::<Result<_>>()?;
    let best = judged
        .iter()
        .min_by(|a, b| a.validation.mse.total_cmp(&b.validation.mse))
        .ok_or_else(|| Error::Option("a fit needs at least one start".into()))?;

    let mut runs: Vec<Run> = judged.iter().map(|judged| judged.run(held_out.is_some())).collect();
    let mut evaluations: usize = judged.iter().map(|judged| judged.descent.evaluations).sum();
    let mut network = best.descent.network(&architecture)?;
    let mut termination = best.descent.termination;
    if !watch.stopped() {
        let objective = Objective::new(data, &scaling, architecture, options)?;
        let descent = watch.refit(&objective, options.seed, best);
        network = descent.network(&architecture)?;
        termination = descent.termination;
        evaluations += descent.evaluations;
        runs.push(Judged::refit(best.start, descent));
    }
    if watch.stopped() {
        termination = Termination::Stopped;
    }
    let provenance = Provenance {
        trainer: "levenberg-marquardt".into(),
        options: options.clone(),
        samples: data.scored(),
        records: data.records().len(),
        chosen_start: best.start,
        termination,
        runs,
        train: errors_of(&network, data, &scaling, options.rate)?,
        validation: held_out.is_some().then(|| best.validation.clone()),
    };
    let model = Model::new(options.model, network, scaling, options.rate, data, provenance)?;
    Ok(Fit { model, evaluations })
}

/// The architecture that options and data ask for.
fn architecture(data: &Dataset, options: &FitOptions) -> Result<Architecture> {
    if !(options.validation > 0.0 && options.validation < 1.0) {
        return Err(Error::Option(format!("validation {} is not between 0 and 1", options.validation)));
    }
    if options.starts == 0 || options.starts > 10_000 {
        return Err(Error::Option(format!("{} starts: choose 1 to 10000", options.starts)));
    }
    if options.epochs > MOST_EPOCHS {
        return Err(Error::Option(format!("{} epochs are too many: at most {MOST_EPOCHS}", options.epochs)));
    }
    options.regularisation.check()?;
    let inputs = data.names().inputs.len();
    let rate = options.rate.is_some();
    let mut architecture = Architecture::new(options.model, options.sizes, inputs, rate, data.has_time())?;
    architecture.deterioration &= !options.no_deterioration;
    Ok(architecture)
}

/// Errors of a free run over a data set, in the user's unit.
fn errors_of(
    network: &Network,
    data: &Dataset,
    scaling: &Scaling,
    rate: Option<RateMethod>,
) -> Result<Errors> {
    let mut sums = ErrorSums::default();
    let mut simulator = network.simulator();
    for record in data.records().iter().filter(|record| record.scored() > 0) {
        let drive = scaling.drive(record, network.architecture(), rate)?;
        let u: Vec<&[f64]> = drive.channels.iter().map(Vec::as_slice).collect();
        let mut y = vec![0.0; drive.len()];
        simulator.reset();
        simulator.run(&u, &drive.steps, &mut y);
        y.iter_mut().for_each(|y| *y = scaling.output(*y));
        sums.add(record.output(), &y);
    }
    sums.errors(&data.names().output)
        .ok_or_else(|| data.records()[0].defect(None, None, crate::error::DataProblem::NothingToScore))
}

/// A descent and how well it does on the data held out.
struct Judged {
    start: usize,
    descent: Descent,
    validation: Errors,
}

impl Judged {
    fn run(&self, held_out: bool) -> Run {
        Run {
            validation_nrmse_percent: self.validation.nrmse_std_percent.filter(|_| held_out),
            ..Self::run_of(Phase::Starts, self.start, &self.descent)
        }
    }

    fn refit(start: usize, descent: Descent) -> Run {
        Self::run_of(Phase::Refit, start, &descent)
    }

    fn run_of(phase: Phase, start: usize, descent: &Descent) -> Run {
        Run {
            phase,
            start,
            history: descent.history.clone(),
            termination: descent.termination,
            validation_nrmse_percent: None,
        }
    }
}

/// The one observer, shared by all starts.
struct Watch<'a> {
    observer: Mutex<&'a mut (dyn FnMut(&Progress) -> ControlFlow<()> + Send)>,
    options: &'a FitOptions,
    /// Iterations that all runs together have done or will not need; `usize::MAX` once stopped.
    finished: Mutex<usize>,
}

/// Descents of the refit.
const REFITS: usize = 2;

/// Iterations of the refit that see every row.
const LAST_EPOCHS_ON_ALL_ROWS: usize = 4;

impl Watch<'_> {
    fn stopped(&self) -> bool {
        *self.finished.lock().expect("no thread panics with the lock") == usize::MAX
    }

    /// One descent on an objective, told to the observer.
    fn descend(&self, objective: &Objective, phase: Phase, start: usize, parameters: Vec<f64>) -> Descent {
        let epochs = self.options.epochs;
        let mut told = 0;
        let descent =
            levenberg_marquardt::descend(objective, parameters, epochs, |epoch, train_nrmse_percent| {
                told += 1;
                self.tell(phase, start, epoch, train_nrmse_percent, 1)
            });
        let mut finished = self.finished.lock().expect("no thread panics with the lock");
        *finished = finished.saturating_add(epochs.saturating_sub(told));
        descent
    }

    /// The winner on all data: thinned first if they are many, then on every row.
    ///
    /// It goes on from where it was judged, and once more from its random beginning, because data that
    /// were held out may lie beyond a barrier from there; the lower objective wins.
    fn refit(&self, objective: &Objective, seed: u64, best: &Judged) -> Descent {
        let thinned = objective.thinned(self.options.thin);
        let (onward, anew) = rayon::join(
            || self.descend(&thinned, Phase::Refit, best.start, best.descent.parameters.clone()),
            || self.descend(&thinned, Phase::Refit, best.start, start::random(&thinned, seed, best.start)),
        );
        let evaluations = onward.evaluations + anew.evaluations;
        let mut first = if anew.objective < onward.objective { anew } else { onward };
        first.evaluations = evaluations;
        if objective.scored() == thinned.scored() || self.stopped() {
            return first;
        }
        let parameters = first.parameters.clone();
        let last =
            levenberg_marquardt::descend(objective, parameters, LAST_EPOCHS_ON_ALL_ROWS, |epoch, nrmse| {
                self.tell(Phase::Refit, best.start, self.options.epochs + epoch, nrmse, 0)
            });
        let done = first.history.last().map_or(0, |point| point.epoch);
        let on_all_rows = last.history.iter().skip(1);
        first.history.extend(on_all_rows.map(|point| HistoryPoint { epoch: done + point.epoch, ..*point }));
        Descent { history: first.history, evaluations: evaluations + last.evaluations, ..last }
    }

    fn tell(&self, phase: Phase, start: usize, epoch: usize, nrmse: f64, weight: usize) -> ControlFlow<()> {
        let mut finished = self.finished.lock().expect("no thread panics with the lock");
        if *finished == usize::MAX {
            return ControlFlow::Break(());
        }
        *finished += weight;
        let all = (self.options.starts + REFITS) * self.options.epochs;
        let progress = Progress {
            phase,
            start,
            epoch,
            train_nrmse_percent: nrmse,
            done: *finished as f64 / all.max(1) as f64,
        };
        let mut observer = self.observer.lock().expect("no thread panics with the lock");
        let flow = observer(&progress);
        if flow.is_break() {
            *finished = usize::MAX;
        }
        flow
    }
}

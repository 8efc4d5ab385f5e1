//! Identification: from a data set to a fitted network.
//!
//! [`fit`] is the whole of it: scale, start from several random networks, let each descend, judge
//! them on data that were held out, and train the best few on everything.

pub mod history;
pub mod least_squares;
pub mod levenberg_marquardt;
pub mod objective;
pub mod options;
pub mod start;
pub mod termination;

use std::ops::ControlFlow;
use std::sync::Mutex;

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::free_run::FreeRun;
use crate::metrics::Errors;
use crate::model::{Model, Provenance};
use crate::record::Dataset;
use crate::scaling::Scaling;
pub use history::{HistoryPoint, Phase, Run};
use levenberg_marquardt::Descent;
use objective::Objective;
pub use options::{FitOptions, Regularisation};
pub use termination::Termination;

/// Fewest rows with an output that a model is identified from.
pub const FEWEST_ROWS: usize = 10;

/// Most iterations of a start.
const MOST_EPOCHS: usize = 1_000_000;

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

/// Who is told of the progress, and may break off.
pub type Observer<'a> = dyn FnMut(&Progress) -> ControlFlow<()> + Send + 'a;

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
pub fn fit(data: &Dataset, options: &FitOptions, observer: &mut Observer<'_>) -> Result<Fit> {
    data.check_identifiable(FEWEST_ROWS)?;
    check(options)?;
    let architecture = options.architecture(data)?;
    let scaling = Scaling::of(data, options.rate)?;
    let watch = Watch { observer: Mutex::new(observer), options, finished: Mutex::new(0) };

    let split =
        data.split_for_validation(options.validation).filter(|(kept, _)| kept.scored() >= FEWEST_ROWS);
    let (kept, held_out) = match &split {
        Some((kept, held_out)) => (kept, Some(held_out)),
        None => (data, None),
    };
    let objective = Objective::new(kept, &scaling, architecture, options)?;
    let thinned = objective.thinned(options.thin);
    let judged: Vec<Judged> = (0..options.starts)
        .into_par_iter()
        // Once stopped, starts not yet begun are left out; one is needed.
        .filter(|&start| start == 0 || !watch.stopped())
        .map(|start| {
            let descent =
                watch.descend(&thinned, Phase::Starts, start, start::random(&thinned, options.seed, start));
            let network = descent.network(&architecture)?;
            let judge = held_out.unwrap_or(kept);
            let validation = FreeRun::new(&network, &scaling, options.rate).errors(judge)?;
            Ok(Judged { start, descent, validation })
        })
        .collect::<Result<_>>()?;
    let mut finalists: Vec<&Judged> = judged.iter().collect();
    finalists.sort_by(|a, b| a.validation.mse.total_cmp(&b.validation.mse));
    finalists.truncate(FINALISTS);
    let mut best = finalists[0];

    let mut runs: Vec<Run> = judged.iter().map(|judged| judged.run(held_out.is_some())).collect();
    let mut evaluations: usize = judged.iter().map(|judged| judged.descent.evaluations).sum();
    let mut network = best.descent.network(&architecture)?;
    let mut termination = best.descent.termination;
    if !watch.stopped() {
        let objective = Objective::new(data, &scaling, architecture, options)?;
        let (winner, descent) = watch.refit(&objective, options.seed, &finalists);
        best = finalists[winner];
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
        train: FreeRun::new(&network, &scaling, options.rate).errors(data)?,
        validation: held_out.is_some().then(|| best.validation.clone()),
    };
    let model = Model::new(options.model, network, scaling, options.rate, data, provenance)?;
    Ok(Fit { model, evaluations })
}

/// Refuses options outside their meaning.
fn check(options: &FitOptions) -> Result<()> {
    if !(options.validation > 0.0 && options.validation < 1.0) {
        return Err(Error::Option(format!("validation {} is not between 0 and 1", options.validation)));
    }
    if options.starts == 0 || options.starts > 10_000 {
        return Err(Error::Option(format!("{} starts: choose 1 to 10000", options.starts)));
    }
    if options.epochs > MOST_EPOCHS {
        return Err(Error::Option(format!("{} epochs are too many: at most {MOST_EPOCHS}", options.epochs)));
    }
    options.regularisation.check()
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
    observer: Mutex<&'a mut Observer<'a>>,
    options: &'a FitOptions,
    /// Iterations that all runs together have done or will not need; `usize::MAX` once stopped.
    finished: Mutex<usize>,
}

/// Starts that do best on the data held out, and are then trained on everything.
const FINALISTS: usize = 3;

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

    /// The finalists on all data: thinned first if they are many, then the winner on every row.
    /// Returns which finalist won.
    ///
    /// Each goes on from where it was judged, and once more from its random beginning, because data
    /// that were held out may lie beyond a barrier from there; the lowest objective wins.
    fn refit(&self, objective: &Objective, seed: u64, finalists: &[&Judged]) -> (usize, Descent) {
        let thinned = objective.thinned(self.options.thin);
        let descents: Vec<Descent> = (0..2 * finalists.len())
            .into_par_iter()
            .map(|index| {
                let finalist = finalists[index / 2];
                let from = match index % 2 {
                    0 => finalist.descent.parameters.clone(),
                    _ => start::random(&thinned, seed, finalist.start),
                };
                self.descend(&thinned, Phase::Refit, finalist.start, from)
            })
            .collect();
        let evaluations = descents.iter().map(|descent| descent.evaluations).sum();
        let (index, mut first) = descents
            .into_iter()
            .enumerate()
            .min_by(|(_, a), (_, b)| a.objective.total_cmp(&b.objective))
            .expect("there is a finalist");
        first.evaluations = evaluations;
        let best = finalists[index / 2];
        if objective.scored() == thinned.scored() || self.stopped() {
            return (index / 2, first);
        }
        let parameters = first.parameters.clone();
        let last =
            levenberg_marquardt::descend(objective, parameters, LAST_EPOCHS_ON_ALL_ROWS, |epoch, nrmse| {
                self.tell(Phase::Refit, best.start, self.options.epochs + epoch, nrmse, 0)
            });
        let done = first.history.last().map_or(0, |point| point.epoch);
        let on_all_rows = last.history.iter().skip(1);
        first.history.extend(on_all_rows.map(|point| HistoryPoint { epoch: done + point.epoch, ..*point }));
        (index / 2, Descent { history: first.history, evaluations: evaluations + last.evaluations, ..last })
    }

    fn tell(&self, phase: Phase, start: usize, epoch: usize, nrmse: f64, weight: usize) -> ControlFlow<()> {
        let mut finished = self.finished.lock().expect("no thread panics with the lock");
        if *finished == usize::MAX {
            return ControlFlow::Break(());
        }
        *finished += weight;
        let all = (self.options.starts + 2 * FINALISTS.min(self.options.starts)) * self.options.epochs;
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

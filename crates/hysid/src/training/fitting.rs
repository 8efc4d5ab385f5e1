//! A fit on its way: which runs there are, and in which order.
//!
//! Runs advance in rounds, one epoch of a few runs at a time; between rounds the whole state is plain
//! data, so that the observer can store it. No run depends on another, nor on how many advance
//! together.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::free_run::FreeRun;
use crate::identification::{ModelName, Request};
use crate::metrics::Errors;
use crate::model::{Body, Model, Provenance};
use crate::network::{Architecture, Network};
use crate::preprocessing::{Preprocessing, Seen};
use crate::record::Dataset;
use crate::scaling::Scaling;
use crate::training::checkpoint::Snapshot;
use crate::training::history::{Phase, Run};
use crate::training::objective::Objective;
use crate::training::options::{FitOptions, Trainer};
use crate::training::run::{From, TrainingRun};
use crate::training::termination::Termination;
use crate::training::{FEWEST_ROWS, Fit, Observer, Progress};

/// Starts that do best on the data held out, and are then trained on everything.
const FINALISTS: usize = 3;

/// Iterations of the winner that see every row.
const LAST_EPOCHS_ON_ALL_ROWS: usize = 4;

/// Runs that advance together, for each thread: enough that no thread waits long for another.
const RUNS_PER_THREAD: usize = 4;

/// All runs of a fit so far.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct State {
    /// The starts on the training part; none if there is only one start.
    starts: Vec<TrainingRun>,
    /// The best starts, or the only one, on all data.
    all_data: Vec<TrainingRun>,
    /// The winner on all rows, where those before saw some of many.
    all_rows: Vec<TrainingRun>,
}

/// A fit on its way.
pub(crate) struct Fitting<'a> {
    /// The data as measured, and what was asked for.
    measured: &'a Dataset,
    asked: FitOptions,
    /// The data as the network sees them, and the options for these.
    preprocessing: Preprocessing,
    data: &'a Dataset,
    options: FitOptions,
    architecture: Architecture,
    scaling: Scaling,
    state: State,
    stopped: bool,
}

/// Runs that advance together.
struct Stage<'o> {
    phase: Phase,
    /// Where the runs are kept.
    runs: fn(&mut State) -> &mut Vec<TrainingRun>,
    objective: &'o Objective<'o>,
    /// Epochs of each run.
    epochs: usize,
    /// Epochs that the observer is to add to those of the runs.
    epochs_before: usize,
}

/// A start that was judged by data held out.
struct Judged {
    start: usize,
    parameters: Vec<f64>,
    network: Network,
    termination: Termination,
    validation: Errors,
}

/// What a fit comes to.
struct Outcome {
    network: Network,
    start: usize,
    termination: Termination,
    validation: Option<Errors>,
    runs: Vec<Run>,
}

impl<'a> Fitting<'a> {
    /// `seen` is what the shaping of the options makes of the data measured.
    pub fn new(measured: &'a Dataset, seen: &'a Seen<'_>, asked: FitOptions) -> Result<Self> {
        asked.check()?;
        Ok(Self {
            architecture: asked.architecture(measured)?,
            scaling: Scaling::of(&seen.data, seen.rate)?,
            measured,
            options: FitOptions { rate: seen.rate, ..asked.clone() },
            asked,
            preprocessing: seen.preprocessing,
            data: &seen.data,
            state: State::default(),
            stopped: false,
        })
    }

    /// As [`Fitting::new`], from a state on.
    pub fn from(self, state: State) -> Self {
        Self { state, ..self }
    }

    /// Goes on to the end, or until the observer says stop.
    pub fn run(mut self, observer: &mut Observer<'_>) -> Result<Fit> {
        let outcome = if self.options.starts == 1 {
            self.train_on_all_data(vec![(0, From::Random)], observer)?
        } else {
            self.choose_among_starts(observer)?
        };
        let evaluations = self.state.all_runs().map(TrainingRun::evaluations).sum();
        let Self { measured, asked, preprocessing, data, options, scaling, stopped, .. } = self;
        let provenance = Provenance {
            samples: data.scored(),
            records: data.records().len(),
            chosen_start: outcome.start,
            termination: if stopped { Termination::Stopped } else { outcome.termination },
            runs: outcome.runs,
            train: FreeRun::new(&outcome.network, &scaling, options.rate).errors(data)?,
            validation: outcome.validation,
            selection: None,
            options: Request::Network(asked.clone()),
        };
        let body = Body::Network { network: outcome.network, scaling };
        let model = Model::new(body, preprocessing, asked.rate, measured, provenance)?;
        Ok(Fit { model, evaluations })
    }

    /// Several starts on a part of the data; those that do best on the rest are trained on everything.
    fn choose_among_starts(&mut self, observer: &mut Observer<'_>) -> Result<Outcome> {
        let split = self.data.split_for_validation(self.options.validation);
        let split = split.filter(|(kept, _)| kept.scored() >= FEWEST_ROWS);
        let (kept, held_out) = match &split {
            Some((kept, held_out)) => (kept, Some(held_out)),
            None => (self.data, None),
        };
        let objective = Objective::new(kept, &self.scaling, self.architecture, &self.options)?;
        let thinned = objective.thinned(self.options.thin);
        let stage = Stage {
            phase: Phase::Starts,
            runs: |state| &mut state.starts,
            objective: &thinned,
            epochs: self.options.epochs,
            epochs_before: 0,
        };
        let beginnings = (0..self.options.starts).map(|start| (start, From::Random)).collect();
        self.drive(&stage, beginnings, observer)?;

        let judged = self.judge(&thinned, held_out.unwrap_or(kept))?;
        let mut runs = Vec::new();
        for (run, judged) in self.state.starts.iter().zip(&judged) {
            runs.extend_from_slice(run.runs());
            let last = runs.last_mut().expect("every run has a history");
            last.validation_nrmse_percent =
                judged.validation.nrmse_std_percent.filter(|_| held_out.is_some());
        }
        let mut finalists: Vec<&Judged> = judged.iter().collect();
        finalists.sort_by(|a, b| a.validation.mse.total_cmp(&b.validation.mse));
        finalists.truncate(FINALISTS);
        let mut outcome = if self.stopped {
            let best = finalists[0];
            let (start, termination) = (best.start, best.termination);
            Outcome { network: best.network.clone(), start, termination, validation: None, runs: Vec::new() }
        } else {
            // Each goes on from where it was judged, and once more from its random beginning, because
            // data that were held out may lie beyond a barrier from there.
            let beginnings = finalists.iter().flat_map(|judged| {
                [(judged.start, From::Parameters(judged.parameters.clone())), (judged.start, From::Random)]
            });
            self.train_on_all_data(beginnings.collect(), observer)?
        };
        runs.append(&mut outcome.runs);
        let chosen = judged.into_iter().find(|judged| judged.start == outcome.start);
        let validation = chosen.filter(|_| held_out.is_some()).map(|judged| judged.validation);
        Ok(Outcome { validation, runs, ..outcome })
    }

    /// The starts on data they were not trained on, in their order.
    fn judge(&self, objective: &Objective, held_out: &Dataset) -> Result<Vec<Judged>> {
        let judge = |run: &TrainingRun| {
            let network = run.network(objective)?;
            let validation = FreeRun::new(&network, &self.scaling, self.options.rate).errors(held_out)?;
            let (start, termination) = (run.start(), run.termination());
            Ok(Judged { start, parameters: run.best().parameters.clone(), network, termination, validation })
        };
        self.state.starts.par_iter().map(judge).collect()
    }

    /// All beginnings on all data, thinned if they are many; then the lowest on every row.
    fn train_on_all_data(
        &mut self,
        beginnings: Vec<(usize, From)>,
        observer: &mut Observer<'_>,
    ) -> Result<Outcome> {
        let objective = Objective::new(self.data, &self.scaling, self.architecture, &self.options)?;
        let thinned = objective.thinned(self.options.thin);
        let stage = Stage {
            phase: Phase::AllData,
            runs: |state| &mut state.all_data,
            objective: &thinned,
            epochs: self.options.epochs,
            epochs_before: 0,
        };
        self.drive(&stage, beginnings, observer)?;
        let runs = self.state.all_data.iter();
        let lowest = runs.min_by(|a, b| a.best().objective.total_cmp(&b.best().objective));
        let mut winner = lowest.expect("at least one run has begun").clone();
        let is_whole = objective.scored() == thinned.scored();
        if self.options.training == Trainer::LevenbergMarquardt && !is_whole && !self.stopped {
            let stage = Stage {
                runs: |state| &mut state.all_rows,
                objective: &objective,
                epochs: LAST_EPOCHS_ON_ALL_ROWS,
                epochs_before: winner.epoch(),
                ..stage
            };
            let from = From::Parameters(winner.best().parameters.clone());
            self.drive(&stage, vec![(winner.start(), from)], observer)?;
            winner.append(self.state.all_rows[0].clone());
        }
        Ok(Outcome {
            network: winner.network(&objective)?,
            start: winner.start(),
            termination: winner.termination(),
            validation: None,
            runs: winner.runs().to_vec(),
        })
    }

    /// Advances runs in rounds until all are over or the observer says stop. `beginnings` are those of
    /// all runs of the stage; those that have begun before are passed over.
    fn drive(
        &mut self,
        stage: &Stage,
        beginnings: Vec<(usize, From)>,
        observer: &mut Observer<'_>,
    ) -> Result<()> {
        let (all, begun) = (beginnings.len(), (stage.runs)(&mut self.state).len());
        let mut waiting = beginnings.into_iter().skip(begun);
        let room = RUNS_PER_THREAD * rayon::current_num_threads();
        while !self.stopped {
            let (options, runs) = (&self.options, (stage.runs)(&mut self.state));
            let under_way = runs.iter().filter(|run| !run.is_over()).count();
            let next: Vec<(usize, From)> = waiting.by_ref().take(room.saturating_sub(under_way)).collect();
            let begin = |(start, from)| {
                TrainingRun::new(stage.objective, options, stage.phase, start, stage.epochs, from)
            };
            runs.extend(next.into_par_iter().map(begin).collect::<Result<Vec<_>>>()?);
            let advance = |(index, run): (usize, &mut TrainingRun)| {
                Ok(run.advance(stage.objective, options)?.then_some(index))
            };
            let under_way = runs.par_iter_mut().enumerate().filter(|(_, run)| !run.is_over());
            let advanced: Vec<Option<usize>> = under_way.map(advance).collect::<Result<_>>()?;
            let is_over = runs.len() == all && runs.iter().all(TrainingRun::is_over);
            for index in advanced.into_iter().flatten() {
                self.tell(stage, index, observer);
                if self.stopped {
                    (stage.runs)(&mut self.state).iter_mut().for_each(TrainingRun::stop);
                    return Ok(());
                }
            }
            if is_over {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Tells the observer where a run is.
    fn tell(&mut self, stage: &Stage, index: usize, observer: &mut Observer<'_>) {
        let done = self.done();
        let run = &(stage.runs)(&mut self.state)[index];
        let progress = Progress {
            model: ModelName::Network(self.asked.model),
            is_part: false,
            phase: stage.phase,
            method: run.method_of_last_epoch(),
            start: run.start(),
            epoch: stage.epochs_before + run.epoch(),
            evaluations: run.evaluations(),
            train_nrmse_percent: run.last().train_nrmse_percent,
            done,
            snapshot: Some(Snapshot { options: &self.asked, data: self.measured, state: &self.state }),
        };
        self.stopped = observer(&progress).is_break();
    }

    /// Share of the work done, if every run takes all its epochs.
    fn done(&self) -> f64 {
        let FitOptions { starts, epochs, .. } = self.options;
        let runs = if starts == 1 { 1 } else { starts + 2 * FINALISTS.min(starts) };
        let of_run = |run: &TrainingRun| if run.is_over() { epochs } else { run.epoch().min(epochs) };
        let done: usize = self.state.starts.iter().chain(&self.state.all_data).map(of_run).sum();
        done as f64 / (runs * epochs).max(1) as f64
    }
}

impl State {
    fn all_runs(&self) -> impl Iterator<Item = &TrainingRun> {
        self.starts.iter().chain(&self.all_data).chain(&self.all_rows)
    }
}

//! A fit on its way: which runs there are, and in which order.
//!
//! Several starts are trained on everything, and the lowest objective wins. The same is done on the folds of a
//! cross-validation, from fewer starts: that estimates the error on new data, and shows whether penalties are needed.
//!
//! Runs advance in rounds, one epoch of a few runs at a time; between rounds the whole state is plain
//! data, so that the observer can store it. No run depends on another, nor on how many advance
//! together.

use hysid_core::elementary::{exp, ln};
use serde::{Deserialize, Serialize};

use crate::data::FEWEST_ROWS;
use crate::data::metrics::Errors;
use crate::data::rate::RateMethod;
use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::network::objective::Objective;
use crate::fit::network::run::{From, TrainingRun};
use crate::fit::network::soundness::{NetworkFrame, require};
use crate::fit::network::wanted_of;
use crate::fit::progress::{Checkpoint, Fitted, HeldOutRows, Observer, PartialFit, Progress, SharedObserver};
use crate::law::facts::Origin;
use crate::linear_algebra::dilated_space::DilatedSpace;
use crate::model::history::Phase;
use crate::model::input_transform::{InputTransform, TransformedData};
use crate::model::{Model, Predictor, ProvenanceDraft};
use crate::network::free_run::FreeRun;
use crate::network::scaling::Scaling;
use crate::network::{Architecture, Network};
use crate::optimise::parallel;
use crate::options::FitSpec;
use crate::options::network::{FitOptions, Regularisation, Trainer};
use crate::stop_check::StopCheck;
use crate::termination::Termination;
use crate::validation::{Fold, PooledErrors, folds};

const MOST_FOLDS: usize = 5;

const STARTS_ON_FOLDS: usize = 3;

/// Near-zero penalties for noise-free data, where any bias would show.
const NO_PENALTIES: Regularisation = Regularisation { ridge: 1e-10, decay: 1e-12 };

/// Largest error without penalties, as a share of the error with them, at which they are left out.
const WORTH: f64 = 0.9;

/// The best starts on everything, which go on without penalties where these are left out.
const FINALISTS: usize = 3;

/// Iterations of the winner that see every row.
const LAST_EPOCHS_ON_ALL_ROWS: usize = 4;

/// Runs that advance together, for each thread: enough that no thread waits long for another.
const RUNS_PER_THREAD: usize = 4;
/// Numbers that the states of these runs hold at most, if there are several of them.
const MOST_NUMBERS: usize = 32 << 20;

#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct State {
    /// The starts on everything.
    all_data: Vec<TrainingRun>,
    /// The first starts on the training part of each fold, fold by fold.
    folds: Vec<TrainingRun>,
    /// The best of each fold, and then the best on everything, further without penalties.
    folds_exact: Vec<TrainingRun>,
    all_exact: Vec<TrainingRun>,
    /// The winner on all rows, where those before saw some of many.
    all_rows: Vec<TrainingRun>,
}

pub(crate) struct Fitting<'a> {
    measured: &'a Dataset,
    asked: FitOptions,
    /// The data in scaled units, with their rates.
    whole: TrainingPart<'a>,
    architecture: Architecture,
    state: State,
    /// Epochs of all runs, as far as they are known.
    epochs_expected: usize,
}

/// Data that networks are trained on, as they see them.
struct TrainingPart<'a> {
    data: &'a Dataset,
    preprocessing: InputTransform,
    scaling: Scaling,
    /// The options for data seen in this way.
    options: FitOptions,
}

/// Where a run of a stage begins, and on which of its objectives.
struct StageStart {
    objective: usize,
    start: usize,
    from: From,
}

struct TrainingStage<'o> {
    phase: Phase,
    runs: Runs,
    objectives: &'o [Objective<'o>],
    epochs: usize,
    /// Epochs that the observer is to add to those of the runs.
    epochs_before: usize,
}

#[derive(Default)]
struct Validation {
    errors: Option<Errors>,
    held_out: Option<HeldOutRows>,
    /// Penalties do harm.
    is_exact: bool,
}

impl<'a> TrainingPart<'a> {
    /// `seen` is what the shaping of the options makes of data measured.
    fn of(seen: &'a TransformedData<'_>, asked: &FitOptions) -> Result<Self> {
        Ok(Self {
            data: &seen.data,
            preprocessing: seen.preprocessing.clone(),
            scaling: Scaling::of(&seen.data, seen.rate)?,
            options: FitOptions { rate: seen.rate, ..asked.clone() },
        })
    }

    fn objective(&self, architecture: Architecture, penalties: Regularisation) -> Result<Objective<'static>> {
        let Regularisation { ridge, decay } = penalties;
        let options = FitOptions { ridge: Some(ridge), decay: Some(decay), ..self.options.clone() };
        Objective::new(self.data, &self.scaling, architecture, &options)
    }

    /// Predictions of a network for the held-out rows of a fold, in the user's unit.
    fn predicted(&self, network: &Network, fold: &Fold, rate: Option<RateMethod>) -> Result<Vec<f64>> {
        let (seen, rate) = self.preprocessing.data(&fold.held_out, rate)?;
        let mut run = FreeRun::new(network, &self.scaling, rate);
        let mut predicted = Vec::with_capacity(fold.held_out.scored());
        for record in seen.records() {
            let rows = run.response(&record.excitation())?.into_iter().zip(record.output());
            predicted.extend(rows.filter(|(_, y)| !y.is_nan()).map(|(simulated, _)| simulated));
        }
        Ok(predicted)
    }
}

impl<'a> Fitting<'a> {
    /// `seen` is what the shaping of the options makes of the data measured.
    pub fn new(measured: &'a Dataset, seen: &'a TransformedData<'_>, asked: FitOptions) -> Result<Self> {
        asked.check()?;
        let starts = asked.starts;
        let on_folds = if starts > 1 { MOST_FOLDS * STARTS_ON_FOLDS.min(starts) } else { 0 };
        Ok(Self {
            architecture: asked.architecture(measured)?,
            whole: TrainingPart::of(seen, &asked)?,
            epochs_expected: (starts + on_folds) * asked.epochs,
            measured,
            asked,
            state: State::default(),
        })
    }

    /// As [`Fitting::new`], from a state; an error for one that no fit with these options comes to.
    pub fn from(self, state: State) -> Result<Self> {
        let starts = self.asked.starts;
        let most = |runs: &[TrainingRun], most: usize| require(runs.len() <= most, "its number of runs");
        most(&state.all_data, starts)?;
        most(&state.folds, MOST_FOLDS * STARTS_ON_FOLDS.min(starts))?;
        most(&state.folds_exact, MOST_FOLDS)?;
        most(&state.all_exact, FINALISTS)?;
        most(&state.all_rows, 1)?;
        let frame = NetworkFrame::new(&self.asked, &self.architecture);
        state.all_runs().try_for_each(|run| run.check(&frame))?;
        Ok(Self { state, ..self })
    }

    /// Runs to the end, or until the observer stops; an error if there is no network by then.
    pub fn run(mut self, observer: &mut Observer<'_>) -> Result<Fitted> {
        let observer = &SharedObserver::new(observer, Some(Progress::of_beginning(&self.asked)));
        let penalties = self.asked.penalties();
        self.train_on_everything(penalties, observer)?;
        let validation = self.validate(penalties, observer)?;
        let (winner, penalties) = if validation.is_exact && !observer.is_over() {
            (self.without_penalties(observer)?, NO_PENALTIES)
        } else {
            (best_of(&self.state.all_data).expect("at least one run has begun").clone(), penalties)
        };
        let (winner, network) = self.finished(winner, penalties, observer)?;

        let runs =
            self.state.folds.iter().flat_map(TrainingRun::runs).chain(winner.runs()).cloned().collect();
        let evaluations = self.state.all_runs().map(TrainingRun::evaluations).sum();
        let found = ProvenanceDraft {
            termination: observer.termination(winner.termination()),
            runs,
            validation: validation.errors,
            ..self.found(&winner, penalties)
        };
        let model = self.model(network, found)?;
        Ok(Fitted::of(model, evaluations).with_held_out(validation.held_out))
    }

    /// Provenance of a run on all data, without its errors.
    fn found(&self, run: &TrainingRun, penalties: Regularisation) -> ProvenanceDraft {
        ProvenanceDraft {
            chosen_start: run.start(),
            runs: run.runs().to_vec(),
            penalties: Some(penalties),
            ..ProvenanceDraft::of(FitSpec::Network(self.asked.clone()), run.termination())
        }
    }

    fn model(&self, network: Network, found: ProvenanceDraft) -> Result<Model> {
        let TrainingPart { preprocessing, scaling, .. } = &self.whole;
        let body = Predictor::Network { network, scaling: scaling.clone() };
        Model::new(body, preprocessing.clone(), self.asked.rate, self.measured, found)
    }

    /// All starts on everything, thinned if it is much.
    fn train_on_everything(
        &mut self,
        penalties: Regularisation,
        observer: &SharedObserver<'_, '_>,
    ) -> Result<()> {
        let is_to_stop = || observer.is_to_stop();
        let objective = self.whole.objective(self.architecture, penalties)?.thinned(self.asked.thin);
        let stage = TrainingStage {
            phase: Phase::AllData,
            runs: |state| &mut state.all_data,
            objectives: &[objective.until(StopCheck::new(&is_to_stop))],
            epochs: self.asked.epochs,
            epochs_before: 0,
        };
        let random = |start| StageStart { objective: 0, start, from: From::Random };
        self.drive(&stage, (0..self.asked.starts).map(random).collect(), observer)?;
        if self.state.all_data.is_empty() { Err(Error::Stopped) } else { Ok(()) }
    }

    /// A few starts on each fold, if there are several: the lowest objective of each fold predicts its held-out rows.
    fn validate(
        &mut self,
        penalties: Regularisation,
        observer: &SharedObserver<'_, '_>,
    ) -> Result<Validation> {
        if self.asked.starts == 1 || observer.is_over() {
            return Ok(Validation::default());
        }
        let is_to_stop = || observer.is_to_stop();
        let stop = StopCheck::new(&is_to_stop);
        let folds = wanted_of(&self.asked).on_folds(self.folds(), stop)?;
        let (shaping, rate) = (self.asked.shaping, self.asked.rate);
        let seen: Vec<TransformedData> = folds
            .iter()
            .map(|fold| TransformedData::of(&fold.train, &shaping, rate, Origin::OfData))
            .collect::<Result<_>>()?;
        let parts: Vec<TrainingPart> =
            seen.iter().map(|seen| TrainingPart::of(seen, &self.asked)).collect::<Result<_>>()?;
        let starts = STARTS_ON_FOLDS.min(self.asked.starts);
        let random = |(objective, start)| StageStart { objective, start, from: From::Random };
        let all = (0..folds.len()).flat_map(|fold| (0..starts).map(move |start| (fold, start)));
        let stage = FoldStage { runs: |state| &mut state.folds, phase: Phase::Starts, penalties };
        self.drive_on_folds(&stage, &parts, all.map(random).collect(), observer, stop)?;
        if observer.is_over() || folds.is_empty() {
            return Ok(Validation::default());
        }
        let on_folds = self.on_folds(&self.state.folds, &parts, &folds, penalties, stop)?;
        if observer.is_over() {
            return Ok(Validation::default());
        }
        for (index, (run, on_fold)) in self.state.folds.iter_mut().zip(&on_folds).enumerate() {
            run.validated(index / starts, on_fold.error_percent());
        }
        let lowest = |fold: usize| {
            let of_fold = fold * starts..(fold + 1) * starts;
            of_fold
                .min_by(|&a, &b| self.state.folds[a].objective().total_cmp(&self.state.folds[b].objective()))
        };
        let best: Vec<usize> = (0..folds.len()).filter_map(lowest).collect();
        let with_penalties: Vec<&FoldPredictions> = best.iter().map(|&index| &on_folds[index]).collect();
        let onward: Vec<StageStart> =
            best.iter().enumerate().map(|(fold, &index)| onward(fold, &self.state.folds[index])).collect();
        let validation = self.validation(&with_penalties, &folds, false)?;
        if self.asked.keeps_penalties() {
            return Ok(validation);
        }
        let stage = FoldStage { runs: |state| &mut state.folds_exact, penalties: NO_PENALTIES, ..stage };
        self.drive_on_folds(&stage, &parts, onward, observer, stop)?;
        if observer.is_over() {
            return Ok(validation);
        }
        let without = self.on_folds(&self.state.folds_exact, &parts, &folds, NO_PENALTIES, stop)?;
        let without: Vec<&FoldPredictions> = without.iter().collect();
        if observer.is_over() {
            return Ok(validation);
        }
        if mean_error(&without) < WORTH * mean_error(&with_penalties) {
            return self.validation(&without, &folds, true);
        }
        Ok(validation)
    }

    /// The parts that are held out in turn: those of a cross-validation, or the share that was requested.
    fn folds(&self) -> Vec<Fold> {
        let Some(share) = self.asked.validation else { return folds(self.measured, MOST_FOLDS) };
        let split = self.measured.split_for_validation(share);
        let split = split.filter(|(train, _)| train.check_identifiable(FEWEST_ROWS).is_ok());
        let fold = |(train, held_out)| Fold { name: format!("{} %", 100.0 * share), train, held_out };
        split.map(fold).into_iter().collect()
    }

    fn drive_on_folds(
        &mut self,
        stage: &FoldStage,
        parts: &[TrainingPart],
        beginnings: Vec<StageStart>,
        observer: &SharedObserver<'_, '_>,
        stop: StopCheck<'_>,
    ) -> Result<()> {
        let FoldStage { phase, runs, penalties } = *stage;
        let objective = |part: &TrainingPart| {
            Ok(part.objective(self.architecture, penalties)?.thinned(self.asked.thin).until(stop))
        };
        let objectives: Vec<Objective> = parts.iter().map(objective).collect::<Result<_>>()?;
        let stage = TrainingStage {
            phase,
            runs,
            objectives: &objectives,
            epochs: self.asked.epochs,
            epochs_before: 0,
        };
        self.drive(&stage, beginnings, observer)
    }

    /// Predictions of runs for the folds, as many of each, fold by fold. Their output weights are those of all rows.
    fn on_folds(
        &self,
        runs: &[TrainingRun],
        parts: &[TrainingPart],
        folds: &[Fold],
        penalties: Regularisation,
        stop: StopCheck<'_>,
    ) -> Result<Vec<FoldPredictions>> {
        let mut on_folds = Vec::with_capacity(runs.len());
        let of_folds = runs.chunks(runs.len() / folds.len());
        for ((runs, part), fold) in of_folds.zip(parts).zip(folds) {
            let objective = part.objective(self.architecture, penalties)?.until(stop);
            for run in runs {
                on_folds.push(FoldPredictions::of(run, part, &objective, fold, self.asked.rate)?);
            }
        }
        Ok(on_folds)
    }

    /// Errors of one run on each fold, on what was held out, all together.
    fn pooled(&self, runs: &[&FoldPredictions], folds: &[Fold]) -> Option<Errors> {
        let mut pooled = PooledErrors::default();
        runs.iter().zip(folds).for_each(|(run, fold)| pooled.add(&fold.held_out, &run.predicted));
        pooled.errors(&self.measured.names().output)
    }

    fn validation(&self, runs: &[&FoldPredictions], folds: &[Fold], is_exact: bool) -> Result<Validation> {
        let predicted = folds.iter().zip(runs.iter().map(|run| run.predicted.as_slice()));
        let held_out = HeldOutRows::of(self.measured.names(), predicted)?;
        Ok(Validation { errors: self.pooled(runs, folds), held_out, is_exact })
    }

    /// The best starts on everything, further without penalties: the lowest objective of these.
    fn without_penalties(&mut self, observer: &SharedObserver<'_, '_>) -> Result<TrainingRun> {
        let mut best: Vec<TrainingRun> = self.state.all_data.clone();
        best.sort_by(|a, b| a.objective().total_cmp(&b.objective()));
        best.truncate(FINALISTS);
        let is_to_stop = || observer.is_to_stop();
        let objective = self.whole.objective(self.architecture, NO_PENALTIES)?.thinned(self.asked.thin);
        let stage = TrainingStage {
            phase: Phase::AllData,
            runs: |state| &mut state.all_exact,
            objectives: &[objective.until(StopCheck::new(&is_to_stop))],
            epochs: self.asked.epochs,
            epochs_before: self.asked.epochs,
        };
        self.drive(&stage, best.iter().map(|run| onward(0, run)).collect(), observer)?;
        let lowest = best.first().expect("there is at least one start").clone();
        let begun = best.into_iter().zip(&self.state.all_exact);
        Ok(match begun.min_by(|a, b| a.1.objective().total_cmp(&b.1.objective())) {
            Some((mut winner, finish)) => {
                winner.append(finish.clone());
                winner
            }
            None => lowest,
        })
    }

    /// The winner with its output weights; of thinned data it goes on for a few epochs on every row.
    fn finished(
        &mut self,
        winner: TrainingRun,
        penalties: Regularisation,
        observer: &SharedObserver<'_, '_>,
    ) -> Result<(TrainingRun, Network)> {
        let mut winner = winner;
        if observer.is_over() {
            let network = winner.network_as_trained(self.architecture)?;
            return Ok((winner, network));
        }
        let is_to_stop = || observer.is_to_stop();
        let objective =
            self.whole.objective(self.architecture, penalties)?.until(StopCheck::new(&is_to_stop));
        let is_whole = objective.scored() <= self.asked.thin;
        if self.asked.training == Trainer::LevenbergMarquardt && !is_whole {
            let stage = TrainingStage {
                phase: Phase::AllData,
                runs: |state| &mut state.all_rows,
                objectives: std::slice::from_ref(&objective),
                epochs: LAST_EPOCHS_ON_ALL_ROWS,
                epochs_before: winner.epoch(),
            };
            self.drive(&stage, vec![onward(0, &winner)], observer)?;
            if let Some(on_all_rows) = self.state.all_rows.first() {
                winner.append(on_all_rows.clone());
            }
        }
        let network = winner.network(&objective)?;
        if observer.is_over() {
            let network = winner.network_as_trained(self.architecture)?;
            return Ok((winner, network));
        }
        Ok((winner, network))
    }

    /// Advances runs in rounds until all are over or the observer says stop. `beginnings` are those of
    /// all runs of the stage; those that have begun before are passed over. What a run was doing when the
    /// observer said stop is thrown away: it stays as it was before the round.
    fn drive(
        &mut self,
        stage: &TrainingStage,
        beginnings: Vec<StageStart>,
        observer: &SharedObserver<'_, '_>,
    ) -> Result<()> {
        let objective_of: Vec<usize> = beginnings.iter().map(|beginning| beginning.objective).collect();
        let (all, begun) = (beginnings.len(), (stage.runs)(&mut self.state).len());
        require(begun <= all, "its number of runs")?;
        let mut waiting = beginnings.into_iter().skip(begun);
        let threads = rayon::current_num_threads();
        let room = room(self.architecture.searched_parameters(), stage.epochs, threads);
        while !observer.is_over() {
            let (options, runs) = (&self.whole.options, (stage.runs)(&mut self.state));
            let under_way = runs.iter().filter(|run| !run.is_over()).count();
            let next: Vec<StageStart> = waiting.by_ref().take(room.saturating_sub(under_way)).collect();
            let begin = |StageStart { objective, start, from }| {
                let objective = &stage.objectives[objective];
                let run = TrainingRun::new(objective, options, stage.phase, start, stage.epochs, from);
                if objective.is_long() && observer.is_over() { Ok(None) } else { run.map(Some) }
            };
            let begun = parallel::each_taken(next, begin).into_iter().collect::<Result<Vec<_>>>()?;
            // In their order, so that a fit that is resumed begins with the first that is missing.
            runs.extend(begun.into_iter().map_while(|run| run));
            let advance = |(index, run): (usize, &mut TrainingRun)| {
                let objective = &stage.objectives[objective_of[index]];
                let before = objective.is_long().then(|| run.clone());
                let advanced = run.advance(objective, options);
                match before.filter(|_| observer.is_over()) {
                    Some(before) => {
                        *run = before;
                        Ok(None)
                    }
                    None => Ok(advanced?.then_some(index)),
                }
            };
            let under_way = runs.iter_mut().enumerate().filter(|(_, run)| !run.is_over());
            let advanced: Vec<Option<usize>> =
                parallel::each_taken(under_way, advance).into_iter().collect::<Result<_>>()?;
            let is_over = runs.len() == all && runs.iter().all(TrainingRun::is_over);
            if observer.is_over() {
                if !runs.is_empty() {
                    observer.tell_last(&self.progress(stage, 0));
                }
                break;
            }
            for index in advanced.into_iter().flatten() {
                if observer.tell(&self.progress(stage, index)).is_break() {
                    break;
                }
            }
            if is_over && !observer.is_over() {
                return Ok(());
            }
        }
        (stage.runs)(&mut self.state).iter_mut().for_each(TrainingRun::stop);
        Ok(())
    }

    fn progress(&mut self, stage: &TrainingStage, index: usize) -> Progress<'_> {
        let done = self.done();
        let run = &(stage.runs)(&mut self.state)[index];
        let told = Progress {
            phase: stage.phase,
            method: run.method_of_last_epoch(),
            start: run.start(),
            epoch: stage.epochs_before + run.epoch(),
            evaluations: run.evaluations(),
            train_nrmse_percent: run.last().train_nrmse_percent,
            done,
            ..Progress::of_beginning(&self.asked)
        };
        told.with_state(self)
    }

    /// Share of the work done, if every run takes all its epochs.
    fn done(&self) -> f64 {
        let epochs = self.asked.epochs;
        let of_run = |run: &TrainingRun| if run.is_over() { epochs } else { run.epoch().min(epochs) };
        let done: usize = self.state.all_runs().map(of_run).sum();
        (done as f64 / self.epochs_expected.max(1) as f64).min(1.0)
    }
}

impl PartialFit for Fitting<'_> {
    fn checkpoint(&self) -> Option<Checkpoint> {
        Some(Checkpoint::of(&self.asked, self.measured, &self.state))
    }

    /// The network with the lowest objective so far of the last stage on all data; `None` if there is none yet.
    fn model_so_far(&self) -> Option<Model> {
        let State { all_data, all_exact, all_rows, .. } = &self.state;
        let run = [all_rows, all_exact, all_data].into_iter().find_map(|runs| best_of(runs))?;
        let penalties = if all_exact.is_empty() { self.asked.penalties() } else { NO_PENALTIES };
        let network = run.network_as_trained(self.architecture).ok()?;
        let found = ProvenanceDraft { termination: Termination::Stopped, ..self.found(run, penalties) };
        self.model(network, found).ok()
    }
}

/// Runs with this number of parameters and epochs that advance together: the state of one may be a dilated space.
pub(crate) fn room(parameters: usize, epochs: usize, threads: usize) -> usize {
    let numbers = DilatedSpace::numbers(parameters, epochs);
    (MOST_NUMBERS / numbers.max(1)).clamp(1, RUNS_PER_THREAD * threads)
}

/// Where the runs of a stage are kept.
type Runs = fn(&mut State) -> &mut Vec<TrainingRun>;

#[derive(Clone, Copy)]
struct FoldStage {
    phase: Phase,
    runs: Runs,
    penalties: Regularisation,
}

/// Predictions for the held-out rows of a fold by a run on its training part.
struct FoldPredictions {
    predicted: Vec<f64>,
    errors: Option<Errors>,
}

impl FoldPredictions {
    fn of(
        run: &TrainingRun,
        part: &TrainingPart,
        objective: &Objective,
        fold: &Fold,
        rate: Option<RateMethod>,
    ) -> Result<Self> {
        let predicted = part.predicted(&run.network(objective)?, fold, rate)?;
        let mut pooled = PooledErrors::default();
        pooled.add(&fold.held_out, &predicted);
        Ok(Self { predicted, errors: pooled.errors("") })
    }

    /// Error in percent of the standard deviation of what is held out.
    fn error_percent(&self) -> Option<f64> {
        self.errors.as_ref().and_then(|errors| errors.nrmse_std_percent)
    }
}

/// Geometric mean of the errors on several folds: one fold that goes far beyond the others does not decide it.
fn mean_error(folds: &[&FoldPredictions]) -> f64 {
    let errors = folds.iter().filter_map(|fold| fold.errors.as_ref());
    let logarithms: Vec<f64> = errors.map(|errors| ln(errors.rmse.max(f64::MIN_POSITIVE))).collect();
    exp(logarithms.iter().sum::<f64>() / logarithms.len() as f64)
}

fn onward(objective: usize, run: &TrainingRun) -> StageStart {
    StageStart { objective, start: run.start(), from: From::Parameters(run.best().parameters.clone()) }
}

fn best_of(runs: &[TrainingRun]) -> Option<&TrainingRun> {
    runs.iter().min_by(|a, b| a.objective().total_cmp(&b.objective()))
}

impl State {
    fn all_runs(&self) -> impl Iterator<Item = &TrainingRun> {
        let exact = self.folds_exact.iter().chain(&self.all_exact);
        self.all_data.iter().chain(&self.folds).chain(exact).chain(&self.all_rows)
    }
}

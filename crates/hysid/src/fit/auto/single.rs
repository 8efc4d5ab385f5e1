//! One small model instead of an ensemble: distilled from the ensemble, or fitted to the data alone. Both are
//! validated as such: on each fold a model is distilled from the ensemble of that fold.
//!
//! The one with the smaller `E` is chosen, which combines the error on held-out data with the distance from the
//! ensemble on input paths that were not measured:
//!
//! ```text
//! E = ½ ln(e^{2S} + d²/σ²)                                                  theory.md (11.13)
//! ```
//!
//! `S` is the score on held-out data, `d` the root mean square distance from the ensemble on the inputs of the data
//! at a half and three quarters of their size, and `σ` the standard deviation of the measured output. A network can
//! predict all held-out rows well and still diverge on other paths.

use hysid_core::elementary::{exp, ln};

use crate::data::record::{Dataset, Record, Thinning};
use crate::error::Result;
use crate::fit::auto::candidates::{Candidate, CandidateKind};
use crate::fit::auto::combination::Combination;
use crate::fit::auto::errors_held_out;
use crate::fit::auto::prior::LoopEvidence;
use crate::fit::auto::score::Score;
use crate::fit::auto::trial::{FoldBench, FoldRows, FoldTrial, HeldOut, Trial};
use crate::fit::auto::work::AutoWork;
use crate::fit::law::search::spread;
use crate::model::input_transform::{InputTransform, origin};
use crate::model::selection::SingleModel;
use crate::model::{HeldOutRow, Model, Predictor};
use crate::optimise::parallel;
use crate::options::fit_spec::AutoOptions;

/// Starts from which a model is distilled, on everything and on each fold.
const STARTS: usize = 12;
const STARTS_ON_A_FOLD: usize = 4;

/// Shares of the measured input on which the ensemble teaches beside the data, as unmeasured paths.
const SHARES: [f64; 2] = [0.5, 0.75];

/// A single model, and what models made in the same way predict on the folds.
pub(super) struct SingleCandidate {
    pub model: Model,
    pub predicted: Vec<Vec<f64>>,
    pub how: SingleModel,
}

/// A candidate as it was fitted to the data alone.
struct Plain {
    place: usize,
    predicted: Vec<Vec<f64>>,
    /// The error of the candidate to be expected on loops that the data do not show.
    unseen: f64,
    /// Logarithm of its error, with its distance from the ensemble where nothing was measured.
    error: f64,
}

struct DistillationData {
    records: Vec<Record>,
    predicted: Vec<Vec<f64>>,
}

impl DistillationData {
    fn of(records: Vec<Record>, ensemble: &Model) -> Result<Self> {
        let predicted = parallel::each(&records, |record| ensemble.simulate(record))
            .into_iter()
            .collect::<Result<_>>()?;
        Ok(Self { records, predicted })
    }

    /// Paths that nobody measured, but that the model may meet: those of the data at shares of their size.
    fn unmeasured(data: &Dataset, ensemble: &Model) -> Result<Self> {
        let origin = origin(data, 0);
        let of_share = |share: f64| data.records().iter().map(move |record| scaled(record, share, origin));
        Self::of(SHARES.into_iter().flat_map(of_share).collect::<Result<_>>()?, ensemble)
    }

    /// The data and, beside them, these records with what is predicted of them.
    fn beside(&self, data: &Dataset) -> Result<Dataset> {
        let mut records = data.records().to_vec();
        for (record, predicted) in self.records.iter().zip(&self.predicted) {
            // As many rows as were measured in all, so that what was measured counts as much.
            let thinning = Thinning::new(predicted.len(), predicted.len().div_ceil(SHARES.len()));
            let row = |(row, &y): (usize, &f64)| if thinning.keeps(row) { y } else { f64::NAN };
            records.push(record.clone().with_output(predicted.iter().enumerate().map(row).collect())?);
        }
        Dataset::new(data.names().clone(), records)
    }

    /// Sum over the rows of the squared distance of a model from the ensemble.
    fn square_distance(&self, model: &Model) -> Result<f64> {
        let of_record = |(record, predicted): (&Record, &Vec<f64>)| -> Result<f64> {
            let output = model.simulate(record)?;
            Ok(output.iter().zip(predicted).map(|(a, b)| (a - b) * (a - b)).sum())
        };
        let squares: Vec<f64> = parallel::each_taken(self.records.iter().zip(&self.predicted), of_record)
            .into_iter()
            .collect::<Result<_>>()?;
        Ok(squares.iter().sum())
    }

    fn rows(&self) -> usize {
        self.predicted.iter().map(Vec::len).sum()
    }
}

/// The fit to everything with the lowest training error of those that there are.
fn closest_to_training(trial: &Trial) -> Option<&Model> {
    let error =
        |model: &&Model| model.provenance().trained_error().nrmse_std_percent.unwrap_or(f64::INFINITY);
    trial.members.values().min_by(|a, b| error(a).total_cmp(&error(b)))
}

pub(super) struct SingleSources<'w, 'o, 'a> {
    pub trials: &'w mut Vec<Trial>,
    pub bench: FoldBench<'w, 'o, 'a>,
    pub combination: &'w Combination,
    pub evidence: LoopEvidence,
    pub options: &'w AutoOptions,
}

impl SingleSources<'_, '_, '_> {
    /// The single model; `None` if no candidate is small, or there was no time.
    pub fn single(mut self, ensemble: &Model) -> Result<Option<SingleCandidate>> {
        let unmeasured = DistillationData::unmeasured(self.bench.data, ensemble)?;
        let deviation = deviation(self.bench.data);
        // Data cannot tell what a model does on paths that were not measured; the ensemble is the best that is known.
        let error = |score: Score, model: &Model| -> Result<f64> {
            let mean_square = unmeasured.square_distance(model)? / unmeasured.rows().max(1) as f64;
            let square = mean_square / (deviation * deviation);
            let logarithm = |score: f64| ln(exp(2.0 * score) + square) / 2.0;
            Ok(logarithm(score.inside) + logarithm(score.outside))
        };
        let mut plain: Vec<Plain> = Vec::new();
        for (place, trial) in self.trials.iter().enumerate() {
            if !trial.is_complete() || trial.candidate.kind == CandidateKind::RandomStops {
                continue;
            }
            let Some(model) = closest_to_training(trial) else { continue };
            let predicted = plain_predictions(trial);
            let score = Score::of(&predicted, self.bench.folds, |_| true);
            let unseen = trial.unseen_error(self.evidence);
            let error = error(score.with_unseen(unseen), model)?;
            plain.push(Plain { place, predicted, unseen, error });
        }
        plain.sort_by(|a, b| a.error.total_cmp(&b.error));
        let Some(best) = plain.first() else { return Ok(None) };
        let candidate = &self.trials[best.place].candidate;
        // A model with inertia takes long to fit, and its search has found the best of several starts already.
        let distilled = match candidate.is_dynamic() {
            true => None,
            false => self.distilled(candidate, ensemble, &unmeasured)?,
        };
        let of_distilled =
            distilled.as_ref().map(|(_, predicted)| Score::of(predicted, self.bench.folds, |_| true));
        let mut how = SingleModel {
            name: candidate.name(),
            distilled: true,
            distilled_percent: distilled.as_ref().and_then(|(_, predicted)| self.held_out_percent(predicted)),
            plain_percent: self.held_out_percent(&best.predicted),
            is_law: false,
        };
        if let (Some((model, predicted)), Some(of_distilled)) = (distilled, of_distilled)
            && error(of_distilled.with_unseen(best.unseen), &model)? <= best.error
        {
            return Ok(Some(SingleCandidate { model, predicted, how }));
        }
        how.distilled = false;
        let (place, predicted) = (best.place, best.predicted.clone());
        let model = self.plain(place);
        Ok(model.map(|model| SingleCandidate { model, predicted, how }))
    }

    /// Error on all held-out rows together, in percent of the standard deviation.
    fn held_out_percent(&self, predicted: &[Vec<f64>]) -> Option<f64> {
        errors_held_out(predicted, self.bench.folds, "")?.nrmse_std_percent
    }

    fn plain(&mut self, place: usize) -> Option<Model> {
        let wanted: Vec<(usize, usize)> =
            (0..self.trials[place].starts.len()).map(|start| (place, start)).collect();
        self.bench.fit_members(self.trials, &wanted);
        closest_to_training(&self.trials[place]).cloned()
    }

    /// A model distilled from the ensemble, and what those distilled on each fold predict.
    fn distilled(
        &self,
        candidate: &Candidate,
        ensemble: &Model,
        unmeasured: &DistillationData,
    ) -> Result<Option<(Model, Vec<Vec<f64>>)>> {
        let starts = if candidate.is_random() { STARTS } else { 1 };
        let mut predicted = Vec::new();
        for (fold, held_out) in self.bench.folds.iter().enumerate() {
            let training = &held_out.fold.train;
            let of_fold =
                |place: usize, start: usize| Some(self.trials[place].starts[start][fold].model.clone());
            let of_fold = self.combination.ensemble(of_fold, training.input_range(0))?;
            let of_fold = Model::new(
                Predictor::Ensemble(of_fold),
                InputTransform::default(),
                self.options.rate,
                training,
                ensemble.provenance().clone().into(),
            )?;
            let starts = starts.min(STARTS_ON_A_FOLD);
            let unmeasured = DistillationData::unmeasured(training, &of_fold)?;
            let Some(model) = distilled(&of_fold, candidate, starts, training, &unmeasured, self.bench.work)?
            else {
                return Ok(None);
            };
            predicted.push(held_out.fold.predicted_by(&model)?);
        }
        let FoldBench { data, work, .. } = self.bench;
        let model = distilled(ensemble, candidate, starts, data, unmeasured, work)?;
        Ok(model.map(|model| (model, predicted)))
    }
}

pub(super) fn deviation(data: &Dataset) -> f64 {
    let records = data.records().iter();
    let measured: Vec<f64> =
        records.flat_map(|record| record.output().iter().copied()).filter(|y| !y.is_nan()).collect();
    spread(&measured).1.max(f64::MIN_POSITIVE)
}

/// Predictions for each fold by the start with the lowest training error.
fn plain_predictions(trial: &Trial) -> Vec<Vec<f64>> {
    let lowest = |fold: usize| {
        let starts = trial.starts.iter().map(|folds| &folds[fold]);
        starts.min_by(|a, b| a.training_error().total_cmp(&b.training_error()))
    };
    let folds = 0..trial.starts.first().map_or(0, Vec::len);
    folds.filter_map(lowest).map(|start: &FoldTrial| start.predicted.clone()).collect()
}

/// A record whose first input goes a share of its way from an origin.
fn scaled(record: &Record, share: f64, origin: f64) -> Result<Record> {
    let mut inputs: Vec<Vec<f64>> = record.inputs().iter().map(|input| input.to_vec()).collect();
    inputs[0].iter_mut().for_each(|x| *x = origin + share * (*x - origin));
    let mut scaled = Record::new(record.name(), inputs, vec![f64::NAN; record.len()])?;
    if let Some(time) = record.time() {
        scaled = scaled.with_time(time.to_vec())?;
    }
    if let Some(lead_in) = record.lead_in() {
        scaled = scaled.with_lead_in(lead_in.iter().map(|x| origin + share * (*x - origin)).collect())?;
    }
    if let Some(rate) = record.given_rate() {
        scaled = scaled.with_given_rate(rate.iter().map(|rate| rate * share).collect())?;
    }
    Ok(scaled)
}

/// Fits the candidate to the data and the ensemble's predictions beside them; gives the start nearest to the ensemble.
fn distilled(
    ensemble: &Model,
    candidate: &Candidate,
    starts: usize,
    data: &Dataset,
    unmeasured: &DistillationData,
    work: &AutoWork,
) -> Result<Option<Model>> {
    let taught = unmeasured.beside(data)?;
    let measured = DistillationData::of(data.records().to_vec(), ensemble)?;
    let distance = |model: &Model| -> Result<f64> {
        Ok(measured.square_distance(model)? + unmeasured.square_distance(model)?)
    };
    let of_start = |start| {
        let Some(fitted) = work.fit(candidate, &taught, start)? else { return Ok(None) };
        Ok(Some((distance(&fitted.model)?, fitted.model)))
    };
    let fitted: Vec<Option<(f64, Model)>> =
        parallel::numbered(starts, of_start).into_iter().collect::<Result<_>>()?;
    let nearest = fitted.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(nearest.map(|(_, model)| model))
}

pub(super) fn rows_held_out(predicted: &[Vec<f64>], folds: &[HeldOut]) -> Vec<Vec<HeldOutRow>> {
    let of_fold = |(predicted, fold): (&Vec<f64>, &HeldOut)| -> Vec<HeldOutRow> {
        let FoldRows { measured, outside, .. } = &fold.rows;
        let rows = predicted.iter().zip(measured).zip(outside);
        rows.map(|((predicted, measured), outside)| HeldOutRow {
            error: measured - predicted,
            disagreement: 0.0,
            outside: *outside,
            weight: 1.0 / fold.rows.measured.len() as f64,
        })
        .collect()
    };
    predicted.iter().zip(folds).map(of_fold).collect()
}

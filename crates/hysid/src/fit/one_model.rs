//! Identification of one network or one classical model, in the requested initial state.

use std::borrow::Cow;

use crate::data::initial_state::InitialState;
use crate::data::record::{Dataset, Record};
use crate::error::{Error, Result};
use crate::fit::initial_state::StateRequest;
use crate::fit::law;
use crate::fit::law::random_stops::fit_random_stops;
use crate::fit::network;
use crate::fit::progress::{Fitted, Observer, Progress, SearchProgress, SharedObserver};
use crate::law::facts::Origin;
use crate::model::history::{HistoryPoint, Phase, Run};
use crate::model::input_transform::TransformedData;
use crate::model::{Model, Predictor, Provenance, ProvenanceDraft};
use crate::optimise::parallel;
use crate::options::FitSpec;
use crate::options::classical::ClassicalOptions;
use crate::options::network::Method;
use crate::stop_check::StopCheck;
use crate::termination::Termination;

/// As [`fit::identify`](crate::fit::identify), of one model, which `auto` is not.
pub fn identify(data: &Dataset, request: &FitSpec, observer: &mut Observer<'_>) -> Result<Fitted> {
    match request.has_free_states() && !request.model().has_free_states() {
        true => after_found_pasts(data, request, observer),
        false => from_given_states(data, request, observer),
    }
}

/// Fits of a model and of the past before each record, one after the other, at most. Designed.
const ROUNDS: usize = 3;

/// Share of the training error that a further round must take away. Designed.
const WORTH_A_ROUND: f64 = 0.01;

/// A fit of a model without free states of its own: each record begins in one of the states that are tried where the initial
/// state is unknown; the past before it is found with the model, and the model is fitted after these pasts again (theory.md (11.15)).
fn after_found_pasts(data: &Dataset, request: &FitSpec, observer: &mut Observer<'_>) -> Result<Fitted> {
    let is_given = |record: &Record| record.lead_in().is_some();
    let mut begun = match data.records().iter().any(is_given) {
        true => data.clone(),
        false => StateRequest {
            state: Some(InitialState::Unknown),
            origin: Origin::OfData,
            rate: request.rate(),
            seed: request.seed(),
        }
        .of(data, observer)?
        .into_owned(),
    };
    let mut fit = |round: usize, data: &Dataset| {
        let mut observe = |progress: &Progress<'_>| {
            let done = (round as f64 + progress.done) / (1 + ROUNDS) as f64;
            observer(&Progress { done, ..progress.clone() })
        };
        let fitted = from_given_states(data, request, &mut observe)?;
        let error = fitted.model.evaluate(data)?.rmse;
        Ok((fitted, error))
    };
    let (mut best, mut least) = fit(0, &begun)?;
    let is_stopped = |fitted: &Fitted| fitted.model.provenance().termination == Termination::Stopped;
    for round in 1..=ROUNDS {
        if is_stopped(&best) {
            break;
        }
        let past = |record: &Record| past_before(record, &best.model);
        let pasts: Vec<Vec<f64>> =
            parallel::each(begun.records(), past).into_iter().collect::<Result<_>>()?;
        let after = begun.clone().with_lead_ins(|place, _| pasts[place].clone())?;
        let next = match fit(round, &after) {
            // The model so far remains.
            Err(Error::Stopped) => None,
            next => Some(next?),
        };
        match next {
            Some((fitted, error)) if error < least => {
                let is_worth_another = error < (1.0 - WORTH_A_ROUND) * least;
                (best, begun, least) = (fitted, after, error);
                if !is_worth_another {
                    break;
                }
            }
            Some((fitted, _)) if !is_stopped(&fitted) => break,
            _ => {
                let stopped =
                    Provenance { termination: Termination::Stopped, ..best.model.provenance().clone() };
                best.model = best.model.with_provenance(stopped);
            }
        }
    }
    Ok(best)
}

/// The past of a record that suits all its outputs best; its own without outputs.
fn past_before(record: &Record, model: &Model) -> Result<Vec<f64>> {
    if record.scored() == 0 {
        return Ok(record.lead_in().unwrap_or_default().to_vec());
    }
    let state = model.find_state(&record.excitation().with_known_beginning(record.output())?)?;
    Ok(state.past().unwrap_or_default().to_vec())
}

/// A fit after the given lead-ins of the records.
fn from_given_states(data: &Dataset, request: &FitSpec, observer: &mut Observer<'_>) -> Result<Fitted> {
    match request {
        FitSpec::Network(options) => network::fit(data, options, observer),
        FitSpec::Classical(options) if options.model.is_network() => random_stops(data, options, observer),
        FitSpec::Classical(options) => of_law(data, options, observer),
        FitSpec::Auto(_) => unreachable!("no candidate of auto is auto"),
    }
}

fn random_stops(data: &Dataset, options: &ClassicalOptions, observer: &mut Observer<'_>) -> Result<Fitted> {
    let begun = begun(data, options, Origin::OfData, observer)?;
    let data = begun.as_ref();
    let seen = TransformedData::of(data, &options.shaping, options.rate, Origin::OfData)?;
    let observer = SharedObserver::new(observer, Some(Progress::of_least_squares(options.model)));
    let is_to_stop = || observer.is_to_stop();
    let stop = StopCheck::new(&is_to_stop);
    let wanted = ClassicalOptions { rate: seen.rate, ..options.clone() };
    let found = fit_random_stops(&seen.data, &wanted, stop)?;
    let body = Predictor::Network { network: found.network, scaling: found.scaling };
    finished(data, options, &seen, body, 1, observer.termination(Termination::Converged), Vec::new())
}

fn of_law(data: &Dataset, options: &ClassicalOptions, observer: &mut Observer<'_>) -> Result<Fitted> {
    let mut history = Vec::new();
    let origin = options.model.facts().origin;
    let begun = begun(data, options, origin, observer)?;
    let data = begun.as_ref();
    let seen = TransformedData::of(data, &options.shaping, options.rate, origin)?;
    let of_seen = ClassicalOptions { rate: seen.rate, ..options.clone() };
    let observer = SharedObserver::new(observer, Some(Progress::of_least_squares(options.model)));
    let is_to_stop = || observer.is_to_stop();
    let stop = StopCheck::new(&is_to_stop);
    let mut of_round = |progress: SearchProgress| {
        if !progress.train_nrmse_percent.is_nan() {
            history.push(HistoryPoint {
                epoch: progress.round,
                evaluations: progress.evaluations,
                train_nrmse_percent: progress.train_nrmse_percent,
            });
        }
        let so_far = || {
            let body = Predictor::Law(progress.law_so_far()?);
            let runs = vec![run_of_law(history.clone(), Termination::Stopped)];
            let evaluations = progress.evaluations;
            let fitted = finished(data, options, &seen, body, evaluations, Termination::Stopped, runs);
            Some(fitted.ok()?.model)
        };
        observer.tell(&Progress::of_search(options.model, &progress).with_state(&so_far))
    };
    let found = law::fit(&seen.data, &of_seen, &mut of_round, stop)?;
    let termination = observer.termination(found.termination);
    let runs = if history.is_empty() { Vec::new() } else { vec![run_of_law(history, termination)] };
    let body = Predictor::Law(found.law);
    let fitted = finished(data, options, &seen, body, found.evaluations, termination, runs)?;
    Ok(Fitted { searched: found.searched, ..fitted })
}

fn run_of_law(history: Vec<HistoryPoint>, termination: Termination) -> Run {
    Run {
        phase: Phase::AllData,
        start: 0,
        method: Method::LeastSquares,
        history,
        termination,
        fold: None,
        validation_nrmse_percent: None,
    }
}

/// The data in the requested initial state.
fn begun<'d>(
    data: &'d Dataset,
    options: &ClassicalOptions,
    origin: Origin,
    observer: &mut Observer<'_>,
) -> Result<Cow<'d, Dataset>> {
    let ClassicalOptions { shaping, rate, seed, .. } = *options;
    StateRequest { state: shaping.initial_state, origin, rate, seed }.of(data, observer)
}

fn finished(
    data: &Dataset,
    options: &ClassicalOptions,
    seen: &TransformedData,
    body: Predictor,
    evaluations: usize,
    termination: Termination,
    runs: Vec<Run>,
) -> Result<Fitted> {
    let request = FitSpec::Classical(ClassicalOptions { near: Vec::new(), ..options.clone() });
    let found = ProvenanceDraft { runs, ..ProvenanceDraft::of(request, termination) };
    let model = Model::new(body, seen.preprocessing.clone(), options.rate, data, found)?;
    Ok(Fitted::of(model, evaluations))
}

//! The automatic model: candidates are judged by what they foretell of data held out, and those that do
//! best answer together.
//!
//! 1. *Folds* of the training data, [`crate::validation::folds`].
//! 2. *Candidates*: networks, random stops and classical models, with and without rate, deterioration,
//!    relaxation and companding. Each is fitted to every fold, from several starts where it has any; what it
//!    foretells is the median of its starts.
//! 3. *Choice*: candidates of a kind count by the mean logarithm of their errors, the best three answer by
//!    their weighted median; the kinds count among each other in the same way. Rows inside the trained
//!    range and beyond it are judged apart.
//! 4. *Fit on everything* of all that count, and an [`Ensemble`](crate::model::Ensemble) of them, or one model that follows it.
//! 5. *Band*, calibrated on what was foretold in step 2.
//!
//! Which settings were tried, on which cases, and what they gave: docs/accuracy.md.

mod candidates;
mod choice;
mod jury;
mod panel;
mod selection;
mod single;
mod trials;
mod warm_up;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::identification::Request;
use crate::metrics::{ErrorSums, Errors};
use crate::model::{Band, Body, Model, Provenance};
use crate::preprocessing::Preprocessing;
use crate::rate::RateMethod;
use crate::record::Dataset;
use crate::training::{FEWEST_ROWS, Fit, Observer, Termination};
use crate::validation::folds;
use candidates::{Candidate, Kind, candidates};
use jury::Jury;
use panel::{Panel, Panelist};
pub use selection::{CandidateResult, Selection};
use trials::{Judge, Watch};

/// The name of the automatic model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Automatic {
    /// `auto`
    #[default]
    Auto,
}

/// What the user can decide; what is `None` is decided by validation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AutoOptions {
    /// Marks the request in model files.
    pub model: Automatic,
    /// A model to make an ensemble of; `None` for all candidates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub only: Option<Box<Request>>,
    /// Members at most; 1 for a single model.
    pub members: usize,
    /// Starts of a random candidate, on all data.
    pub starts: usize,
    /// How the rate of the first input is found; `None` for candidates that do not see it.
    pub rate: Option<RateMethod>,
    /// No candidate without the rate.
    pub always_rate: bool,
    /// Whether stops deteriorate.
    pub deterioration: Option<bool>,
    /// Relaxation neurons of candidates that have any; 0 for none at all.
    pub relaxation: Option<usize>,
    /// Stops of a network.
    pub stops: Option<usize>,
    /// Tanh neurons of a network.
    pub hidden: Option<usize>,
    /// Plays, intervals of each axis of a Preisach plane, or random stops.
    pub operators: Option<usize>,
    /// Epochs of a search.
    pub epochs: Option<usize>,
    /// Whether the input is companded.
    pub companding: Option<bool>,
    /// Whether largest input and path so far are inputs.
    pub history: Option<bool>,
    /// Rows at the beginning of each record that drive the memory and are not trained on.
    pub warm_up: Option<usize>,
    /// Seed of all randomness.
    pub seed: u64,
}

impl Default for AutoOptions {
    fn default() -> Self {
        Self {
            model: Automatic::Auto,
            only: None,
            members: 32,
            starts: 8,
            rate: None,
            always_rate: false,
            deterioration: None,
            relaxation: None,
            stops: None,
            hidden: None,
            operators: None,
            epochs: None,
            companding: None,
            history: None,
            warm_up: None,
            seed: 1,
        }
    }
}

/// Most members of an ensemble.
pub const MOST_MEMBERS: usize = 200;

/// Most folds.
const MOST_FOLDS: usize = 5;

/// Starts of a random candidate on each fold.
const STARTS_ON_FOLDS: usize = 4;

/// Rows with an output that candidates are fitted to and judged on, at most; the memory runs through all.
const MOST_ROWS: usize = 6000;

/// Power of theory.md (11.6) among candidates of a kind, and how many of them count.
const POWER_IN_KIND: f64 = 8.0;
const MOST_IN_KIND: usize = 3;

/// The same among kinds.
const POWER_OF_KINDS: f64 = 3.0;

/// Identifies by validation.
///
/// # Errors
/// Data that nothing can be identified from, and decisions that leave no candidate.
pub(crate) fn fit(data: &Dataset, options: &AutoOptions, observer: &mut Observer<'_>) -> Result<Fit> {
    data.check_identifiable(FEWEST_ROWS)?;
    if options.members == 0 || options.members > MOST_MEMBERS {
        return Err(Error::Option(format!("{} members: choose 1 to {MOST_MEMBERS}", options.members)));
    }
    let candidates = match &options.only {
        Some(request) => vec![Candidate::alone(request)],
        None => candidates(data, options),
    };
    let Some(first) =
        candidates.iter().find(|candidate| candidate.kind == Kind::Networks).or(candidates.first())
    else {
        let advice = "no candidate is left by these decisions: take one of them back";
        return Err(Error::Option(advice.into()));
    };
    let few = data.thinned(MOST_ROWS);
    let folds = folds(&few, MOST_FOLDS);
    let judges: Vec<Judge> = folds.iter().map(Judge::of).collect();
    let fits: usize = candidates
        .iter()
        .map(|candidate| judges.len() * if candidate.is_random() { STARTS_ON_FOLDS } else { 1 })
        .sum();
    let watch = Watch::new(observer, 1 + fits + 2 * options.members);

    // Should the observer stop everything soon, this is what there is.
    let alone = watch.first_fit(first, &few)?;
    let rows = options.warm_up.unwrap_or_else(|| warm_up::better(first, &few, &folds, &watch));
    let candidates: Vec<Candidate> = candidates.iter().map(|one| one.warmed_up(rows)).collect();
    let first = &first.warmed_up(rows);
    let mut panels: Vec<Panel> = Vec::new();
    if judges.is_empty() {
        panels.extend(Panel::unjudged(first, &few, options, &watch));
    } else {
        for kind in Kind::ALL {
            let of_kind: Vec<Candidate> = candidates.iter().filter(|one| one.kind == kind).cloned().collect();
            panels.extend(Panel::form(kind, &of_kind, &judges, &few, options, &watch));
        }
    }
    if panels.is_empty() {
        let provenance = provenance_of(&alone, None, None, &watch);
        return Ok(Fit { model: alone.with_provenance(provenance), evaluations: watch.fits() });
    }
    let jury = Jury::of(panels, &judges);
    let ensemble = ensemble(data, options, &jury, &judges, &watch)?;
    if options.members > 1 {
        return Ok(Fit { model: ensemble, evaluations: watch.fits() });
    }
    let Some(panelist) = single::best_alone(&jury, &judges) else {
        return Ok(Fit { model: ensemble, evaluations: watch.fits() });
    };
    let followed = single::following(&ensemble, &panelist.candidate, &few, &watch)?;
    let model = followed.or(panelist.members.first().cloned()).unwrap_or(alone);
    let validation = panelist_errors(panelist, &judges, &data.names().output);
    let provenance = provenance_of(&model, ensemble.provenance().selection.clone(), validation, &watch);
    // It was taught more than the data.
    let (samples, records) = (data.scored(), data.records().len());
    let provenance = Provenance { train: model.evaluate(data)?, samples, records, ..provenance };
    let band = Band::calibrate(&single::rows_held_out(panelist, &judges));
    let model = model.with_provenance(provenance).with_band(band).trained_on(data)?;
    Ok(Fit { model, evaluations: watch.fits() })
}

/// The members of all panels, with what is known of them.
fn ensemble(
    data: &Dataset,
    options: &AutoOptions,
    jury: &Jury,
    judges: &[Judge],
    watch: &Watch,
) -> Result<Model> {
    // A single model follows more than one.
    let most = if options.members == 1 { AutoOptions::default().members } else { options.members };
    let body = Body::Ensemble(jury.ensemble(most, data.input_range(0))?);
    let provenance = Provenance {
        options: Request::Auto(options.clone()),
        samples: data.scored(),
        records: data.records().len(),
        chosen_start: 0,
        termination: if watch.is_stopped() { Termination::Stopped } else { Termination::Converged },
        train: body.errors(None, data)?,
        validation: jury.validation(judges, &data.names().output),
        runs: Vec::new(),
        selection: (!judges.is_empty()).then(|| Selection::of(jury, judges, most)),
    };
    let model = Model::new(body, Preprocessing::default(), options.rate, data, provenance)?;
    Ok(model.with_band(Band::calibrate(&jury.rows_held_out(judges))))
}

/// Errors of a candidate's starts, one by one, on all that was held out.
fn panelist_errors(panelist: &Panelist, judges: &[Judge], output: &str) -> Option<Errors> {
    let mut sums = ErrorSums::default();
    for (starts, judge) in panelist.trial.folds.iter().zip(judges) {
        starts.iter().for_each(|foretold| sums.add(&judge.measured, foretold));
    }
    sums.errors(output)
}

/// How a single model came about that stands for all.
fn provenance_of(
    model: &Model,
    selection: Option<Selection>,
    validation: Option<Errors>,
    watch: &Watch,
) -> Provenance {
    let provenance = model.provenance().clone();
    let termination = if watch.is_stopped() { Termination::Stopped } else { provenance.termination };
    Provenance { termination, validation, selection, ..provenance }
}

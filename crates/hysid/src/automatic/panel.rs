//! The candidates of one kind, judged and fitted: a panel that answers by the weighted median of its best.

use rayon::prelude::*;

use crate::automatic::candidates::{Candidate, Kind};
use crate::automatic::choice::{Score, medians, of_starts, weights};
use crate::automatic::trials::{Judge, Trial, Watch, try_all};
use crate::automatic::{AutoOptions, MOST_IN_KIND, POWER_IN_KIND, STARTS_ON_FOLDS};
use crate::model::{Model, Weights};
use crate::record::Dataset;

/// A candidate that was judged.
pub(super) struct Panelist {
    pub candidate: Candidate,
    pub score: Score,
    pub weights: Weights,
    pub trial: Trial,
    /// The median of its starts, fold by fold.
    pub foretold: Vec<Vec<f64>>,
    /// Its fits to everything; none if it does not count.
    pub members: Vec<Model>,
}

/// All candidates of a kind.
pub(super) struct Panel {
    pub kind: Kind,
    pub panelists: Vec<Panelist>,
    /// What they answer together, fold by fold.
    pub foretold: Vec<Vec<f64>>,
}

impl Panel {
    /// Tries the candidates, weighs them, and fits those that count to everything. `None` if there was
    /// no time for it, or none could be fitted.
    pub fn form(
        kind: Kind,
        candidates: &[Candidate],
        judges: &[Judge],
        data: &Dataset,
        options: &AutoOptions,
        watch: &Watch,
    ) -> Option<Self> {
        let trials = try_all(candidates, judges, STARTS_ON_FOLDS, watch);
        let judged = candidates.iter().zip(trials).filter_map(|(candidate, trial)| Some((candidate, trial?)));
        let mut panelists: Vec<Panelist> = judged
            .map(|(candidate, trial)| {
                let foretold = of_starts(&trial);
                Panelist {
                    candidate: candidate.clone(),
                    score: Score::of(&foretold, judges),
                    weights: Weights { inside: 0.0, outside: 0.0 },
                    trial,
                    foretold,
                    members: Vec::new(),
                }
            })
            .collect();
        let scores: Vec<Score> = panelists.iter().map(|panelist| panelist.score).collect();
        for (panelist, weights) in panelists.iter_mut().zip(weights(&scores, POWER_IN_KIND, MOST_IN_KIND)) {
            panelist.weights = weights;
        }
        fit_members(&mut panelists, data, options, watch);
        // Those whose fits were not reached in time cannot be heard.
        panelists.iter_mut().filter(|one| one.members.is_empty()).for_each(|one| one.weights = NO_WEIGHT);
        let voices: Vec<&Panelist> = panelists.iter().filter(|one| one.counts()).collect();
        if voices.is_empty() {
            return None;
        }
        let weights: Vec<Weights> = voices.iter().map(|voice| voice.weights).collect();
        let foretold = judges.iter().enumerate().map(|(fold, judge)| {
            let of_fold: Vec<&[f64]> = voices.iter().map(|voice| voice.foretold[fold].as_slice()).collect();
            medians(&of_fold, &weights, &judge.outside)
        });
        Some(Self { kind, foretold: foretold.collect(), panelists })
    }

    /// A panel of one candidate that nobody judged, for data too few to hold any out.
    pub fn unjudged(
        candidate: &Candidate,
        data: &Dataset,
        options: &AutoOptions,
        watch: &Watch,
    ) -> Option<Self> {
        let mut panelist = Panelist {
            candidate: candidate.clone(),
            score: Score { inside: 0.0, outside: 0.0 },
            weights: Weights::equal(),
            trial: Trial { folds: Vec::new() },
            foretold: Vec::new(),
            members: Vec::new(),
        };
        fit_members(std::slice::from_mut(&mut panelist), data, options, watch);
        let is_fitted = !panelist.members.is_empty();
        is_fitted.then(|| Self { kind: candidate.kind, panelists: vec![panelist], foretold: Vec::new() })
    }

    /// Those that are heard.
    pub fn voices(&self) -> impl Iterator<Item = &Panelist> {
        self.panelists.iter().filter(|panelist| panelist.counts())
    }
}

const NO_WEIGHT: Weights = Weights { inside: 0.0, outside: 0.0 };

/// Share of the weight of all below which a candidate is not fitted.
const TOO_LITTLE: f64 = 0.02;

impl Panelist {
    pub fn counts(&self) -> bool {
        self.weights.inside > 0.0 || self.weights.outside > 0.0
    }
}

/// Fits those that count to everything, the more often the more they count.
fn fit_members(panelists: &mut [Panelist], data: &Dataset, options: &AutoOptions, watch: &Watch) {
    let sum = |weight: fn(&Weights) -> f64| -> f64 {
        panelists.iter().map(|panelist| weight(&panelist.weights)).sum::<f64>().max(f64::MIN_POSITIVE)
    };
    let (inside, outside) = (sum(|weights| weights.inside), sum(|weights| weights.outside));
    for panelist in panelists.iter_mut() {
        let weights = &mut panelist.weights;
        if weights.inside < TOO_LITTLE * inside && weights.outside < TOO_LITTLE * outside {
            *weights = NO_WEIGHT;
        }
    }
    let jobs: Vec<(usize, usize)> = panelists
        .iter()
        .enumerate()
        .filter(|(_, panelist)| panelist.counts())
        .flat_map(|(place, panelist)| {
            let starts = if panelist.candidate.is_random() { options.starts } else { 1 };
            let share = (panelist.weights.inside / inside).max(panelist.weights.outside / outside);
            let fair = (share * options.members as f64).ceil() as usize;
            (0..starts.min(fair.max(1))).map(move |start| (place, start))
        })
        .collect();
    let fitted: Vec<Option<Model>> = jobs
        .par_iter()
        .map(|&(place, start)| watch.fit(&panelists[place].candidate, data, start).ok().flatten())
        .collect();
    for (&(place, _), model) in jobs.iter().zip(fitted) {
        panelists[place].members.extend(model);
    }
}

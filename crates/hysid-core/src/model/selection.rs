//! How a model was chosen among candidates.

use serde::{Deserialize, Serialize};

use crate::model::Weights;
use crate::options::preset::listed;
use crate::significant::Significant;

/// Cross-validation of candidates: the folds, and the error of each candidate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Selection {
    /// Name of the held-out data of each fold.
    pub folds: Vec<String>,
    /// Error of the ensemble in percent of the standard deviation, inside and outside the trained range:
    /// geometric mean over the folds of `rmse_f / σ_f`, with the standard deviation `σ_f` of the output on
    /// fold `f` (theory.md (11.5)).
    pub error_percent: (f64, f64),
    /// The candidates, the best of each kind first.
    pub candidates: Vec<CandidateResult>,
    /// How a single model was chosen; `None` for an ensemble.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub single: Option<SingleModel>,
    /// The warm-up: rows at the beginning of each record that were not scored in training; `None` if there
    /// are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warm_up: Option<WarmUp>,
    /// Errors by which initial states were found for the records; `None` if cross-validation did not decide it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub found_states: Option<FoundStates>,
    /// True if all reversals of the first input lie at the ends of its range. Such data cannot distinguish
    /// candidates inside the loop. The weights then also use errors on generated cases, and the band is
    /// wider.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub one_loop: bool,
    /// Candidates that were dropped early because their errors were far above the best.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub dropped: Vec<String>,
}

impl Selection {
    /// The choice and its reason, in two lines.
    pub fn summary(&self) -> [String; 2] {
        let mut kinds: Vec<&str> = self.candidates.iter().map(|one| one.kind.as_str()).collect();
        kinds.dedup();
        [self.chosen(&kinds), self.why(&kinds)]
    }

    fn chosen(&self, kinds: &[&str]) -> String {
        if let Some(SingleModel { name, distilled, .. }) = &self.single {
            return match distilled {
                true => format!("one {name}, distilled from the ensemble"),
                false => format!("one {name}, fitted to the data alone"),
            };
        }
        let count = |kind: &str| -> usize {
            self.candidates.iter().filter(|one| one.kind == kind).map(|one| one.members).sum()
        };
        let parts = kinds.iter().filter(|kind| count(kind) > 0);
        let parts: Vec<String> = parts.map(|kind| counted(count(kind), kind)).collect();
        let most = self.candidates.iter().max_by(|a, b| a.share.inside.total_cmp(&b.share.inside));
        let leading = most.map_or("", |one| one.name.as_str());
        match kinds.iter().map(|kind| count(kind)).sum() {
            1 => format!("{}: {leading}", listed(&parts)),
            _ => {
                let parts = listed(&parts);
                format!("ensemble of {parts}, combined by weighted medians; largest weight: {leading}")
            }
        }
    }

    fn why(&self, kinds: &[&str]) -> String {
        let percent = |error: (f64, f64)| format!("{:.3} %", Significant(error.0));
        let ensemble = format!("ensemble {}", percent(self.error_percent));
        let errors = match &self.single {
            Some(SingleModel { distilled_percent, plain_percent, .. }) => {
                let distilled = distilled_percent.map(|error| format!("distilled model {}", percent(error)));
                let plain = format!("best single fit {}", percent(*plain_percent));
                distilled.into_iter().chain([plain, ensemble]).collect::<Vec<String>>().join(", ")
            }
            None => {
                let best_of = |kind: &&str| {
                    let of_kind = self.candidates.iter().filter(|one| one.kind == **kind);
                    let best = of_kind.min_by(|a, b| a.error_percent.0.total_cmp(&b.error_percent.0))?;
                    Some(format!("{} {}", best.name, percent(best.error_percent)))
                };
                let bests: Vec<String> = kinds.iter().filter_map(best_of).collect();
                format!("{ensemble}; best of each kind alone: {}", bests.join(", "))
            }
        };
        let folds = self.folds.len();
        format!("cross-validation error (geometric mean over {folds} folds, in % of std): {errors}")
    }
}

/// So many models of a kind.
fn counted(count: usize, kind: &str) -> String {
    let one = match kind {
        "networks" => "network",
        "classical" => "classical model",
        "random stops" => "random-stops network",
        "recurrent" => "recurrent network",
        "dynamic" => "model with inertia",
        other => other,
    };
    match (count, kind) {
        (1, _) => format!("1 {one}"),
        (_, "dynamic") => format!("{count} models with inertia"),
        _ => format!("{count} {one}s"),
    }
}

/// Cross-validation result of a candidate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CandidateResult {
    /// Name of the candidate.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Its error, in percent, as that of the ensemble.
    pub error_percent: (f64, f64),
    /// Its share of all weights in the ensemble, inside and outside.
    pub share: Weights,
    /// Number of its fits in the ensemble.
    pub members: usize,
    /// Error of the ensemble without it, in percent; `None` if it has no weight.
    pub without_percent: Option<(f64, f64)>,
}

/// How a requested single model was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SingleModel {
    /// The candidate of which it is a fit.
    pub name: String,
    /// True if it was distilled from the ensemble, false if it was fitted to the data alone. The smaller error decides;
    /// the distance from the ensemble on paths that were not measured is part of it (theory.md (11.13)).
    pub distilled: bool,
    /// Error of the distilled model on held-out data, in percent, as that of the ensemble; `None` if none was
    /// made.
    pub distilled_percent: Option<(f64, f64)>,
    /// Error of the best candidate fitted to the data alone, from one start, in percent, as that of the
    /// ensemble.
    pub plain_percent: (f64, f64),
}

/// Warm-up: rows at the beginning of each record that advance the memory and are not scored in training, and
/// their effect.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WarmUp {
    /// Number of rows of each record.
    pub rows: usize,
    /// Cross-validated error on the later rows, in percent of the standard deviation, of a quick model
    /// trained without the rows of the warm-up; `None` if the user chose the warm-up.
    pub without_percent: Option<f64>,
    /// The same of a model trained with them.
    pub with_percent: Option<f64>,
}

impl WarmUp {
    /// A warm-up chosen by the user.
    pub fn decided(rows: usize) -> Self {
        Self { rows, without_percent: None, with_percent: None }
    }
}

/// Effect of initial states that were found for the records: cross-validated errors of the better of two quick
/// models, in percent of the standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FoundStates {
    /// Error with the states that were found; held-out records begin in the most frequent one.
    pub found_percent: f64,
    /// Error from the virgin state.
    pub virgin_percent: f64,
}

//! How a model was chosen among candidates.

use serde::{Deserialize, Serialize};

use crate::model::Weights;
use crate::options::default_words::listed;
use crate::significant::Significant;

/// Cross-validation of candidates: the folds, and the error of each candidate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Selection {
    /// Name of the held-out data of each fold.
    pub folds: Vec<String>,
    /// Held-out error of the ensemble: RMSE over the rows that were held out, in percent of their standard deviation, with
    /// weights that were found on the other folds. It is the validation error of an ensemble. Where folds lie between
    /// the others in amplitude and speed, only these count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held_out_percent: Option<f64>,
    /// The error on records beyond the others, which is no part of the held-out error unless all folds are of this kind;
    /// `None` without such a fold.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond: Option<Beyond>,
    /// Error by which candidates are weighted, in percent of the standard deviation, inside and outside the trained range:
    /// geometric mean over the folds of `rmse_f / σ_f`, with the standard deviation `σ_f` of the output on
    /// fold `f` (theory.md (11.5)).
    pub error_percent: (f64, f64),
    /// The candidates, the best of each kind first.
    pub candidates: Vec<CandidateResult>,
    /// How a single model was chosen; `None` for an ensemble.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub single: Option<SingleModel>,
    /// The warm-up; `None` if there is none.
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

    /// Rows behind the validation errors, in words.
    pub fn held_out_rows(&self) -> String {
        let all = self.folds.len();
        match &self.beyond {
            None => format!("errors on the rows held out in {all} folds"),
            Some(Beyond { folds, .. }) if folds.len() == all => format!(
                "errors on records beyond the rest in amplitude or speed, held out in {all} folds; the error between the \
                 records is usually smaller"
            ),
            Some(Beyond { folds, percent }) => format!(
                "errors on the rows held out in {} of {all} folds; the others hold out records beyond the rest in \
                 amplitude or speed, with an error of {:.3} % of std",
                all - folds.len(),
                Significant(*percent)
            ),
        }
    }

    fn chosen(&self, kinds: &[&str]) -> String {
        if let Some(SingleModel { name, distilled, is_law, .. }) = &self.single {
            return match (is_law, distilled) {
                (true, _) => format!("{name}, a law, in place of an ensemble"),
                (false, true) => format!("one {name}, trained to imitate the ensemble"),
                (false, false) => format!("one {name}, fitted to the data alone"),
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

    /// Held-out errors of the ensemble and of the best of each kind, and why the lowest did not decide.
    fn why(&self, kinds: &[&str]) -> String {
        let percent = |error: Option<f64>| match error {
            Some(error) => format!("{:.3} %", Significant(error)),
            None => "unknown".into(),
        };
        let (errors, reason) = match &self.single {
            Some(SingleModel { distilled, distilled_percent, plain_percent, is_law: false, .. }) => {
                let of_distilled = distilled_percent
                    .map(|error| format!("model trained to imitate the ensemble {}", percent(Some(error))));
                let plain = format!("best single fit {}", percent(*plain_percent));
                let errors: Vec<String> = of_distilled.into_iter().chain([plain]).collect();
                let is_lower =
                    distilled_percent.zip(*plain_percent).is_none_or(|(d, p)| (d <= p) == *distilled);
                let reason = match (is_lower, distilled) {
                    (true, _) => "",
                    (false, true) => {
                        "; this model agrees better with the ensemble on inputs that were not measured"
                    }
                    (false, false) => {
                        "; the single fit agrees better with the ensemble on inputs that were not measured"
                    }
                };
                (errors.join(", "), reason)
            }
            law => {
                let error = |one: &CandidateResult| one.held_out_percent.unwrap_or(f64::INFINITY);
                let best_of = |kind: &&str| {
                    let of_kind = self.candidates.iter().filter(|one| one.kind == **kind);
                    of_kind.min_by(|a, b| error(a).total_cmp(&error(b)))
                };
                let bests: Vec<&CandidateResult> = kinds.iter().filter_map(best_of).collect();
                let alone =
                    |one: &&CandidateResult| format!("{} {}", one.name, percent(one.held_out_percent));
                let lowest = bests.iter().map(|one| error(one)).fold(f64::INFINITY, f64::min);
                let is_lowest = self.held_out_percent.is_none_or(|ensemble| ensemble <= lowest);
                let reason = match (is_lowest, law, self.one_loop) {
                    (true, ..) => "",
                    (false, Some(_), _) => {
                        "; a law of few numbers, or one that holds beyond the data, is preferred where the product of its errors, on the data and on the folds, is about the lowest"
                    }
                    (false, None, true) => "; one loop does not tell how well smaller loops are predicted",
                    (false, None, false) => {
                        "; one of them alone would be taken if its error were lower than that of the ensemble by 10 %, and lower in the mean of the folds"
                    }
                };
                let bests: Vec<String> = bests.iter().map(alone).collect();
                let this = law.as_ref().map_or("ensemble", |law| law.name.as_str());
                let held_out = percent(self.held_out_percent);
                (format!("{this} {held_out}; best of each kind alone: {}", bests.join(", ")), reason)
            }
        };
        format!("error on the rows held out (RMSE in % of std): {errors}{reason}")
    }
}

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

/// Records that were held out and lie beyond the others: in amplitude or speed, they are larger or smaller than all that
/// was fitted to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Beyond {
    /// Name of the held-out data of each such fold.
    pub folds: Vec<String>,
    /// RMSE over all rows of these folds, in percent of their standard deviation.
    pub percent: f64,
}

/// Cross-validation result of a candidate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CandidateResult {
    /// Name of the candidate.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Its held-out error, in percent of the standard deviation, as that of the ensemble.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held_out_percent: Option<f64>,
    /// The error by which it is weighted, in percent, as that of the ensemble.
    pub error_percent: (f64, f64),
    /// Its share of all weights in the ensemble, inside and outside.
    pub share: Weights,
    /// Number of its fits in the ensemble.
    pub members: usize,
}

/// How a single model was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SingleModel {
    /// The candidate of which it is a fit.
    pub name: String,
    /// True if it was distilled from the ensemble, false if it was fitted to the data alone. The smaller error decides;
    /// the distance from the ensemble on paths that were not measured is part of it (theory.md (11.13)).
    pub distilled: bool,
    /// Held-out error of the distilled model, in percent, as that of the ensemble; `None` if none was made.
    pub distilled_percent: Option<f64>,
    /// Held-out error of the best candidate fitted to the data alone, in percent, as that of the ensemble.
    pub plain_percent: Option<f64>,
    /// True for a law of few numbers, or one that holds beyond the data: the product of its errors, on the data and on the
    /// folds, is about the lowest of all candidates. It was not requested, but takes the place of the ensemble.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_law: bool,
}

/// Warm-up: first rows of each record that are not scored in training, and their effect.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WarmUp {
    /// Number of rows of each record.
    pub rows: usize,
    /// Cross-validated error on later rows without training on the warm-up, in percent; `None` if the user chose it.
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

/// Effect of found or periodic initial states: cross-validated errors of a quick model, in percent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FoundStates {
    /// Error with these states; held-out records begin in the most frequent, or after a period of themselves.
    pub found_percent: f64,
    /// Error from the virgin state.
    pub virgin_percent: f64,
}

//! Whether the records begin in the virgin state: if not, their first rows had better not be trained on.

use serde::{Deserialize, Serialize};

use crate::automatic::candidates::Candidate;
use crate::automatic::score::Score;
use crate::automatic::trial::{Bench, HeldOut, Trial};
use crate::automatic::work::Work;
use crate::record::Dataset;
use crate::validation::Fold;

/// Share of the shortest record that is left out of the training. Designed.
const SHARE: f64 = 0.05;

/// What leaving rows out must better the error by to be worth it. Designed.
const WORTH: f64 = 0.9;

/// Rows at the beginning of each record that drive the memory and are not trained on, and what that changes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WarmUp {
    /// Rows of each record.
    pub rows: usize,
    /// Cross-validated error of a quick model that was not trained on them, on the rows behind, in percent of
    /// the standard deviation (theory.md 11.5); `None` where the user has decided.
    pub without_percent: Option<f64>,
    /// The same of a model that was.
    pub with_percent: Option<f64>,
}

impl WarmUp {
    /// So many rows, because the user has decided so.
    pub(super) fn decided(rows: usize) -> Self {
        Self { rows, without_percent: None, with_percent: None }
    }
}

/// Rows at the beginning of each record that are better not trained on: 0, or a share of the shortest
/// record. Both ways are judged on the same rows, behind those, by a candidate that is quickly fitted.
pub(super) fn better(quick: Candidate, data: &Dataset, folds: &[Fold], work: &Work) -> WarmUp {
    let none = WarmUp::decided(0);
    let shortest = data.records().iter().map(|record| record.len()).min().unwrap_or_default();
    let rows = (SHARE * shortest as f64) as usize;
    let is_scored = data.records().iter().any(|record| record.output()[..rows].iter().any(|y| !y.is_nan()));
    if !is_scored {
        return none;
    }
    let behind =
        folds.iter().map(|fold| Fold { held_out: fold.held_out.clone().warmed_up(rows), ..fold.clone() });
    let folds: Vec<HeldOut> = behind.filter(|fold| fold.held_out.scored() > 0).map(HeldOut::of).collect();
    let mut trials = [Trial::of(quick.clone()), Trial::of(quick.warmed_up(rows))];
    Bench { data, folds: &folds, work }.try_start(&mut trials, &[0, 1], 0);
    let error = |trial: &Trial| {
        let score = (!trial.starts.is_empty()).then(|| Score::of(&trial.predicted, &folds, |_| true))?;
        Some(100.0 * (0.5 * score.sum()).exp())
    };
    match (error(&trials[0]), error(&trials[1])) {
        (Some(with), Some(without)) if without < WORTH * with => {
            WarmUp { rows, without_percent: Some(without), with_percent: Some(with) }
        }
        _ => none,
    }
}

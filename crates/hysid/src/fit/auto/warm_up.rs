//! Warm-up: decides whether the records begin in the virgin state. If not, their first rows are not scored in
//! training.

use crate::data::record::Dataset;
use crate::fit::auto::candidates::Candidate;
use crate::fit::auto::score::Score;
use crate::fit::auto::trial::{FoldBench, HeldOut, Trial};
use crate::fit::auto::work::AutoWork;
use crate::model::selection::WarmUp;
use crate::validation::Fold;

/// Share of the shortest record that is left out of the training. Designed.
const SHARE: f64 = 0.05;

/// Factor on the error that leaving rows out must reach to be worth it. Designed.
const WORTH: f64 = 0.9;

/// Rows to leave out at the beginning of each record: 0 or a share of the shortest, compared on the same later rows.
pub(super) fn better(quick: Candidate, data: &Dataset, folds: &[Fold], work: &AutoWork) -> WarmUp {
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
    FoldBench { data, whole: data, folds: &folds, work }.try_start(&mut trials, &[0, 1], 0);
    let error = |trial: &Trial| {
        (!trial.starts.is_empty()).then(|| Score::of(&trial.predicted, &folds, |_| true).mean_percent())
    };
    match (error(&trials[0]), error(&trials[1])) {
        (Some(with), Some(without)) if without < WORTH * with => {
            WarmUp { rows, without_percent: Some(without), with_percent: Some(with) }
        }
        _ => none,
    }
}

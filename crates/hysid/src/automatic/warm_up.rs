//! Whether the records begin in the virgin state: if not, their first rows had better not be trained on.

use crate::automatic::STARTS_ON_FOLDS;
use crate::automatic::candidates::Candidate;
use crate::automatic::choice::{Score, of_starts};
use crate::automatic::trials::{Judge, Watch, try_all};
use crate::record::Dataset;
use crate::validation::Fold;

/// Share of the shortest record that is left out of the training. Designed.
const SHARE: f64 = 0.05;

/// What leaving rows out must better the error by to be worth it. Designed.
const WORTH: f64 = 0.9;

/// Rows at the beginning of each record that are better not trained on: 0, or a share of the shortest
/// record. Both ways are judged on the same rows, behind those.
pub(super) fn better(candidate: &Candidate, data: &Dataset, folds: &[Fold], watch: &Watch) -> usize {
    let shortest = data.records().iter().map(|record| record.len()).min().unwrap_or_default();
    let rows = (SHARE * shortest as f64) as usize;
    let is_scored = data.records().iter().any(|record| record.output()[..rows].iter().any(|y| !y.is_nan()));
    if !is_scored {
        return 0;
    }
    let folds: Vec<Fold> = folds
        .iter()
        .map(|fold| Fold { held_out: fold.held_out.clone().warmed_up(rows), ..fold.clone() })
        .collect();
    let judges: Vec<Judge> = folds.iter().filter(|fold| fold.held_out.scored() > 0).map(Judge::of).collect();
    let both = [candidate.clone(), candidate.warmed_up(rows)];
    let trials = try_all(&both, &judges, STARTS_ON_FOLDS, watch);
    let error = |trial: usize| {
        let score = Score::of(&of_starts(trials[trial].as_ref()?), &judges);
        Some((0.5 * (score.inside + score.outside)).exp())
    };
    match (error(0), error(1)) {
        (Some(from_the_beginning), Some(after)) if after < WORTH * from_the_beginning => rows,
        _ => 0,
    }
}

//! Cross-validation results for the model file.

use crate::fit::auto::combination::Combination;
use crate::fit::auto::errors_held_out;
use crate::fit::auto::score::Score;
use crate::fit::auto::trial::{HeldOut, Trial};
use crate::model::Weights;
use crate::model::selection::{CandidateResult, Selection};

pub(super) fn selection(
    trials: &[Trial],
    left_out: &[Trial],
    folds: &[HeldOut],
    combination: &Combination,
    output: &str,
) -> Selection {
    let shares = combination.shares();
    let result = |(place, trial): (usize, &Trial)| {
        let share = shares.iter().find(|(other, _)| *other == place).map(|(_, share)| *share);
        CandidateResult {
            name: trial.candidate.name(),
            kind: trial.candidate.kind.name().into(),
            held_out_percent: errors_held_out(&trial.predicted, folds, output)
                .and_then(|errors| errors.nrmse_std_percent),
            error_percent: Score::of(&trial.predicted, folds, |_| true).percent(),
            share: share.unwrap_or(Weights { inside: 0.0, outside: 0.0 }),
            members: combination.members(place),
        }
    };
    // Those that were left out have places that no share belongs to.
    let tried = trials.iter().chain(left_out).enumerate().filter(|(_, trial)| trial.is_complete());
    let mut candidates: Vec<CandidateResult> = tried.map(result).collect();
    let kinds: Vec<String> =
        shares.iter().map(|(place, _)| trials[*place].candidate.kind.name().into()).collect();
    let of_kind = |kind: &String| kinds.iter().position(|other| other == kind).unwrap_or(kinds.len());
    candidates.sort_by(|a, b| {
        let by_kind = of_kind(&a.kind).cmp(&of_kind(&b.kind)).then(a.kind.cmp(&b.kind));
        by_kind.then(a.error_percent.0.total_cmp(&b.error_percent.0))
    });
    Selection {
        folds: folds.iter().map(|fold| fold.fold.name.clone()).collect(),
        held_out_percent: None,
        beyond: None,
        error_percent: combination.score(trials, folds).percent(),
        candidates,
        single: None,
        warm_up: None,
        found_states: None,
        one_loop: false,
        dropped: Vec::new(),
    }
}

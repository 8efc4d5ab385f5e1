//! Which branches are first-order reversal curves.

use crate::branch::{Branch, BranchSet};

/// Fewest curves with different reversal inputs.
const FEWEST: usize = 5;

/// Share of the branches of their direction that the curves, repeated ones too, must be.
const MOST: f64 = 0.6;

/// Reversal inputs closer than this share of the input's range are the same.
const SAME: f64 = 0.002;

/// The curves that were found.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CurveSet {
    /// True if the input rises along them.
    pub rising: bool,
    pub end: f64,
    /// Numbers of the branches, from the reversal input next to the end to the furthest.
    pub branches: Vec<usize>,
    /// Curves with the reversal input of another.
    pub repeated: usize,
}

/// The first-order reversal curves of the direction with more of them.
pub(super) fn recognised(survey: &BranchSet) -> Option<CurveSet> {
    let (rising, falling) = (of_direction(survey, true), of_direction(survey, false));
    let count = |found: &Option<CurveSet>| found.as_ref().map_or(0, |found| found.branches.len());
    if count(&falling) > count(&rising) { falling } else { rising }
}

fn of_direction(survey: &BranchSet, rising: bool) -> Option<CurveSet> {
    let sign = if rising { 1.0 } else { -1.0 };
    let end = if rising { survey.input.1 } else { survey.input.0 };
    let reaches = |x: f64| (x - end).abs() <= survey.same_input();
    let in_direction = || survey.branches.iter().enumerate().filter(|(_, branch)| branch.rises() == rising);
    let begins_on_the_outer_branch = |number: usize, branch: &Branch| {
        match number.checked_sub(1).map(|before| &survey.branches[before]) {
            Some(before) if before.record == branch.record => reaches(before.from),
            // A record of a single curve begins at its reversal; what came before was not recorded.
            _ => survey.of_record(branch.record).len() == 1,
        }
    };
    let is_curve = |(number, branch): &(usize, &Branch)| {
        reaches(branch.to) && !branch.curve.is_empty() && begins_on_the_outer_branch(*number, branch)
    };
    let mut branches: Vec<usize> = in_direction().filter(is_curve).map(|(number, _)| number).collect();
    let all = branches.len();
    let from = |number: usize| sign * survey.branches[number].from;
    branches.sort_by(|&a, &b| from(b).total_cmp(&from(a)));
    let same = SAME * survey.width() + 2.0 * survey.input_noise.deviation();
    branches.dedup_by(|next, kept| from(*kept) - from(*next) <= same);
    let is_most = all as f64 >= MOST * in_direction().count() as f64;
    (branches.len() >= FEWEST && is_most).then(|| CurveSet {
        rising,
        // The mean of the ends, which noise moves.
        end: branches.iter().map(|&number| survey.branches[number].to).sum::<f64>() / branches.len() as f64,
        repeated: all - branches.len(),
        branches,
    })
}

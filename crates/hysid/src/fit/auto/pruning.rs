//! Pruning: members that the error on held-out data hardly depends on are removed, one at a time, those first
//! whose removal leaves the smallest error.

use rayon::prelude::*;

use crate::fit::auto::combination::{Combination, Leaf, predictions};
use crate::fit::auto::prior::Evidence;
use crate::fit::auto::score::Score;
use crate::fit::auto::trial::{HeldOut, Rows, Trial};

/// Largest error of what is kept, relative to the smallest error that was found.
const WORTH: f64 = 1.02;

/// Held-out rows that removals are compared on, at most, all folds together.
const MOST_ROWS: usize = 3000;

/// What a combination is pruned by.
#[derive(Clone, Copy)]
pub(super) struct Pruning<'t> {
    pub trials: &'t [Trial],
    pub folds: &'t [HeldOut],
    pub evidence: Evidence,
    /// Leaves at most.
    pub most: usize,
}

impl Pruning<'_> {
    /// The combination with as few leaves as have an error within 2 % of the smallest one on the folds that are
    /// `counted`, and at most as many as are allowed.
    pub fn of(self, all: Combination, counted: impl Fn(usize) -> bool + Copy + Sync) -> Combination {
        let rows: usize = self.folds.iter().map(|fold| fold.rows.measured.len()).sum();
        let step = rows.div_ceil(MOST_ROWS).max(1);
        let thinned: Vec<Rows> = self.folds.iter().map(|fold| fold.rows.every(step)).collect();
        let score = |combination: &Combination| -> f64 {
            let of_leaf = |leaf: usize, fold: usize, row: usize| {
                combination.predicted(self.trials, leaf, fold)[step * row]
            };
            let predicted = predictions(combination.group(), of_leaf, &thinned);
            let prior = combination.prior(self.trials, self.evidence);
            Score::of(&predicted, &thinned, counted).with_prior(prior).sum() / 2.0
        };
        let mut smallest = score(&all);
        let mut kept = all;
        while kept.leaves().len() > 1 {
            let without = |gone: &Leaf| kept.only(|leaf| leaf != *gone).map(|left| (score(&left), left));
            let left: Vec<(f64, Combination)> = kept.leaves().par_iter().filter_map(without).collect();
            let Some((error, left)) = left.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            if error > smallest + WORTH.ln() && kept.leaves().len() <= self.most {
                break;
            }
            smallest = smallest.min(error);
            kept = left;
        }
        kept
    }
}

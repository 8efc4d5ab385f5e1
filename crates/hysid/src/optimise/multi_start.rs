//! A search from several starts in parallel: all advance round by round, and those with the worst results are
//! dropped.
//!
//! The result does not depend on the number of threads: starts advance independently and are compared in
//! their order. Starts of networks are not dropped, and their fit is stored between rounds: see
//! `fit/network/fitting.rs`.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use crate::optimise::parallel;
use crate::termination::Termination;

pub(crate) trait SearchStart: Send {
    /// Which of two is the better, which comes first.
    fn order(&self, other: &Self) -> Ordering;

    fn evaluations(&self) -> usize;

    fn ended(&self) -> Option<Termination>;
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct RoundPlan {
    /// Rounds at most.
    pub rounds: usize,
    /// Rounds at first in which no start is given up and the search does not end.
    pub spared: usize,
    /// Further rounds after which half of the starts are given up, and again after as many more.
    pub to_prove_itself: usize,
    /// Starts that are never given up.
    pub finalists: usize,
}

#[derive(Debug, Clone)]
pub(crate) struct MultiStart<S> {
    starts: Vec<S>,
    /// Evaluations of starts that were given up.
    given_up: usize,
}

impl<S: SearchStart> MultiStart<S> {
    /// Starts in their order; at least one.
    pub fn new(starts: Vec<S>) -> Self {
        Self { starts, given_up: 0 }
    }

    /// Advances all starts in rounds, counted from 1, until all have ended or `tell` breaks.
    pub fn run(
        &mut self,
        plan: RoundPlan,
        advance: impl Fn(&mut S, usize) + Sync,
        mut tell: impl FnMut(&Self, usize) -> ControlFlow<()>,
    ) -> Termination {
        for round in 1..=plan.rounds {
            parallel::each_taken(&mut self.starts, |start| advance(start, round));
            self.sort();
            let judged = round.saturating_sub(plan.spared);
            if judged > 0 && judged.is_multiple_of(plan.to_prove_itself) {
                let keep = self.starts.len().div_ceil(2).max(plan.finalists).min(self.starts.len());
                self.given_up += self.starts.drain(keep..).map(|start| start.evaluations()).sum::<usize>();
            }
            if tell(self, round).is_break() {
                return Termination::Stopped;
            }
            if judged > 0 && self.starts.iter().all(|start| start.ended().is_some()) {
                return self.best().ended().unwrap_or(Termination::Converged);
            }
        }
        Termination::EpochsUsed
    }

    /// Puts the best first. Stable: of equals the earlier start stays before the later.
    pub fn sort(&mut self) {
        self.starts.sort_by(S::order);
    }

    /// The best start.
    pub fn best(&self) -> &S {
        &self.starts[0]
    }

    /// All that were not given up.
    pub fn starts_mut(&mut self) -> &mut [S] {
        &mut self.starts
    }

    /// Evaluations of all starts together.
    pub fn evaluations(&self) -> usize {
        self.given_up + self.starts.iter().map(S::evaluations).sum::<usize>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A start whose cost falls to a tenth in each round, down to its own valley.
    #[derive(Debug, Clone)]
    struct Falling {
        valley: f64,
        cost: f64,
        rounds: usize,
    }

    impl SearchStart for Falling {
        fn order(&self, other: &Self) -> Ordering {
            self.cost.total_cmp(&other.cost)
        }

        fn evaluations(&self) -> usize {
            self.rounds
        }

        fn ended(&self) -> Option<Termination> {
            (self.cost == self.valley).then_some(Termination::Converged)
        }
    }

    fn starts() -> MultiStart<Falling> {
        let valley = |k: usize| 1e-9 * [5.0, 3.0, 8.0, 2.0, 9.0, 4.0, 7.0][k];
        MultiStart::new((0..7).map(|k| Falling { valley: valley(k), cost: 1.0, rounds: 0 }).collect())
    }

    fn fall(start: &mut Falling, _: usize) {
        if start.ended().is_none() {
            start.cost = (0.1 * start.cost).max(start.valley);
            start.rounds += 1;
        }
    }

    #[test]
    fn the_best_is_found_and_those_behind_are_given_up() {
        let plan = RoundPlan { rounds: 100, spared: 1, to_prove_itself: 4, finalists: 2 };
        let (mut search, mut left) = (starts(), Vec::new());
        let ended = search.run(plan, fall, |search, _| {
            left.push(search.starts.len());
            ControlFlow::Continue(())
        });
        assert_eq!(ended, Termination::Converged);
        assert_eq!(left, [7, 7, 7, 7, 4, 4, 4, 4, 2]);
        // Until the fifth round all are equal, so the first four stay.
        assert_eq!(search.best().valley, 2e-9);
        assert_eq!(search.evaluations(), 3 * 5 + 4 * 9);
    }

    #[test]
    fn a_search_ends_when_its_rounds_are_used_or_it_is_broken_off() {
        let plan = RoundPlan { rounds: 3, spared: 0, to_prove_itself: 10, finalists: 1 };
        assert_eq!(starts().run(plan, fall, |_, _| ControlFlow::Continue(())), Termination::EpochsUsed);
        let stop_at_two = |_: &MultiStart<Falling>, round: usize| match round {
            2 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let mut search = starts();
        assert_eq!(search.run(plan, fall, stop_at_two), Termination::Stopped);
        assert_eq!(search.evaluations(), 14);
    }
}

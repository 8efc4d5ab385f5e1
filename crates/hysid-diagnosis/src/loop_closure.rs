//! Loop closure: under a periodic input, does the output come back every period? Index: gap after a period
//! over the range of the output, the first period of each kind aside.
//!
//! `|y(t + T) - y(t)| / R`                                                          theory.md (10.10)

use super::branch::BranchSet;
use super::comparison::{BOUND, Comparison, judge};
use super::cycles::repeated;
use super::{Cycle, Finding, Property, Verdict};

/// A gap that matters, as a share of the range of the output.
const EFFECT: f64 = 0.01;

/// Where the speed matters, loops are repeated at speeds within this factor.
const ONE_SPEED: f64 = 1.05;

/// Cycles that are compared at most.
const MOST: usize = 400;

const EXPERIMENT: &str = "repeat a loop three times or more";

/// Tests for closed loops; `may_fade` where the memory may fade with time.
pub(crate) fn test<'c>(survey: &BranchSet, cycles: &'c [Cycle], may_fade: bool) -> Finding {
    let groups = repeated(survey, cycles);
    let judged = |cycles_after: &dyn Fn(&[&'c Cycle]) -> Vec<&'c Cycle>| {
        let later: Vec<&Cycle> = groups.iter().flat_map(|group| cycles_after(group)).collect();
        let step = later.len().div_ceil(MOST).max(1);
        let comparisons: Vec<Comparison> =
            later.into_iter().step_by(step).filter_map(|cycle| gap(survey, cycle)).collect();
        judge(&comparisons, EFFECT, BOUND).map(|judgement| (judgement, comparisons))
    };
    // The first period still remembers what was before.
    let Some((mut judgement, comparisons)) = judged(&|group| group[1..].to_vec()) else {
        return Finding::not_testable(Property::LoopClosure, "no loop is repeated", EXPERIMENT);
    };
    // Where the speed matters and memory may fade, so may every period that follows another loop, and the one after.
    for before in [1, 2] {
        if may_fade && judgement.verdict == Verdict::No {
            let settled = judged(&|group| settled(survey, group, before));
            judgement.verdict = settled.map_or(Verdict::NotTestable, |(settled, _)| settled.verdict);
        }
    }
    // Loops that close may yet be different loops each time.
    let moving = judgement.verdict == Verdict::Yes && moves(survey, &groups);
    if moving {
        judgement.verdict = Verdict::NotTestable;
    }
    let percent = 100.0 * judgement.index;
    let statement = match judgement.verdict {
        Verdict::Yes => format!("repeated loops close, within {percent:.2} % of the output's range"),
        Verdict::No => format!("a repeated loop stays open by {percent:.1} % of the output's range"),
        Verdict::NotTestable if moving => format!(
            "repeated loops close, within {percent:.2} % of the output's range, but the last begins at another output \
             than the first"
        ),
        Verdict::NotTestable => {
            format!(
                "a repeated loop is open by {percent:.1} % of the output's range: noise or an initial transient may cause this"
            )
        }
    };
    survey.finding(Property::LoopClosure, &judgement, &comparisons, statement, EXPERIMENT)
}

/// The cycles of a group that directly follow at least `before` cycles of the same group at the same speed.
fn settled<'c>(survey: &BranchSet, group: &[&'c Cycle], before: usize) -> Vec<&'c Cycle> {
    let one_speed = |a: usize, b: usize| match (survey.branches[a].speed, survey.branches[b].speed) {
        (Some(a), Some(b)) => a.max(b) <= ONE_SPEED * a.min(b),
        _ => true,
    };
    let follows = |pair: &[&Cycle]| {
        let (last, next) = (pair[0].branches, pair[1].branches);
        next.0 == last.1 + 1 && one_speed(last.0, next.0) && one_speed(last.1, next.1)
    };
    group.windows(before + 1).filter(|run| run.windows(2).all(follows)).map(|run| run[before]).collect()
}

/// True if, in any group, the last loop begins at a different output than the first.
fn moves(survey: &BranchSet, groups: &[Vec<&Cycle>]) -> bool {
    let moved = |group: &Vec<&Cycle>| -> Option<Comparison> {
        let [first, last] =
            [group[0], group[group.len() - 1]].map(|cycle| &survey.branches[cycle.branches.0]);
        let x = if first.rises() { first.from.max(last.from) } else { first.from.min(last.from) };
        let (before, after) = (first.curve.at(x)?, last.curve.at(x)?);
        let wander = survey.wander(survey.rows_between(first, last, x));
        Some(Comparison::of_readings(survey.height(), [before, after], wander))
    };
    let moves: Vec<Comparison> = groups.iter().filter_map(moved).collect();
    judge(&moves, EFFECT, BOUND).is_some_and(|judgement| judgement.verdict == Verdict::No)
}

/// The gap between a branch and the next that begins at the same turning point: both are then at the same speed.
fn gap(survey: &BranchSet, cycle: &Cycle) -> Option<Comparison> {
    let (out, back) = (&survey.branches[cycle.branches.0], &survey.branches[cycle.branches.1]);
    let again = survey.branches.get(cycle.branches.1 + 1).filter(|again| again.record == out.record);
    // At the end of a record only the way back is left.
    let after = again.filter(|again| !again.curve.is_empty()).unwrap_or(back);
    // Where the input did not come back quite to its beginning, both branches are read where it ended.
    let x = if out.rises() { out.from.max(back.to) } else { out.from.min(back.to) };
    if !survey.similar_speed_at(out, after, x) {
        return None;
    }
    let (first, last) = (out.curve.at(x)?, after.curve.at(x)?);
    // Away from its beginning a loop has a width of its own, between the ways there and back.
    let own = if x != out.from && after.rises() != out.rises() {
        (out.curve.at(out.from)?.y - first.y).abs()
    } else {
        0.0
    };
    let wander = survey.wander(survey.rows_between(out, after, x));
    let readings = Comparison::of_readings(survey.height(), [first, last], wander);
    Some(Comparison {
        bend: readings.bend + own / survey.height(),
        pieces: vec![cycle.piece()],
        curves: vec![survey.curve("there", out), survey.curve("back", back)],
        ..readings
    })
}

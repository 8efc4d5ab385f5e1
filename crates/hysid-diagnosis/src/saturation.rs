//! Saturation: the output hardly grows at the ends of the input. Index: slope over the last tenth of a branch
//! over the largest slope of the same branch, theory.md (10.8).

use hysid_core::elementary::{hypot, square};

use super::branch::{Branch, BranchSet};
use super::comparison::{Comparison, GAP};
use super::wiping_out::loops;
use super::{Evidence, Finding, Property, Verdict};

/// A slope below this share of the largest one is saturated.
const SATURATED: f64 = 0.1;

/// Parts of a branch over which slopes are taken.
const PARTS: usize = 10;

/// Deviations of the noise that make sure.
const SURE: f64 = 3.0;

/// An uncertainty below this does not matter.
const CLOSE: f64 = 0.02;

/// Share of the input's range that a branch must cover.
const COVERED: f64 = 0.6;

/// Share of the output's range that a branch must cover.
const HIGH: f64 = 0.3;

/// Branches at most, each end.
const MOST: usize = 12;

const EXPERIMENT: &str = "drive the input over its whole range, up and down";

/// Tests for saturation at either end: the upper end from rising, the lower end from falling branches
/// (what follows a turning point is the stiffness of unloading).
pub(crate) fn verdict(survey: &BranchSet) -> Finding {
    let mut ends = [end(survey, true), end(survey, false)].into_iter().flatten();
    let Some(first) = ends.next() else {
        return Finding::not_testable(Property::Saturation, "no branch over most of the range", EXPERIMENT);
    };
    // Either end is enough.
    match ends.next() {
        Some(second) if second.verdict == Verdict::Yes && first.verdict != Verdict::Yes => second,
        _ => first,
    }
}

fn end(survey: &BranchSet, rising: bool) -> Option<Finding> {
    let edge = if rising { survey.input.1 } else { survey.input.0 };
    let reaches = |branch: &&Branch| {
        branch.rises() == rising
            && (branch.to - edge).abs() <= survey.same_input()
            && branch.travel() >= COVERED * survey.width()
            // All of it has an output.
            && branch.curve.at(branch.from).is_some()
            && branch.curve.at(branch.to).is_some()
    };
    let branches: Vec<&Branch> = survey.branches.iter().filter(reaches).collect();
    let step = branches.len().div_ceil(MOST).max(1);
    let comparisons: Vec<Comparison> =
        branches.into_iter().step_by(step).filter_map(|branch| slope_ratio(survey, branch)).collect();
    let n = comparisons.len() as f64;
    if comparisons.is_empty() {
        return None;
    }
    let index = comparisons.iter().map(|c| c.index).sum::<f64>() / n;
    let deviation = comparisons.iter().map(|c| square(c.deviation)).sum::<f64>().sqrt() / n;
    let side = if rising { "upper" } else { "lower" };
    let share = 100.0 * index;
    let (verdict, statement) = if index + SURE * deviation < SATURATED {
        (Verdict::Yes, format!("at the {side} end the slope is {share:.1} % of the largest"))
    } else if index - SURE * deviation > SATURATED || SURE * deviation < CLOSE {
        let verdict = if index < SATURATED { Verdict::Yes } else { Verdict::No };
        (verdict, format!("at the {side} end the slope is {share:.0} % of the largest"))
    } else {
        (
            Verdict::NotTestable,
            format!(
                "at the {side} end the slope is {share:.0} % of the largest, too uncertain because of the \
                 noise"
            ),
        )
    };
    Some(Finding {
        property: Property::Saturation,
        verdict,
        index: Some(index),
        threshold: Some(SATURATED),
        noise: Some(deviation),
        comparisons: comparisons.len(),
        statement,
        experiment: (verdict == Verdict::NotTestable)
            .then(|| format!("measure with less noise, or repeat and average; {EXPERIMENT}")),
        evidence: comparisons.iter().map(|c| Evidence { index: c.index, pieces: c.pieces.clone() }).collect(),
        picture: Some(loops(comparisons[0].curves.clone())),
    })
}

fn slope_ratio(survey: &BranchSet, branch: &Branch) -> Option<Comparison> {
    let place = |part: usize| branch.from + (branch.to - branch.from) * part as f64 / PARTS as f64;
    let readings: Vec<_> = (0..=PARTS).map(|part| branch.curve.at(place(part))).collect::<Option<_>>()?;
    let direction = (readings[PARTS].y - readings[0].y).signum();
    let rises: Vec<f64> =
        readings.windows(2).map(|pair| (direction * (pair[1].y - pair[0].y)).max(0.0)).collect();
    let largest = rises.iter().copied().fold(0.0, f64::max);
    // Of an output that stays, or only falls back, no slope is the largest.
    if !((readings[PARTS].y - readings[0].y).abs() >= HIGH * survey.height() && largest > 0.0) {
        return None;
    }
    let last = hypot(readings[PARTS - 1].deviation, readings[PARTS].deviation);
    Some(Comparison {
        index: rises[PARTS - 1] / largest,
        deviation: last / largest,
        bend: 0.0,
        freedom: GAP,
        other: 0.0,
        pieces: vec![survey.piece(branch)],
        curves: vec![
            survey.curve("branch", branch),
            survey.curve_between("last tenth", branch, (place(PARTS - 1), branch.to)),
        ],
    })
}

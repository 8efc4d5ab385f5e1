//! Saturation: the output hardly grows at the ends of the input. Index: slope over the last tenth of a branch
//! over the largest slope of the same branch, theory.md (10.8).

use super::branch::{Branch, Survey};
use super::comparison::{Comparison, judge};
use super::{Finding, Property, Verdict};

/// A slope below this share of the largest one is saturated.
const SATURATED: f64 = 0.1;

/// Parts of a branch over which slopes are taken.
const PARTS: usize = 10;

/// Share of the input's range that a branch must cover.
const COVERED: f64 = 0.6;

/// Branches at most, each end.
const MOST: usize = 12;

const EXPERIMENT: &str = "drive the input over its whole range, up and down";

/// Tests for saturation at either end: the upper end from rising, the lower end from falling branches
/// (what follows a turning point is the stiffness of unloading).
pub(crate) fn test(survey: &Survey) -> Finding {
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

fn end(survey: &Survey, rising: bool) -> Option<Finding> {
    let edge = if rising { survey.input.1 } else { survey.input.0 };
    let reaches = |branch: &&Branch| {
        branch.rises() == rising
            && (branch.to - edge).abs() <= survey.same_input()
            && branch.travel() >= COVERED * survey.width()
    };
    let branches: Vec<&Branch> = survey.branches.iter().filter(reaches).collect();
    let step = branches.len().div_ceil(MOST).max(1);
    let comparisons: Vec<Comparison> =
        branches.into_iter().step_by(step).filter_map(|branch| slope_ratio(survey, branch)).collect();
    // The slope at the end is to be nought: the comparisons say whether it is.
    let judgement = judge(&comparisons, SATURATED)?;
    let side = if rising { "upper" } else { "lower" };
    let share = 100.0 * judgement.index;
    let statement = match judgement.verdict {
        Verdict::Yes => format!("at the {side} end the slope is {share:.1} % of the largest"),
        Verdict::No => format!("at the {side} end the slope is still {share:.0} % of the largest"),
        Verdict::NotTestable => "the noise hides slopes of the size that matters".into(),
    };
    Some(survey.finding(Property::Saturation, &judgement, &comparisons, statement, EXPERIMENT))
}

fn slope_ratio(survey: &Survey, branch: &Branch) -> Option<Comparison> {
    let place = |part: usize| branch.from + (branch.to - branch.from) * part as f64 / PARTS as f64;
    let readings: Vec<_> = (0..=PARTS).map(|part| branch.curve.at(place(part))).collect::<Option<_>>()?;
    let rises: Vec<f64> = readings.windows(2).map(|pair| (pair[1].y - pair[0].y).abs()).collect();
    let largest = rises.iter().copied().fold(0.0, f64::max);
    if largest <= 0.0 {
        return None;
    }
    let last = readings[PARTS - 1].deviation.hypot(readings[PARTS].deviation);
    Some(Comparison {
        index: rises[PARTS - 1] / largest,
        deviation: last / largest,
        bend: 0.0,
        pieces: vec![survey.piece(branch)],
        curves: vec![
            survey.curve("branch", branch),
            survey.curve_between("last tenth", branch, (place(PARTS - 1), branch.to)),
        ],
    })
}

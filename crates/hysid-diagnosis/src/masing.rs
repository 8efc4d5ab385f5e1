//! Masing's rule: every branch is the same curve, beginning at its turning point and magnified by two.
//! Index: how far branches, laid onto each other at their beginnings, differ, over their height.
//!
//! `(|x - x_a|/2, |y - y_a|/2)` of each own part against that of the longest          theory.md (10.6)

use hysid_core::elementary::{hypot, square};

use super::branch::{Branch, BranchSet, is_one_speed};
use super::comparison::{BOUND, Comparison, SHAPE, judge};
use super::{Finding, Property, Verdict};

/// A difference that matters, as a share of the height.
const EFFECT: f64 = 0.05;

/// Branches shorter than this share of the input's range.
const SHORTEST: f64 = 0.05;

/// Length of a branch, as a share of the longest, from which on a comparison shows nothing new.
const SAME_LENGTH: f64 = 0.9;

/// Branches that are compared at most.
const MOST: usize = 200;

/// The rule holds for all branches only if at least this share of them can be compared.
const MOST_OF_THEM: f64 = 0.25;

/// Places along a branch.
const PLACES: usize = 40;

const EXPERIMENT: &str = "run closed loops of three or more amplitudes, the smaller ones within the larger";

/// A branch as far as it belongs to its loop, from its turning point on.
struct OwnPart<'b> {
    branch: &'b Branch,
    length: f64,
}

impl OwnPart<'_> {
    /// `|y - y_a|/2` at a distance `u = |x - x_a|/2`, with the sign that growth in the branch's
    /// direction is positive.
    fn at(&self, u: f64) -> Option<(f64, f64, f64)> {
        let sign = if self.branch.rises() { 1.0 } else { -1.0 };
        let start = self.branch.curve.at(self.branch.from)?;
        let there = self.branch.curve.at(self.branch.from + 2.0 * u * sign)?;
        Some((
            0.5 * sign * (there.y - start.y),
            0.5 * hypot(start.deviation, there.deviation),
            0.5 * (start.bend + there.bend),
        ))
    }
}

pub(crate) fn verdict(survey: &BranchSet, equal_speed: bool) -> Finding {
    let mut parts: Vec<OwnPart> =
        survey.branches.iter().filter_map(|branch| own_part(survey, branch)).collect();
    parts.sort_by(|a, b| b.length.total_cmp(&a.length));
    let (candidates, comparisons) = match parts.split_first() {
        Some((longest, others)) => {
            let shorter = others.iter().filter(|part| part.length < SAME_LENGTH * longest.length);
            let allowed = shorter.filter(|part| !equal_speed || one_course_of_speed(survey, longest, part));
            let parts: Vec<&OwnPart> = allowed.collect();
            let step = parts.len().div_ceil(MOST).max(1);
            let candidates = parts.len().div_ceil(step);
            let compared = parts.into_iter().step_by(step).filter_map(|part| compare(survey, longest, part));
            (candidates, compared.collect())
        }
        None => (0, Vec::new()),
    };
    if comparisons.len() < 2 {
        let branches = match comparisons.len() {
            0 => "no branch is",
            _ => "only one branch is",
        };
        let statement = format!("{branches} shorter than the longest, within known loops; 2 are needed");
        return Finding::not_testable(Property::Masing, statement, EXPERIMENT);
    }
    let mut judgement = judge(&comparisons, EFFECT, BOUND).expect("there are comparisons");
    if judgement.verdict == Verdict::Yes && (comparisons.len() as f64) < MOST_OF_THEM * candidates as f64 {
        judgement.verdict = Verdict::NotTestable;
        judgement.doubt = "noise or widely spaced rows hide most of the branches";
    }
    let percent = 100.0 * judgement.index;
    let statement = match judgement.verdict {
        Verdict::Yes => format!("all branches lie on one curve, within {percent:.1} % of their height"),
        Verdict::No => format!("a branch deviates from the longest by {percent:.0} % of its height"),
        Verdict::NotTestable => judgement.doubt.into(),
    };
    let mut finding = survey.finding(Property::Masing, &judgement, &comparisons, statement, EXPERIMENT);
    if let Some(picture) = &mut finding.picture {
        picture.x_label = "|x - x_a|/2".into();
        picture.y_label = "|y - y_a|/2".into();
        picture.curves.extend(judgement.order.iter().skip(1).take(8).map(|&place| {
            let mut curve = comparisons[place].curves[1].clone();
            curve.label = String::new();
            curve
        }));
    }
    finding
}

fn own_part<'b>(survey: &BranchSet, branch: &'b Branch) -> Option<OwnPart<'b>> {
    let length = (branch.own_end()? - branch.from).abs();
    let long_enough = length >= SHORTEST * survey.width() && !branch.curve.is_empty();
    long_enough.then_some(OwnPart { branch, length })
}

/// True if two parts are gone at the same speed at equal distances from their beginnings.
fn one_course_of_speed(survey: &BranchSet, a: &OwnPart, b: &OwnPart) -> bool {
    let speed = |part: &OwnPart, way: f64| {
        let sign = if part.branch.rises() { 1.0 } else { -1.0 };
        survey.speed_at(part.branch, part.branch.from + sign * way)
    };
    let at = |way: f64| Some((speed(a, way)?, speed(b, way)?));
    [0.05, 0.3, 0.6, 0.95].iter().all(|share| at(share * b.length).is_none_or(|(a, b)| is_one_speed(a, b)))
}

fn compare(survey: &BranchSet, longest: &OwnPart, part: &OwnPart) -> Option<Comparison> {
    let (mut squares, mut variance, mut bend, mut places) = (0.0, 0.0, 0.0, 0.0);
    let mut height: f64 = 0.0;
    let mut curves = [Vec::new(), Vec::new()];
    for place in 1..=PLACES {
        let u = 0.5 * part.length * place as f64 / PLACES as f64;
        let (Some(master), Some(here)) = (longest.at(u), part.at(u)) else { continue };
        squares += square(master.0 - here.0);
        variance += square(master.1) + square(here.1);
        bend += square(master.2 + here.2);
        places += 1.0;
        height = height.max(here.0.abs());
        curves[0].push((u, master.0));
        curves[1].push((u, here.0));
    }
    // Heights are halved here.
    if places < 0.8 * PLACES as f64 || height < 0.5 * survey.lowest_shape() {
        return None;
    }
    let [master, here] = curves;
    let along = |of: &OwnPart| 0.5 * survey.wander_along(of.branch, part.length);
    let wander = hypot(along(longest), along(part));
    Some(Comparison {
        index: (squares / places).sqrt() / height,
        deviation: hypot((variance / places).sqrt(), wander) / height,
        bend: (bend / places).sqrt() / height,
        freedom: SHAPE,
        other: 0.5 * (survey.turn_error(longest.branch) + survey.turn_error(part.branch)) / height,
        pieces: vec![survey.piece(longest.branch), survey.piece(part.branch)],
        curves: vec![
            super::PictureCurve { label: "longest branch".into(), points: master },
            super::PictureCurve { label: "shorter branch".into(), points: here },
        ],
    })
}

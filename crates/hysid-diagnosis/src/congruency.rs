//! Congruency: minor loops between the same two inputs have the same shape, whatever came before. Index:
//! how far two branches of equal beginning and different past differ in shape, over their height.
//!
//! `rms(Δ(y - y(x_a))) / height` over the part that belongs to both                  theory.md (10.5)

use std::collections::BTreeMap;

use hysid_core::elementary::{hypot, square};

use super::branch::{Branch, BranchSet};
use super::comparison::{Comparison, NARROW_BOUND, SHAPE, judge};
use super::{Finding, PictureCurve, Property, Verdict};

/// A difference of shape that matters, as a share of the height.
const EFFECT: f64 = 0.05;

/// Branches shorter than this share of the input's range.
const SHORTEST: f64 = 0.05;

/// Pasts whose last outer turning points are closer than this share of the input's range are the same.
const OTHER_PAST: f64 = 0.05;

/// Loops whose first outputs are apart by this share of the output's range, or of the mean height of the largest loop if
/// that is less, are different loops.
const APART: f64 = 0.05;
const OF_A_LOOP: f64 = 0.5;

/// Pairs with one beginning that are compared at most.
const MOST_PAIRS: usize = 100;

/// Places along the common part.
const PLACES: usize = 40;

const EXPERIMENT: &str =
    "run the same minor loop twice: once on the way up and once on the way down of a larger loop";

/// Tests for congruent minor loops. `needs_loops_apart` where the output has loops and the path was not chosen for this
/// test: loops at the same output may then be the same loop.
pub(crate) fn verdict(survey: &BranchSet, equal_speed: bool, needs_loops_apart: bool) -> Finding {
    let (mut comparisons, mut apart) = (Vec::new(), Vec::new());
    for group in same_beginning(survey).values() {
        let pairs = (0..group.len()).flat_map(|i| (i + 1..group.len()).map(move |j| (group[i], group[j])));
        let different = pairs.filter(|(a, b)| other_past(survey, &survey.branches[*a], &survey.branches[*b]));
        for (a, b) in different.take(MOST_PAIRS) {
            let (a, b) = (&survey.branches[a], &survey.branches[b]);
            if let Some((comparison, displaced)) = compare(survey, a, b, equal_speed) {
                comparisons.push(comparison);
                apart.push(displaced);
            }
        }
    }
    let Some(judgement) = judge(&comparisons, EFFECT, NARROW_BOUND) else {
        let statement =
            "no two branches begin at the same input, in the same direction, with a different past";
        return Finding::not_testable(Property::Congruency, statement, EXPERIMENT);
    };
    let percent = 100.0 * judgement.index;
    let is_told = !needs_loops_apart || apart.iter().any(|apart| *apart > least_apart(survey));
    let withheld = judgement.verdict == Verdict::Yes && !is_told;
    let statement = match judgement.verdict {
        Verdict::Yes if withheld => {
            "loops between the same inputs begin at the same output, and may be the same loop".into()
        }
        Verdict::Yes => format!(
            "loops between the same inputs have the same shape, within {percent:.1} % of their height"
        ),
        Verdict::No => {
            format!("loops between the same inputs differ in shape by {percent:.0} % of their height")
        }
        Verdict::NotTestable => judgement.doubt.into(),
    };
    let mut finding = survey.finding(Property::Congruency, &judgement, &comparisons, statement, EXPERIMENT);
    if withheld {
        finding.verdict = Verdict::NotTestable;
        finding.experiment = Some(EXPERIMENT.into());
    }
    if let Some(picture) = &mut finding.picture {
        picture.y_label = "y - y(x_a)".into();
    }
    finding
}

/// Branches that begin at about the same input and go the same way. The first branch of a record is
/// left out: where it comes from is not known.
fn same_beginning(survey: &BranchSet) -> BTreeMap<(i64, bool), Vec<usize>> {
    let mut groups: BTreeMap<(i64, bool), Vec<usize>> = BTreeMap::new();
    let cell = survey.same_input();
    for (index, branch) in survey.branches.iter().enumerate() {
        let known = branch.own_end().is_some() && !branch.curve.is_empty();
        if known && branch.travel() >= SHORTEST * survey.width() {
            let place = (branch.from / cell).round() as i64;
            groups.entry((place, branch.rises())).or_default().push(index);
        }
    }
    groups
}

/// True if the turning points that enclose two branches differ, so that they are on different loops.
fn other_past(survey: &BranchSet, a: &Branch, b: &Branch) -> bool {
    let same = OTHER_PAST * survey.width();
    let (a, b) = (past(a, same), past(b, same));
    // What is not known is not known to differ.
    a.iter().zip(&b).take(2).any(|(a, b)| (a - b).abs() > same)
}

/// The known turning points that enclose a branch, the latest first, without its beginning. A loop that is closed but for
/// `nearly` has left hardly a trace: whatever law it is, the branch goes on as if the loop had not been.
fn past(branch: &Branch, nearly: f64) -> Vec<f64> {
    let unknown = branch.beneath.len() - branch.known.min(branch.beneath.len());
    let mut past: Vec<f64> = branch.beneath[unknown..].to_vec();
    while past.len() >= 3 && (past[past.len() - 1] - past[past.len() - 3]).abs() <= nearly {
        past.truncate(past.len() - 2);
    }
    past.pop();
    past.reverse();
    past
}

/// A curve moved to where branches of one shape lie on each other.
fn from_beginning(mut curve: PictureCurve, start: f64) -> PictureCurve {
    curve.points.iter_mut().for_each(|point| point.1 -= start);
    curve
}

/// Outputs that are further apart than this are those of different loops.
fn least_apart(survey: &BranchSet) -> f64 {
    let heights = survey.openings.iter().map(|opening| opening.area / opening.swing.max(f64::MIN_POSITIVE));
    (APART * survey.height()).min(OF_A_LOOP * heights.fold(0.0, f64::max))
}

/// The difference of shape, and how far apart the outputs at the beginnings are, in their unit.
fn compare(survey: &BranchSet, a: &Branch, b: &Branch, equal_speed: bool) -> Option<(Comparison, f64)> {
    let nearest = |a: f64, b: f64, rises: bool| if rises { a.min(b) } else { a.max(b) };
    let rises = a.rises();
    let beginning = if rises { a.from.max(b.from) } else { a.from.min(b.from) };
    let end = nearest(a.own_end()?, b.own_end()?, rises);
    let way = if rises { end - beginning } else { beginning - end };
    if way < SHORTEST * survey.width() {
        return None;
    }
    let along = [0.05, 0.3, 0.6, 0.95].map(|share| beginning + share * (end - beginning));
    if equal_speed && !along.iter().all(|&x| survey.similar_speed_at(a, b, x)) {
        return None;
    }
    let (start_a, start_b) = (a.curve.at(beginning)?, b.curve.at(beginning)?);
    let (mut squares, mut variance, mut bend, mut places) = (0.0, 0.0, 0.0, 0.0);
    let (mut low, mut high) = ([start_a.y, start_b.y], [start_a.y, start_b.y]);
    for place in 1..=PLACES {
        let x = beginning + (end - beginning) * place as f64 / PLACES as f64;
        let (Some(y_a), Some(y_b)) = (a.curve.at(x), b.curve.at(x)) else { continue };
        let difference = (y_a.y - start_a.y) - (y_b.y - start_b.y);
        squares += difference * difference;
        variance += square(y_a.deviation) + square(y_b.deviation);
        bend += square(y_a.bend + y_b.bend);
        places += 1.0;
        for (side, y) in [y_a.y, y_b.y].into_iter().enumerate() {
            low[side] = low[side].min(y);
            high[side] = high[side].max(y);
        }
    }
    let height = (high[0] - low[0]).max(high[1] - low[1]);
    if places < 0.8 * PLACES as f64 || height < survey.lowest_shape() {
        return None;
    }
    // Of the noise, that at the beginning shifts the whole branch.
    let deviation = (variance / places + square(start_a.deviation) + square(start_b.deviation)).sqrt();
    let wander = hypot(survey.wander_along(a, way), survey.wander_along(b, way));
    let comparison = Comparison {
        index: (squares / places).sqrt() / height,
        deviation: hypot(deviation, wander) / height,
        bend: ((bend / places).sqrt() + start_a.bend + start_b.bend) / height,
        freedom: SHAPE,
        other: (survey.turn_error(a) + survey.turn_error(b)) / height,
        pieces: vec![survey.piece(a), survey.piece(b)],
        curves: vec![
            from_beginning(survey.curve_between("first", a, (beginning, end)), start_a.y),
            from_beginning(survey.curve_between("second, with another past", b, (beginning, end)), start_b.y),
        ],
    };
    Some((comparison, (start_a.y - start_b.y).abs()))
}

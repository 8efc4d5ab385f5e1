//! Odd symmetry: a loop turned by half a turn about its centre is itself. Index: how far the falling branch,
//! turned, is off the rising one, their mean difference aside, over the range of the output.
//!
//! `rms(y_up(x) + y_down(2 x_c - x) - mean) / R`,  half the mean is the offset       theory.md (10.7)

use hysid_core::elementary::{hypot, square};

use super::branch::{Branch, BranchSet};
use super::comparison::{BOUND, Comparison, SHAPE, judge};
use super::{Finding, Property, Verdict};

/// A difference that matters, as a share of the range of the output.
pub(super) const EFFECT: f64 = 0.02;

/// The centre is 0 if 0 is this close to the middle of the input's range, as a share of it.
const ABOUT_ZERO: f64 = 0.1;

/// The loop must cover this share of the input's range.
const COVERED: f64 = 0.6;

/// Pairs of branches at most.
const MOST: usize = 12;

/// Places along a branch.
const PLACES: usize = 80;

const EXPERIMENT: &str = "run a few equal loops over the whole range of the input, equally far to both sides";

pub(crate) fn verdict(survey: &BranchSet, equal_speed: bool) -> Finding {
    let middle = 0.5 * (survey.input.0 + survey.input.1);
    let centre = if middle.abs() <= ABOUT_ZERO * survey.width() { 0.0 } else { middle };
    let (half, mut pairs) = pairs(survey, centre);
    // Where the speed matters, so does that of the branch before: the memory may fade.
    pairs.retain(|pair| !equal_speed || pair.iter().all(|branch| survey.similar_speed(branch, pair[0])));
    let step = pairs.len().div_ceil(MOST).max(1);
    let comparisons: Vec<Comparison> =
        pairs.into_iter().step_by(step).filter_map(|pair| compare(survey, centre, half, pair)).collect();
    let Some(judgement) = judge(&comparisons, EFFECT, BOUND) else {
        let statement = "no three successive branches over most of the range";
        return Finding::not_testable(Property::OddSymmetry, statement, EXPERIMENT);
    };
    let percent = 100.0 * judgement.index;
    let about = if centre == 0.0 { "x = 0" } else { "the middle of the input's range" };
    let statement = match judgement.verdict {
        Verdict::Yes => {
            format!(
                "loops rotated by 180° about {about} coincide with themselves within {percent:.2} % of \
                     the output's range"
            )
        }
        Verdict::No => {
            format!(
                "a loop rotated by 180° about {about} deviates from itself by {percent:.1} % of the \
                     output's range"
            )
        }
        Verdict::NotTestable => judgement.doubt.into(),
    };
    survey.finding(Property::OddSymmetry, &judgement, &comparisons, statement, EXPERIMENT)
}

/// The largest distance from the centre that three successive branches reach on both sides, and all triples that reach it,
/// if it covers enough of the input's range. Below the whole range the record went as far to both sides before and no
/// further, so that the loops have a symmetric past. Half way between before and after, what a loop loses by wear is in both
/// directions alike.
fn pairs<'s>(survey: &'s BranchSet, centre: f64) -> (f64, Vec<[&'s Branch; 3]>) {
    let tolerance = survey.same_input();
    let whole = (survey.input.1 - centre).min(centre - survey.input.0);
    let reach = |branch: &Branch| {
        let (low, high) = branch.curve.range();
        if branch.curve.is_empty() { 0.0 } else { (centre - low).min(high - centre) }
    };
    let mut found: Vec<(f64, [&Branch; 3])> = Vec::new();
    let (mut record, mut low, mut high) = (usize::MAX, 0.0f64, 0.0f64);
    for three in survey.branches.windows(3) {
        if three[0].record != record {
            (record, low, high) = (three[0].record, three[0].from, three[0].from);
        }
        for end in [three[0].to, three[1].to] {
            (low, high) = (low.min(end), high.max(end));
        }
        let half = three.iter().map(reach).fold(f64::INFINITY, f64::min);
        let is_furthest = (high - centre - half).abs().max((centre - low - half).abs()) <= tolerance;
        if three[2].record == record && (is_furthest || half >= whole - tolerance) {
            found.push((half, [&three[0], &three[1], &three[2]]));
        }
    }
    let half = whole.min(found.iter().map(|(half, _)| *half).fold(0.0, f64::max) + tolerance);
    if half < 0.5 * COVERED * survey.width() {
        return (half, Vec::new());
    }
    let far = found.into_iter().filter(|(reach, _)| *reach >= half - tolerance);
    (half, far.map(|(_, three)| three).collect())
}

fn compare(
    survey: &BranchSet,
    centre: f64,
    half: f64,
    [before, branch, after]: [&Branch; 3],
) -> Option<Comparison> {
    let mut rows = Vec::with_capacity(PLACES);
    let half = half - survey.same_input();
    for place in 0..PLACES {
        let distance = half * (2.0 * place as f64 / (PLACES - 1) as f64 - 1.0);
        let (x, turned) = (centre + distance, centre - distance);
        let here = branch.curve.at(x)?;
        let (one, other) = (before.curve.at(turned)?, after.curve.at(turned)?);
        let mirrored = 0.5 * (one.y + other.y);
        let variance = square(here.deviation) + 0.25 * (square(one.deviation) + square(other.deviation));
        rows.push((x, here.y, mirrored, variance, here.bend + 0.5 * (one.bend + other.bend)));
    }
    let n = rows.len() as f64;
    let mean = rows.iter().map(|row| row.1 + row.2).sum::<f64>() / n;
    let square = rows.iter().map(|row| square(row.1 + row.2 - mean)).sum::<f64>() / n;
    let variance = rows.iter().map(|row| row.3).sum::<f64>() / n;
    let bend = (rows.iter().map(|row| row.4 * row.4).sum::<f64>() / n).sqrt();
    let wander = survey.wander_along(branch, 2.0 * half);
    let height = survey.height();
    Some(Comparison {
        index: square.sqrt() / height,
        deviation: hypot(variance.sqrt(), wander) / height,
        bend: bend / height,
        freedom: SHAPE,
        other: 0.0,
        pieces: [before, branch, after].into_iter().map(|branch| survey.piece(branch)).collect(),
        curves: vec![
            super::PictureCurve {
                label: "branch".into(),
                points: rows.iter().map(|row| (row.0, row.1)).collect(),
            },
            super::PictureCurve {
                label: "opposite branch, rotated".into(),
                points: rows.iter().map(|row| (row.0, mean - row.2)).collect(),
            },
        ],
    })
}

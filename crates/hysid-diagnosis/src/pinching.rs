//! Pinching: near zero load a member is soft, and stiffens before it reaches its tip. Index: slope near zero load over the
//! largest slope after it, on loading branches; such loops enclose much less than the parallelogram through their tips
//! and their crossings of zero load, theory.md (10.51).

use hysid_core::elementary::hypot;

use super::branch::{Branch, BranchSet};
use super::cycles::CycleRow;
use super::wiping_out::loops;
use super::{Evidence, Finding, Property, Verdict, significance};

/// A branch is pinched if the slope near zero load is below this share of the largest one after it.
const SOFT: f64 = 0.5;

/// Pinched loops enclose less than this share of their parallelogram.
const SLENDER: f64 = 0.6;

/// Branches and cycles of less than this share of the largest say little.
const LARGE: f64 = 0.3;

/// Loads below this share of that at the tip are near zero load.
const NEAR: f64 = 0.25;

/// Share of a branch over which a slope is taken.
const OVER: f64 = 0.1;

/// Deviations of the noise between an index and its limit.
const SURE: f64 = 3.0;

/// Distances of the crossings of zero load below this share of the swing leave no parallelogram.
const NARROW: f64 = 0.05;

const EXPERIMENT: &str =
    "run cycles through zero load of growing amplitude, two of each, with 50 rows a cycle or more";

/// The slope near zero load of a branch.
struct UnloadedSlope<'b> {
    branch: &'b Branch,
    index: f64,
    deviation: f64,
}

pub(crate) fn verdict(survey: &BranchSet, cycles: &[CycleRow]) -> Finding {
    let not_testable = |why: &str| Finding::not_testable(Property::Pinching, why, EXPERIMENT);
    let longest = survey.branches.iter().map(|branch| branch.travel()).fold(0.0, f64::max);
    let large = survey.branches.iter().filter(|branch| branch.travel() > LARGE * longest);
    let mut found: Vec<UnloadedSlope> =
        large.filter_map(|branch| softness(branch, survey.height())).collect();
    let mut shares = shares(cycles);
    if found.is_empty() || shares.is_empty() {
        return not_testable("no loop of a relevant size crosses zero load on both sides");
    }
    found.sort_by(|a, b| a.index.total_cmp(&b.index));
    let middle = &found[found.len() / 2];
    let share = significance::median(&mut shares);
    let (slope, area) = (100.0 * middle.index, 100.0 * share);
    let statement = format!(
        "near zero load the stiffness is {slope:.0} % of the largest on the way to the tip, and loops enclose {area:.0} % of \
         the parallelogram"
    );
    let (verdict, statement) = if middle.index + SURE * middle.deviation < SOFT && share < SLENDER {
        (Verdict::Yes, statement)
    } else if middle.index - SURE * middle.deviation > SOFT || share >= SLENDER {
        (Verdict::No, statement)
    } else {
        (Verdict::NotTestable, format!("{statement}: too uncertain because of the noise"))
    };
    Finding {
        property: Property::Pinching,
        verdict,
        index: Some(middle.index),
        threshold: Some(SOFT),
        noise: Some(middle.deviation),
        comparisons: found.len(),
        statement,
        experiment: (verdict == Verdict::NotTestable).then(|| EXPERIMENT.into()),
        evidence: vec![Evidence { index: middle.index, pieces: vec![survey.piece(middle.branch)] }],
        picture: Some(loops(vec![survey.curve("loading through zero load", middle.branch)])),
    }
}

/// Slope near zero load over the largest slope beyond it; `None` for a branch that does not pass zero load, or is low.
fn softness(branch: &Branch, height: f64) -> Option<UnloadedSlope<'_>> {
    let (first, last) = (branch.curve.at(branch.from)?, branch.curve.at(branch.to)?);
    let sense = if branch.rises() { 1.0 } else { -1.0 };
    let loads = sense * first.y < 0.0 && sense * last.y > 0.0;
    if !loads || (last.y - first.y).abs() < LARGE * height {
        return None;
    }
    let points: Vec<(f64, f64)> = branch.curve.points().collect();
    let crossing = points.windows(2).find(|pair| pair[0].1 < 0.0 && pair[1].1 >= 0.0)?;
    let zero =
        crossing[0].0 - crossing[0].1 * (crossing[1].0 - crossing[0].0) / (crossing[1].1 - crossing[0].1);
    let over = OVER * branch.travel();
    // Near the beginning of a branch, over what there is of it.
    let (low, high) = branch.curve.range();
    let slope = |middle: f64| {
        let (from, to) = ((middle - 0.5 * over).max(low), (middle + 0.5 * over).min(high));
        let (a, b) = (branch.curve.at(from)?, branch.curve.at(to)?);
        (to > from).then(|| ((b.y - a.y) / (to - from), hypot(a.deviation, b.deviation) / (to - from)))
    };
    let steps = ((sense * (branch.to - zero) / over - 0.5).max(0.0) * 2.0) as usize;
    let places: Vec<f64> = (0..=steps).map(|step| zero + sense * 0.5 * over * step as f64).collect();
    let slopes: Vec<(f64, f64)> = places.iter().map(|place| slope(*place)).collect::<Option<_>>()?;
    let is_near = |place: &f64| {
        branch.curve.at(*place).is_some_and(|reading| sense * reading.y < NEAR * sense * last.y)
    };
    let near = places.iter().take_while(|place| is_near(place)).count().max(1);
    let softest = (0..near).min_by(|&a, &b| slopes[a].0.total_cmp(&slopes[b].0))?;
    let (slope, deviation) = slopes[softest];
    let largest = slopes[softest..].iter().map(|(slope, _)| *slope).fold(0.0, f64::max);
    (largest > 0.0).then_some(UnloadedSlope {
        branch,
        index: slope / largest,
        deviation: deviation / largest,
    })
}

/// Energies of large cycles as shares of their parallelograms.
fn shares(cycles: &[CycleRow]) -> Vec<f64> {
    let height = |row: &CycleRow| Some(row.peak_output? - row.valley_output?);
    let swing = |row: &CycleRow| Some(row.input_max? - row.input_min?);
    let most = |of: &dyn Fn(&CycleRow) -> Option<f64>| cycles.iter().filter_map(of).fold(0.0, f64::max);
    let (highest, widest) = (most(&height), most(&swing));
    let share = |row: &CycleRow| {
        let (height, swing) = (height(row)?, swing(row)?);
        let apart = (row.residual_after_peak? - row.residual_after_valley?).abs();
        let is_large =
            row.complete && height > LARGE * highest && swing > LARGE * widest && apart > NARROW * swing;
        is_large.then_some(row.energy?.abs() / (height * apart))
    };
    cycles.iter().filter_map(share).collect()
}

#[cfg(test)]
mod tests {
    use crate::strength_loss::tests::{diagnosed, member};
    use crate::{Property, Verdict};

    /// A member that bears only beyond 60 % of its largest deformations, with friction, is pinched; an elastic-plastic one is
    /// not, nor one that loses strength.
    #[test]
    fn slack_is_pinching_and_yielding_is_not() {
        for (noise, slack, expected) in [
            (0.0, true, Verdict::Yes),
            (0.004, true, Verdict::Yes),
            (0.0, false, Verdict::No),
            (0.004, false, Verdict::No),
        ] {
            let (mut friction, mut reach) = (0.0f64, (0.0f64, 0.0f64));
            let data = member(noise, |x, dx| {
                friction = (friction + 5.0 * dx).clamp(-1.0, 1.0);
                reach = (reach.0.min(x), reach.1.max(x));
                let bearing = (x - 0.6 * reach.1).max(0.0) + (x - 0.6 * reach.0).min(0.0);
                if slack { 0.5 * friction + 2.5 * bearing } else { 10.0 * friction }
            });
            let diagnosis = diagnosed(&data);
            let finding = diagnosis.finding(Property::Pinching);
            assert_eq!(finding.verdict, expected, "{noise}: {}", finding.statement);
        }
    }
}

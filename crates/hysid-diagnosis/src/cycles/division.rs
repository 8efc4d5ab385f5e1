//! How a record is divided into cycles.
//!
//! ```text
//! zero, mean, start   from one passing of a level to the next in the same direction; the level is 0, the median of the
//!                     middles of the half cycles, or the first input of the record
//! reversals           from one turning point of the input to the next but one
//! ```
//!
//! The noise of the input decides what is a turning point ([`ReversalRule`](crate::branch::ReversalRule)). What is left at
//! the beginning and at the end of a record is a part of its own, marked as incomplete.

use std::ops::Range;

use hysid_core::elementary::ln;
use hysid_core::named;
use serde::Serialize;

use super::CLOSED;
use super::field::Field;
use super::path::{at, range, share, width};
use crate::branch::{Branch, BranchSet};
use crate::significance::median;

/// Where cycles begin and end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Division {
    /// Where the input passes 0, always in the same direction.
    Zero,
    /// Where the input passes the mean of its cycles, always in the same direction.
    Mean,
    /// At every other turning point.
    Reversals,
    /// Where the input passes the value with which its record begins, always in the same direction.
    Start,
}

named!(
    Division, "division":
    Zero = "zero", Mean = "mean", Reversals = "reversals", Start = "start"
);

/// A half cycle passes a level if it goes on to both sides by this share of its way.
const BEYOND: f64 = 0.1;

/// A record of whole cycles may end a step before the level is passed again; next to a turning point steps are shorter.
pub(super) const LAST_STEP: f64 = 1.25;

/// Deviations of the input's noise within which two inputs are the same.
const IN_NOISE: f64 = 4.0;

/// Such a step is at most this share of the way since the last turning point.
const LARGEST_STEP: f64 = 0.5;

/// Share of the way of the input in half cycles that pass the level of a division.
const MOST: f64 = 0.5;

/// That share where the record first goes to a static load.
const NEARLY_ALL: f64 = 0.9;

/// A record that oscillates about its mean begins this close to it, as a share of the swing.
const NEAR_THE_MEAN: f64 = 0.1;

/// Turning points of one side that scatter less than this share of those of the other side are the ends of the cycles.
const STEADIER: f64 = 0.5;

/// Output at the end of a closed loop less output at its beginning, at most, as a share of the loop's range of the output.
const CLOSED_OUTPUT: f64 = 0.05;

/// As [`CLOSED_OUTPUT`], of a loop that no other follows: what is left of it is nowhere but at its beginning. Its opening is said.
const ALMOST_CLOSED_OUTPUT: f64 = 0.1;

/// A division is better than another if it has more of the way of the input in closed loops, by this share.
const BETTER: f64 = 1e-3;

/// Ratios of successive half cycles scatter this many times less if the other pairs of them are the cycles.
const OTHER_PAIRS: f64 = 4.0;

/// Mean deviation of the logarithm of the ratio of two half cycles below which they are alike.
const ALIKE: f64 = 0.1;

/// The division with the most of the data in loops that close; of equal ones, that which is usual in the field: magnets and
/// actuators from turning point to turning point, so that a cycle has both branches of its loop; other data from zero to
/// zero, or from mean to mean, if most half cycles pass it. A test that begins with a static load has its cycles about
/// their mean where they close better there than in any other way.
pub(super) fn choose(survey: &BranchSet, field: Field) -> Division {
    let from_tips = field.goes_from_tips();
    let order = match from_tips {
        true => [Division::Reversals, Division::Zero, Division::Mean, Division::Start],
        false => [Division::Zero, Division::Mean, Division::Reversals, Division::Start],
    };
    let records = 0..survey.data.records().len();
    let is_biased = !begins_at(survey, Division::Mean)
        && passing(survey, Division::Mean) > NEARLY_ALL
        && records.clone().all(|record| is_about_its_mean(survey.of_record(record)));
    let candidates: Vec<(Division, f64, f64)> = order
        .into_iter()
        .filter(|&division| suits(survey, division))
        .chain(is_biased.then_some(Division::Mean))
        .map(|division| {
            let ways = records.clone().map(|record| ways(survey, record, division, from_tips));
            let (closed, open) = ways.fold((0.0, 0.0), |sum, way| (sum.0 + way.0, sum.1 + way.1));
            (division, closed, open)
        })
        .collect();
    let any_closes = candidates.iter().any(|candidate| candidate.1 > 0.0);
    let way = |candidate: &(Division, f64, f64)| if any_closes { candidate.1 } else { candidate.2 };
    let most = candidates.iter().map(way).fold(0.0, f64::max);
    candidates
        .iter()
        .find(|candidate| way(candidate) >= (1.0 - BETTER) * most)
        .map_or(order[0], |found| found.0)
}

/// True unless most half cycles do not pass the level of a division.
fn suits(survey: &BranchSet, division: Division) -> bool {
    match division {
        Division::Reversals | Division::Start => true,
        Division::Zero => passing(survey, division) > MOST,
        Division::Mean => passing(survey, division) > MOST && begins_at(survey, division),
    }
}

/// Share of the way of the input in half cycles that pass the level of a division.
fn passing(survey: &BranchSet, division: Division) -> f64 {
    let (mut passing, mut all) = (0.0, 0.0);
    for record in 0..survey.data.records().len() {
        let level = level(survey, record, division);
        for branch in half_cycles(survey.of_record(record)) {
            all += branch.travel();
            passing += if level.is_none_or(|level| is_beyond(branch, level)) { branch.travel() } else { 0.0 };
        }
    }
    passing / all
}

/// True if both turning points of each cycle lie equally far from the mean. The first branch goes to a turning point.
fn is_about_its_mean(branches: &[Branch]) -> bool {
    let mean = mean(branches);
    half_cycles(branches)
        .iter()
        .step_by(2)
        .all(|branch| (0.5 * (branch.from + branch.to) - mean).abs() <= NEAR_THE_MEAN * branch.travel())
}

/// True if all records begin near the level of a division.
fn begins_at(survey: &BranchSet, division: Division) -> bool {
    (0..survey.data.records().len()).all(|record| {
        let branches = survey.of_record(record);
        let swing = half_cycles(branches).iter().map(Branch::travel).fold(0.0, f64::max);
        let level = level(survey, record, division).unwrap_or_default();
        branches.first().is_some_and(|first| (first.from - level).abs() <= NEAR_THE_MEAN * swing)
    })
}

/// The way of the input in whole cycles of a record that close, and in those that do not.
fn ways(survey: &BranchSet, record: usize, division: Division, output_too: bool) -> (f64, f64) {
    let data = &survey.data.records()[record];
    let (x, y) = (&*data.inputs()[0], data.output());
    let (mut closed, mut open) = (0.0, 0.0);
    for span in divide(survey, record, division).iter().filter(|span| span.part == SpanPart::Cycle) {
        let rows = span.from.floor() as usize..span.to.ceil() as usize + 1;
        let swing = width(&x[rows.clone()]);
        let back = (at(x, span.to) - at(x, span.from)).abs() <= tolerance(survey, swing);
        if back && (!output_too || output_closes(survey, y, (span.from, span.to), false)) {
            closed += 2.0 * swing;
        } else {
            open += 2.0 * swing;
        }
    }
    (closed, open)
}

/// True if the outputs at both ends of a part of a record are the same, or almost the same at the end of a record.
pub(super) fn output_closes(survey: &BranchSet, y: &[f64], (from, to): (f64, f64), is_last: bool) -> bool {
    let measured: Vec<f64> =
        y[from.floor() as usize..=to.ceil() as usize].iter().copied().filter(|y| !y.is_nan()).collect();
    let gap = (at(y, to) - at(y, from)).abs();
    let noise = 5.0 * survey.output_noise.deviation();
    let share = if is_last { ALMOST_CLOSED_OUTPUT } else { CLOSED_OUTPUT };
    gap.is_nan() || gap <= share * width(&measured) + noise
}

/// The branches between two turning points; all of them, if there are none.
fn half_cycles(branches: &[Branch]) -> &[Branch] {
    if branches.len() > 2 { &branches[1..branches.len() - 1] } else { branches }
}

fn is_beyond(branch: &Branch, level: f64) -> bool {
    let (low, high) = (branch.from.min(branch.to), branch.from.max(branch.to));
    let margin = BEYOND * branch.travel();
    low <= level - margin && high >= level + margin
}

/// The median of the middles of the half cycles.
fn mean(branches: &[Branch]) -> f64 {
    let mut middles: Vec<f64> =
        half_cycles(branches).iter().map(|branch| 0.5 * (branch.from + branch.to)).collect();
    if middles.is_empty() { 0.0 } else { median(&mut middles) }
}

/// A cycle, or what is left of one at an end of a record.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Span {
    /// Where it begins: a row and a share of the step to the next.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// Which part of a cycle it is.
    pub part: SpanPart,
    /// Its branches among those of the record: those with a step of it.
    pub branches: Range<usize>,
}

/// Role of a part of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SpanPart {
    /// A whole cycle.
    Cycle,
    /// Rows before the first whole cycle.
    Beginning,
    /// Rows after the last whole cycle.
    End,
    /// All of a record without any whole cycle.
    All,
}

/// The level whose passings divide a record; `None` for turning points.
pub(super) fn level(survey: &BranchSet, record: usize, division: Division) -> Option<f64> {
    match division {
        Division::Zero => Some(0.0),
        Division::Mean => Some(mean(survey.of_record(record))),
        Division::Start => survey.of_record(record).first().map(|first| first.from),
        Division::Reversals => None,
    }
}

/// The cycles of a record and its incomplete parts, in order. Parts over which the input goes less than the smallest
/// reversal are left out.
pub(super) fn divide(survey: &BranchSet, record: usize, division: Division) -> Vec<Span> {
    let branches = survey.of_record(record);
    let (Some(first), Some(last)) = (branches.first(), branches.last()) else { return Vec::new() };
    let bounds = match level(survey, record, division) {
        Some(level) => {
            in_pairs(&survey.data.records()[record].inputs()[0], level, passings(survey, record, level))
        }
        None => reversals(survey, branches),
    };
    let (begin, end) = (first.rows.start as f64, (last.rows.end - 1) as f64);
    let mut spans = Vec::new();
    let mut push = |from: f64, to: f64, part: SpanPart| {
        let overlaps =
            |branch: &Branch| (branch.rows.start as f64) < to && (branch.rows.end - 1) as f64 > from;
        let start = branches.iter().position(overlaps).unwrap_or(0);
        let count = branches[start..].iter().take_while(|branch| overlaps(branch)).count();
        let x = &survey.data.records()[record].inputs()[0];
        let rows = &x[from.floor() as usize..=to.ceil() as usize];
        let (low, high) = range(rows);
        if part == SpanPart::Cycle || high - low >= survey.smallest_reversal {
            spans.push(Span { from, to, part, branches: start..start + count });
        }
    };
    let cycles: Vec<(f64, f64)> =
        bounds.iter().zip(bounds.iter().skip(2)).step_by(2).map(|(&from, &to)| (from, to)).collect();
    match (cycles.first(), cycles.last()) {
        (Some(&(from, _)), Some(&(_, to))) => {
            if from > begin {
                push(begin, from, SpanPart::Beginning);
            }
            cycles.iter().for_each(|&(from, to)| push(from, to, SpanPart::Cycle));
            if to < end {
                push(to, end, SpanPart::End);
            }
        }
        _ => push(begin, end, SpanPart::All),
    }
    spans
}

/// Half cycles begin and end where the input passes a level. A record that begins or ends near it begins or ends there.
fn passings(survey: &BranchSet, record: usize, level: f64) -> Vec<f64> {
    let branches = survey.of_record(record);
    let x = &survey.data.records()[record].inputs()[0];
    let (last, end) = (branches.len() - 1, x.len() - 1);
    let is_near = |branch: &Branch, x: f64| (x - level).abs() <= tolerance(survey, branch.travel());
    let is_a_step_away = || {
        let (step, missing) = (x[end] - x[end - 1], level - x[end]);
        (0.0..=LAST_STEP).contains(&(missing / step))
            && missing.abs() <= LARGEST_STEP * branches[last].travel()
    };
    let begins_there = is_near(&branches[0], branches[0].from);
    let ends_there = is_near(&branches[last], branches[last].to) || is_a_step_away();
    let mut places = Vec::new();
    if begins_there {
        places.push(branches[0].rows.start as f64);
    }
    for (number, branch) in branches.iter().enumerate() {
        let taken = (begins_there && number == 0) || (ends_there && number == last);
        if !taken && (branch.from - level) * (branch.to - level) < 0.0 {
            let rows = &x[branch.rows.clone()];
            let is_passed = |pair: &[f64]| (pair[0] - level) * (pair[1] - level) <= 0.0 && pair[0] != pair[1];
            let row = rows.windows(2).position(is_passed).expect("the branch has both sides of the level");
            places.push((branch.rows.start + row) as f64 + share(rows, row, level));
        }
    }
    if ends_there && last > 0 {
        places.push((branches[last].rows.end - 1) as f64);
    }
    places
}

/// The passings from that one on from which two half cycles make a cycle: the first one, unless the half cycles before and
/// after each second passing are clearly more alike.
fn in_pairs(x: &[f64], level: f64, passings: Vec<f64>) -> Vec<f64> {
    let furthest = |pair: &[f64]| {
        let rows = &x[pair[0].floor() as usize..=pair[1].ceil() as usize];
        let (low, high) = range(rows);
        (high - level).max(level - low)
    };
    let heights: Vec<f64> = passings.windows(2).map(furthest).collect();
    let scatter = |first: usize| {
        let ratio = |pair: &[f64]| ln(pair[0] / pair[1]);
        let mut ratios: Vec<f64> = heights[first..].chunks_exact(2).map(ratio).collect();
        let middle = median(&mut ratios.clone());
        let count = ratios.len() as f64;
        ratios.drain(..).map(|ratio| (ratio - middle).abs()).sum::<f64>() / count
    };
    let shifted = heights.len() >= 5 && scatter(0) > ALIKE.max(OTHER_PAIRS * scatter(1));
    if shifted { passings[1..].to_vec() } else { passings }
}

/// Half cycles begin and end at turning points, every other of which is the end of a cycle: on the side where they scatter
/// less. A record that begins or ends at the same input as its neighbours begins or ends there.
fn reversals(survey: &BranchSet, branches: &[Branch]) -> Vec<f64> {
    let mut inputs = vec![branches[0].from];
    inputs.extend(branches.iter().map(|branch| branch.to));
    let mut rows = vec![branches[0].rows.start as f64];
    rows.extend(branches.iter().map(|branch| (branch.rows.end - 1) as f64));
    let last = branches.len();
    let is_same = |a: usize, b: usize| {
        (inputs[a] - inputs[b]).abs() <= tolerance(survey, branches[a].travel().max(branches[b - 1].travel()))
    };
    let begins = last >= 2 && is_same(0, 2);
    let ends = last >= 2 && is_same(last - 2, last);
    let scatter = |parity: usize| {
        let side = (1..last).filter(|place| place % 2 == parity).map(|place| inputs[place]);
        let (count, low, high) = side.fold((0, f64::INFINITY, f64::NEG_INFINITY), |(count, low, high), x| {
            (count + 1, f64::min(low, x), f64::max(high, x))
        });
        (count >= 2).then_some(high - low)
    };
    let parity = match (scatter(0), scatter(1)) {
        (Some(even), Some(odd)) if even < STEADIER * odd && odd > survey.same_input() => 0,
        (Some(even), Some(odd)) if odd < STEADIER * even && even > survey.same_input() => 1,
        _ => usize::from(!begins),
    };
    let first = match (parity, begins) {
        (1, _) => 1,
        (_, true) => 0,
        _ => 2,
    };
    (first..=last).filter(|&place| place < last || ends).map(|place| rows[place]).collect()
}

/// Inputs at the ends of a cycle that are closer than this are the same.
fn tolerance(survey: &BranchSet, swing: f64) -> f64 {
    CLOSED * swing + IN_NOISE * survey.input_noise.deviation()
}

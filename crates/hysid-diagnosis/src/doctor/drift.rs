//! Drift: both tips of a repeated loop move the same way, theory.md (10.23). Where a specimen deteriorates they
//! move towards each other.

use super::{ColumnUnits, DataIssue, DataIssueKind, Severity};
use crate::branch::BranchSet;
use crate::cycles::repeated;
use crate::significance;
use crate::{Cycle, Piece};

/// A drift that matters, over all cycles of a kind: share of the range of the output.
const EFFECT: f64 = 0.01;

/// Fewest cycles of a kind, after the first, which still depends on what was before.
const FEWEST: usize = 4;

/// Cycles of a kind that are compared at most.
const MOST: usize = 200;

/// The slower tip moves this share of what the faster does.
const TOGETHER: f64 = 0.4;

/// Rises less falls, over their standard deviation.
const STEADY: f64 = 2.6;

/// How the tips of loops between two inputs move.
struct TipTrend<'c> {
    cycles: Vec<&'c Cycle>,
    /// Over all cycles, both tips together; 0 where they do not move together.
    drift: f64,
}

pub(super) fn complaint(survey: &BranchSet, cycles: &[Cycle]) -> Option<DataIssue> {
    let groups = repeated(survey, cycles);
    let trends: Vec<TipTrend> = groups.iter().filter_map(|group| trend(group)).collect();
    // A tip is an extreme of many rows: its noise is a fraction of theirs.
    let limit = (EFFECT * survey.height()).max(3.0 * survey.output_noise.deviation());
    let drifting = |trend: &&TipTrend| trend.drift.abs() > limit;
    let count = |trend: &TipTrend| trend.cycles.len();
    let longest = trends.iter().filter(drifting).max_by_key(|trend| count(trend))?;
    let same_way: usize =
        trends.iter().filter(drifting).filter(|t| t.drift * longest.drift > 0.0).map(count).sum();
    if 2 * same_way <= trends.iter().map(count).sum() {
        return None;
    }
    let units = ColumnUnits::of(survey);
    let (first, last) = (longest.cycles[0], longest.cycles[count(longest) - 1]);
    let statement = format!(
        "repeated loops move {} by {} over {} cycles, {:.1} % of the output's range: drift (of a sensor or \
         of the mean load, or ratcheting); remove it if it is not part of the hysteresis",
        if longest.drift > 0.0 { "up" } else { "down" },
        units.output(longest.drift.abs()),
        count(longest),
        100.0 * longest.drift.abs() / survey.height()
    );
    let rows = [first, last].map(|cycle| Piece { record: cycle.record.clone(), rows: cycle.rows });
    let issue = DataIssue::of_rows(DataIssueKind::Drift, Severity::Warning, statement, rows.into());
    Some(issue.measured(longest.drift, &units.output))
}

fn trend<'c>(group: &[&'c Cycle]) -> Option<TipTrend<'c>> {
    let settled = &group[1..];
    let cycles: Vec<&Cycle> = settled.iter().copied().step_by(settled.len().div_ceil(MOST).max(1)).collect();
    if cycles.len() < FEWEST {
        return None;
    }
    let tips =
        |tip: fn(&Cycle) -> f64| movement(&cycles.iter().map(|cycle| tip(cycle)).collect::<Vec<f64>>());
    let (low, high) = (tips(|cycle| cycle.output.0)?, tips(|cycle| cycle.output.1)?);
    let together = low * high > 0.0 && low.abs().min(high.abs()) >= TOGETHER * low.abs().max(high.abs());
    Some(TipTrend { cycles, drift: if together { 0.5 * (low + high) } else { 0.0 } })
}

/// How far values move from the first to the last along the median slope (Theil and Sen), if they do so steadily
/// (Mann and Kendall); 0 if not.
fn movement(values: &[f64]) -> Option<f64> {
    let n = values.len();
    let mut slopes = Vec::with_capacity(n * (n - 1) / 2);
    let mut rises = 0.0;
    for (k, first) in values.iter().enumerate() {
        for (ahead, second) in values[k + 1..].iter().enumerate() {
            slopes.push((second - first) / (ahead + 1) as f64);
            rises += if second == first { 0.0 } else { (second - first).signum() };
        }
    }
    let (size, pairs) = (n as f64, slopes.len() as f64);
    let deviation = (size * (size - 1.0) * (2.0 * size + 5.0) / 18.0).sqrt();
    let steady = rises.abs() == pairs || rises.abs() > STEADY * deviation;
    Some(if steady { significance::median(&mut slopes) * (size - 1.0) } else { 0.0 })
}

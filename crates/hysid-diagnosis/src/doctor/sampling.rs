//! How the data were sampled: gaps, changing time steps, too few rows for a cycle, too few turning points.

use super::{ColumnUnits, DataIssue, DataIssueKind, Severity, piece};
use crate::branch::BranchSet;

/// Ratio of a step to those on both sides of it from which on it is a gap.
const GAP: f64 = 5.0;

/// Of the steps, a tenth are shorter and a tenth longer than two that differ by this factor.
const CHANGING: f64 = 1.5;

/// Rows from turning point to turning point.
const FEWEST_ROWS: usize = 10;

/// Branches longer than this share of the range of the input are counted.
const LONG: f64 = 0.2;

const FEWEST_TURNS: usize = 4;

pub(super) fn complaints(survey: &BranchSet) -> Vec<DataIssue> {
    let mut found = time_steps(survey);
    found.extend(rows_of_a_branch(survey));
    found.extend(turning_points(survey));
    found
}

fn time_steps(survey: &BranchSet) -> Vec<DataIssue> {
    let units = ColumnUnits::of(survey);
    let mut found = Vec::new();
    for record in survey.data.records() {
        let Some(time) = record.time() else {
            continue;
        };
        let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let is_gap = |k: &usize| steps[*k] > GAP * steps[k - 1].max(steps[k + 1]);
        let gaps: Vec<usize> = (1..steps.len().saturating_sub(1)).filter(is_gap).collect();
        if let Some(&longest) = gaps.iter().max_by(|a, b| steps[**a].total_cmp(&steps[**b])) {
            let statement = format!(
                "{} where rows are missing, the longest {} at {}: the input there is unknown, so the memory \
                 after it may be wrong; start a new record after each gap, or fill in the input",
                match gaps.len() {
                    1 => "a gap".to_string(),
                    n => format!("{n} gaps"),
                },
                units.time(steps[longest]),
                units.time(time[longest])
            );
            let rows = vec![piece(record, longest, longest + 1)];
            let issue = DataIssue::of_rows(DataIssueKind::TimeGap, Severity::Warning, statement, rows);
            found.push(issue.measured(steps[longest], &units.time));
        }
        let mut sorted = steps;
        sorted.sort_by(f64::total_cmp);
        let (short, long) = (sorted.get(sorted.len() / 10), sorted.get(sorted.len() * 9 / 10));
        if let (Some(&short), Some(&long)) = (short, long)
            && long > CHANGING * short
        {
            let statement = format!(
                "time steps change from {} to {}: parts with dense rows have more weight in a fit; rates \
                 use the time stamps as given",
                units.time(short),
                units.time(long)
            );
            let rows = vec![piece(record, 0, record.len() - 1)];
            let issue =
                DataIssue::of_rows(DataIssueKind::ChangingSamplingRate, Severity::Note, statement, rows);
            found.push(issue.measured(long / short, &None));
        }
    }
    found
}

fn rows_of_a_branch(survey: &BranchSet) -> Option<DataIssue> {
    let mut counts: Vec<usize> = survey
        .branches
        .iter()
        .filter(|branch| branch.travel() >= LONG * survey.width())
        .map(|branch| branch.rows.len() - 1)
        .collect();
    counts.sort_unstable();
    let typical = *counts.get(counts.len() / 2)?;
    (typical < FEWEST_ROWS).then(|| {
        let statement = format!(
            "there are {typical} rows from turning point to turning point: too few for the shape of a branch; sample \
             {} times as fast",
            (2 * FEWEST_ROWS).div_ceil(typical.max(1))
        );
        DataIssue::of_all(DataIssueKind::FewSamples, Severity::Warning, statement)
            .measured(typical as f64, &None)
    })
}

fn turning_points(survey: &BranchSet) -> Option<DataIssue> {
    let units = ColumnUnits::of(survey);
    let found = survey.branches.len().saturating_sub(survey.data.records().len());
    let times = match found {
        1 => "once".to_string(),
        2 => "twice".to_string(),
        n => format!("{n} times"),
    };
    (found < FEWEST_TURNS).then(|| {
        let statement = format!(
            "the input turns only {times} (by more than {}), so the data show little of the memory; measure several \
             cycles of different amplitude",
            units.input(survey.smallest_reversal)
        );
        DataIssue::of_all(DataIssueKind::FewTurningPoints, Severity::Warning, statement)
            .measured(found as f64, &None)
    })
}

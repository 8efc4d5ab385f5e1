//! The data doctor: what in the data would mislead whoever fits a model to them, and what helps. Each complaint
//! is a test of its own; silence means that nothing was found, not that there is nothing.

mod artifacts;
mod clipping;
mod closure;
mod columns;
mod creep;
mod drift;
mod hum;
mod lag;
mod loops;
mod marks;
mod repetition;
mod resonance;
mod sampling;
mod spikes;
mod start;

use std::ops::Range;

pub(crate) use clipping::clipped_outputs;
use serde::Serialize;

use super::artifact::Explanation;
use super::branch::BranchSet;
use super::{Cycle, CycleTable, Delay, DiagnosisOptions, FEWEST_ROWS, Finding, Piece};
use crate::resonance::Resonance;
use hysid_core::data::record::{Dataset, Record};
use hysid_core::data::unit;
use hysid_core::error::Result;
use hysid_core::significant::Significant;
use hysid_core::words::Words;

/// Most issues of one kind that are listed one by one.
const TOLD: usize = 2;

/// Kind of a problem in the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DataIssueKind {
    /// Repeated loops move slowly up or down.
    Drift,
    /// The output moves while the input stands still.
    Creep,
    /// The output comes a fixed time after the input, or before it.
    Lag,
    /// It does, by a time that depends on the speed.
    LagChangesWithSpeed,
    /// The output stands at the end of what was measured while the input goes on.
    OutputClipped,
    /// The input stands at the end of what was measured while the output goes on.
    InputClipped,
    /// Values that mark what was not measured, or spikes.
    MissingValueMark,
    /// Rows repeat the row before.
    RepeatedRows,
    /// A column keeps its value for a fixed number of rows.
    HeldSamples,
    /// The output swings with a period of its own.
    Hum,
    /// The output swings as that of a mass on a spring.
    Resonance,
    /// A column has few different values.
    CoarseResolution,
    /// Time steps change within a record.
    ChangingSamplingRate,
    /// Rows are missing.
    TimeGap,
    /// Loops of a periodic input stay open.
    UnclosedLoops,
    /// A straight line lies under a loop, such as the diamagnetism of a holder.
    LinearBackground,
    /// The output of loops about the input 0 has another middle than 0.
    OutputOffset,
    /// The output falls as the input grows.
    WrongSign,
    /// The output looks like the command, the input like the response.
    SwappedColumns,
    /// Few rows between turning points.
    FewSamples,
    /// Few turning points.
    FewTurningPoints,
    /// A record does not begin at rest, so that its memory at the beginning is not known.
    UnknownStart,
    /// A record's beginning is not that of a virgin specimen.
    NotVirgin,
}

/// How much a complaint matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Worth noting.
    Note,
    /// Mend it first.
    Warning,
}

/// Something in the data that would mislead.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DataIssue {
    /// Kind of the problem.
    pub kind: DataIssueKind,
    /// Name of the record; `None` for all of them together.
    pub record: Option<String>,
    /// How much it matters.
    pub severity: Severity,
    /// Problem and remedy, in words.
    pub statement: String,
    /// Size of the problem.
    pub value: Option<f64>,
    /// Its unit, where it has one that is known.
    pub unit: Option<String>,
    /// The rows that show it.
    pub evidence: Vec<Piece>,
    /// Options that help.
    #[serde(skip)]
    pub advice: Option<Words>,
}

impl DataIssue {
    /// The statement and the advice.
    pub fn words(&self) -> Words {
        let statement = Words::from(self.statement.as_str());
        self.advice.iter().fold(statement, |words, advice| words.advised(advice.clone()))
    }

    fn of_all(kind: DataIssueKind, severity: Severity, statement: String) -> Self {
        let (record, value, unit, evidence, advice) = (None, None, None, Vec::new(), None);
        Self { kind, record, severity, statement, value, unit, evidence, advice }
    }

    fn of_rows(kind: DataIssueKind, severity: Severity, statement: String, rows: Vec<Piece>) -> Self {
        let record = rows.first().map(|piece| piece.record.clone());
        Self { record, evidence: rows, ..Self::of_all(kind, severity, statement) }
    }

    /// The same with the size of the problem, and its unit.
    fn measured(self, value: f64, unit: &Option<String>) -> Self {
        Self { value: Some(value), unit: unit.clone(), ..self }
    }
}

/// Looks for all that may be wrong; warnings first.
pub(crate) fn examine(
    survey: &BranchSet,
    (cycles, table): (&[Cycle], &CycleTable),
    findings: &[Finding],
    delay: Option<&Delay>,
    resonance: Option<&Resonance>,
    explanations: &[Explanation],
) -> Vec<DataIssue> {
    let clipped = clipping::complaints(survey);
    // A flat top turns earlier or later than the input.
    let lags = if clipped.is_empty() { lag::complaints(survey, delay) } else { Vec::new() };
    let drifts = drift::complaint(survey, cycles).into_iter().collect();
    let found = [
        marks::complaints(survey.data),
        spikes::complaint(survey).into_iter().collect(),
        artifacts::added(survey, lags, explanations, DataIssueKind::Lag),
        artifacts::added(survey, drifts, explanations, DataIssueKind::Drift),
        creep::complaint(survey).into_iter().collect(),
        match resonance {
            Some(found) => vec![resonance::complaint(survey, found)],
            None => hum::complaint(survey).into_iter().collect(),
        },
        clipped,
        repetition::complaints(survey),
        sampling::complaints(survey),
        closure::complaint(findings).into_iter().collect(),
        loops::complaints(survey, table),
        columns::complaints(survey),
        start::complaints(survey),
    ];
    let mut told: Vec<DataIssue> = Vec::new();
    for complaint in found.into_iter().flatten() {
        let alike = told.iter().filter(|other| other.kind == complaint.kind).count();
        if alike < TOLD {
            told.push(complaint);
        } else if let Some(last) = told.iter_mut().rfind(|other| other.kind == complaint.kind) {
            last.evidence.extend(complaint.evidence.into_iter().take(1));
        }
    }
    // A vibration turns at its own frequency; more rows would not make it another law.
    if told.iter().any(|complaint| complaint.kind == DataIssueKind::Resonance) {
        told.retain(|complaint| complaint.kind != DataIssueKind::FewSamples);
    }
    told.sort_by_key(|complaint| std::cmp::Reverse(complaint.severity));
    told
}

/// Problems of the values themselves to report before any fit: marks of missing values, and clipped channels.
///
/// # Errors
/// Data that nothing can be said about: a constant input or output, hardly any rows.
pub fn before_a_fit(data: &Dataset) -> Result<Vec<DataIssue>> {
    data.check_identifiable(FEWEST_ROWS)?;
    let found = marks::complaints(data);
    // Where the range is that of a mark, the ends of what was measured are not known.
    if !found.is_empty() || !clipping::may_be(data) {
        return Ok(found);
    }
    Ok(clipping::complaints(&BranchSet::new(data, &DiagnosisOptions::default())))
}

/// The data without the outputs that an instrument clipped, and without spikes; `None` where there are none.
pub(crate) fn without_defects(survey: &BranchSet, clipped: &[(usize, Range<usize>)]) -> Option<Dataset> {
    let spikes = spikes::spikes(survey);
    if clipped.is_empty() && spikes.is_empty() {
        return None;
    }
    let is_defect = |number: usize, row: usize| {
        spikes.contains(&(number, row))
            || clipped.iter().any(|(record, rows)| *record == number && rows.contains(&row))
    };
    let records = survey.data.records().iter().enumerate();
    let records = records.map(|(number, record)| record.clone().scored_where(|row| !is_defect(number, row)));
    Dataset::new(survey.data.names().clone(), records.collect()).ok()
}

/// The longest time by which the output may lag behind the input or lead it, from how it turns where the input
/// turns, theory.md (10.21); `None` where the turning points do not show it.
pub(crate) fn longest_lag(survey: &BranchSet) -> Option<f64> {
    lag::longest(survey)
}

/// Units of the columns, by their names.
struct ColumnUnits {
    input: Option<String>,
    output: Option<String>,
    time: Option<String>,
}

impl ColumnUnits {
    fn of(survey: &BranchSet) -> Self {
        let names = survey.data.names();
        Self {
            input: unit::of_column(&names.inputs[0]),
            output: unit::of_column(&names.output),
            time: names.time.as_deref().and_then(unit::of_column),
        }
    }

    fn input(&self, value: f64) -> String {
        format!("{:.3}{}", Significant(value), unit::suffix(self.input.as_deref()))
    }

    fn output(&self, value: f64) -> String {
        format!("{:.3}{}", Significant(value), unit::suffix(self.output.as_deref()))
    }

    fn time(&self, value: f64) -> String {
        format!("{:.3}{}", Significant(value), unit::suffix(self.time.as_deref()))
    }

    fn speed(&self, value: f64) -> String {
        let unit = match (&self.input, &self.time) {
            (Some(input), Some(time)) => format!(" {input}/{time}"),
            _ => String::new(),
        };
        format!("{:.3}{unit}", Significant(value))
    }

    fn behind(&self, lag: f64) -> String {
        format!("{} {} the input", self.time(lag.abs()), if lag > 0.0 { "behind" } else { "ahead of" })
    }
}

fn piece(record: &Record, first: usize, last: usize) -> Piece {
    Piece::of(record, (first, last))
}

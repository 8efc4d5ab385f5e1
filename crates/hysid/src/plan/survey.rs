//! Gaps in data: properties that they cannot test, and swings, reversals and rates that were not run.

use hysid_diagnosis::cycles::Field;
use hysid_diagnosis::{Diagnosis, DiagnosisOptions, Verdict};
use serde::Serialize;

use super::limits::Limits;
use crate::data::record::{Dataset, Record};
use crate::data::turning_points::turning_points;
use crate::error::Result;
use crate::property::Property;
use crate::significant::Significant;

/// Reversals below this share of the range are noise.
const SMALLEST_REVERSAL: f64 = 0.02;

/// Intervals of the amplitude, and of each axis of the plane of turning points.
const INTERVALS: usize = 8;

/// Swings below this share of the range are minor loops, and away from the middle if they are this far from it.
const MINOR: f64 = 0.6;
const AWAY: f64 = 0.15;

/// Branches below this share of the range say nothing about speeds.
const SHORTEST: f64 = 0.1;

/// Speeds closer than this ratio are one.
const ONE_SPEED: f64 = 1.5;

/// Least number of rows of a hold, with less than this share of the range of movement.
const HOLD_ROWS: usize = 8;
const STILL: f64 = 1e-3;

/// Something that data do not cover.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gap {
    /// A property, or `amplitudes`, `minor-loops`, `turning-points`, `speeds`, `holds`.
    pub what: &'static str,
    /// In words.
    pub statement: String,
}

/// Summary of the data before a plan.
#[derive(Debug, Clone)]
pub(super) struct Survey {
    pub gaps: Vec<Gap>,
    pub rate_dependence: Verdict,
    pub deterioration: Verdict,
    /// True if the specimen deteriorates, or is a structure whose data cannot show it.
    pub may_deteriorate: bool,
    /// True if the data have time and do not exclude rate dependence.
    pub speed_matters: bool,
    /// True if the state of the memory at the beginning of the data is not known.
    pub unknown_start: bool,
    /// True if the input never stood still.
    pub no_hold: bool,
}

impl Survey {
    /// Examines data, for a plan within these limits.
    pub fn of(data: &Dataset, Limits { range, step, .. }: Limits) -> Result<Self> {
        use hysid_diagnosis::DataIssueKind::{NotVirgin, UnknownStart};
        let diagnosis = Diagnosis::of(data, &DiagnosisOptions::default())?;
        let swings = Swings::of(data, range);
        let no_hold = data.has_time() && !has_hold(data, range);
        let mut gaps: Vec<Gap> =
            swings.amplitudes().into_iter().chain(swings.minor_loops()).chain([swings.plane()]).collect();
        gaps.extend(swings.speeds(data));
        if no_hold {
            gaps.push(gap("holds", "the input never stood still: creep and relaxation were not measured"));
        }
        gaps.extend(range_gap(data, range));
        let untested = diagnosis.properties.iter().filter(|finding| finding.verdict == Verdict::NotTestable);
        gaps.extend(untested.map(|finding| gap(finding.property.name(), finding.statement.clone())));
        let rate_dependence = diagnosis.verdict(Property::RateDependence);
        let deterioration = diagnosis.verdict(Property::Deterioration);
        let is_structure = Field::of(data.names()) == Field::Structure;
        Ok(Self {
            gaps,
            rate_dependence,
            deterioration,
            may_deteriorate: deterioration == Verdict::Yes
                || is_structure && deterioration == Verdict::NotTestable,
            speed_matters: step.is_some() && rate_dependence != Verdict::No,
            unknown_start: diagnosis
                .doctor
                .iter()
                .any(|issue| matches!(issue.kind, NotVirgin | UnknownStart))
                && data.records().iter().all(|record| record.lead_in().is_none()),
            no_hold,
        })
    }
}

fn gap(what: &'static str, statement: impl Into<String>) -> Gap {
    Gap { what, statement: statement.into() }
}

/// The part of a range that the data do not have.
fn range_gap(data: &Dataset, (low, high): (f64, f64)) -> Option<Gap> {
    let measured = data.input_range(0);
    let margin = SMALLEST_REVERSAL * (high - low);
    (low < measured.0 - margin || high > measured.1 + margin).then(|| {
        let (from, to) = (Significant(measured.0), Significant(measured.1));
        gap("range", format!("the input was measured from {from:.3} to {to:.3} only"))
    })
}

/// The swings of data between turning points, as shares of a range.
struct Swings {
    range: (f64, f64),
    /// From and to, and mean speed.
    swings: Vec<(f64, f64, f64)>,
}

impl Swings {
    fn of(data: &Dataset, range: (f64, f64)) -> Self {
        let mut swings = Vec::new();
        for record in data.records() {
            swings.extend(swings_of(record, range.1 - range.0));
        }
        Self { range, swings }
    }

    fn share(&self, swing: f64) -> f64 {
        swing.abs() / (self.range.1 - self.range.0)
    }

    fn amplitudes(&self) -> Option<Gap> {
        let mut run = [false; INTERVALS];
        for (from, to, _) in &self.swings {
            let place = (self.share(to - from) * INTERVALS as f64) as usize;
            run[place.min(INTERVALS - 1)] = true;
        }
        let (start, length) = longest_false(&run)?;
        let percent = |place: usize| 100.0 * place as f64 / INTERVALS as f64;
        Some(gap(
            "amplitudes",
            format!(
                "no swing of {:.0} % to {:.0} % of the range was run",
                percent(start),
                percent(start + length)
            ),
        ))
    }

    fn minor_loops(&self) -> Option<Gap> {
        let middle = 0.5 * (self.range.0 + self.range.1);
        let is_minor = |(from, to, _): &(f64, f64, f64)| {
            let share = self.share(to - from);
            share < MINOR && share > SHORTEST && self.share(0.5 * (from + to) - middle) > AWAY
        };
        // The first swing from rest is no loop.
        let inner = self.swings.iter().skip(1);
        (!inner.clone().any(is_minor))
            .then(|| gap("minor-loops", "no minor loop away from the middle was run"))
    }

    /// How many pairs of turning points were run.
    fn plane(&self) -> Gap {
        let place = |x: f64| {
            let place = (x - self.range.0) / (self.range.1 - self.range.0) * INTERVALS as f64;
            (place.max(0.0) as usize).min(INTERVALS - 1)
        };
        let mut pairs = std::collections::BTreeSet::new();
        for (from, to, _) in &self.swings {
            let (a, b) = (place(*from), place(*to));
            pairs.insert((a.min(b), a.max(b)));
        }
        let all = INTERVALS * (INTERVALS + 1) / 2;
        gap(
            "turning-points",
            format!("{} of {all} pairs of turning points were run, in eighths of the range", pairs.len()),
        )
    }

    fn speeds(&self, data: &Dataset) -> Option<Gap> {
        if !data.has_time() {
            return Some(gap("speeds", "the data have no time: a drive can only be run slowly"));
        }
        let long = self.swings.iter().filter(|(from, to, _)| self.share(to - from) > SHORTEST);
        let (slow, fast) =
            long.fold((f64::INFINITY, 0.0_f64), |(slow, fast), swing| (slow.min(swing.2), fast.max(swing.2)));
        (fast < ONE_SPEED * slow).then(|| gap("speeds", "all swings were run at one speed"))
    }
}

/// From, to and mean speed of the swings of a record, for a plan over a range of this width.
fn swings_of(record: &Record, width: f64) -> Vec<(f64, f64, f64)> {
    let x = &record.inputs()[0];
    let turns = turning_points(x, SMALLEST_REVERSAL * width);
    let ends: Vec<usize> = std::iter::once(0).chain(turns).chain([x.len() - 1]).collect();
    let swing = |pair: &[usize]| {
        let (start, end) = (pair[0], pair[1]);
        let elapsed = record.time().map_or((end - start) as f64, |time| time[end] - time[start]);
        (x[start], x[end], (x[end] - x[start]).abs() / elapsed)
    };
    ends.windows(2).map(swing).collect()
}

/// The longest run of `false`: where it begins and its length.
fn longest_false(run: &[bool]) -> Option<(usize, usize)> {
    let mut longest: Option<(usize, usize)> = None;
    let mut start = 0;
    for (place, &is_run) in run.iter().chain(&[true]).enumerate() {
        if is_run {
            let length = place - start;
            if length > longest.map_or(0, |(_, longest)| longest) {
                longest = Some((start, length));
            }
            start = place + 1;
        }
    }
    longest
}

fn has_hold(data: &Dataset, range: (f64, f64)) -> bool {
    let still = STILL * (range.1 - range.0);
    data.records().iter().any(|record| {
        record.inputs()[0].windows(HOLD_ROWS).any(|x| x.iter().all(|value| (value - x[0]).abs() <= still))
    })
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;

    #[test]
    fn the_longest_interval_is_found() {
        assert_eq!(longest_false(&[true, false, false, true, false]), Some((1, 2)));
        assert_eq!(longest_false(&[true, true]), None);
        assert_eq!(longest_false(&[false, false]), Some((0, 2)));
    }

    /// Loops from -1 to 1: swings of the whole range, and the half swing of the beginning.
    #[test]
    fn loops_of_one_amplitude_leave_small_swings_unknown() {
        let t: Vec<f64> = (0..=580).map(|k| 0.01 * f64::from(k)).collect();
        let angle = |t: &f64| 2.5 * std::f64::consts::PI * t;
        let x: Vec<f64> = t.iter().map(|t| sin(angle(t))).collect();
        let y: Vec<f64> = t.iter().map(|t| sin(angle(t) - 0.2)).collect();
        let data = Dataset::from_columns(Some(("t", &t)), &[("x", &x)], ("y", &y)).unwrap();
        let limits =
            Limits { range: (-1.0, 1.0), start: 0.0, step: Some(0.01), max_rate: 8.0, rows: data.rows() };
        let survey = Survey::of(&data, limits).unwrap();
        let statement =
            |what| survey.gaps.iter().find(|gap| gap.what == what).map(|gap| gap.statement.as_str());
        assert_eq!(statement("amplitudes"), Some("no swing of 0 % to 50 % of the range was run"));
        assert!(statement("minor-loops").is_some() && statement("holds").is_some());
        assert!(statement("rate-dependence").is_some());
        assert!(survey.no_hold);
    }
}

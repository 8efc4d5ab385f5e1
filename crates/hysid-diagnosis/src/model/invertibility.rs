//! Whether a model can be inverted sample by sample, theory.md (10.45): after any past, is the next output a monotone
//! function of the next input, in one direction and without jumps?
//!
//! The model is driven to many pasts. After each, trial steps scan the output over the trained range of the input. Of a
//! model with a rate, the rate belongs to the unknown input, so what is found depends on the time step; a scan then
//! covers the inputs that the trained rates can reach.

mod examination;
mod pasts;
mod scan;
mod words;

use serde::Serialize;

use super::probe::Probe;
use crate::{Evidence, Finding, Piece, Property, Verdict};
use examination::{Examination, Examined};
use hysid_core::error::Result;
use words::Words;

/// A way back or a jump below this share of the output's range does not matter.
const EFFECT: f64 = 1e-6;

/// Time steps that differ by this share are the same.
const SAME_STEP: f64 = 1e-9;

/// What outputs with a large constant part round to, as a share of the output.
const LARGE_OUTPUT: f64 = 64.0 * f64::EPSILON;

/// A slope below this share of the mean one is flat.
const FLAT: f64 = 1e-6;

/// Curves of a drawing.
const DRAWN: usize = 16;

const EXPERIMENT: &str = "fit the model to a record whose output follows the input";

/// In which direction the output goes while the input rises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// Upwards.
    Rising,
    /// Downwards.
    Falling,
}

impl Direction {
    fn sign(self) -> f64 {
        match self {
            Self::Rising => 1.0,
            Self::Falling => -1.0,
        }
    }
}

/// What prevents an inverse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlaceKind {
    /// The output goes back.
    Reversal,
    /// The output jumps.
    Jump,
}

/// Where a model is not monotone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Place {
    /// What is there.
    pub kind: PlaceKind,
    /// Its size, as a share of the range of the output.
    pub size: f64,
    /// The path of the input that led there.
    pub path: String,
    /// Row of the path after which it is, counted from 0; `None` before the first sample.
    pub row: Option<usize>,
    /// Time of that row, in the unit of the time.
    pub time: f64,
    /// The first input of that row, in its unit.
    pub input: f64,
    /// The last turning points of the input, in its unit; the latest at the end.
    pub turning_points: Vec<f64>,
    /// Time from that row to the next sample; `None` for a model that does not depend on it.
    pub time_step: Option<f64>,
    /// Next inputs between which the output goes back, or at which it jumps, in the unit of the input.
    pub inputs: (f64, f64),
    /// Outputs there, in the unit of the output.
    pub outputs: (f64, f64),
}

/// What a time step does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AtTimeStep {
    /// Time to the next sample, in its unit.
    pub time_step: f64,
    /// The largest way back or jump, as a share of the range of the output.
    pub index: f64,
}

/// Outputs over the next input, to be drawn.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scans {
    /// After several pasts, over the whole trained range.
    pub several: Vec<Vec<(f64, f64)>>,
    /// After the past with the worst place, if there is one.
    pub worst: Option<Vec<(f64, f64)>>,
}

/// Whether a model has an inverse sample by sample, and for which outputs. Ranges are in the unit of the output.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Invertibility {
    /// The verdict. Its index is the largest way back or jump of the output, as a share of its range.
    #[serde(flatten)]
    pub finding: Finding,
    /// In which direction the output goes while the input rises, in most scans.
    pub direction: Direction,
    /// Outputs that can be reached in one step after each past; `None` if there are none. Of a model with a rate: in a
    /// step that is long enough for the whole trained range.
    pub always: Option<(f64, f64)>,
    /// The widest part of [`Self::always`] in which no past leaves an output that belongs to several inputs or that a
    /// jump omits. Time steps below the shortest one do not count.
    pub monotone_outputs: Option<(f64, f64)>,
    /// Shortest time step from which on all scans are monotone; `None` if there is none, or if time does not matter.
    pub shortest_time_step: Option<f64>,
    /// What each time step does, the shortest first; empty if time does not matter.
    pub time_steps: Vec<AtTimeStep>,
    /// Number of pasts.
    pub pasts: usize,
    /// Number of scans, some of them with different time steps after the same past.
    pub scans: usize,
    /// Share of the scanned inputs over which the output does not change.
    pub flat_share: f64,
    /// Number of jumps that were found.
    pub jumps: usize,
    /// The largest way back or jump; `None` for a verdict *yes*.
    pub worst: Option<Place>,
    /// A drawing.
    #[serde(skip)]
    pub drawing: Scans,
}

impl Invertibility {
    /// # Errors
    /// A rate that cannot be computed.
    pub(super) fn of(probe: &Probe) -> Result<Self> {
        Ok(Judgement::of(&Examination::of(probe)?).invertibility(probe))
    }
}

/// What the scans say.
struct Judgement<'e> {
    examined: &'e Examination,
    /// What follows decides.
    deciding: Vec<&'e Examined>,
    direction: Direction,
    tolerance: f64,
}

impl<'e> Judgement<'e> {
    fn of(examined: &'e Examination) -> Self {
        let shortest = examined.fastest_step * (1.0 - SAME_STEP);
        let deciding: Vec<&Examined> = examined
            .scans
            .iter()
            .filter(|examined| examined.time_step.is_none_or(|step| step >= shortest))
            .collect();
        let change: f64 = deciding.iter().map(|examined| examined.scan.change()).sum();
        let largest = deciding
            .iter()
            .map(|examined| examined.scan.outputs())
            .fold(0.0, |largest: f64, (low, high)| largest.max(low.abs()).max(high.abs()));
        Self {
            examined,
            deciding,
            direction: if change < 0.0 { Direction::Falling } else { Direction::Rising },
            tolerance: (EFFECT * examined.range).max(LARGE_OUTPUT * largest),
        }
    }

    fn whole(&self) -> impl Iterator<Item = &'e Examined> + '_ {
        self.deciding.iter().copied().filter(|examined| examined.is_whole)
    }

    fn invertibility(&self, probe: &Probe) -> Invertibility {
        let Examination { pasts, scans, .. } = self.examined;
        let always = self.always();
        let time_steps = self.time_steps();
        let threshold = self.tolerance / self.examined.range;
        // From the longest downwards, as long as all scans are monotone.
        let monotone = time_steps.iter().rev().take_while(|at| at.index <= threshold);
        let shortest_time_step = monotone.last().map(|at| at.time_step);
        let (size, worst) = self.worst();
        let verdict = match size <= self.tolerance {
            _ if !self.moves() => Verdict::NotTestable,
            true => Verdict::Yes,
            false => Verdict::No,
        };
        let place = worst.filter(|_| verdict == Verdict::No);
        let evidence = place.iter().map(|(_, place)| Evidence {
            index: place.size,
            pieces: vec![Piece { record: place.path.clone(), rows: [place.row.unwrap_or(0); 2].into() }],
        });
        let mut found = Invertibility {
            finding: Finding {
                property: Property::Invertible,
                verdict,
                index: Some(size / self.examined.range),
                threshold: Some(threshold),
                noise: Some(0.0),
                comparisons: self.deciding.len(),
                statement: String::new(),
                experiment: None,
                evidence: evidence.collect(),
                picture: None,
            },
            direction: self.direction,
            always,
            monotone_outputs: always.and_then(|always| self.monotone_outputs(always, shortest_time_step)),
            shortest_time_step,
            time_steps,
            pasts: pasts.len(),
            scans: scans.len(),
            flat_share: self.flat_share(),
            jumps: self.deciding.iter().map(|examined| examined.scan.jumps.len()).sum(),
            worst: place.as_ref().map(|(_, place)| place.clone()),
            drawing: Scans {
                several: self.several(),
                worst: place.map(|(examined, _)| examined.scan.points.clone()),
            },
        };
        if verdict == Verdict::NotTestable {
            let statement = "the output hardly changes with the next input";
            found.finding = Finding::not_testable(Property::Invertible, statement, EXPERIMENT);
            return found;
        }
        found.finding.statement = Words::of(probe.model.names()).statement(&found);
        found
    }

    /// False for a model whose output no next input changes.
    fn moves(&self) -> bool {
        let extent = |examined: &&Examined| {
            let (low, high) = examined.scan.outputs();
            high - low
        };
        self.deciding.iter().map(extent).fold(0.0, f64::max) > self.tolerance
    }

    /// The largest way back or jump, and where it is.
    fn worst(&self) -> (f64, Option<(&'e Examined, Place)>) {
        let places = self.deciding.iter().flat_map(|examined| {
            let reversal = examined.scan.reversal(self.direction.sign());
            let jumps = examined.scan.jumps.iter();
            let jumps = jumps.map(|jump| (PlaceKind::Jump, (jump.input, jump.input), jump.outputs));
            [(PlaceKind::Reversal, reversal.inputs, reversal.outputs)]
                .into_iter()
                .chain(jumps)
                .map(|(kind, inputs, outputs)| (*examined, kind, inputs, outputs))
        });
        let size = |(low, high): (f64, f64)| (high - low).abs();
        // Of equal ones the first.
        let worst = places.reduce(|a, b| if size(b.3) > size(a.3) { b } else { a });
        let Some((examined, kind, inputs, outputs)) = worst else { return (0.0, None) };
        let past = &self.examined.pasts[examined.past];
        let place = Place {
            kind,
            size: size(outputs) / self.examined.range,
            path: past.path.into(),
            row: past.row,
            time: past.time,
            input: past.input,
            turning_points: past.turning_points.clone(),
            time_step: examined.time_step,
            inputs,
            outputs,
        };
        (size(outputs), Some((examined, place)))
    }

    /// Outputs that every scan of the whole range has.
    fn always(&self) -> Option<(f64, f64)> {
        let outputs = self.whole().map(|examined| examined.scan.outputs());
        let (low, high) = outputs.reduce(|a, b| (a.0.max(b.0), a.1.min(b.1)))?;
        (high - low > self.tolerance).then_some((low, high))
    }

    /// The widest part of some outputs that no reversal and no jump touches.
    fn monotone_outputs(&self, (low, high): (f64, f64), shortest: Option<f64>) -> Option<(f64, f64)> {
        let counts = |step: Option<f64>| step.is_none_or(|step| shortest.is_none_or(|least| step >= least));
        let mut omitted: Vec<(f64, f64)> = self
            .deciding
            .iter()
            .filter(|examined| counts(examined.time_step))
            .flat_map(|examined| {
                let jumps = examined.scan.jumps.iter().map(|jump| jump.outputs);
                let jumps = jumps.map(|(a, b)| (a.min(b), a.max(b)));
                jumps.chain(examined.scan.ambiguous(self.direction.sign(), self.tolerance))
            })
            .collect();
        omitted.push((high, f64::INFINITY));
        omitted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut from, mut widest) = (low, (low, low));
        for (begin, end) in omitted {
            let to = begin.min(high);
            if to - from > widest.1 - widest.0 {
                widest = (from, to);
            }
            from = from.max(end);
        }
        (widest.1 - widest.0 > self.tolerance).then_some(widest)
    }

    /// What each time step does, the shortest first, those that do not decide with them.
    fn time_steps(&self) -> Vec<AtTimeStep> {
        let timed = self.examined.scans.iter();
        let mut all: Vec<AtTimeStep> = timed
            .filter_map(|examined| {
                let back = examined.scan.reversal(self.direction.sign()).size();
                let jumps = examined.scan.jumps.iter().map(|jump| (jump.outputs.1 - jump.outputs.0).abs());
                let size = jumps.fold(back, f64::max);
                Some(AtTimeStep { time_step: examined.time_step?, index: size / self.examined.range })
            })
            .collect();
        all.sort_by(|a, b| a.time_step.total_cmp(&b.time_step));
        all.dedup_by(|next, kept| {
            let same = next.time_step <= kept.time_step * (1.0 + SAME_STEP);
            if same {
                kept.index = kept.index.max(next.index);
            }
            same
        });
        all
    }

    /// Share of the whole scans over which the output does not change.
    fn flat_share(&self) -> f64 {
        let (change, width) = self.whole().fold((0.0, 0.0), |(change, width), examined| {
            (change + examined.scan.change().abs(), width + examined.scan.width())
        });
        let parts = self.whole().flat_map(|examined| examined.scan.flats(FLAT * change / width));
        let flat = parts.fold(0.0, |sum, (from, to)| sum + (to - from));
        if width > 0.0 { flat / width } else { 0.0 }
    }

    fn several(&self) -> Vec<Vec<(f64, f64)>> {
        let whole: Vec<&Examined> = self.whole().collect();
        let every = whole.len().div_ceil(DRAWN).max(1);
        whole.iter().step_by(every).map(|examined| examined.scan.points.clone()).collect()
    }
}

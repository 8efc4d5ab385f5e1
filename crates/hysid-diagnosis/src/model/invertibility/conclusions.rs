//! Conclusions from the scans of a model about its inverse.

use super::examination::{Examination, ExaminedScan};
use super::words::Words;
use super::{AtTimeStep, EFFECT, Invertibility, NonMonotonePlace, OutputDirection, PlaceKind, Scans};
use crate::model::probe::Probe;
use crate::{Evidence, Finding, Piece, Property, Verdict};

/// Time steps that differ by this share are the same.
const SAME_STEP: f64 = 1e-9;

/// Rounding of outputs with a large constant part, as a share of the output.
const LARGE_OUTPUT: f64 = 64.0 * f64::EPSILON;

/// A slope below this share of the mean one is flat.
const FLAT: f64 = 1e-6;

/// Curves of a drawing.
const DRAWN: usize = 16;

const EXPERIMENT: &str = "fit the model to a record whose output follows the input";
const WITHOUT_INERTIA: &str = "fit a model without inertia to a record well below the resonance";

/// The scans, with what is common to all conclusions.
pub(super) struct ScanConclusions<'e> {
    examined: &'e Examination,
    /// The scans that decide: not those with very short time steps.
    deciding: Vec<&'e ExaminedScan>,
    direction: OutputDirection,
    tolerance: f64,
}

impl<'e> ScanConclusions<'e> {
    pub fn of(examined: &'e Examination) -> Self {
        let shortest = examined.fastest_step * (1.0 - SAME_STEP);
        let deciding: Vec<&ExaminedScan> = examined
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
            direction: if change < 0.0 { OutputDirection::Falling } else { OutputDirection::Rising },
            tolerance: (EFFECT * examined.range).max(LARGE_OUTPUT * largest),
        }
    }

    fn whole(&self) -> impl Iterator<Item = &'e ExaminedScan> + '_ {
        self.deciding.iter().copied().filter(|examined| examined.is_whole)
    }

    pub fn invertibility(&self, probe: &Probe) -> Invertibility {
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
        if verdict == Verdict::NotTestable || probe.model.has_inertia() {
            let (statement, experiment) = match probe.model.has_inertia() {
                true => ("the sample-by-sample inverse of a model with inertia is unstable", WITHOUT_INERTIA),
                false => ("the output hardly changes with the next input", EXPERIMENT),
            };
            found.finding = Finding::not_testable(Property::Invertible, statement, experiment);
            return found;
        }
        found.finding.statement = Words::of(probe.model.names()).statement(&found);
        found
    }

    /// False for a model whose output no next input changes.
    fn moves(&self) -> bool {
        let extent = |examined: &&ExaminedScan| {
            let (low, high) = examined.scan.outputs();
            high - low
        };
        self.deciding.iter().map(extent).fold(0.0, f64::max) > self.tolerance
    }

    /// The largest way back or jump, and where it is.
    fn worst(&self) -> (f64, Option<(&'e ExaminedScan, NonMonotonePlace)>) {
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
        let place = NonMonotonePlace {
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

    /// Results of each time step, the shortest first, those that do not decide with them.
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
        let whole: Vec<&ExaminedScan> = self.whole().collect();
        let every = whole.len().div_ceil(DRAWN).max(1);
        whole.iter().step_by(every).map(|examined| examined.scan.points.clone()).collect()
    }
}

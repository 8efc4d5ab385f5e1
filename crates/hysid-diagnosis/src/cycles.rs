//! Cycles of the input and the numbers engineers read from their loops.
//!
//! A [`CycleTable`] divides
//! whole records into cycles, one row a cycle, with the figures of structures, magnets and actuators; definitions:
//! docs/cycles.md.

mod backbone;
mod branches;
mod charge;
mod correction;
mod creep;
mod division;
mod elastic_plastic;
mod field;
mod figure;
mod harmonic;
mod igse;
mod joint;
mod least_squares;
mod levels;
mod loss_separation;
mod losses;
mod notes;
mod path;
mod period;
mod quantities;
mod reading;
mod record_figure;
mod row;
mod saturation;
mod strand;
mod table;
#[cfg(test)]
mod tests;
mod tips;

use std::borrow::Cow;
use std::collections::HashMap;

pub use self::backbone::{BackbonePoint, Direction};
pub use self::correction::{Correction, corrected};
pub use self::division::Division;
pub use self::field::Field;
pub use self::figure::{FIGURES, Figure, FigureQuantity, LEVEL_FIGURES};
pub use self::levels::LevelRow;
pub use self::losses::LossAtFrequency;
pub use self::quantities::Quantities;
pub use self::record_figure::{RecordFigure, RecordFigureKind};
pub use self::row::CycleRow;
pub use self::table::{CycleOptions, CycleTable};

use self::charge::counted_through;
use self::path::{area, range, weights};
use self::reading::apart_along_input;
use super::branch::{Branch, BranchSet};
use super::reversal_curves::without_calibration_points;
use super::significance::{self, MEDIAN_OF_NORMAL};
use super::static_hysteresis::FULL;
use super::{DiagnosisOptions, Piece};
use hysid_core::data::record::Dataset;
use hysid_core::elementary::square;

/// A cycle closes if the input comes back this close, as a share of its swing.
pub(crate) const CLOSED: f64 = 0.02;

/// The data from which cycles are read: without calibration points, and the charge of a battery on one axis; with a note on
/// each change.
pub fn prepared(data: &Dataset, field: Option<Field>) -> (Cow<'_, Dataset>, Vec<String>) {
    let (mut set, mut notes) = (Cow::Borrowed(data), Vec::new());
    if let Some((curves, note)) = without_calibration_points(data) {
        (set, notes) = (Cow::Owned(curves), vec![note]);
    }
    if let Some((joined, note)) = counted_through(&set, field) {
        set = Cow::Owned(joined);
        notes.push(note);
    }
    (set, notes)
}

/// A branch and the next one, if they come back to the same input: what tests of properties compare. The table of cycles
/// that users read is a [`CycleTable`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cycle {
    pub record: String,
    /// First and last row, counted from 0 at the beginning of the record.
    pub rows: (usize, usize),
    /// Smallest and largest input.
    pub input: (f64, f64),
    /// Smallest and largest output.
    pub output: (f64, f64),
    /// `∮ y dx`: the energy lost, for a force over a displacement. Positive if the loop is passed clockwise.
    pub energy: f64,
    /// Area between the rising and the falling branch, all of it counted as positive.
    pub area: f64,
    /// Standard deviation of the energy from the noise.
    pub energy_deviation: f64,
    /// Distance of the branches along the input, half way up the loop.
    pub width: f64,
    /// Its branches among those of the survey.
    pub(crate) branches: (usize, usize),
}

impl Cycle {
    pub fn height(&self) -> f64 {
        self.output.1 - self.output.0
    }

    pub fn swing(&self) -> f64 {
        self.input.1 - self.input.0
    }

    /// True if it is no line: its area is a relevant share of its bounding box.
    pub(crate) fn is_open(&self) -> bool {
        self.area > FULL * self.swing() * self.height()
    }

    /// The rows of the cycle.
    pub fn piece(&self) -> Piece {
        Piece { record: self.record.clone(), rows: self.rows }
    }
}

/// The backbones of all records, from where each began.
pub(crate) fn backbones(survey: &BranchSet) -> Vec<BackbonePoint> {
    let of_record = |record: usize| {
        let begin = survey.of_record(record).first().map_or(0.0, |branch| branch.from);
        backbone::backbone(survey, record, begin)
    };
    (0..survey.data.records().len()).flat_map(of_record).collect()
}

/// All cycles of the input whose rows have an output. They do not overlap: after one the next begins.
pub(crate) fn cycles(survey: &BranchSet) -> Vec<Cycle> {
    walk(survey, |_, _| false)
}

/// A cycle loses what matters from this share on, see [`cycles_up_to_growth`].
pub(crate) const LOSS: f64 = 0.05;

/// All cycles, and the second cycle of each level of a growing test, which goes on beyond its beginning to the next level: it
/// ends where it comes back to its beginning. A law without wear may settle on the way that first goes to a new amplitude.
/// So a loss counts only if a quarter of it, of the half that wear gives, is between the next way and the one that goes on.
pub(crate) fn cycles_up_to_growth(survey: &BranchSet) -> Vec<Cycle> {
    let tolerance = survey.same_input();
    let area = |branch: usize| {
        let place = survey.openings.binary_search_by_key(&branch, |opening| opening.branch).ok();
        place.map(|place| survey.openings[place].area)
    };
    walk(survey, |found, index| {
        let [out, back] = [index, index + 1].map(|number| &survey.branches[number]);
        let is_alike = |earlier: usize| {
            let before = found.len().checked_sub(earlier).map(|place| found[place].branches);
            before.filter(|before| before.1 + 2 * earlier - 1 == index).is_some_and(|before| {
                let before = &survey.branches[before.0];
                (before.from - out.from).abs().max((before.to - out.to).abs()) <= tolerance
            })
        };
        let goes_on = if out.rises() { back.to <= out.from } else { back.to >= out.from };
        if !goes_on || !is_alike(1) || is_alike(2) {
            return false;
        }
        let (low, high) = (out.from.min(out.to) - tolerance, out.from.max(out.to) + tolerance);
        let first = survey.branches.partition_point(|branch| branch.record < out.record);
        let is_furthest = survey.branches[first..index]
            .iter()
            .all(|branch| branch.from.min(branch.to) >= low && branch.from.max(branch.to) <= high);
        let areas = area(index - 2).zip(area(index - 1)).zip(area(index));
        is_furthest
            && areas.is_some_and(|((whole, shared), last)| {
                let loss = 1.0 - last / whole;
                loss <= LOSS || 1.0 - last / shared >= 0.25 * loss
            })
    })
}

/// The cycles from the first branch on. `passes` says, after the cycles so far, that a branch and the next are a cycle that
/// goes on beyond its beginning.
fn walk(survey: &BranchSet, passes: impl Fn(&[Cycle], usize) -> bool) -> Vec<Cycle> {
    let mut found = Vec::new();
    let mut index = 0;
    while index + 1 < survey.branches.len() {
        match cycle(survey, index, passes(&found, index)) {
            Some(cycle) => {
                found.push(cycle);
                index += 2;
            }
            None => index += 1,
        }
    }
    found
}

fn cycle(survey: &BranchSet, index: usize, passes: bool) -> Option<Cycle> {
    let (out, back) = (&survey.branches[index], &survey.branches[index + 1]);
    let swing = out.travel().max(back.travel());
    let closed = (back.to - out.from).abs() <= CLOSED * swing + 2.0 * survey.input_noise.deviation();
    if out.record != back.record || !(closed || passes) {
        return None;
    }
    let place = survey.openings.binary_search_by_key(&index, |opening| opening.branch).ok()?;
    let record = &survey.data.records()[out.record];
    let inputs = &record.inputs()[0][back.rows.clone()];
    let beyond = |x: &f64| if out.rises() { *x < out.from } else { *x > out.from };
    let past = inputs.iter().position(beyond).filter(|_| !closed).unwrap_or(inputs.len());
    let rows = out.rows.start..back.rows.start + past;
    let (x, y) = (&record.inputs()[0][rows.clone()], &record.output()[rows.clone()]);
    if y.iter().any(|y| y.is_nan()) || out.curve.is_empty() || back.curve.is_empty() {
        return None;
    }
    let (input, output) = (range(x), range(y));
    let middle = 0.5 * (output.0 + output.1);
    Some(Cycle {
        record: record.name().into(),
        rows: (rows.start, rows.end - 1),
        input,
        output,
        energy: area(x, y),
        area: survey.openings[place].area,
        energy_deviation: survey.output_noise.of_sum(&weights(x)),
        width: apart_along_input(out, back, middle).unwrap_or(0.0),
        branches: (index, index + 1),
    })
}

/// Cycles of the same record between the same inputs and within the same outer turning points, in the order of
/// time, two of a kind at least. Loops with another past are other loops.
pub(crate) fn repeated<'c>(survey: &BranchSet, cycles: &'c [Cycle]) -> Vec<Vec<&'c Cycle>> {
    let tolerance = survey.same_input();
    let out = |cycle: &Cycle| &survey.branches[cycle.branches.0];
    let cell = |cycle: &Cycle| (out(cycle).to / tolerance).floor() as i64;
    let same = |a: f64, b: f64| (a - b).abs() <= tolerance;
    let alike = |a: &Branch, b: &Branch| {
        let outer = a.around.iter().rev().skip(1).zip(b.around.iter().rev().skip(1)).take(2);
        same(a.from, b.from) && same(a.to, b.to) && outer.into_iter().all(|(a, b)| same(*a, *b))
    };
    let mut groups: Vec<Vec<&Cycle>> = Vec::new();
    let mut near: HashMap<(usize, i64), Vec<usize>> = HashMap::new();
    for cycle in cycles {
        let (record, here) = (out(cycle).record, cell(cycle));
        let candidates = (here - 1..=here + 1).filter_map(|cell| near.get(&(record, cell))).flatten();
        let known = candidates.copied().find(|&group| alike(out(groups[group][0]), out(cycle)));
        match known {
            Some(group) => groups[group].push(cycle),
            None => {
                near.entry((record, here)).or_default().push(groups.len());
                groups.push(vec![cycle]);
            }
        }
    }
    groups.retain(|group| group.len() >= 2);
    groups
}

/// Fewest second differences of successive tips from which their scatter is estimated.
const FEWEST_TIPS: usize = 6;

/// Factor by which the scatter of few tips may be larger.
const UNSURE: f64 = 1.5;

/// Looks through the data, with the noise that only repeated cycles show.
pub(crate) fn survey<'d>(data: &'d Dataset, options: &DiagnosisOptions) -> BranchSet<'d> {
    let survey = BranchSet::new(data, options);
    BranchSet { slow_noise: slow_noise(&survey), ..survey }
}

/// Deviation by which the output at the tips of repeated cycles moves from one to the next, beyond a steady course (by
/// second differences) and the noise of the tips themselves: noise and drift slower than a branch. 0 where cycles are not
/// repeated often enough.
fn slow_noise(survey: &BranchSet) -> f64 {
    let cycles = cycles(survey);
    let (mut scatter, mut variances) = (Vec::new(), Vec::new());
    for group in repeated(survey, &cycles) {
        let out = |cycle: &Cycle| &survey.branches[cycle.branches.0];
        for tip in [|branch: &Branch| branch.from, |branch: &Branch| branch.to] {
            let readings: Vec<_> = group[1..].iter().filter_map(|c| out(c).curve.at(tip(out(c)))).collect();
            for three in readings.windows(3) {
                scatter.push((three[2].y - 2.0 * three[1].y + three[0].y).abs());
                let [first, middle, last] = [0, 1, 2].map(|k: usize| square(three[k].deviation));
                variances.push(first + 4.0 * middle + last);
            }
        }
    }
    if scatter.len() < FEWEST_TIPS {
        return 0.0;
    }
    let found = significance::median(&mut scatter) / MEDIAN_OF_NORMAL;
    let expected = significance::median(&mut variances);
    // A second difference has two independent moves.
    UNSURE * (0.5 * (found * found - expected).max(0.0)).sqrt()
}

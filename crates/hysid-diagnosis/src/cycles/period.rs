//! Periods of cycles: without the rests between them, and none where the parts of a cycle differ in frequency.

use hysid_core::data::record::Record;

use super::division::{Division, Span};
use super::path::{at, width};
use super::row::CycleRow;
use crate::branch::{Branch, BranchSet};

/// An input rests while it moves by less than this share of the cycle's swing, or than so many deviations of its noise.
const RESTS: f64 = 1e-3;
const RESTS_IN_NOISE: f64 = 4.0;

/// The input leaves its place until it is so many times as far from it.
const LEAVES: f64 = 4.0;

/// Fewest rows of a rest, for each row in which the input leaves it. A steady motion leaves in three times as many rows as it
/// stays, a rounded turning point in as many.
const FEWEST: usize = 4;

/// A dwell at the other turning point lasts at least this share of the rest.
const DWELLS: f64 = 0.3;

/// Ratio of the durations of its halves from which on a cycle has no frequency, if those beside it have halves more alike.
const UNEVEN: f64 = 1.5;

/// Rests of the input in a cycle.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Rests {
    /// Time at the beginning of the cycle that does not belong to it.
    pub beginning: f64,
    /// Time at its end. Of dwells at all turning points, two belong to the cycle.
    pub end: f64,
    /// True if one rest between them is longer than the rest of the cycle.
    pub is_mostly_one: bool,
}

impl Rests {
    /// Time that does not belong to the cycle.
    pub fn at_ends(self) -> f64 {
        self.beginning + self.end
    }
}

/// The rests of a cycle; none without time.
pub(super) fn rests(
    survey: &BranchSet,
    record: &Record,
    branches: &[Branch],
    span: &Span,
    division: Division,
) -> Rests {
    let Some(time) = record.time() else { return Rests::default() };
    let x = &record.inputs()[0];
    let (first, last) = (span.from.ceil() as usize, span.to.floor() as usize);
    let noise = survey.input_noise.deviation();
    let small = RESTS * width(&x[first..=last]);
    let tolerance = small.max(RESTS_IN_NOISE * noise);
    // The last row of a rest at `end`, in the direction of the rows, and its time.
    let rest = |rows: &mut dyn Iterator<Item = usize>, end: f64| {
        let is_near = |row: usize, times: f64| (x[row] - at(x, end)).abs() <= times * tolerance;
        let mut rows = rows.peekable();
        let (mut resting, mut leaving, mut until) = (0, 1, None);
        while let Some(row) = rows.next_if(|row| is_near(*row, 1.0)) {
            (resting, until) = (resting + 1, Some(row));
        }
        while rows.next_if(|row| is_near(*row, LEAVES)).is_some() {
            leaving += 1;
        }
        until.filter(|_| resting >= FEWEST * leaving).map(|row| (row, (time[row] - at(time, end)).abs()))
    };
    let ends = [rest(&mut (first..=last), span.from), rest(&mut (first..=last).rev(), span.to)];
    let lasts = |rest: Option<(usize, f64)>| rest.map_or(0.0, |rest| rest.1);
    let (mut beginning, mut end) = (lasts(ends[0]), lasts(ends[1]));
    let turn = branches[span.branches.start].rows.end - 1;
    if division == Division::Reversals {
        let at_turn = turn as f64;
        let around = [rest(&mut (turn..=last), at_turn), rest(&mut (first..=turn).rev(), at_turn)];
        if lasts(around[0]) + lasts(around[1]) > DWELLS * (beginning + end) {
            (beginning, end) = (0.0, beginning.min(end));
        }
    }
    let row = |end: Option<(usize, f64)>, otherwise| end.map_or(otherwise, |end| end.0);
    let within = row(ends[0], first)..=row(ends[1], last);
    let half = 0.5 * (at(time, span.to) - at(time, span.from) - beginning - end);
    let mut begin = *within.start();
    let is_mostly_one = within.into_iter().any(|row| {
        if (x[row] - x[begin]).abs() > small {
            begin = row;
        }
        time[row] - time[begin] > half
    });
    Rests { beginning, end, is_mostly_one }
}

/// A cycle whose halves are of two frequencies has none. `unevenness` is how many times as long the second half of each
/// cycle lasts as its first, 1 where that is not known.
pub(super) fn leave_out_mixed_frequencies(rows: &mut [CycleRow], unevenness: &[f64]) {
    let is_uneven = |ratio: f64| !(UNEVEN.recip()..=UNEVEN).contains(&ratio);
    for (place, row) in rows.iter_mut().enumerate() {
        let beside = [place.checked_sub(1), Some(place + 1)];
        let mut beside = beside.into_iter().flatten().filter_map(|place| unevenness.get(place));
        if is_uneven(unevenness[place]) && beside.all(|ratio| !is_uneven(*ratio)) && unevenness.len() > 1 {
            (row.frequency, row.power) = (None, None);
            row.notes.push("no frequency: its two halves last unequally".into());
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use hysid_core::data::record::{ColumnNames, Dataset, Record};
    use hysid_core::elementary::sin;

    use crate::cycles::{CycleOptions, CycleTable, Division};

    /// Periods and frequencies of three sines of 2 s, after each of which the input rests, or dwells at both turning points.
    fn periods(division: Division, (rest, dwell): (f64, f64), noise: f64) -> Vec<(f64, Option<f64>)> {
        let (step, quarter) = (0.01, if division == Division::Zero { 0.0 } else { 0.25 });
        let (mut time, mut x) = (Vec::new(), Vec::new());
        let mut push = |value: f64| {
            let row = x.len() as u64;
            let even = (hysid_core::random::mix(row) >> 40) as f64 / f64::from(1u32 << 24) - 0.5;
            time.push(row as f64 * step);
            x.push(value + noise * even);
        };
        for _ in 0..3 {
            for row in 0..200 {
                let phase = row as f64 / 200.0;
                push(sin(TAU * (phase + quarter)));
                if row == 100 {
                    (0..(dwell / step) as usize).for_each(|_| push(sin(TAU * (phase + quarter))));
                }
            }
            (0..((rest + dwell) / step) as usize).for_each(|_| push(sin(TAU * (1.0 + quarter))));
        }
        let y: Vec<f64> = x.iter().map(|x| 3.0 * x + 0.2 * x * x * x).collect();
        let names = ColumnNames::of(Some("t_s"), &["x_mm"], "y_kN");
        let record = Record::new("test", vec![x], y).unwrap().with_time(time).unwrap();
        let options = CycleOptions { division: Some(division), ..CycleOptions::default() };
        let table = CycleTable::of(&Dataset::new(names, vec![record]).unwrap(), &options).unwrap();
        table.complete().map(|row| (row.period.unwrap(), row.frequency)).collect()
    }

    #[test]
    fn a_rest_between_cycles_is_no_part_of_their_period() {
        for noise in [0.0, 0.002] {
            for division in [Division::Zero, Division::Reversals] {
                let found = periods(division, (5.0, 0.0), noise);
                assert!(found.len() >= 2, "{division}: {found:?}");
                found.iter().for_each(|(period, frequency)| {
                    assert!((period - 2.0).abs() < 0.05, "{division} {noise}: {found:?}");
                    assert_eq!(*frequency, Some(period.recip()), "{division} {noise}");
                });
            }
        }
    }

    #[test]
    fn a_cycle_that_mostly_rests_has_no_frequency() {
        let mut x: Vec<f64> = (0..=600).map(|row| sin(TAU * f64::from(row) / 200.0)).collect();
        x.splice(230..230, std::iter::repeat_n(x[230], 300));
        let time = (0..x.len()).map(|row| row as f64 * 0.01).collect();
        let y = x.iter().map(|x| 3.0 * x + 0.2 * x * x * x).collect();
        let record = Record::new("test", vec![x], y).unwrap().with_time(time).unwrap();
        let names = ColumnNames::of(Some("t_s"), &["x_mm"], "y_kN");
        let data = Dataset::new(names, vec![record]).unwrap();
        let table = CycleTable::of(&data, &CycleOptions::default()).unwrap();
        let frequencies: Vec<Option<f64>> = table.complete().map(|row| row.frequency).collect();
        assert_eq!(frequencies.iter().map(Option::is_some).collect::<Vec<_>>(), [true, false, true]);
    }

    #[test]
    fn a_dwell_at_each_turning_point_is_part_of_it() {
        // The record begins without a dwell.
        for ((period, _), expected) in
            periods(Division::Reversals, (0.0, 1.0), 0.0).iter().zip([3.0, 4.0, 4.0])
        {
            assert!((period - expected).abs() < 0.02, "{period}");
        }
        for (period, _) in periods(Division::Zero, (0.0, 0.0), 0.0) {
            assert!((period - 2.0).abs() < 0.01, "{period}");
        }
    }
}

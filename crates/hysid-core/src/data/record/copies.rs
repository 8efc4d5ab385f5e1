//! Records that are one measurement: given twice, copied with rounded numbers or other time stamps, or cut
//! out of a longer record. Held-out data are not unseen if a copy of them is in the training data.

use std::collections::HashMap;

use super::Record;
use crate::data::likeness::Likeness;
use crate::elementary::square;

/// Largest root mean square difference of two columns that count as one, as a share of the standard
/// deviation. It allows for numbers rounded to three digits; repeated measurements differ more, by their
/// noise.
const NEARLY: f64 = 2e-3;

/// Largest difference of single values that are compared first, as a share of the range.
const LOOSELY: f64 = 0.02;

/// Rows that are compared before all others.
const PROBES: usize = 8;

/// Least number of common scored rows.
const FEWEST: usize = 10;

/// Share of the scored rows of the shorter record that must be scored in the longer one too.
const SHARED: f64 = 0.9;

/// How many times longer one unit of time is than another.
const UNITS_OF_TIME: [f64; 5] = [1.0, 60.0, 3600.0, 1e3, 1e6];

/// Most places at which records are searched for in others; beyond it only equal records are found.
const MOST_PLACES: usize = 5_000_000;

/// Two records that are one measurement, by their indices.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordCopy {
    /// The copy; the shorter one if they differ in length, otherwise the later one.
    pub copy: usize,
    /// The record that it is a copy of.
    pub of: usize,
    /// How similar they are.
    pub likeness: Likeness,
}

/// All copies among records, at most one for each record.
pub fn copies(records: &[Record]) -> Vec<RecordCopy> {
    let pairs = || (1..records.len()).flat_map(|later| (0..later).map(move |earlier| (later, earlier)));
    let mut places = 0;
    let are_many = pairs().any(|(a, b)| {
        places += 1 + records[a].len().abs_diff(records[b].len());
        places > MOST_PLACES
    });
    if are_many {
        return equal_ones(records);
    }
    let known: Vec<CopySearch> = records.iter().map(CopySearch::new).collect();
    let mut is_copy = vec![false; records.len()];
    let mut found: Vec<RecordCopy> = Vec::new();
    for (later, earlier) in pairs() {
        let is_shorter = records[later].len() <= records[earlier].len();
        let (short, long) = if is_shorter { (later, earlier) } else { (earlier, later) };
        // A copy of a copy is found with the first.
        if is_copy[short] {
            continue;
        }
        if let Some(likeness) = known[short].likeness_to(&records[long]) {
            is_copy[short] = true;
            found.push(RecordCopy { copy: short, of: long, likeness });
        }
    }
    found
}

fn equal_ones(records: &[Record]) -> Vec<RecordCopy> {
    let mut known: HashMap<String, usize> = HashMap::new();
    let copy = |(place, record): (usize, &Record)| {
        let of = *known.entry(record.fingerprint().text()?).or_insert(place);
        (of != place).then_some(RecordCopy { copy: place, of, likeness: Likeness::Equal })
    };
    records.iter().enumerate().filter_map(copy).collect()
}

/// Similarity of a record to one that is at least as long; `None` if they are two measurements.
pub fn likeness(short: &Record, long: &Record) -> Option<Likeness> {
    CopySearch::new(short).likeness_to(long)
}

struct CopySearch<'r> {
    record: &'r Record,
    scored: Vec<usize>,
    /// Differences of a single input, and of an output, that are negligible.
    loose: Vec<f64>,
    /// Mean square differences of a whole column that are negligible, inputs first.
    limits: Vec<f64>,
}

impl<'r> CopySearch<'r> {
    fn new(record: &'r Record) -> Self {
        let columns = || record.inputs.iter().map(|input| &**input).chain([&record.output[..]]);
        let range = |column: &[f64]| {
            let (low, high) = super::range(column.iter());
            high - low
        };
        let variance = |column: &[f64]| {
            let values = || column.iter().filter(|value| !value.is_nan());
            let count = values().count() as f64;
            let mean = values().sum::<f64>() / count;
            values().map(|value| square(value - mean)).sum::<f64>() / count
        };
        Self {
            record,
            scored: (0..record.len()).filter(|&row| !record.output[row].is_nan()).collect(),
            loose: columns().map(|column| LOOSELY * range(column)).collect(),
            limits: columns().map(|column| NEARLY * NEARLY * variance(column)).collect(),
        }
    }

    fn likeness_to(&self, long: &Record) -> Option<Likeness> {
        let short = self.record;
        let is_possible = self.scored.len() >= FEWEST
            && short.len() <= long.len()
            && short.inputs.len() == long.inputs.len();
        let compared = RecordPair { sought: self, short, long };
        // The row of the largest output is found in the longer record; from there all others are compared.
        let largest = |a: &&usize, b: &&usize| short.output[**a].total_cmp(&short.output[**b]);
        let anchor = *self.scored.iter().max_by(largest).filter(|_| is_possible)?;
        let mut shifts = (0..=long.len() - short.len()).filter(|shift| compared.is_like(anchor, *shift));
        let alike = shifts.find_map(|shift| compared.whole(shift))?;
        Some(if short.len() < long.len() { Likeness::Part } else { alike })
    }
}

struct RecordPair<'r> {
    sought: &'r CopySearch<'r>,
    short: &'r Record,
    long: &'r Record,
}

impl RecordPair<'_> {
    /// Differences of a row from one `shift` rows later in the longer record: each input, and the output.
    fn differences(&self, row: usize, shift: usize) -> impl Iterator<Item = f64> {
        let inputs = self.short.inputs.iter().zip(&self.long.inputs);
        let inputs = inputs.map(move |(short, long)| short[row] - long[row + shift]);
        inputs.chain([self.short.output[row] - self.long.output[row + shift]])
    }

    fn is_like(&self, row: usize, shift: usize) -> bool {
        // A blank output differs from nothing.
        self.differences(row, shift)
            .zip(&self.sought.loose)
            .all(|(difference, loose)| difference.is_nan() || difference.abs() <= *loose)
    }

    fn whole(&self, shift: usize) -> Option<Likeness> {
        let step = self.sought.scored.len().div_ceil(PROBES);
        if !self.sought.scored.iter().step_by(step).all(|&row| self.is_like(row, shift)) {
            return None;
        }
        let mut sums = vec![0.0; self.sought.limits.len()];
        let mut shared = 0;
        for row in 0..self.short.len() {
            for (sum, difference) in sums.iter_mut().zip(self.differences(row, shift)) {
                // A blank output, in one of them.
                if !difference.is_nan() {
                    *sum += difference * difference;
                }
            }
            shared += usize::from(!(self.short.output[row] - self.long.output[row + shift]).is_nan());
        }
        let rows = self.short.len() as f64;
        let counts =
            (0..sums.len()).map(|column| if column + 1 == sums.len() { shared as f64 } else { rows });
        let is_near = sums
            .iter()
            .zip(&self.sought.limits)
            .zip(counts)
            .all(|((sum, limit), count)| *sum <= limit * count);
        let is_shared = shared >= FEWEST && shared as f64 >= SHARED * self.sought.scored.len() as f64;
        let is_equal = sums.iter().all(|sum| *sum == 0.0);
        (is_near && is_shared && (is_equal || self.is_as_fast(shift))).then_some(if is_equal {
            Likeness::Equal
        } else {
            Likeness::NearlyEqual
        })
    }

    /// False for a path that was run at another speed, in any unit of time.
    fn is_as_fast(&self, shift: usize) -> bool {
        let last = self.short.len() - 1;
        let (Some(short), Some(long)) = (&self.short.time, &self.long.time) else { return true };
        let ratio = (short[last] - short[0]) / (long[last + shift] - long[shift]);
        let is_near = |unit: &f64| (ratio / unit - 1.0).abs() < 0.01 || (ratio * unit - 1.0).abs() < 0.01;
        UNITS_OF_TIME.iter().any(is_near)
    }
}

/// The records grouped by measurement: the indices of the records of each measurement, the longest first.
pub(super) fn measurements(records: &[Record]) -> Vec<Vec<usize>> {
    let mut group: Vec<usize> = (0..records.len()).collect();
    for RecordCopy { copy, of, .. } in copies(records) {
        let (from, to) = (group[copy], group[of]);
        group.iter_mut().filter(|group| **group == from).for_each(|group| *group = to);
    }
    let mut found: Vec<Vec<usize>> = Vec::new();
    let mut place_of: HashMap<usize, usize> = HashMap::new();
    for (record, group) in group.into_iter().enumerate() {
        let place = *place_of.entry(group).or_insert_with(|| {
            found.push(Vec::new());
            found.len() - 1
        });
        found[place].push(record);
    }
    found
        .iter_mut()
        .for_each(|places| places.sort_by_key(|&record| std::cmp::Reverse(records[record].scored())));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::{cos, sin};

    /// Growing oscillations with a loop, and noise that is told by a seed.
    fn record(rows: usize, size: f64, noise: f64, seed: u64) -> Record {
        let jitter = |k: usize| noise * (crate::random::uniform(seed << 32 | k as u64) - 0.5);
        let x: Vec<f64> = (0..rows).map(|k| size * sin(0.1 * k as f64) * (0.3 + k as f64 / 400.0)).collect();
        let y = (0..rows).map(|k| x[k] + 0.3 * size * cos(0.1 * k as f64) + jitter(k)).collect();
        Record::new("r", vec![x], y).unwrap()
    }

    #[test]
    fn copies_are_found_and_others_are_not() {
        let one = record(400, 1.0, 0.0, 1);
        let rounded = |values: &[f64]| values.iter().map(|value| (value * 1e3).round() / 1e3).collect();
        let copy = Record::new("c", vec![rounded(&one.inputs[0])], rounded(&one.output)).unwrap();
        let part =
            Record::new("p", vec![one.inputs[0][150..320].to_vec()], one.output[150..320].to_vec()).unwrap();
        let timed = one.clone().with_time((0..400).map(f64::from).collect()).unwrap();
        assert_eq!(likeness(&timed, &one), Some(Likeness::Equal));
        assert_eq!(likeness(&copy, &one), Some(Likeness::NearlyEqual));
        assert_eq!(likeness(&part, &one), Some(Likeness::Part));
        assert_eq!(likeness(&part, &copy), Some(Likeness::Part));
        let (clean, repeated) = (record(400, 1.0, 0.02, 2), record(400, 1.0, 0.02, 3));
        assert_eq!(likeness(&clean, &repeated), None, "a second measurement of the same path");
        assert_eq!(likeness(&record(400, 1.02, 0.0, 1), &one), None);
        // The same path at twice the speed is another measurement, in another unit it is not.
        let at = |record: &Record, step: f64| {
            record.clone().with_time((0..400).map(|k| step * f64::from(k)).collect())
        };
        assert_eq!(likeness(&at(&copy, 0.5).unwrap(), &timed), None);
        assert_eq!(likeness(&at(&copy, 1e-3).unwrap(), &timed), Some(Likeness::NearlyEqual));
        assert_eq!(likeness(&at(&one, 0.5).unwrap(), &timed), Some(Likeness::Equal));
        // What is blank in the longer record is not seen there.
        let blank = one.clone().scored_where(|row| row >= 320);
        assert_eq!(likeness(&part, &blank), None);
        let all = [part, repeated, one, timed, copy];
        assert_eq!(measurements(&all), [vec![2, 3, 4, 0], vec![1]]);
    }
}

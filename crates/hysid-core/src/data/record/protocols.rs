//! Records of one test protocol: repeats of a test, whose inputs agree although their outputs differ by noise, and copies.
//! A model that was fitted to one run of a protocol has seen what the other runs measure, so they are held out together.
//!
//! Two records are of one protocol if their first inputs reverse at the same values, within [`NEAR`] of the range, and take
//! about the same time; or if the inputs agree row by row. A record is also of a protocol if it reverses like a part of it.

use super::copies::measurements;
use super::{Record, range};
use crate::data::turning_points::turning_points;
use crate::elementary::square;

/// Difference of two inputs that count as one, as a share of their range. Designed.
const NEAR: f64 = 0.03;

/// Reversals below these shares of the range are noise; inputs that differ at one share agree at another.
const SMALLEST_REVERSALS: [f64; 3] = [0.03, 0.05, 0.08];

/// Fewest turning points of a part of a protocol: more than one cycle. Designed.
const FEWEST_OF_A_PART: usize = 3;

/// Times of two runs of one protocol differ by less than this factor. Designed.
const AS_FAST: f64 = 1.1;

/// Inputs whose root mean square difference is at most this share of the range are at the same places.
const SAME_PLACE: f64 = 0.005;

/// Differences of neighbouring rows whose correlation is above this are not noise. Designed.
const CORRELATED: f64 = 0.5;

/// Numbers of rows of two runs that are compared row by row differ by less than this share.
const AS_LONG: f64 = 0.02;

/// Records of one protocol.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RepeatedProtocol {
    /// A record of each measurement that runs through the whole protocol, the longest first.
    pub runs: Vec<usize>,
    /// All records, with copies and parts.
    pub records: Vec<usize>,
}

/// The records grouped by protocol, in the order of the first record of each.
pub fn protocols(records: &[Record]) -> Vec<RepeatedProtocol> {
    let mut measured = measurements(records);
    // The longest first, so that parts are compared with what they are a part of.
    measured.sort_by_key(|group| std::cmp::Reverse(records[group[0]].scored()));
    let mut found: Vec<(RecordPath, RepeatedProtocol)> = Vec::new();
    for group in measured {
        let path = RecordPath::of(&records[group[0]]);
        let known = found.iter_mut().find_map(|(other, protocol)| Some((path.agrees(other)?, protocol)));
        match known {
            Some((agreement, protocol)) => {
                if agreement == Agreement::Whole {
                    protocol.runs.push(group[0]);
                }
                protocol.records.extend(group);
            }
            None => found.push((path, RepeatedProtocol { runs: vec![group[0]], records: group })),
        }
    }
    let mut protocols: Vec<RepeatedProtocol> = found.into_iter().map(|(_, protocol)| protocol).collect();
    protocols.sort_by_key(|protocol| protocol.records.iter().copied().min());
    protocols
}

/// How the outputs of runs of one protocol differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProtocolDifference {
    /// Standard deviation of an output about the mean of two runs, in its unit.
    pub deviation: f64,
    /// Neighbouring rows differ independently. If not, the runs were made under other conditions, or the specimen changed.
    pub is_noise: bool,
}

impl RepeatedProtocol {
    /// How the outputs of the first run and the others differ, row by row; `None` unless their inputs are the same.
    pub fn difference(&self, records: &[Record]) -> Option<ProtocolDifference> {
        let (&first, others) = self.runs.split_first()?;
        let first = &records[first];
        let (mut squares, mut shifted, mut count) = (0.0, 0.0, 0.0);
        for other in others.iter().map(|&run| &records[run]) {
            let x = || first.inputs[0].iter().zip(&*other.inputs[0]).map(|(a, b)| square(a - b));
            let near = SAME_PLACE * extent(&first.inputs[0]);
            if other.len() != first.len() || x().sum::<f64>() > near * near * first.len() as f64 {
                return None;
            }
            let y = first.output.iter().zip(&other.output).map(|(a, b)| a - b).filter(|d| !d.is_nan());
            let mut before = 0.0;
            for difference in y {
                squares += difference * difference;
                shifted += difference * before;
                count += 1.0;
                before = difference;
            }
        }
        let deviation = (0.5 * squares / count).sqrt();
        (count > 0.0).then_some(ProtocolDifference { deviation, is_noise: shifted <= CORRELATED * squares })
    }
}

/// How a path agrees with another that is at least as long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Agreement {
    Whole,
    Part,
}

struct RecordPath<'r> {
    record: &'r Record,
    ranges: Vec<f64>,
    largest: usize,
    /// The rows at which the first input reverses, for each smallest reversal.
    turning: Vec<Vec<usize>>,
}

impl<'r> RecordPath<'r> {
    fn of(record: &'r Record) -> Self {
        let ranges: Vec<f64> = record.inputs.iter().map(|input| extent(input)).collect();
        let x = &record.inputs[0];
        let turning = SMALLEST_REVERSALS.iter().map(|share| turning_points(x, share * ranges[0])).collect();
        let largest = (0..x.len()).max_by(|&i, &j| x[i].total_cmp(&x[j])).unwrap_or(0);
        Self { record, ranges, largest, turning }
    }

    fn agrees(&self, long: &RecordPath<'_>) -> Option<Agreement> {
        if self.record.inputs.len() != long.record.inputs.len() || self.record.lead_in != long.record.lead_in
        {
            return None;
        }
        let near = self.near(long);
        if self.by_rows(long, &near) || self.by_turns(long, &near) {
            return Some(Agreement::Whole);
        }
        self.is_part_of(long, &near).then_some(Agreement::Part)
    }

    /// Differences of each input that are negligible; of further inputs, which may be constant, also a share of their value.
    fn near(&self, long: &RecordPath<'_>) -> Vec<f64> {
        let ranges = self.ranges.iter().zip(&long.ranges).map(|(a, b)| a.max(*b)).enumerate();
        let near = ranges.map(|(index, range)| match index {
            0 => NEAR * range,
            further => NEAR * range.max(self.record.inputs[further][0].abs()),
        });
        near.collect()
    }

    /// True if both records reverse alike, from the first row to the last.
    fn by_turns(&self, long: &RecordPath<'_>, near: &[f64]) -> bool {
        let ends = |path: &RecordPath<'_>, turning: &[usize]| -> Vec<usize> {
            let last = path.record.len() - 1;
            std::iter::once(0).chain(turning.iter().copied()).chain([last]).collect()
        };
        self.turning.iter().zip(&long.turning).any(|(short_turning, long_turning)| {
            short_turning.len() == long_turning.len()
                && self.is_alike(&ends(self, short_turning), long, &ends(long, long_turning), near)
        })
    }

    /// True if the turning points are those of a part of the other record.
    fn is_part_of(&self, long: &RecordPath<'_>, near: &[f64]) -> bool {
        self.turning.iter().zip(&long.turning).any(|(short, of_long)| {
            short.len() >= FEWEST_OF_A_PART
                && of_long.windows(short.len()).any(|part| self.is_alike(short, long, part, near))
        })
    }

    /// True if all inputs agree at these rows, and the time between them.
    fn is_alike(&self, rows: &[usize], other: &RecordPath<'_>, other_rows: &[usize], near: &[f64]) -> bool {
        let is_near = |(&row, &other_row): (&usize, &usize)| {
            let mut inputs = self.record.inputs.iter().zip(&other.record.inputs).zip(near);
            inputs.all(|((a, b), near)| (a[row] - b[other_row]).abs() <= *near)
        };
        rows.iter().zip(other_rows).all(is_near) && {
            let time = |path: &RecordPath<'_>, rows: &[usize]| {
                let time = path.record.time()?;
                Some(time[*rows.last()?] - time[*rows.first()?])
            };
            time(self, rows).zip(time(other, other_rows)).is_none_or(|(a, b)| is_as_fast(a, b))
        }
    }

    /// True if the inputs agree row by row, after a shift that brings the largest values together.
    fn by_rows(&self, long: &RecordPath<'_>, near: &[f64]) -> bool {
        let (a, b) = (self.record, long.record);
        let (rows, others) = (a.len(), b.len());
        if rows.abs_diff(others) as f64 > AS_LONG * others as f64 {
            return false;
        }
        let total = |record: &Record| record.time().map(|time| time[time.len() - 1] - time[0]);
        if total(a).zip(total(b)).is_some_and(|(a, b)| !is_as_fast(a, b)) {
            return false;
        }
        let (first, second) = (self.largest, long.largest);
        let shift = second.abs_diff(first);
        if shift as f64 > AS_LONG * others as f64 {
            return false;
        }
        let (skip_a, skip_b) = (first - first.min(second), second - first.min(second));
        a.inputs.iter().zip(&b.inputs).zip(near).all(|((a, b), near)| {
            let pairs = a[skip_a..].iter().zip(&b[skip_b..]);
            // A root mean square difference is smaller than single ones.
            let mut left = 0.25 * near * near * pairs.len() as f64;
            pairs.into_iter().all(|(a, b)| {
                left -= square(a - b);
                left >= 0.0
            })
        })
    }
}

fn extent(values: &[f64]) -> f64 {
    let (low, high) = range(values.iter());
    high - low
}

fn is_as_fast(one: f64, other: f64) -> bool {
    one <= AS_FAST * other && other <= AS_FAST * one
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::sin;
    use crate::random::uniform;

    /// Growing cycles of a size, so many rows each, with noise in input and output.
    fn record(cycles: usize, rows: usize, size: f64, noise: f64, seed: u64) -> Record {
        let jitter = |k: usize| noise * (uniform(seed << 32 | k as u64) - 0.5);
        let phase = |k: usize| std::f64::consts::TAU * k as f64 / rows as f64;
        let amplitude = |k: usize| size * (1.0 + (k / rows) as f64);
        let count = cycles * rows;
        let x: Vec<f64> = (0..count).map(|k| amplitude(k) * sin(phase(k)) + jitter(k)).collect();
        let y = (0..count).map(|k| amplitude(k) * sin(phase(k) - 0.4) + jitter(k + count)).collect();
        let time = (0..count).map(|k| 100.0 * k as f64 / rows as f64).collect();
        Record::new("r", vec![x], y).unwrap().with_time(time).unwrap()
    }

    fn groups(records: &[Record]) -> Vec<Vec<usize>> {
        protocols(records).into_iter().map(|protocol| protocol.records).collect()
    }

    #[test]
    fn repeats_are_one_protocol_and_other_amplitudes_another() {
        let one = record(6, 100, 1.0, 0.02, 1);
        let repeat = record(6, 100, 1.02, 0.02, 2);
        let sampled_otherwise = record(6, 73, 1.0, 0.02, 3);
        let larger = record(6, 100, 1.5, 0.02, 4);
        let all = [one.clone(), larger, repeat, sampled_otherwise, one];
        assert_eq!(groups(&all), [vec![0, 4, 2, 3], vec![1]]);
        assert_eq!(protocols(&all)[0].runs, [0, 2, 3]);
        // Uniform noise within 0.01 of either side has a standard deviation of 0.01 / √3.
        let [protocol] = &protocols(&[record(6, 100, 1.0, 0.02, 1), record(6, 100, 1.0, 0.02, 2)])[..] else {
            panic!("one protocol")
        };
        let of = |other: Record| protocol.difference(&[record(6, 100, 1.0, 0.02, 1), other]);
        let noise = of(record(6, 100, 1.0, 0.02, 2)).unwrap();
        approx::assert_relative_eq!(noise.deviation, 0.01 / 3f64.sqrt(), max_relative = 0.05);
        assert!(noise.is_noise);
        assert_eq!(of(record(6, 100, 1.1, 0.0, 2)), None);
        // A weaker specimen.
        let weaker = record(6, 100, 1.0, 0.02, 2);
        let output = weaker.output().iter().map(|y| 0.9 * y).collect();
        assert!(!of(weaker.with_output(output).unwrap()).unwrap().is_noise);
    }

    #[test]
    fn a_part_of_a_protocol_is_no_run_of_it() {
        let (whole, part) = (record(6, 100, 1.0, 0.02, 1), record(3, 100, 1.0, 0.02, 2));
        let [protocol] = &protocols(&[part.clone(), whole.clone()])[..] else { panic!("one protocol") };
        assert_eq!((&protocol.runs[..], &protocol.records[..]), (&[1][..], &[1, 0][..]));
        // One cycle alone could be of any test.
        assert_eq!(groups(&[whole, record(1, 100, 1.0, 0.02, 3)]).len(), 2);
    }

    #[test]
    fn another_speed_or_condition_is_another_test() {
        let one = record(6, 100, 1.0, 0.0, 1);
        let time = one.time().unwrap().iter().map(|t| 2.0 * t).collect();
        assert_eq!(
            groups(&[one.clone(), one.clone().with_output(vec![1.0; 600]).unwrap().with_time(time).unwrap()])
                .len(),
            2
        );
        let at = |condition: f64| {
            let inputs = vec![one.inputs[0].to_vec(), vec![condition; 600]];
            let output = one.output.iter().map(|y| y * condition).collect();
            Record::new("r", inputs, output).unwrap()
        };
        assert_eq!(groups(&[at(1.0), at(1.2), at(1.01)]), [vec![0, 2], vec![1]]);
    }

    #[test]
    fn random_inputs_agree_row_by_row() {
        let random = |seed: u64, noise: u64| {
            let value = |k: u64| uniform(seed << 32 | k);
            let jitter = |k: usize| 0.005 * (uniform(noise << 40 | k as u64) - 0.5);
            let x: Vec<f64> = (0..900usize)
                .map(|k| {
                    let (from, share) = ((k / 9) as u64, (k % 9) as f64 / 9.0);
                    value(from) + share * (value(from + 1) - value(from)) + jitter(k)
                })
                .collect();
            let y = (0..900).map(|k| x[k] + jitter(k + 900)).collect();
            Record::new("r", vec![x], y).unwrap()
        };
        assert_eq!(groups(&[random(1, 1), random(2, 1), random(1, 2)]), [vec![0, 2], vec![1]]);
    }

    /// Reversal curves are measured at closely spaced fields, and are not repeats of each other.
    #[test]
    fn reversal_curves_are_several_tests() {
        let curve = |reversal: f64| {
            let x: Vec<f64> = (0..200)
                .map(|k| {
                    if k < 100 {
                        1.0 - (1.0 - reversal) * f64::from(k) / 100.0
                    } else {
                        reversal + (1.0 - reversal) * f64::from(k - 100) / 99.0
                    }
                })
                .collect();
            let y = x.iter().map(|x| x + reversal).collect();
            Record::new("r", vec![x], y).unwrap()
        };
        let curves: Vec<Record> = (0..10).map(|k| curve(0.8 - 0.15 * f64::from(k))).collect();
        assert_eq!(protocols(&curves).len(), 10);
    }
}

//! Paths that drive specimens, and what they have in common when made into records.

use hysid_core::data::record::Record;
use hysid_core::error::Result;

/// Fewest steps of a swing, so that a small loop is a loop.
const FEWEST_STEPS: f64 = 4.0;

const GOLDEN: f64 = 1.618_033_988_749_895;

/// The plastic ratio, of which R2 takes multiples of the first two powers.
const PLASTIC: f64 = 1.324_717_957_244_746;

/// A path through the turning points, each swing in equal steps of at most `longest_step`.
pub fn through(turning: &[f64], longest_step: f64) -> Vec<f64> {
    let mut path = turning[..1].to_vec();
    for ends in turning.windows(2) {
        let swing = ends[1] - ends[0];
        let steps = (swing.abs() / longest_step).ceil().max(FEWEST_STEPS);
        path.extend((1..=steps as usize).map(|step| ends[0] + swing * (step as f64 / steps)));
    }
    path
}

/// Turning points whose swings cover the half-plane of a Preisach model evenly: up to `α` and down to
/// `β`, both in the range, with the pairs `(α, β)` those of a sequence of low discrepancy (Roberts' R2).
pub(super) fn covering(pairs: usize, (low, high): (f64, f64)) -> Vec<f64> {
    let place = |k: usize, step: f64| low + (high - low) * (k as f64 * step).fract();
    let pair = |k: usize| {
        let (a, b) = (place(k, 1.0 / PLASTIC), place(k, 1.0 / (PLASTIC * PLASTIC)));
        [a.max(b), a.min(b)]
    };
    (1..=pairs).flat_map(pair).collect()
}

/// Turning points all over a range, with swings of between a third and two thirds of it: multiples of
/// the golden ratio, modulo 1.
pub(super) fn wandering(count: usize, (low, high): (f64, f64)) -> Vec<f64> {
    (1..=count).map(|k| low + (high - low) * (k as f64 * GOLDEN).fract()).collect()
}

/// The way from the first turning point to the last.
pub fn travel(turning: &[f64]) -> f64 {
    turning.windows(2).map(|ends| (ends[1] - ends[0]).abs()).sum()
}

/// A path for training that goes on through other turning points for the test.
pub(super) struct Continued {
    /// Name of the record.
    pub record: &'static str,
    /// Turning points to begin training with.
    pub training: &'static [f64],
    /// Number of [covering] pairs of turning points of training that follow, and their range.
    pub further: (usize, (f64, f64)),
    /// Turning points of the test.
    pub test: &'static [f64],
    /// Largest step between two rows.
    pub longest_step: f64,
    /// Time between two rows in s.
    pub sampling: f64,
}

impl Continued {
    /// The training and the test record of a law.
    pub fn records(&self, law: impl Fn(&[f64]) -> Vec<f64>) -> Result<(Record, Record)> {
        let (pairs, range) = self.further;
        let training = [self.training, &covering(pairs, range)].concat();
        continued(self.record, &training, self.test, self.longest_step, self.sampling, law)
    }
}

/// The record of a law on a path through the turning points of training, and the whole record with this part blanked on
/// through those of the test.
pub(super) fn continued(
    name: &str,
    training: &[f64],
    test: &[f64],
    longest_step: f64,
    sampling: f64,
    law: impl Fn(&[f64]) -> Vec<f64>,
) -> Result<(Record, Record)> {
    let path = through(&[training, test].concat(), longest_step);
    let (output, time) = (law(&path), every(sampling, path.len()));
    let whole = Record::new(name, vec![path], output)?.with_time(time)?;
    Ok(cut(&whole, through(training, longest_step).len()))
}

/// Cuts a record without blanks before row `end`: the head ends there, the tail is the whole record
/// with the head's outputs blanked.
pub fn cut(whole: &Record, end: usize) -> (Record, Record) {
    let fraction = end as f64 / whole.len() as f64;
    whole.split_at_fraction(fraction).expect("a specimen's record has more than two rows")
}

/// Time stamps `0, step, 2 step, ...`
pub fn every(step: f64, rows: usize) -> Vec<f64> {
    (0..rows).map(|row| row as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every sixteenth of the half-plane has about its share of the pairs.
    #[test]
    fn swings_cover_the_preisach_plane_evenly() {
        let pairs = 400;
        let turning = covering(pairs, (-1.0, 3.0));
        let mut counts = [[0usize; 4]; 4];
        for pair in turning.chunks_exact(2) {
            assert!(-1.0 <= pair[1] && pair[1] <= pair[0] && pair[0] <= 3.0, "{pair:?}");
            counts[(pair[0] + 1.0) as usize][(pair[1] + 1.0) as usize] += 1;
        }
        for (a, row) in counts.iter().enumerate() {
            for (b, &count) in row.iter().enumerate() {
                // A square off the diagonal is met by pairs in either order; one above it is empty.
                let share = [2.0, 1.0, 0.0][(1 + b).saturating_sub(a).min(2)] / 16.0;
                let share = if a == b { 1.0 / 16.0 } else { share };
                assert!((count as f64 / pairs as f64 - share).abs() < 0.02, "{a} {b}: {count}");
            }
        }
    }

    #[test]
    fn wandering_swings_are_a_third_to_two_thirds_of_the_range() {
        for pair in wandering(200, (0.0, 1.0)).windows(2) {
            let swing = (pair[1] - pair[0]).abs();
            assert!((0.38..0.62).contains(&swing), "{swing}");
        }
    }
}

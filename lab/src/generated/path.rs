//! Paths that drive the specimens of the cases.

use hysid_core::data::record::Record;

/// Fewest steps of a swing, so that a small loop is a loop.
const FEWEST_STEPS: f64 = 4.0;

/// A path through the turning points, each swing in equal steps of at most `longest_step`.
pub(super) fn through(turning: &[f64], longest_step: f64) -> Vec<f64> {
    let mut path = turning[..1].to_vec();
    for ends in turning.windows(2) {
        let swing = ends[1] - ends[0];
        let steps = (swing.abs() / longest_step).ceil().max(FEWEST_STEPS);
        path.extend((1..=steps as usize).map(|step| ends[0] + swing * (step as f64 / steps)));
    }
    path
}

/// The way from the first turning point to the last.
pub(super) fn travel(turning: &[f64]) -> f64 {
    turning.windows(2).map(|ends| (ends[1] - ends[0]).abs()).sum()
}

/// Cuts a record without blanks before row `end`: the head ends there, the tail is the whole record
/// with the head's outputs blanked.
pub(super) fn cut(whole: &Record, end: usize) -> (Record, Record) {
    let fraction = end as f64 / whole.len() as f64;
    whole.split_at_fraction(fraction).expect("a specimen's record has more than two rows")
}

/// Time stamps `0, step, 2 step, ...`
pub(super) fn every(step: f64, rows: usize) -> Vec<f64> {
    (0..rows).map(|row| row as f64 * step).collect()
}

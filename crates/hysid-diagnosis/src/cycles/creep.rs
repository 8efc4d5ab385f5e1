//! Creep: the drift of the output while the input rests.
//!
//! ```text
//! y(t) = a + c log10(t - t_0)
//! ```
//!
//! `t_0` is when the hold begins, `c` the creep in a decade of time, by least squares over the rows of the hold. This is the
//! law of logarithmic creep of piezo actuators (H. Jung and D.-G. Gweon, Rev. Sci. Instrum. 71, 2000, 1896-1900).

use hysid_core::elementary::log10;

use super::path::range;
use crate::branch::BranchSet;

/// The input rests within this share of its range, or within what noise does.
const RESTS: f64 = 0.002;

/// Deviations of the input's noise within which it rests.
const IN_NOISE: f64 = 6.0;

/// A hold lasts so many times as long as the input, at its mean speed, takes to leave the band in which it rests. A sine
/// stays near its peak for less than a third of that.
const LASTS: f64 = 100.0;

/// Fewest rows of a hold.
const FEWEST_ROWS: usize = 10;

/// The time of the hold is known to a step between rows: the logarithm counts from so many steps on.
const FROM_STEP: f64 = 3.0;

/// Ratio of the last to the first time of which the logarithm is fitted.
const DECADE: f64 = 10.0;

/// A hold of the input, and what the output does meanwhile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CycleHold {
    /// Its first row and its last.
    pub rows: (usize, usize),
    pub duration: f64,
    /// Output at the end less output at the beginning.
    pub drift: f64,
    /// Change of the output in a decade of time, if the hold is long enough for one.
    pub per_decade: Option<f64>,
}

/// The holds of a record with time; none of a record without.
pub(super) fn holds(survey: &BranchSet, record: usize) -> Vec<CycleHold> {
    let data = &survey.data.records()[record];
    let Some(time) = data.time() else { return Vec::new() };
    let (x, y) = (&*data.inputs()[0], data.output());
    let travel: f64 = survey.of_record(record).iter().map(|branch| branch.travel()).sum();
    let band = (RESTS * survey.width()).max(IN_NOISE * survey.input_noise.deviation());
    let speed = travel / (time[time.len() - 1] - time[0]);
    let longest_passing = LASTS * band / speed;
    let mut holds = Vec::new();
    let mut first = 0;
    while first + 1 < x.len() {
        let (mut low, mut high) = (x[first], x[first]);
        let rests = |x: &&f64| {
            (low, high) = (low.min(**x), high.max(**x));
            high - low <= band
        };
        let last = first + x[first..].iter().take_while(rests).count() - 1;
        if last + 1 - first >= FEWEST_ROWS && time[last] - time[first] > longest_passing {
            holds.extend(hold(time, y, settled(x, first, last, band), last));
            first = last;
        } else if let Some(&next) = x.get(last + 1) {
            // A hold that begins later goes on beyond this one: only rows near the next one can be of it.
            let far = (first..=last).rev().find(|&row| (x[row] - next).abs() > band);
            first = far.map_or(first, |row| row) + 1;
        } else {
            break;
        }
    }
    holds
}

/// The row from which on the input is where it rests: the band is entered before.
fn settled(x: &[f64], first: usize, last: usize, band: f64) -> usize {
    let mut rest: Vec<f64> = x[first..=last].to_vec();
    let middle = crate::significance::median(&mut rest);
    let spread = range(&x[first + (last - first) / 2..=last]);
    let near = (0.5 * (spread.1 - spread.0)).max(1e-3 * band);
    let is_there = |row: &usize| (x[*row] - middle).abs() <= 1.5 * near;
    (first..=last).find(is_there).unwrap_or(first)
}

fn hold(time: &[f64], y: &[f64], first: usize, last: usize) -> Option<CycleHold> {
    let (begin, end) = (y[first], y[last]);
    if last <= first || begin.is_nan() || end.is_nan() {
        return None;
    }
    let step = time[first + 1] - time[first];
    let rows =
        (first + 1..=last).filter(|&row| time[row] - time[first] >= FROM_STEP * step && !y[row].is_nan());
    let points: Vec<(f64, f64)> = rows.map(|row| (time[row] - time[first], y[row])).collect();
    Some(CycleHold {
        rows: (first, last),
        duration: time[last] - time[first],
        drift: end - begin,
        per_decade: slope_over_logarithm(&points),
    })
}

/// Slope of the line of least squares over `log10` of the first coordinate, if it covers a decade.
fn slope_over_logarithm(points: &[(f64, f64)]) -> Option<f64> {
    let (first, last) = (points.first()?.0, points.last()?.0);
    if points.len() < FEWEST_ROWS || last < DECADE * first {
        return None;
    }
    let n = points.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (u, v) = (mean(&|point| log10(point.0)), mean(&|point| point.1));
    let products = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
        points.iter().map(|point| of(log10(point.0) - u, point.1 - v)).sum()
    };
    Some(products(&|u, v| u * v) / products(&|u, _| u * u))
}

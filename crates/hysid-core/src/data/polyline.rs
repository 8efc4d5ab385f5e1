//! A polyline through few rows of a long signal.
//!
//! A fit scores some ten thousand of a million rows; the others only advance the memory of the model. On a straight part
//! of the input, one long step gives the same memory as many short ones: a play moves in one direction, and the
//! relaxation equation has an exact solution.
//!
//! ```text
//! |u(k) - û(k)| <= ε  for every row k
//! |p(k) - p̂(k)| <= ε
//! ```
//!
//! `u` is the signal, `û` the polyline through the kept rows, `ε` the tolerance, `p` the play of `u` and `p̂` the play of
//! `û`. The second line follows from the first: if two inputs differ by at most `ε`, their plays of equal threshold do
//! too (theory.md (1.2)).
//!
//! One pass finds the rows. For each column, it holds the interval of slopes of lines from the last kept row that pass
//! all later rows within the tolerance. If the slope to the next row is outside the interval, the row before it is kept.

/// A column of the signal and the limits of its polyline, in the column's unit.
#[derive(Debug, Clone, Copy)]
pub struct PolylineColumn<'a> {
    /// The value at each row.
    pub values: &'a [f64],
    /// Largest distance of the polyline from a value.
    pub tolerance: f64,
    /// Largest change between two successive kept rows with rows left out between them.
    pub longest: f64,
}

impl PolylineColumn<'_> {
    fn slope(&self, anchor: usize, row: usize, elapsed: f64) -> f64 {
        (self.values[row] - self.values[anchor]) / elapsed
    }
}

/// Interval of slopes of lines from the last kept row that pass all later rows within the tolerance.
#[derive(Debug, Clone, Copy)]
struct SlopeInterval {
    low: f64,
    high: f64,
}

const OPEN: SlopeInterval = SlopeInterval { low: f64::NEG_INFINITY, high: f64::INFINITY };

/// Indices of the kept rows: the first row, the last, every row that is `needed`, and those of a polyline that deviates
/// from every row by at most the tolerances.
///
/// `step(row)` is the time since the row before, or 1 without time. Both rows of a step that is infinite, NaN or not
/// positive are kept.
pub fn polyline(
    columns: &[PolylineColumn],
    step: impl Fn(usize) -> f64,
    needed: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let count = columns.first().map_or(0, |column| column.values.len());
    let is_jump = |row: usize| row < count && !(step(row) > 0.0 && step(row) < f64::INFINITY);
    let is_needed = |row: usize| row + 1 >= count || needed(row) || is_jump(row) || is_jump(row + 1);
    let mut rows: Vec<usize> = (0..count.min(1)).collect();
    let mut openings = vec![OPEN; columns.len()];
    let (mut anchor, mut elapsed) = (0, 0.0);
    for row in 1..count {
        elapsed += step(row);
        let is_met = columns.iter().zip(&openings).all(|(column, opening)| {
            let slope = column.slope(anchor, row, elapsed);
            let is_short = (column.values[row] - column.values[anchor]).abs() <= column.longest;
            is_short && opening.low <= slope && slope <= opening.high
        });
        if !is_met && anchor + 1 < row {
            rows.push(row - 1);
            (anchor, elapsed) = (row - 1, step(row));
            openings.fill(OPEN);
        }
        if is_needed(row) {
            rows.push(row);
            (anchor, elapsed) = (row, 0.0);
            openings.fill(OPEN);
            continue;
        }
        for (column, opening) in columns.iter().zip(&mut openings) {
            let (slope, room) = (column.slope(anchor, row, elapsed), column.tolerance / elapsed);
            opening.low = opening.low.max(slope - room);
            opening.high = opening.high.min(slope + room);
        }
    }
    rows
}

/// The time from each of these rows, which are in order, back to the one before it; for the first, to the beginning.
pub fn steps_between(rows: &[usize], step: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut next = 0;
    let since_last = |&row: &usize| {
        let elapsed = (next..=row).map(&step).sum();
        next = row + 1;
        elapsed
    };
    rows.iter().map(since_last).collect()
}

/// Maximum number of windows for the estimate of the noise.
const MOST_WINDOWS: usize = 10_000;

/// Standard deviation of the noise of a signal, in its unit, estimated from the median magnitude of its fourth
/// differences, which are small for a smooth signal. For a sine without noise, with twenty rows a cycle, the estimate is
/// below 0.2 % of the amplitude.
pub fn noise(values: &[f64]) -> f64 {
    let every = (values.len() / MOST_WINDOWS).max(1);
    let fourth = |w: &[f64]| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).abs();
    let mut differences: Vec<f64> = values.windows(5).step_by(every).map(fourth).collect();
    if differences.is_empty() {
        return 0.0;
    }
    let middle = differences.len() / 2;
    let (_, median, _) = differences.select_nth_unstable_by(middle, f64::total_cmp);
    // Fourth differences of white noise have √70 times its deviation, whose median magnitude is 0.6745 of it.
    *median / (0.6745 * 70f64.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::{cos, sin};
    use crate::random::uniform;

    fn column(values: &[f64], tolerance: f64) -> PolylineColumn<'_> {
        PolylineColumn { values, tolerance, longest: f64::INFINITY }
    }

    /// Largest distance between a signal and the polyline through some of its rows, at these times.
    fn distance(values: &[f64], time: &[f64], rows: &[usize]) -> f64 {
        let mut most: f64 = 0.0;
        for pair in rows.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            for row in a..=b {
                let share = (time[row] - time[a]) / (time[b] - time[a]);
                most = most.max((values[row] - values[a] - share * (values[b] - values[a])).abs());
            }
        }
        most
    }

    /// Two columns, uneven steps, and rows that have to stay.
    #[test]
    fn every_row_is_met_within_the_tolerance() {
        let steps: Vec<f64> = (0..5000).map(|k| 0.01 * (1.0 + 0.5 * f64::from(k % 3))).collect();
        let time: Vec<f64> = (0..steps.len()).map(|row| steps[1..=row].iter().sum()).collect();
        let x: Vec<f64> = time.iter().map(|t| sin(*t) + 0.3 * sin(2.7 * t)).collect();
        let rate: Vec<f64> = time.iter().map(|t| cos(*t) + 0.81 * cos(2.7 * t)).collect();
        let columns = [column(&x, 1e-3), column(&rate, 1e-2)];
        let rows = polyline(&columns, |row| steps[row], |row| row % 701 == 5);
        assert!(rows.len() < 1500, "{}", rows.len());
        assert!(rows.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((rows[0], *rows.last().unwrap()), (0, 4999));
        assert!((0..5000).filter(|row| row % 701 == 5).all(|row| rows.binary_search(&row).is_ok()));
        assert!(distance(&x, &time, &rows) <= 1.001e-3);
        assert!(distance(&rate, &time, &rows) <= 1.001e-2);
    }

    #[test]
    fn of_straight_lines_the_ends_stay() {
        let zigzag: Vec<f64> = (0..1001).map(|k| (f64::from(k % 200) - 100.0).abs()).collect();
        let rows = polyline(&[column(&zigzag, 1e-9)], |_| 1.0, |_| false);
        assert_eq!(rows, (0..=10).map(|k| 100 * k).collect::<Vec<_>>());
        let short = PolylineColumn { longest: 10.0, ..column(&zigzag, 1e-9) };
        let rows = polyline(&[short], |_| 1.0, |_| false);
        assert_eq!(rows, (0..=100).map(|k| 10 * k).collect::<Vec<_>>());
    }

    /// The rows around steps without a duration stay, and signals of no, one and two rows have an answer.
    #[test]
    fn jumps_and_short_signals() {
        let ramp: Vec<f64> = (0..100).map(f64::from).collect();
        for odd in [0.0, f64::INFINITY, f64::NAN] {
            let rows = polyline(&[column(&ramp, 0.1)], |row| if row == 40 { odd } else { 1.0 }, |_| false);
            assert_eq!(rows, [0, 39, 40, 99], "{odd}");
        }
        for count in 0..3 {
            let rows = polyline(&[column(&ramp[..count], 0.1)], |_| 1.0, |_| false);
            assert_eq!(rows, (0..count).collect::<Vec<_>>());
        }
    }

    #[test]
    fn noise_is_found_beside_a_smooth_signal() {
        // The sum of twelve numbers between 0 and 1 less its mean: nearly normal, of deviation 1.
        let uniform = |seed: u64| uniform(seed) - 0.5;
        let normal = |row: usize| (0..12).map(|k| uniform(12 * row as u64 + k)).sum::<f64>();
        let smooth: Vec<f64> =
            (0..50_000).map(|k| sin(std::f64::consts::TAU / 20.0 * f64::from(k))).collect();
        assert!(noise(&smooth) < 2e-3, "{}", noise(&smooth));
        let noisy: Vec<f64> = smooth.iter().enumerate().map(|(row, x)| x + 0.02 * normal(row)).collect();
        assert!((noise(&noisy) / 0.02 - 1.0).abs() < 0.05, "{}", noise(&noisy));
        assert_eq!(noise(&smooth[..4]), 0.0);
    }
}

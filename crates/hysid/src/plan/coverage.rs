//! Which states of the memory were visited: cells of reversal, reversal before it, input and speed.
//!
//! ```text
//! gain of a path = Σ_c v_c [h(n_c + a_c) - h(n_c)],    h(n) = n / (n + 1)             theory.md (14.1)
//! ```
//!
//! A branch of hysteresis is determined by where it began and, with memory of more than one reversal, by the reversal
//! before. A cell is an eighth of the range of the input, on a branch that began in an eighth of the range after a
//! reversal in a quarter of the range, at one of four speeds (hold, slow, medium, fast). `n_c` is how often the cell was
//! crossed so far, `a_c` how often the path crosses it, and `v_c` its value. The first visit of a cell gains half of
//! its value, the second a sixth.

use crate::data::record::{Dataset, Record};
use crate::data::turning_points::turning_points;

use super::limits::Limits;

/// Intervals of the input, and of the reversal at which a branch began.
const INTERVALS: usize = 8;

/// Intervals of the reversal before.
const COARSE_INTERVALS: usize = 4;

/// Speeds of a branch: hold, slow, medium, fast.
const SPEEDS: usize = 4;

/// Shares of the largest speed of a branch between which branches are slow, medium and fast.
const SLOW: f64 = 0.3;
const FAST: f64 = 0.67;

/// Speeds at which paths are run, as shares of the largest rate: fast, medium, slow.
pub(super) const CLASSES: [f64; 3] = [1.0, 0.45, 0.2];

/// Reversals below this share of the range are noise.
pub(super) const SMALLEST_REVERSAL: f64 = 0.02;

/// A swing of data between two turning points.
pub(super) struct DataSwing {
    /// Row where it begins.
    pub start: usize,
    /// Row where it ends.
    pub end: usize,
    /// Mean speed.
    pub speed: f64,
}

/// The swings of a record, for a plan over a range of this width.
pub(super) fn swings(record: &Record, width: f64) -> Vec<DataSwing> {
    let x = &record.inputs()[0];
    let turns = turning_points(x, SMALLEST_REVERSAL * width);
    let ends: Vec<usize> = std::iter::once(0).chain(turns).chain([x.len() - 1]).collect();
    let swing = |pair: &[usize]| {
        let (start, end) = (pair[0], pair[1]);
        let elapsed = record.time().map_or((end - start) as f64, |time| time[end] - time[start]);
        DataSwing { start, end, speed: (x[end] - x[start]).abs() / elapsed }
    };
    ends.windows(2).map(swing).collect()
}

/// How often each cell was crossed.
#[derive(Debug, Clone)]
pub(super) struct Coverage {
    limits: Limits,
    /// Mean speed of the fastest branch.
    fastest: f64,
    /// False if the speed makes no difference.
    by_speed: bool,
    visits: Vec<f64>,
}

/// Where the memory is: the last reversal and the one before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Past {
    pub last: f64,
    pub before: f64,
}

impl Past {
    /// Of a machine at rest.
    pub fn at(x: f64) -> Self {
        Self { last: x, before: x }
    }

    /// After a reversal.
    pub fn turned(self, at: f64) -> Self {
        Self { last: at, before: self.last }
    }
}

/// A piece of a branch in one cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Visit {
    pub cell: usize,
    /// How much of the cell was crossed.
    pub amount: f64,
}

impl Coverage {
    /// Without any visit. `fastest` is the mean speed of the fastest branch.
    pub fn none(limits: Limits, fastest: f64, by_speed: bool) -> Self {
        let cells = INTERVALS * INTERVALS * COARSE_INTERVALS * SPEEDS;
        Self { limits, fastest, by_speed, visits: vec![0.0; cells] }
    }

    /// Adds the visits of data.
    pub fn add_data(&mut self, data: &Dataset) {
        for record in data.records() {
            let x = &record.inputs()[0];
            let mut past = Past::at(x[0]);
            for (number, DataSwing { start, end, speed }) in
                swings(record, self.limits.width()).into_iter().enumerate()
            {
                if number > 0 {
                    past = past.turned(x[start]);
                }
                let scored = start + 1..=end;
                let visits: Vec<Visit> = scored
                    .filter(|&row| !record.output()[row].is_nan())
                    .map(|row| self.visit(x[row - 1], x[row], past, speed))
                    .collect();
                self.add(&visits);
            }
        }
    }

    /// The visit of a row after another, on a branch of this mean speed.
    pub fn visit(&self, from: f64, to: f64, past: Past, speed: f64) -> Visit {
        let width = self.limits.width() / INTERVALS as f64;
        let share = speed / self.fastest;
        let holds = share == 0.0;
        let class = match share {
            _ if holds => 0,
            share if share < SLOW => 1,
            share if share < FAST => 2,
            _ => 3,
        };
        let class = if self.by_speed || holds { class } else { 3 };
        let place = |x: f64, intervals: usize| {
            let place = (x - self.limits.range.0) / self.limits.width() * intervals as f64;
            (place.max(0.0) as usize).min(intervals - 1)
        };
        let x = place(0.5 * (from + to), INTERVALS);
        let (last, before) = (place(past.last, INTERVALS), place(past.before, COARSE_INTERVALS));
        // A hold takes as long as the fastest branch through the cell.
        let amount =
            if holds { self.fastest * self.limits.time_step() / width } else { (to - from).abs() / width };
        Visit { cell: ((x * INTERVALS + last) * COARSE_INTERVALS + before) * SPEEDS + class, amount }
    }

    /// Adds visits.
    pub fn add(&mut self, visits: &[Visit]) {
        for visit in visits {
            self.visits[visit.cell] += visit.amount;
        }
    }

    /// What visits gain, each cell with the mean of the values of its visits.
    pub fn gain(&self, visits: &[Visit], value: impl Fn(usize) -> f64) -> f64 {
        by_cell(visits, value)
            .into_iter()
            .map(|(cell, amount, value)| {
                let before = self.visits[cell];
                value / amount * (saturated(before + amount) - saturated(before))
            })
            .sum()
    }

    /// Share of the visits in cells that were crossed less than half before.
    pub fn new_share(&self, visits: &[Visit]) -> f64 {
        let all: f64 = visits.iter().map(|visit| visit.amount).sum();
        let new = visits.iter().filter(|visit| self.visits[visit.cell] < 0.5);
        // The empty sum is -0.
        if all > 0.0 { new.map(|visit| visit.amount).sum::<f64>().abs() / all } else { 0.0 }
    }
}

fn saturated(visits: f64) -> f64 {
    visits / (visits + 1.0)
}

/// Cells with the sum of the amounts, and of amounts times values.
fn by_cell(visits: &[Visit], value: impl Fn(usize) -> f64) -> Vec<(usize, f64, f64)> {
    let mut order: Vec<usize> = (0..visits.len()).filter(|&row| visits[row].amount > 0.0).collect();
    order.sort_by_key(|&row| (visits[row].cell, row));
    let mut cells: Vec<(usize, f64, f64)> = Vec::new();
    for row in order {
        let Visit { cell, amount } = visits[row];
        let added = amount * value(row);
        match cells.last_mut() {
            Some(last) if last.0 == cell => {
                last.1 += amount;
                last.2 += added;
            }
            _ => cells.push((cell, amount, added)),
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coverage() -> Coverage {
        let limits = Limits { range: (0.0, 8.0), start: 0.0, step: None, max_rate: 1.0, rows: 100 };
        Coverage::none(limits, 1.0, true)
    }

    /// A whole cell gains a half, then a sixth, then a twelfth.
    #[test]
    fn visits_of_the_same_cell_gain_less_and_less() {
        let mut coverage = coverage();
        let visit = coverage.visit(0.0, 1.0, Past::at(0.0), 1.0);
        assert_eq!(visit.amount, 1.0);
        for gain in [1.0 / 2.0, 1.0 / 6.0, 1.0 / 12.0] {
            assert!((coverage.gain(&[visit], |_| 1.0) - gain).abs() < 1e-12);
            coverage.add(&[visit]);
        }
    }

    #[test]
    fn branches_of_other_reversals_and_speeds_are_other_cells() {
        let coverage = coverage();
        let cell =
            |last: f64, before: f64, speed: f64| coverage.visit(4.0, 4.5, Past { last, before }, speed).cell;
        let first = cell(0.0, 8.0, 1.0);
        assert_ne!(first, cell(2.0, 8.0, 1.0));
        assert_ne!(first, cell(0.0, 5.0, 1.0));
        assert_ne!(first, cell(0.0, 8.0, 0.4));
        assert_ne!(first, cell(0.0, 8.0, 0.0));
        assert_eq!(first, cell(0.5, 7.9, 0.9));
        assert_eq!(
            coverage.visit(-3.0, -2.0, Past::at(99.0), 1.0).cell,
            coverage.visit(0.0, 0.1, Past::at(8.0), 1.0).cell
        );
    }

    #[test]
    fn a_repeated_test_is_not_new() {
        let x: Vec<f64> = (0..200).map(|k| 4.0 - 4.0 * (0.1 * f64::from(k)).cos()).collect();
        let data = Dataset::from_slices(&x, &x).unwrap();
        let mut coverage = coverage();
        coverage.add_data(&data);
        let again = |past: Past| -> Vec<Visit> {
            x[32..63].windows(2).map(|pair| coverage.visit(pair[0], pair[1], past, 8.0 / 31.0)).collect()
        };
        // From the upper end down, as in the data; and from the middle, which they do not have.
        assert!(coverage.new_share(&again(Past { last: 8.0, before: 0.0 })) < 0.05);
        assert_eq!(coverage.new_share(&again(Past { last: 4.5, before: 0.0 })), 1.0);
    }
}

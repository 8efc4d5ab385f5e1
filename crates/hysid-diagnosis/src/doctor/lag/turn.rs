//! The output around one turning point of the input, as a rate-independent law gives it: a smooth function of
//! the input before and another after the turning point, which meet there, theory.md (10.20).

use std::ops::Range;

use crate::branch::{Branch, BranchSet};

/// Rows on each side of a turning point at least.
const FEWEST_ROWS: usize = 5;

/// Most rows of a window; of more, evenly spaced ones are taken.
const MOST_ROWS: usize = 400;

/// The input turns sharply where its second derivatives in three rows are so many times one beside them (for a
/// smooth turn three times).
const SHARP: f64 = 9.0;

/// Powers of the way from the turning point, on each side.
const POWERS: usize = 3;

/// Columns of the fit: 1, the powers on each side, what is fitted beside the law, the output.
const COLUMNS: usize = 2 * POWERS + 3;

/// A column whose own part is below this share of it says nothing new.
const DEPENDENT: f64 = 1e-13;

/// Effect fitted beside the law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum LagEffect {
    /// Nothing: the output is this much later than the input.
    Lag(f64),
    /// A step at the turning point.
    Step,
    /// A part in proportion to the rate of the input.
    Rate,
}

/// A turning point with the branches on both sides.
pub(super) struct TurnBranches<'d> {
    time: &'d [f64],
    x: &'d [f64],
    y: &'d [f64],
    row: usize,
    rows: Range<usize>,
    /// Its time and input, between rows.
    moment: f64,
    extreme: f64,
    /// The input's rate just before and after a sharp turn.
    rates: Option<(f64, f64)>,
    /// The shorter way of both branches.
    travel: f64,
    /// Speed of the slower branch.
    pub speed: f64,
}

/// Rows around a turning point.
pub(super) struct TurnWindow {
    rows: Range<usize>,
    stride: usize,
    /// Way of the input within it.
    way: f64,
}

impl TurnWindow {
    /// Rows that are fitted.
    pub fn len(&self) -> usize {
        self.rows.len().div_ceil(self.stride)
    }
}

impl<'d> TurnBranches<'d> {
    /// The turning point between two branches that follow one another, of a record with time.
    pub fn between(survey: &BranchSet<'d>, before: &Branch, after: &Branch) -> Option<Self> {
        let record = &survey.data.records()[before.record];
        let (time, x, y) = (record.time()?, &*record.inputs()[0], record.output());
        let row = after.rows.start;
        let rows = before.rows.start..after.rows.end;
        if row < rows.start + FEWEST_ROWS || row + FEWEST_ROWS >= rows.end {
            return None;
        }
        let mut turn = Self {
            time,
            x,
            y,
            row,
            rows,
            moment: time[row],
            extreme: x[row],
            rates: None,
            travel: before.travel().min(after.travel()),
            speed: before.speed?.min(after.speed?),
        };
        turn.refine();
        Some(turn)
    }

    /// The turning point between the rows: where lines from both sides meet if it is sharp, the top of a
    /// parabola if not.
    fn refine(&mut self) {
        let (t, x, k) = (self.time, self.x, self.row);
        let here = self.bend(k);
        let bends: f64 = (k - 1..=k + 1).map(|row| self.bend(row).abs()).sum();
        if bends > SHARP * self.bend(k - 2).abs().max(self.bend(k + 2).abs()) {
            // The corner may lie on either side of its nearest row.
            let slope = |a: usize, b: usize| (x[b] - x[a]) / (t[b] - t[a]);
            let (left, right) = (slope(k - 3, k - 1), slope(k + 1, k + 3));
            if left * right < 0.0 {
                self.moment = (x[k + 1] - x[k - 1] + left * t[k - 1] - right * t[k + 1]) / (left - right);
                self.moment = self.moment.clamp(t[k - 1], t[k + 1]);
                self.extreme = x[k - 1] + left * (self.moment - t[k - 1]);
                self.rates = Some((left, right));
            }
        } else if here != 0.0 {
            let slope = (x[k + 1] - x[k - 1]) / (t[k + 1] - t[k - 1]);
            let shift = (-slope / here).clamp(t[k - 1] - t[k], t[k + 1] - t[k]);
            self.moment += shift;
            self.extreme += 0.5 * slope * shift;
        }
    }

    /// Second derivative of the input at a row.
    fn bend(&self, k: usize) -> f64 {
        let (t, x) = (self.time, self.x);
        if k == 0 || k + 1 >= t.len() {
            return 0.0;
        }
        let (before, after) = (t[k] - t[k - 1], t[k + 1] - t[k]);
        2.0 * ((x[k + 1] - x[k]) / after - (x[k] - x[k - 1]) / before) / (before + after)
    }

    /// The input at a time between rows `k` and `k + 1`: straight, and bent as far as the rows on both sides
    /// agree that it is.
    fn input_at(&self, k: usize, at: f64) -> f64 {
        if let Some((left, right)) = self.rates
            && k + 1 >= self.row
            && k <= self.row
        {
            return self.extreme + if at < self.moment { left } else { right } * (at - self.moment);
        }
        let (since, until) = (at - self.time[k], self.time[k + 1] - at);
        let straight = (self.x[k] * until + self.x[k + 1] * since) / (since + until);
        let (a, b) = (self.bend(k), self.bend(k + 1));
        let agreed = if a * b > 0.0 { a.signum() * a.abs().min(b.abs()) } else { 0.0 };
        straight - 0.5 * agreed * since * until
    }

    /// Mean time between rows.
    pub fn step(&self) -> f64 {
        self.duration() / (self.rows.len() - 1) as f64
    }

    /// Time between its first row and its last.
    pub fn duration(&self) -> f64 {
        self.time[self.rows.end - 1] - self.time[self.rows.start]
    }

    /// Rows where the input is within `share` of the shorter branch from the turning point, or was at any of the
    /// `lags` earlier. `None` where they are few, or have no output.
    pub fn window(&self, share: f64, lags: (f64, f64)) -> Option<TurnWindow> {
        let way = share * self.travel;
        let inside = |row: &usize| (self.x[*row] - self.extreme).abs() <= way;
        let before = (self.rows.start..self.row).rev().take_while(inside).count();
        let after = (self.row + 1..self.rows.end).take_while(inside).count();
        if before.min(after) < FEWEST_ROWS {
            return None;
        }
        let ends =
            [self.time[self.row - before] + lags.0.min(0.0), self.time[self.row + after] + lags.1.max(0.0)];
        let place = |time: f64| self.time.partition_point(|t| *t < time - 1e-9 * (ends[1] - ends[0]));
        let rows = place(ends[0])..(place(ends[1]) + 1).min(self.time.len());
        let measured = rows.len() > before + after && self.y[rows.clone()].iter().all(|y| !y.is_nan());
        let stride = rows.len().div_ceil(MOST_ROWS);
        measured.then_some(TurnWindow { rows, stride, way })
    }

    /// Sum of squares that the law leaves of the output in a window.
    pub fn remainder(&self, window: &TurnWindow, beside: LagEffect) -> f64 {
        let lag = if let LagEffect::Lag(lag) = beside { lag } else { 0.0 };
        let origin = self.y[self.row];
        let mut sides = [SideSums::default(); 2];
        let mut k = window.rows.start;
        for row in window.rows.clone().step_by(window.stride) {
            let at = self.time[row] - lag;
            while k > 0 && self.time[k] > at {
                k -= 1;
            }
            while k + 2 < self.time.len() && self.time[k + 1] <= at {
                k += 1;
            }
            let q = (self.input_at(k, at) - self.extreme) / window.way;
            let side = usize::from(at >= self.moment);
            let effect = match beside {
                LagEffect::Lag(_) => 0.0,
                LagEffect::Step => side as f64,
                LagEffect::Rate => self.rate(row),
            };
            sides[side].add(q, effect, self.y[row] - origin);
        }
        what_is_left(products(&sides))
    }

    fn rate(&self, row: usize) -> f64 {
        let (before, after) = (row.saturating_sub(1), (row + 1).min(self.time.len() - 1));
        (self.x[after] - self.x[before]) / (self.time[after] - self.time[before]) / self.speed
    }
}

/// Sums over the rows on one side of a turning point: of the powers of `q`, the way from it, alone and times an
/// effect and the output.
#[derive(Debug, Clone, Copy, Default)]
struct SideSums {
    powers: [f64; 2 * POWERS + 1],
    effect: [f64; POWERS + 1],
    output: [f64; POWERS + 1],
    squares: [f64; 3],
}

impl SideSums {
    fn add(&mut self, q: f64, effect: f64, y: f64) {
        let square = q * q;
        let powers = [1.0, q, square, q * square];
        for (sum, power) in self.powers.iter_mut().zip(powers) {
            *sum += power;
        }
        for (sum, power) in self.powers[POWERS + 1..].iter_mut().zip(&powers[1..]) {
            *sum += powers[POWERS] * power;
        }
        for (k, power) in powers.iter().enumerate() {
            self.effect[k] += effect * power;
            self.output[k] += y * power;
        }
        self.squares =
            [self.squares[0] + effect * effect, self.squares[1] + effect * y, self.squares[2] + y * y];
    }
}

/// Products of all columns, lower triangle: 1, the powers before, the powers after, the effect, the output.
fn products(sides: &[SideSums; 2]) -> [[f64; COLUMNS]; COLUMNS] {
    const EFFECT: usize = COLUMNS - 2;
    const OUTPUT: usize = COLUMNS - 1;
    let mut products = [[0.0; COLUMNS]; COLUMNS];
    for (side, sums) in sides.iter().enumerate() {
        let column = |power: usize| if power == 0 { 0 } else { side * POWERS + power };
        for i in 0..=POWERS {
            for j in 0..=i {
                products[column(i)][column(j)] += sums.powers[i + j];
            }
            products[EFFECT][column(i)] += sums.effect[i];
            products[OUTPUT][column(i)] += sums.output[i];
        }
        products[EFFECT][EFFECT] += sums.squares[0];
        products[OUTPUT][EFFECT] += sums.squares[1];
        products[OUTPUT][OUTPUT] += sums.squares[2];
    }
    products
}

/// The square of the last column's part that is no combination of the others, from the products of all
/// columns (lower triangle): elimination, column by column.
fn what_is_left(mut products: [[f64; COLUMNS]; COLUMNS]) -> f64 {
    let own: [f64; COLUMNS] = std::array::from_fn(|i| products[i][i]);
    for pivot in 0..COLUMNS - 1 {
        let here = products[pivot][pivot];
        if here <= DEPENDENT * own[pivot] {
            continue;
        }
        let column: [f64; COLUMNS] = std::array::from_fn(|i| products[i][pivot]);
        for (i, row) in products.iter_mut().enumerate().skip(pivot + 1) {
            let factor = column[i] / here;
            for (entry, other) in row[pivot + 1..=i].iter_mut().zip(&column[pivot + 1..]) {
                *entry -= factor * other;
            }
        }
    }
    products[COLUMNS - 1][COLUMNS - 1].max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DiagnosisOptions;
    use hysid_core::data::record::{ColumnNames, Dataset, Record};
    use hysid_core::elementary::{cos, powi, sin};

    /// A sine at first, and the response of cubics on both sides of its top, `lag` later, with `beside` added.
    fn around_a_top(lag: f64, beside: impl Fn(f64) -> f64) -> Dataset {
        let time: Vec<f64> = (0..400).map(|k| 0.01 * f64::from(k)).collect();
        let top = 0.5 * std::f64::consts::PI;
        let law = |t: f64| {
            let q = sin(t) - 1.0;
            let (slope, bend) = if t < top { (1.0, 0.3) } else { (2.0, -0.4) };
            slope * q + bend * q * q + 0.1 * powi(q, 3)
        };
        let x = time.iter().map(|t| sin(*t)).collect();
        let y = time.iter().map(|t| law(t - lag) + beside(*t)).collect();
        let record = Record::new("r", vec![x], y).unwrap().with_time(time).unwrap();
        Dataset::new(ColumnNames::plain(1), vec![record]).unwrap()
    }

    /// Root mean square of what is left around the top.
    fn left(data: &Dataset, beside: LagEffect) -> f64 {
        let survey = BranchSet::new(data, &DiagnosisOptions::default());
        let turn = TurnBranches::between(&survey, &survey.branches[0], &survey.branches[1]).unwrap();
        let window = turn.window(0.3, (0.0, 0.03)).unwrap();
        (turn.remainder(&window, beside) / window.len() as f64).sqrt()
    }

    #[test]
    fn a_law_with_its_own_lag_leaves_nothing() {
        let data = around_a_top(0.023, |_| 0.0);
        assert!(left(&data, LagEffect::Lag(0.023)) < 1e-6);
        for wrong in [LagEffect::Lag(0.0), LagEffect::Lag(0.04), LagEffect::Step, LagEffect::Rate] {
            assert!(left(&data, wrong) > 1e-4, "{wrong:?}: {}", left(&data, wrong));
        }
    }

    #[test]
    fn a_viscous_part_is_no_lag() {
        let data = around_a_top(0.0, |t| 0.05 * cos(t));
        assert!(left(&data, LagEffect::Rate) < 1e-5);
        for lag in [-0.05, -0.03, -0.01, 0.0] {
            assert!(left(&data, LagEffect::Lag(lag)) > 1e-4);
        }
    }

    #[test]
    fn the_remainder_is_that_of_least_squares() {
        // One side only: a straight line through (0, 0), (1, 0), (2, 3), with 1 and q alone, leaves 3/2. The
        // other powers are left out by rows that all have none of them.
        let mut sides = [SideSums::default(); 2];
        for (q, y) in [(0.0, 0.0), (1.0, 0.0), (2.0, 3.0)] {
            sides[0].add(q, 0.0, y);
        }
        let mut products = products(&sides);
        for row in &mut products {
            row[2..=POWERS].fill(0.0);
        }
        for row in &mut products[2..=POWERS] {
            row.fill(0.0);
        }
        assert!((what_is_left(products) - 1.5).abs() < 1e-12);
    }
}

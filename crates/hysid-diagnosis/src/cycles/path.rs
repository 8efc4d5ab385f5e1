//! The path of a cycle through its rows, closed to a loop, and the area within.
//!
//! ```text
//! ∮ y dx = Σ_k y_k ½(x_{k+1} - x_{k-1}),    k + 1 and k - 1 counted around the loop
//! ```
//!
//! This is the area of the polygon through the rows, exact for straight lines between them. As the loop is closed, it
//! does not depend on where the output has its zero.

use hysid_core::data::record::Record;

/// Weights of the outputs of a loop's rows in its area.
pub(super) fn weights(x: &[f64]) -> Vec<f64> {
    let n = x.len();
    (0..n).map(|row| 0.5 * (x[(row + 1) % n] - x[(row + n - 1) % n])).collect()
}

/// `∮ y dx` of the polygon through the rows and straight back from the last to the first; positive if it is passed
/// clockwise.
pub(super) fn area(x: &[f64], y: &[f64]) -> f64 {
    weights(x).iter().zip(y).map(|(weight, y)| weight * y).sum()
}

/// Inputs and outputs along a part of a record. Its ends may lie between two rows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CyclePath {
    /// The inputs.
    pub x: Vec<f64>,
    /// The outputs; NaN where the record has none.
    pub y: Vec<f64>,
    /// Where its first branch ends and its last one begins.
    turns: (usize, usize),
}

/// Part of a path that is its loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Closure {
    /// All of it.
    Whole,
    /// The input went beyond where it began: the loop ends where it comes back, which closes a loop of a material with
    /// return-point memory.
    EndCut,
    /// The input did not come back to where it began: the loop begins where it first had the input of the end. The outputs
    /// there differ.
    BeginningCut,
}

impl CyclePath {
    /// The part between two places, which are rows and shares of the step to the next row. `turns` are the rows where its
    /// first branch ends and its last one begins.
    pub fn between(record: &Record, (from, to): (f64, f64), turns: (usize, usize)) -> Self {
        let (x, y) = (&*record.inputs()[0], record.output());
        let inner = from.floor() as usize + 1..to.ceil() as usize;
        let column = |values: &[f64]| {
            let rows = values[inner.clone()].iter().copied();
            [at(values, from)].into_iter().chain(rows).chain([at(values, to)]).collect()
        };
        let (x, y): (Vec<f64>, Vec<f64>) = (column(x), column(y));
        let place = |row: usize| (row + 1).saturating_sub(inner.start).min(x.len() - 1);
        let turns = (place(turns.0), place(turns.1));
        Self { x, y, turns }
    }

    /// Rows without an output.
    pub fn blanks(&self) -> usize {
        self.y.iter().filter(|y| y.is_nan()).count()
    }

    /// The path without rows at its ends that have no output, as far as the input hardly moves there: by a share of its swing.
    pub fn without_blank_ends(mut self, share: f64) -> Self {
        let (low, high) = range(&self.x);
        let is_measured = |y: &f64| !y.is_nan();
        let (Some(first), Some(last)) =
            (self.y.iter().position(is_measured), self.y.iter().rposition(is_measured))
        else {
            return self;
        };
        let end = self.x.len() - 1;
        let moves = (self.x[first] - self.x[0]).abs().max((self.x[end] - self.x[last]).abs());
        if moves <= share * (high - low) && last > first {
            self.x = self.x[first..=last].to_vec();
            self.y = self.y[first..=last].to_vec();
            let place = |row: usize| row.saturating_sub(first).min(last - first);
            self.turns = (place(self.turns.0), place(self.turns.1));
        }
        self
    }

    /// The part over which the input comes back to where it was, and how that was reached.
    pub fn closed(self) -> (Self, Closure) {
        let (Some(&first), Some(&last)) = (self.x.first(), self.x.last()) else {
            return (self, Closure::Whole);
        };
        if first == last {
            return (self, Closure::Whole);
        }
        let passes = |level: f64| move |pair: &[f64]| (pair[0] - level) * (pair[1] - level) <= 0.0;
        let (ends, begins) = self.turns;
        let early = self.x[..=ends].windows(2).position(passes(last));
        if let Some(row) = early {
            let share = share(&self.x, row, last);
            return (self.from((row, share)), Closure::BeginningCut);
        }
        let late = self.x[begins..].windows(2).rposition(passes(first));
        match late.map(|row| begins + row) {
            Some(row) => {
                let share = share(&self.x, row, first);
                (self.up_to((row, share)), Closure::EndCut)
            }
            None => (self, Closure::Whole),
        }
    }

    fn from(self, (row, share): (usize, f64)) -> Self {
        let cut = |values: &[f64]| {
            let first = at(values, row as f64 + share);
            std::iter::once(first).chain(values[row + 1..].iter().copied()).collect()
        };
        let turns = (self.turns.0 - row, self.turns.1 - row);
        Self { x: cut(&self.x), y: cut(&self.y), turns }
    }

    fn up_to(self, (row, share): (usize, f64)) -> Self {
        let cut = |values: &[f64]| {
            let last = at(values, row as f64 + share);
            values[..=row].iter().copied().chain([last]).collect()
        };
        Self { x: cut(&self.x), y: cut(&self.y), turns: self.turns }
    }
}

/// Smallest and largest value.
pub(super) fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
}

/// Difference of the largest and the smallest value.
pub(super) fn width(values: &[f64]) -> f64 {
    let (low, high) = range(values);
    high - low
}

/// The value at a row and a share of the step to the next.
pub(super) fn at(values: &[f64], place: f64) -> f64 {
    let row = (place.floor() as usize).min(values.len() - 1);
    match place - row as f64 {
        0.0 => values[row],
        share => values[row] + share * (values[(row + 1).min(values.len() - 1)] - values[row]),
    }
}

/// Share of the step after a row at which a level is passed.
pub(super) fn share(values: &[f64], row: usize, level: f64) -> f64 {
    let step = values[row + 1] - values[row];
    if step == 0.0 { 0.0 } else { ((level - values[row]) / step).clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_of_a_polygon_is_exact_and_knows_the_direction() {
        let (x, y) = ([0.0, 2.0, 2.0, 0.0], [1.0, 1.0, -2.0, -2.0]);
        assert_eq!(area(&x, &y), 6.0, "clockwise: up above, back below");
        let backwards = |values: [f64; 4]| values.into_iter().rev().collect::<Vec<f64>>();
        assert_eq!(area(&backwards(x), &backwards(y)), -6.0);
        assert_eq!(area(&x, &y.map(|y| y + 7.0)), 6.0, "wherever the output has its zero");
    }

    #[test]
    fn a_path_that_does_not_close_is_cut_where_it_does() {
        let path = |x: &[f64], turns| {
            let y = x.iter().map(|x| 2.0 * x).collect();
            CyclePath::between(
                &Record::new("r", vec![x.to_vec()], y).unwrap(),
                (0.0, (x.len() - 1) as f64),
                turns,
            )
        };
        // It ends above its beginning: from where it first had the input of its end.
        assert_eq!(path(&[0.0, 2.0, 4.0, 1.0], (2, 2)).closed().0.x, [1.0, 2.0, 4.0, 1.0]);
        // It ends below: up to where it last had the input of its beginning.
        let below = path(&[0.0, 4.0, 2.0, -2.0], (1, 1)).closed().0;
        assert_eq!((below.x, below.y), (vec![0.0, 4.0, 2.0, 0.0], vec![0.0, 8.0, 4.0, 0.0]));
        assert_eq!(path(&[0.0, 1.0, 0.0], (1, 1)).closed().0.x, [0.0, 1.0, 0.0]);
        // From one passing upwards to the next: what passes downwards between them cuts nothing.
        let rounded = [0.0, 2.0, -2.0, -1.0, 1e-16];
        assert_eq!(path(&rounded, (1, 2)).closed().0.x.len(), 5);
        let short = [0.1, 2.0, -2.0, -1.0, 0.0];
        assert_eq!(path(&short, (1, 2)).closed().0.x, short, "it ends before it comes back");
    }

    #[test]
    fn blank_rows_at_the_ends_are_left_out_where_the_input_hardly_moves() {
        let path = |blank: usize| {
            let x = vec![0.0, 0.1, 5.0, 10.0, 5.0, 0.1];
            let mut y = x.clone();
            y[..blank].fill(f64::NAN);
            let path = CyclePath::between(&Record::new("r", vec![x], y).unwrap(), (0.0, 5.0), (3, 3));
            path.without_blank_ends(0.02)
        };
        assert_eq!((path(1).blanks(), path(1).x.len()), (0, 5));
        assert_eq!((path(2).blanks(), path(2).x.len()), (2, 6), "half of the swing");
    }

    #[test]
    fn the_ends_of_a_path_may_lie_between_rows() {
        let record =
            Record::new("r", vec![vec![0.0, 1.0, 2.0, 3.0]], vec![0.0, 10.0, f64::NAN, 30.0]).unwrap();
        let path = CyclePath::between(&record, (0.5, 1.0), (1, 1));
        assert_eq!((path.x, path.y), (vec![0.5, 1.0], vec![5.0, 10.0]));
        assert_eq!(CyclePath::between(&record, (0.0, 3.0), (3, 0)).blanks(), 1);
        assert_eq!(range(&CyclePath::between(&record, (0.0, 3.0), (3, 0)).x), (0.0, 3.0));
    }
}

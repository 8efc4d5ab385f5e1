//! Savitzky-Golay filters and their weights in the rows of a record, theory.md (15.21).

use std::borrow::Cow;

use super::local_polynomial::weights;

/// Time steps that differ by less than this share are equal.
const EVEN: f64 = 1e-6;

/// Fewest rows of a window.
pub const SMALLEST_WINDOW: usize = 5;

/// A Savitzky-Golay filter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Filter {
    /// Degree of its polynomial.
    pub degree: usize,
    /// Rows on each side of the one whose derivative it gives.
    pub on_a_side: usize,
}

impl Filter {
    /// Rows of its window.
    pub fn window(&self) -> usize {
        2 * self.on_a_side + 1
    }

    /// The filter by whose difference the smoothing error of this one is estimated.
    pub(super) fn reference(&self) -> Self {
        Self { degree: self.degree + 2, ..*self }
    }

    /// True if the window is long enough for the polynomial of the reference.
    pub(super) fn is_possible(&self) -> bool {
        self.window() > self.reference().degree
    }
}

/// The weights of a filter in the rows of a record.
pub struct RowWeights<'t> {
    time: &'t [f64],
    filter: Filter,
    order: usize,
    /// Those of rows with a whole window around them, if time steps are equal.
    inner: Option<Vec<f64>>,
}

impl<'t> RowWeights<'t> {
    /// Of a filter for the derivative of an order.
    pub fn new(time: &'t [f64], filter: Filter, order: usize) -> Self {
        let window = filter.window().min(time.len());
        let is_even = has_even_steps(time) && time.len() >= filter.window();
        let inner = is_even.then(|| weights(&time[..window], filter.on_a_side, filter.degree, order));
        Self { time, filter, order, inner }
    }

    /// The first row of the window of a row, and the weights.
    pub fn at(&self, row: usize) -> (usize, Cow<'_, [f64]>) {
        let window = self.filter.window().min(self.time.len());
        let first = row.saturating_sub(self.filter.on_a_side).min(self.time.len() - window);
        match &self.inner {
            Some(inner) if row - first == self.filter.on_a_side => (first, Cow::Borrowed(inner)),
            _ => {
                let time = &self.time[first..first + window];
                (first, Cow::Owned(weights(time, row - first, self.filter.degree, self.order)))
            }
        }
    }

    /// The derivative in a row.
    pub fn sum(&self, values: &[f64], row: usize) -> f64 {
        let (first, weights) = self.at(row);
        weights.iter().zip(&values[first..]).map(|(weight, value)| weight * value).sum()
    }
}

fn has_even_steps(time: &[f64]) -> bool {
    let mean = (time[time.len() - 1] - time[0]) / (time.len() - 1).max(1) as f64;
    time.windows(2).all(|pair| (pair[1] - pair[0] - mean).abs() <= EVEN * mean)
}

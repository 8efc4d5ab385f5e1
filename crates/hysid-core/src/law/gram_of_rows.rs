//! Uses of the rows of a simulation: their Gram matrix, for least squares, or the rows themselves.

use pulp::Simd;

use crate::linear_algebra::{Batch, Gram};
use crate::stop_check::{Pace, StopCheck};

/// Rows that are gathered before they are added to a batch.
const ROWS: usize = 8;

/// Uses of the rows of a simulation. It is no generic type, so that a simulation is compiled once for all of them.
pub(super) enum RowUse<'a> {
    HalfSquare(f64),
    Gram(GramOfRows<'a>),
    Rows(Vec<Vec<f64>>),
}

impl RowUse<'_> {
    /// All entries of the Gram matrix, row by row.
    #[cfg(test)]
    pub fn entries(self) -> Option<Vec<f64>> {
        let Self::Gram(GramOfRows { gram, waiting, .. }) = self else { return None };
        let n = waiting.len();
        Some((0..n * n).map(|k| gram.at(k / n, k % n)).collect())
    }

    /// Takes the columns of one row.
    #[inline(always)]
    pub fn take<S: Simd>(&mut self, simd: S, row: &[f64]) {
        match self {
            Self::HalfSquare(sum) => {
                let error = row[row.len() - 1];
                *sum += 0.5 * error * error;
            }
            Self::Gram(gram) => gram.take(simd, row),
            Self::Rows(rows) => rows.push(row.to_vec()),
        }
    }

    /// Ends the sums after the last row.
    #[inline(always)]
    pub fn end<S: Simd>(&mut self, simd: S) {
        if let Self::Gram(gram) = self {
            gram.flush(simd);
            gram.gram.add(simd, &mut gram.batch, &mut gram.pace);
        }
    }
}

/// Sums rows in a Gram matrix.
pub(super) struct GramOfRows<'a> {
    pub gram: Gram,
    batch: Batch,
    /// Some rows, by columns: a batch is filled in whole cache lines.
    waiting: Vec<[f64; ROWS]>,
    count: usize,
    pace: Pace<'a>,
}

impl<'a> GramOfRows<'a> {
    pub fn new(columns: usize, stop: StopCheck<'a>) -> Self {
        Self {
            gram: Gram::new(columns),
            batch: Batch::new(columns),
            waiting: vec![[0.0; ROWS]; columns],
            count: 0,
            pace: Pace::new(stop),
        }
    }

    #[inline(always)]
    fn flush<S: Simd>(&mut self, simd: S) {
        if self.batch.free() < self.count {
            self.gram.add(simd, &mut self.batch, &mut self.pace);
        }
        self.batch.append(self.waiting.iter(), self.count);
        self.count = 0;
    }

    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, row: &[f64]) {
        for (column, &value) in self.waiting.iter_mut().zip(row) {
            column[self.count] = value;
        }
        self.count += 1;
        if self.count == ROWS {
            self.flush(simd);
        }
    }
}

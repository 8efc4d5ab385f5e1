//! Sums the rows of a simulation in a Gram matrix, for least squares.

use pulp::Simd;

use crate::linear_algebra::{Batch, Gram};
use crate::stop_check::{Pace, StopCheck};

/// Rows that are gathered before they are added to a batch.
const ROWS: usize = 8;

/// Takes the columns of one row after the other.
pub(super) trait TakeRows {
    fn take<S: Simd>(&mut self, simd: S, row: &[f64]);

    /// After the last row.
    fn end<S: Simd>(&mut self, simd: S);
}

impl TakeRows for Vec<Vec<f64>> {
    #[inline(always)]
    fn take<S: Simd>(&mut self, _: S, row: &[f64]) {
        self.push(row.to_vec());
    }

    #[inline(always)]
    fn end<S: Simd>(&mut self, _: S) {}
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
}

impl TakeRows for GramOfRows<'_> {
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

    #[inline(always)]
    fn end<S: Simd>(&mut self, simd: S) {
        self.flush(simd);
        self.gram.add(simd, &mut self.batch, &mut self.pace);
    }
}

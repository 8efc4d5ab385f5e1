//! Dense linear algebra for training: the Gram matrix of many rows, and the Cholesky factor of a symmetric
//! matrix.

mod blocked_cholesky;
pub mod dilated_space;
mod few_columns;

use pulp::{Simd, WithSimd};

pub use few_columns::FewColumns;

use crate::simd::{self, LANES, multiply_add_lanes, sum_of_lanes};
use crate::stop_check::{Pace, StopCheck};

/// Fewest and most rows of a [`Batch`]; with few columns it has more rows.
const FEWEST_ROWS: usize = 256;
const MOST_ROWS: usize = 512;

/// Numbers of a batch that stay in the second-level cache, if it has more than the fewest rows.
const IN_CACHE: usize = 12 * 1024;

/// Columns of a [`Batch`] come in multiples of this, the edge of the kernel's tiles.
const TILE: usize = 4;

/// Some rows of a tall matrix, stored by columns.
#[derive(Debug, Clone)]
pub struct Batch {
    columns: usize,
    /// Rows that there is room for in all, a multiple of 64.
    capacity: usize,
    rows: usize,
    data: Vec<f64>,
}

impl Batch {
    /// An empty batch of `columns` columns.
    pub fn new(columns: usize) -> Self {
        let stride = columns.next_multiple_of(TILE);
        let capacity = (IN_CACHE / stride.max(1) / 64 * 64).clamp(FEWEST_ROWS, MOST_ROWS);
        Self { columns, capacity, rows: 0, data: vec![0.0; stride * capacity] }
    }

    /// Rows that there is room for.
    pub fn free(&self) -> usize {
        self.capacity - self.rows
    }

    /// Appends rows, given by columns; there must be room for them.
    #[inline(always)]
    pub fn append<'c, C: AsRef<[f64]> + 'c>(&mut self, columns: impl Iterator<Item = &'c C>, rows: usize) {
        for (column, values) in self.data.chunks_exact_mut(self.capacity).zip(columns) {
            column[self.rows..self.rows + rows].copy_from_slice(&values.as_ref()[..rows]);
        }
        self.rows += rows;
    }

    fn clear(&mut self) {
        self.rows = 0;
    }

    fn zero_rest(&mut self) {
        for column in self.data.chunks_exact_mut(self.capacity) {
            column[self.rows..].fill(0.0);
        }
    }
}

/// The lower triangle of the Gram matrix `AᵀA` of a tall matrix `A`, summed batch by batch.
#[derive(Debug, Clone)]
pub struct Gram {
    n: usize,
    stride: usize,
    data: Vec<f64>,
}

impl Gram {
    /// Of no rows, for `n` columns.
    pub fn new(n: usize) -> Self {
        let stride = n.next_multiple_of(TILE);
        Self { n, stride, data: vec![0.0; stride * stride] }
    }

    /// The element at `row` and `column`: the scalar product of these columns of `A`.
    #[inline]
    pub fn at(&self, row: usize, column: usize) -> f64 {
        let (row, column) = (row.max(column), row.min(column));
        debug_assert!(row < self.n);
        self.data[row * self.stride + column]
    }

    /// Adds the rows of a batch and empties it, with the widest instruction set of this machine.
    pub fn gather(&mut self, batch: &mut Batch, pace: &mut Pace<'_>) {
        simd::run(AddBatch { gram: self, batch, pace });
    }

    /// Adds `factor` times another Gram matrix of the same columns: 1 for more rows, -1 for fewer.
    pub fn add_multiple(&mut self, other: &Gram, factor: f64) {
        debug_assert_eq!(self.n, other.n);
        self.data.iter_mut().zip(&other.data).for_each(|(a, b)| *a += factor * b);
    }

    /// Adds the rows of a batch and empties it; incomplete once the pace is over.
    #[inline(always)]
    pub fn add<S: Simd>(&mut self, simd: S, batch: &mut Batch, pace: &mut Pace<'_>) {
        // One function of each instruction set for all kernels, and not a copy wherever they call it.
        simd.vectorize(AddBatch { gram: self, batch, pace });
    }

    /// Scalar products of four columns with `N` others; of the four with themselves those of the lower triangle.
    #[inline(always)]
    fn add_tile<S: Simd, const N: usize, const SAME: bool>(
        &mut self,
        simd: S,
        first: usize,
        left: [&[S::f64s]; TILE],
        second: usize,
        right: [&[S::f64s]; N],
    ) {
        self.add_sums(first, second, products_of_columns::<S, TILE, N, SAME>(simd, left, right));
    }

    #[inline(always)]
    fn add_sums<const N: usize>(&mut self, first: usize, second: usize, sums: [[f64; N]; TILE]) {
        for (i, sums) in sums.into_iter().enumerate() {
            for (j, sum) in sums.into_iter().enumerate() {
                self.data[(first + i) * self.stride + second + j] += sum;
            }
        }
    }
}

/// Scalar products of `M` columns with `N` others, in whole groups of [`LANES`] rows; if they are the `SAME`, those of the
/// lower triangle, and zeros.
///
/// Vectors that are shorter than a group take its parts in turns, so that the partial sums are the same.
#[inline(always)]
fn products_of_columns<S: Simd, const M: usize, const N: usize, const SAME: bool>(
    simd: S,
    left: [&[S::f64s]; M],
    right: [&[S::f64s]; N],
) -> [[f64; N]; M] {
    let parts = LANES / S::F64_LANES;
    let mut lanes = [[[0.0; LANES]; N]; M];
    for part in 0..parts {
        let zeros = [[simd.splat_f64s(0.0); N]; M];
        let sums = add_products::<S, M, N, SAME>(simd, part, left, right, zeros);
        for i in 0..M {
            for j in 0..N {
                S::as_mut_simd_f64s(&mut lanes[i][j]).0[part] = sums[i][j];
            }
        }
    }
    let mut total = [[0.0; N]; M];
    for i in 0..M {
        for j in 0..N {
            total[i][j] = sum_of_lanes(simd, &lanes[i][j]);
        }
    }
    total
}

/// Adds products of `M` columns with `N` others to one part of their partial sums, all in registers.
#[inline(always)]
fn add_products<S: Simd, const M: usize, const N: usize, const SAME: bool>(
    simd: S,
    part: usize,
    left: [&[S::f64s]; M],
    right: [&[S::f64s]; N],
    mut sums: [[S::f64s; N]; M],
) -> [[S::f64s; N]; M] {
    // No closures: one that is called twice need not be inlined, and is then not compiled for the instruction set.
    let length = left[0].len();
    let (mut a, mut b) = (left, right);
    for i in 0..M {
        a[i] = &left[i][..length];
    }
    for j in 0..N {
        b[j] = &right[j][..length];
    }
    for k in (part..length).step_by(LANES / S::F64_LANES) {
        for i in 0..M {
            for j in 0..N {
                if !SAME || j <= i {
                    sums[i][j] = multiply_add_lanes(simd, a[i][k], b[j][k], sums[i][j]);
                }
            }
        }
    }
    sums
}

struct AddBatch<'a, 's> {
    gram: &'a mut Gram,
    batch: &'a mut Batch,
    pace: &'a mut Pace<'s>,
}

impl WithSimd for AddBatch<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { gram, batch, pace } = self;
        debug_assert_eq!(batch.columns, gram.n);
        if batch.rows == 0 {
            return;
        }
        batch.zero_rest();
        let capacity = batch.capacity;
        let columns = |first: usize| -> [&[S::f64s]; TILE] {
            std::array::from_fn(|k| {
                S::as_simd_f64s(&batch.data[(first + k) * capacity..(first + k + 1) * capacity]).0
            })
        };
        for first in (0..gram.stride).step_by(TILE) {
            if pace.is_over(first * TILE * capacity / 4) {
                break;
            }
            let left = columns(first);
            for second in (0..first).step_by(TILE) {
                let right = columns(second);
                if S::REGISTER_COUNT >= 32 {
                    gram.add_tile::<S, TILE, false>(simd, first, left, second, right);
                } else {
                    let halves = [[right[0], right[1]], [right[2], right[3]]];
                    gram.add_tile::<S, 2, false>(simd, first, left, second, halves[0]);
                    gram.add_tile::<S, 2, false>(simd, first, left, second + 2, halves[1]);
                }
            }
            gram.add_tile::<S, TILE, true>(simd, first, left, first, left);
        }
        batch.clear();
    }
}

/// A symmetric matrix, stored by rows, of which only the lower triangle is used.
#[derive(Debug, Clone)]
pub struct Symmetric {
    n: usize,
    data: Vec<f64>,
}

impl Symmetric {
    /// An `n` by `n` matrix from a function of row and column, which is called for the lower triangle.
    pub fn from_fn(n: usize, mut value: impl FnMut(usize, usize) -> f64) -> Self {
        let mut data = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                data[i * n + j] = value(i, j);
            }
        }
        Self { n, data }
    }

    /// The element `i` of the diagonal.
    #[inline]
    pub fn diagonal(&self, i: usize) -> f64 {
        self.data[i * self.n + i]
    }

    /// The element at a row and a column.
    #[inline]
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.data[row.max(column) * self.n + row.min(column)]
    }

    /// Adds to the entry of `row` and `column`, which is also that of `column` and `row`.
    #[inline]
    pub fn add_at(&mut self, row: usize, column: usize, value: f64) {
        self.data[row.max(column) * self.n + row.min(column)] += value;
    }

    /// The matrix of some rows and columns, given in rising order.
    pub fn select(&self, chosen: &[usize]) -> Self {
        let mut data = vec![0.0; chosen.len() * chosen.len()];
        for (k, &i) in chosen.iter().enumerate() {
            let (row, from) = (&mut data[k * chosen.len()..], &self.data[i * self.n..]);
            for (to, &j) in row[..=k].iter_mut().zip(chosen) {
                *to = from[j];
            }
        }
        Self { n: chosen.len(), data }
    }

    /// The product with a vector.
    pub fn times(&self, v: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.n];
        for i in 0..self.n {
            let row = &self.data[i * self.n..i * self.n + i];
            product[i] += dot(row, &v[..i]) + self.diagonal(i) * v[i];
            for (product, a) in product.iter_mut().zip(row) {
                *product += a * v[i];
            }
        }
        product
    }

    /// Adds to the element `i` of the diagonal.
    #[inline]
    pub fn add_to_diagonal(&mut self, i: usize, value: f64) {
        self.data[i * self.n + i] += value;
    }

    /// Subtracts `W Wᵀ`, where `W` has one row of `columns` numbers for each row of `self`; incomplete once
    /// stopped.
    pub fn subtract_product(&mut self, w: &[f64], columns: usize, stop: StopCheck<'_>) {
        let mut pace = Pace::new(stop);
        for i in 0..self.n {
            if pace.is_over(i * columns) {
                return;
            }
            for j in 0..=i {
                let (a, b) = (&w[i * columns..(i + 1) * columns], &w[j * columns..(j + 1) * columns]);
                self.data[i * self.n + j] -= dot(a, b);
            }
        }
    }

    /// Cholesky factor `L` with `self = L Lᵀ`; `None` if not positive definite to rounding, or once stopped.
    pub fn cholesky(mut self, stop: StopCheck<'_>) -> Option<Cholesky> {
        let n = self.n;
        if n >= blocked_cholesky::WORTH_BLOCKS {
            let data = blocked_cholesky::factorise(self.data, n, stop)?;
            return Some(Cholesky { n, data });
        }
        for i in 0..n {
            let (done, rest) = self.data.split_at_mut(i * n);
            let row = &mut rest[..=i];
            for j in 0..i {
                let other = &done[j * n..=j * n + j];
                row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
            }
            let pivot = row[i] - dot(&row[..i], &row[..i]);
            if pivot.is_nan() || pivot <= row[i].abs() * 1e-15 {
                return None;
            }
            row[i] = pivot.sqrt();
        }
        Some(Cholesky { n, data: self.data })
    }
}

/// A Cholesky factor: a lower triangular matrix `L`.
#[derive(Debug, Clone)]
pub struct Cholesky {
    n: usize,
    data: Vec<f64>,
}

impl Cholesky {
    /// Of no rows.
    pub fn empty() -> Self {
        Self { n: 0, data: Vec::new() }
    }

    /// The rows of `L`, each with zeros behind the diagonal.
    pub fn into_rows(mut self) -> Vec<f64> {
        for i in 0..self.n {
            self.data[i * self.n..][i + 1..self.n].fill(0.0);
        }
        self.data
    }

    /// Replaces `b` by `L⁻¹ b`.
    pub fn solve_lower(&self, b: &mut [f64]) {
        for i in 0..self.n {
            let row = &self.data[i * self.n..i * self.n + i];
            b[i] = (b[i] - dot(row, &b[..i])) / self.data[i * self.n + i];
        }
    }

    /// Replaces `b` by `(L Lᵀ)⁻¹ b`.
    pub fn solve(&self, b: &mut [f64]) {
        self.solve_lower(b);
        for i in (0..self.n).rev() {
            b[i] /= self.data[i * self.n + i];
            let (before, rest) = b.split_at_mut(i);
            for (b, l) in before.iter_mut().zip(&self.data[i * self.n..]) {
                *b -= l * rest[0];
            }
        }
    }
}

/// Scalar product, in eight partial sums so that it becomes SIMD code.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, a_rest) = a.as_chunks::<8>();
    let (b, b_rest) = b.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for l in 0..8 {
            sums[l] += a[l] * b[l];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::{cos, sin};
    use crate::simd;

    fn value(row: usize, column: usize) -> f64 {
        sin((row * 31 + column * 17) as f64 * 0.7) + if row % 7 == column % 7 { 1.0 } else { 0.0 }
    }

    /// The Gram matrix of so many columns and rows.
    struct Fill(usize, usize);

    impl pulp::WithSimd for Fill {
        type Output = Gram;
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Gram {
            let Self(n, rows) = self;
            let (mut batch, mut pace) = (Batch::new(n), Pace::new(StopCheck::never()));
            let mut gram = Gram::new(n);
            for row in 0..rows {
                if batch.free() == 0 {
                    gram.add(simd, &mut batch, &mut pace);
                }
                let columns: Vec<[f64; 1]> = (0..n).map(|column| [value(row, column)]).collect();
                batch.append(columns.iter(), 1);
            }
            gram.add(simd, &mut batch, &mut pace);
            gram
        }
    }

    #[test]
    fn gram_is_the_matrix_of_scalar_products() {
        for (n, rows) in [(1, 1), (5, 700), (13, 256), (8, 257)] {
            let grams = simd::run_with_all(|| Fill(n, rows));
            for i in 0..n {
                for j in 0..n {
                    let exact: f64 = (0..rows).map(|row| value(row, i) * value(row, j)).sum();
                    approx::assert_relative_eq!(grams[0].at(i, j), exact, epsilon = 1e-10);
                    assert!(grams.iter().all(|gram| gram.at(i, j) == grams[0].at(i, j)), "{i} {j} of {n}");
                }
            }
        }
    }

    #[test]
    fn cholesky_solves_and_refuses() {
        for n in [1, 37, blocked_cholesky::WORTH_BLOCKS, 331] {
            cholesky_solves(n);
        }
        for n in [2, blocked_cholesky::WORTH_BLOCKS + 3] {
            let indefinite = Symmetric::from_fn(n, |i, j| if i == j { 1.0 } else { 2.0 });
            assert!(indefinite.cholesky(StopCheck::never()).is_none());
            let mut poisoned = Symmetric::from_fn(n, |i, j| f64::from(i == j));
            poisoned.add_at(n - 1, 0, f64::NAN);
            assert!(poisoned.cholesky(StopCheck::never()).is_none());
        }
    }

    fn cholesky_solves(n: usize) {
        let product = |i: usize, j: usize| (0..n + 23).map(|row| value(row, i) * value(row, j)).sum::<f64>();
        let entry = |i: usize, j: usize| product(i, j) + if i == j { 3.0 } else { 0.0 };
        let matrix = Symmetric::from_fn(n, entry);
        let exact: Vec<f64> = (0..n).map(|i| cos(i as f64)).collect();
        let mut b = matrix.times(&exact);
        for i in [0, n / 2, n - 1] {
            let product: f64 = (0..n).map(|j| entry(i, j) * exact[j]).sum();
            approx::assert_relative_eq!(b[i], product, max_relative = 1e-11, epsilon = 1e-9);
        }
        matrix.clone().cholesky(StopCheck::never()).unwrap().solve(&mut b);
        for (found, exact) in b.iter().zip(&exact) {
            approx::assert_relative_eq!(found, exact, epsilon = 1e-7);
        }
    }

    #[test]
    fn rows_can_be_taken_out_of_a_gram_matrix() {
        let n = 6;
        let (mut all, some) = (simd::run(Fill(n, 40)), simd::run(Fill(n, 15)));
        all.add_multiple(&some, -1.0);
        let exact: f64 = (15..40).map(|row| value(row, 4) * value(row, 2)).sum();
        approx::assert_relative_eq!(all.at(2, 4), exact, epsilon = 1e-10);
        let matrix = Symmetric::from_fn(n, |i, j| (10 * i + j) as f64);
        let part = matrix.select(&[1, 4, 5]);
        assert_eq!((part.at(0, 2), part.at(2, 1), part.n), (51.0, 54.0, 3));
    }
}

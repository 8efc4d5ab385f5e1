//! Cholesky factor of a matrix of hundreds to thousands of rows.
//!
//! ```text
//! L_ij = (A_ij - Σ_{k<j} L_ik L_jk) / L_jj,      L_ii² = A_ii - Σ_{k<i} L_ik²
//! ```
//!
//! The sums of four rows with four others are formed together, so that every number loaded serves four
//! products, and for a group of rows at a time, which stays in the second-level cache.

use pulp::{Simd, WithSimd};

use super::{dot, products_of_columns};
use crate::simd::{self, LANES};
use crate::stop_check::{Pace, StopCheck};

/// Rows from which on blocks pay.
pub(super) const WORTH_BLOCKS: usize = 256;

/// Rows of a group, a multiple of [`TILE`].
const GROUP: usize = 64;

/// Edge of a tile of sums, all of which fit into registers.
const TILE: usize = 4;

/// The factor in place of the lower triangle of `data`; `None` unless positive definite, and once stopped.
pub(super) fn factorise(mut data: Vec<f64>, n: usize, stop: StopCheck<'_>) -> Option<Vec<f64>> {
    simd::run(Factorise { data: &mut data, n, pace: Pace::new(stop) }).then_some(data)
}

struct Factorise<'a, 's> {
    data: &'a mut [f64],
    n: usize,
    pace: Pace<'s>,
}

impl WithSimd for Factorise<'_, '_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> bool {
        let n = self.n;
        for first in (0..n).step_by(GROUP) {
            let (done, rest) = self.data.split_at_mut(first * n);
            let rows = GROUP.min(n - first);
            let group = &mut rest[..rows * n];
            for column in (0..first).step_by(TILE) {
                if self.pace.is_over(column * TILE * GROUP / 2) {
                    return false;
                }
                let others: [&[f64]; TILE] =
                    std::array::from_fn(|k| &done[(column + k) * n..(column + k) * n + column + TILE]);
                let mut tiles = group.chunks_exact_mut(TILE * n);
                for tile in &mut tiles {
                    divide_tile(simd, tile, n, column, others);
                }
                for row in tiles.into_remainder().chunks_exact_mut(n) {
                    divide_row(row, column, others);
                }
            }
            if !factorise_group(group, n, first) {
                return false;
            }
        }
        true
    }
}

/// Columns `column` to `column + 3` of four rows, from the finished rows of the same numbers.
#[inline(always)]
fn divide_tile<S: Simd>(simd: S, tile: &mut [f64], n: usize, column: usize, others: [&[f64]; TILE]) {
    let mut sums = [[0.0; TILE]; TILE];
    {
        let whole = column / LANES * LANES;
        let left: [&[f64]; TILE] = std::array::from_fn(|k| &tile[k * n..k * n + column]);
        let lanes = products_of_columns::<S, _, _, false>(
            simd,
            left.map(|row| S::as_simd_f64s(&row[..whole]).0),
            others.map(|row| S::as_simd_f64s(&row[..whole]).0),
        );
        for i in 0..TILE {
            for j in 0..TILE {
                let ends = left[i][whole..].iter().zip(&others[j][whole..column]).map(|(a, b)| a * b);
                sums[i][j] = lanes[i][j] + ends.sum::<f64>();
            }
        }
    }
    for (row, sums) in tile.chunks_exact_mut(n).zip(sums) {
        for j in 0..TILE {
            let within: f64 = (0..j).map(|k| row[column + k] * others[j][column + k]).sum();
            row[column + j] = (row[column + j] - sums[j] - within) / others[j][column + j];
        }
    }
}

/// The same for a single row.
fn divide_row(row: &mut [f64], column: usize, others: [&[f64]; TILE]) {
    for (j, other) in others.into_iter().enumerate() {
        let end = column + j;
        row[end] = (row[end] - dot(&row[..end], &other[..end])) / other[end];
    }
}

/// The columns of a group's own rows; false where a pivot is not positive.
fn factorise_group(group: &mut [f64], n: usize, first: usize) -> bool {
    for i in 0..group.len() / n {
        let (done, rest) = group.split_at_mut(i * n);
        let row = &mut rest[..n];
        for (j, other) in done.chunks_exact(n).enumerate() {
            let end = first + j;
            row[end] = (row[end] - dot(&row[..end], &other[..end])) / other[end];
        }
        let end = first + i;
        let pivot = row[end] - dot(&row[..end], &row[..end]);
        if pivot.is_nan() || pivot <= row[end].abs() * 1e-15 {
            return false;
        }
        row[end] = pivot.sqrt();
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::sin;

    struct Factor(usize);

    impl WithSimd for Factor {
        type Output = Vec<f64>;
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
            let n = self.0;
            let entry = |i: usize, j: usize| {
                sin((i * 31 + j * 17) as f64 * 0.7) + if i == j { 2.0 * n as f64 } else { 0.0 }
            };
            let mut data: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
            let factorise = Factorise { data: &mut data, n, pace: Pace::new(StopCheck::never()) };
            assert!(factorise.with_simd(simd));
            data
        }
    }

    #[test]
    fn instruction_sets_agree_to_the_last_bit() {
        for n in [200, 331] {
            let factors = simd::run_with_all(|| Factor(n));
            assert!(factors.iter().all(|factor| *factor == factors[0]), "{n}");
        }
    }
}

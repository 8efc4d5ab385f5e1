//! The Gram matrix of few columns, which are not collected before they are multiplied.

use pulp::Simd;

use super::{Gram, MOST_ROWS, TILE, add_products};
use crate::simd::{LANES, sum_of_lanes};

/// Rows of a block.
const BLOCK: usize = 64;

/// Most columns: their partial sums and a block of rows stay in the first-level cache.
const MOST: usize = 24;

/// Partial sums of the products of two groups of columns.
type Sums = [[[f64; LANES]; TILE]; TILE];

/// Sums the Gram matrix of few columns block by block, to the last bit as batches give it: partial sums are added up after
/// as many rows as a [`Batch`](super::Batch) of so few columns has room for.
#[derive(Debug, Clone)]
pub struct FewColumns {
    gram: Gram,
    /// Of the groups of columns up to each group.
    sums: Vec<Sums>,
    /// Rows in the partial sums.
    rows: usize,
}

impl FewColumns {
    /// Of no rows; `None` for too many columns.
    pub fn new(columns: usize) -> Option<Self> {
        let groups = columns.div_ceil(TILE);
        let sums = vec![[[[0.0; LANES]; TILE]; TILE]; groups * (groups + 1) / 2];
        (columns <= MOST).then(|| Self { gram: Gram::new(columns), sums, rows: 0 })
    }

    /// Adds the first `rows` rows of a block, given by columns.
    #[inline(always)]
    pub fn add<'c, S: Simd, C: AsRef<[f64; BLOCK]> + 'c>(
        &mut self,
        simd: S,
        columns: impl Iterator<Item = &'c C>,
        rows: usize,
    ) {
        if self.rows + rows > MOST_ROWS {
            self.add_up(simd);
        }
        self.rows += rows;
        let none = [0.0; BLOCK];
        let mut block = [&none; MOST];
        for (to, column) in block.iter_mut().zip(columns) {
            *to = column.as_ref();
        }
        if rows == BLOCK {
            self.add_block(simd, &block);
            return;
        }
        let mut padded = [none; MOST];
        for (to, from) in padded.iter_mut().zip(block) {
            to[..rows].copy_from_slice(&from[..rows]);
        }
        self.add_block(simd, &padded.each_ref());
    }

    #[inline(always)]
    fn add_block<S: Simd>(&mut self, simd: S, block: &[&[f64; BLOCK]; MOST]) {
        let groups = block.as_chunks::<TILE>().0;
        let mut sums = self.sums.iter_mut();
        for (first, left) in groups.iter().enumerate() {
            for (right, sums) in groups[..first].iter().zip(&mut sums) {
                add_to_lanes::<S, false>(simd, left, right, sums);
            }
            let Some(sums) = sums.next() else { return };
            add_to_lanes::<S, true>(simd, left, left, sums);
        }
    }

    /// Adds the partial sums to the matrix.
    #[inline(always)]
    fn add_up<S: Simd>(&mut self, simd: S) {
        self.rows = 0;
        let mut sums = self.sums.iter_mut();
        for first in (0..self.gram.stride).step_by(TILE) {
            for (second, lanes) in (0..=first).step_by(TILE).zip(&mut sums) {
                let mut total = [[0.0; TILE]; TILE];
                for i in 0..TILE {
                    for j in 0..TILE {
                        total[i][j] = sum_of_lanes(simd, &lanes[i][j]);
                        lanes[i][j] = [0.0; LANES];
                    }
                }
                self.gram.add_sums(first, second, total);
            }
        }
    }

    /// The matrix of all rows.
    #[inline(always)]
    pub fn gram<S: Simd>(mut self, simd: S) -> Gram {
        self.add_up(simd);
        self.gram
    }
}

/// Adds the products of two groups of columns to their partial sums.
#[inline(always)]
fn add_to_lanes<S: Simd, const SAME: bool>(
    simd: S,
    left: &[&[f64; BLOCK]; TILE],
    right: &[&[f64; BLOCK]; TILE],
    lanes: &mut Sums,
) {
    let (left, right) = (vectors::<S>(left), vectors::<S>(right));
    for part in 0..LANES / S::F64_LANES {
        if S::REGISTER_COUNT >= 32 || SAME {
            add_part::<S, 0, TILE, SAME>(simd, part, left, right, lanes);
        } else {
            add_part::<S, 0, 2, SAME>(simd, part, left, [right[0], right[1]], lanes);
            add_part::<S, 2, 2, SAME>(simd, part, left, [right[2], right[3]], lanes);
        }
    }
}

#[inline(always)]
fn vectors<'c, S: Simd>(columns: &[&'c [f64; BLOCK]; TILE]) -> [&'c [S::f64s]; TILE] {
    let mut vectors: [&[S::f64s]; TILE] = [&[]; TILE];
    for k in 0..TILE {
        vectors[k] = S::as_simd_f64s(columns[k]).0;
    }
    vectors
}

/// Adds the products with `N` columns, from the column `FIRST` of a group on, to one part of their partial sums.
#[inline(always)]
fn add_part<S: Simd, const FIRST: usize, const N: usize, const SAME: bool>(
    simd: S,
    part: usize,
    left: [&[S::f64s]; TILE],
    right: [&[S::f64s]; N],
    lanes: &mut Sums,
) {
    let mut sums = [[simd.splat_f64s(0.0); N]; TILE];
    for i in 0..TILE {
        for j in 0..N {
            sums[i][j] = S::as_simd_f64s(&lanes[i][FIRST + j]).0[part];
        }
    }
    let sums = add_products::<S, TILE, N, SAME>(simd, part, left, right, sums);
    for i in 0..TILE {
        for j in 0..N {
            S::as_mut_simd_f64s(&mut lanes[i][FIRST + j]).0[part] = sums[i][j];
        }
    }
}

#[cfg(test)]
mod tests {
    use pulp::WithSimd;

    use super::super::Batch;
    use super::*;
    use crate::random::uniform;
    use crate::simd;
    use crate::stop_check::{Pace, StopCheck};

    /// The Gram matrices of so many columns and rows, by blocks and by batches.
    struct BothWays(usize, usize);

    impl WithSimd for BothWays {
        type Output = [Gram; 2];

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> [Gram; 2] {
            let Self(n, rows) = self;
            let mut few = FewColumns::new(n).unwrap();
            let (mut gram, mut batch) = (Gram::new(n), Batch::new(n));
            let mut pace = Pace::new(StopCheck::never());
            for first in (0..rows).step_by(BLOCK) {
                let number = |column: usize, row: usize| uniform((column * 10_000 + first + row) as u64);
                let column = |column: usize| BlockRow(std::array::from_fn(|row| number(column, row)));
                let block: Vec<BlockRow> = (0..n).map(column).collect();
                let rows = BLOCK.min(rows - first);
                few.add(simd, block.iter(), rows);
                if batch.free() < rows {
                    gram.add(simd, &mut batch, &mut pace);
                }
                batch.append(block.iter().map(|row| &row.0), rows);
            }
            gram.add(simd, &mut batch, &mut pace);
            [few.gram(simd), gram]
        }
    }

    struct BlockRow([f64; BLOCK]);

    impl AsRef<[f64; BLOCK]> for BlockRow {
        fn as_ref(&self) -> &[f64; BLOCK] {
            &self.0
        }
    }

    #[test]
    fn blocks_and_batches_give_the_same_bits() {
        for (n, rows) in [(1, 3), (5, 64), (12, 2000), (MOST, 1100)] {
            let all = simd::run_with_all(|| BothWays(n, rows));
            let numbers =
                all.iter().flatten().map(|gram| (0..n * n).map(|k| gram.at(k / n, k % n).to_bits()));
            let numbers: Vec<Vec<u64>> = numbers.map(Iterator::collect).collect();
            assert!(numbers.iter().all(|bits| *bits == numbers[0]), "{n} columns, {rows} rows");
        }
        assert!(FewColumns::new(MOST + 1).is_none());
    }
}

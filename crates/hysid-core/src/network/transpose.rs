//! Transposition of eight by eight numbers, between time-major and neuron-major order.

use std::array::from_fn;

use pulp::Simd;

/// Writes the first columns of `rows` to `columns`, as many as there are, by shuffles between registers
/// where the machine has them.
///
/// Left to itself, the compiler writes the generic form with gathers and scatters under AVX-512, and a
/// simulation takes half as long again.
#[inline(always)]
pub(crate) fn transpose<'a, S: Simd, const L: usize>(
    simd: S,
    rows: &[[f64; L]; 8],
    columns: impl ExactSizeIterator<Item = &'a mut [f64; 8]>,
) {
    #[cfg(target_arch = "x86_64")]
    {
        let simd = &simd as &dyn std::any::Any;
        let v4 = simd.downcast_ref::<pulp::x86::V4>();
        if let Some(simd) = v4.filter(|_| L == 8) {
            // Two columns need about half of the shuffles.
            if columns.len() <= 2 {
                store(by_shuffles(*simd, rows), columns.take(2));
            } else {
                store(by_shuffles(*simd, rows), columns);
            }
            return;
        }
        if let Some(simd) = simd.downcast_ref::<pulp::x86::V3>().or(v4.map(|simd| &**simd)) {
            store_tiles(*simd, rows, columns);
            return;
        }
    }
    let _ = simd;
    for (index, column) in columns.enumerate() {
        *column = from_fn(|row| rows[row][index]);
    }
}

/// Stored as vectors, which the compiler does not take apart again.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn store<'a>(turned: [std::arch::x86_64::__m512d; 8], columns: impl Iterator<Item = &'a mut [f64; 8]>) {
    for (column, turned) in columns.zip(turned) {
        pulp::x86::V4::as_mut_simd_f64s(column).0[0] = pulp::cast(turned);
    }
}

/// Edge of the tiles that vectors of 256 bits turn.
#[cfg(target_arch = "x86_64")]
const EDGE: usize = 4;

/// Turns tiles of four by four numbers, of the columns that there are.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn store_tiles<'a, const L: usize>(
    simd: pulp::x86::V3,
    rows: &[[f64; L]; 8],
    mut columns: impl ExactSizeIterator<Item = &'a mut [f64; 8]>,
) {
    let mut first = 0;
    while columns.len() > 0 {
        let upper = tile_by_shuffles(simd, rows, 0, first);
        let lower = tile_by_shuffles(simd, rows, EDGE, first);
        for k in 0..EDGE {
            let Some(column) = columns.next() else { return };
            let column = pulp::x86::V3::as_mut_simd_f64s(column).0;
            column[0] = pulp::cast(upper[k]);
            column[1] = pulp::cast(lower[k]);
        }
        first += EDGE;
    }
}

/// The columns of the tile of four by four numbers that begins at a row and a column.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn tile_by_shuffles<const L: usize>(
    simd: pulp::x86::V3,
    rows: &[[f64; L]; 8],
    row: usize,
    column: usize,
) -> [std::arch::x86_64::__m256d; EDGE] {
    const LOWER: i32 = 0x20;
    const UPPER: i32 = 0x31;
    let avx = simd.avx;
    let mut r = [avx._mm256_setzero_pd(); EDGE];
    for k in 0..EDGE {
        r[k] = pulp::cast(pulp::x86::V3::as_simd_f64s(&rows[row + k][column..column + EDGE]).0[0]);
    }
    let even = [avx._mm256_unpacklo_pd(r[0], r[1]), avx._mm256_unpacklo_pd(r[2], r[3])];
    let odd = [avx._mm256_unpackhi_pd(r[0], r[1]), avx._mm256_unpackhi_pd(r[2], r[3])];
    [
        avx._mm256_permute2f128_pd::<LOWER>(even[0], even[1]),
        avx._mm256_permute2f128_pd::<LOWER>(odd[0], odd[1]),
        avx._mm256_permute2f128_pd::<UPPER>(even[0], even[1]),
        avx._mm256_permute2f128_pd::<UPPER>(odd[0], odd[1]),
    ]
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn by_shuffles<const L: usize>(simd: pulp::x86::V4, rows: &[[f64; L]; 8]) -> [std::arch::x86_64::__m512d; 8] {
    use std::arch::x86_64::__m512d;
    const EVEN: i32 = 0b10_00_10_00;
    const ODD: i32 = 0b11_01_11_01;
    let avx = simd.avx512f;
    let r: [__m512d; 8] = from_fn(|k| pulp::cast(pulp::x86::V4::as_simd_f64s(&rows[k]).0[0]));
    // Pairs of rows: four columns of two rows in each, even columns apart from odd ones.
    let mut turned = [r[0]; 8];
    for parity in 0..2 {
        let pair: [__m512d; 4] = from_fn(|k| {
            let (upper, lower) = (r[2 * k], r[2 * k + 1]);
            if parity == 0 {
                avx._mm512_unpacklo_pd(upper, lower)
            } else {
                avx._mm512_unpackhi_pd(upper, lower)
            }
        });
        let top_even = avx._mm512_shuffle_f64x2::<EVEN>(pair[0], pair[1]);
        let top_odd = avx._mm512_shuffle_f64x2::<ODD>(pair[0], pair[1]);
        let bottom_even = avx._mm512_shuffle_f64x2::<EVEN>(pair[2], pair[3]);
        let bottom_odd = avx._mm512_shuffle_f64x2::<ODD>(pair[2], pair[3]);
        turned[parity] = avx._mm512_shuffle_f64x2::<EVEN>(top_even, bottom_even);
        turned[parity + 2] = avx._mm512_shuffle_f64x2::<EVEN>(top_odd, bottom_odd);
        turned[parity + 4] = avx._mm512_shuffle_f64x2::<ODD>(top_even, bottom_even);
        turned[parity + 6] = avx._mm512_shuffle_f64x2::<ODD>(top_odd, bottom_odd);
    }
    turned
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd;

    struct Transpose([[f64; 8]; 8], usize);

    impl pulp::WithSimd for Transpose {
        type Output = [[f64; 8]; 8];
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let mut columns = [[f64::NAN; 8]; 8];
            transpose(simd, &self.0, columns.iter_mut().take(self.1));
            columns
        }
    }

    #[test]
    fn rows_become_columns() {
        let rows: [[f64; 8]; 8] = from_fn(|i| from_fn(|j| (10 * i + j) as f64));
        for wanted in [8, 3] {
            for turned in [
                simd::run(Transpose(rows, wanted)),
                pulp::WithSimd::with_simd(Transpose(rows, wanted), pulp::Scalar::new()),
            ] {
                for (j, column) in turned.iter().enumerate() {
                    for (i, value) in column.iter().enumerate() {
                        let written = j < wanted;
                        assert!(if written { *value == rows[i][j] } else { value.is_nan() });
                    }
                }
            }
        }
    }
}

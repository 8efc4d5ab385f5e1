//! The Everett function of weights on cells, in constant time.
//!
//! ```text
//! E(a, b) = Σ_ij w_ij (share of cell ij in the triangle b ≤ β ≤ α ≤ a)               theory.md (7.10)
//! ```
//!
//! With `a` a share `s` into interval `i` and `b` a share `t` into interval `j < i`,
//!
//! ```text
//! E = E_{i,j+1} + s C_ij + (1-t) R_ij + s² w_ii + (1-t)² w_jj + s (1-t) w_ij
//! ```
//!
//! where `E_ik` is that of the triangle between lines `k` and `i`, `C_ij` the sum of the weights of row
//! `i` between columns `j` and `i`, and `R_ij` that of column `j` between rows `j` and `i`. The virgin
//! curve is a parabola between neighbouring points among the lines and their mirror images.

use super::plane::Plane;

/// Place of an input among the lines: interval, and share of it below the input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LinePlace {
    interval: usize,
    share: f64,
}

impl LinePlace {
    /// Interval, and share of it below.
    pub fn parts(self) -> (usize, f64) {
        (self.interval, self.share)
    }
}

/// Tables of the Everett function.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct EverettTables {
    lines: Vec<f64>,
    /// One row for each interval of α, one column for each of β.
    cells: Vec<EverettCell>,
    virgin: [VirginCurve; 2],
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct EverettCell {
    weight: f64,
    /// `E_{i,j+1}`
    inner: f64,
    /// `C_ij`
    along_row: f64,
    /// `R_ij`
    along_column: f64,
}

/// Output along the virgin curve on one side of 0, by the magnitude of the input.
#[derive(Debug, Clone, PartialEq)]
struct VirginCurve {
    knots: Vec<f64>,
    /// Coefficients of each piece in the distance from its first knot; the last is constant.
    pieces: Vec<[f64; 3]>,
}

impl EverettTables {
    /// Tables for weights of the cells, in their order.
    pub fn new(plane: &Plane, weights: &[f64]) -> Self {
        let n = plane.intervals();
        let mut cells = vec![EverettCell::default(); n * n];
        for ((i, j), &weight) in plane.indices().zip(weights) {
            cells[i * n + j].weight = weight;
        }
        for i in 0..n {
            for j in (0..i).rev() {
                cells[i * n + j].along_row = if j + 1 < i {
                    cells[i * n + j + 1].along_row + cells[i * n + j + 1].weight
                } else {
                    0.0
                };
                cells[i * n + j].along_column = if j + 1 < i {
                    cells[(i - 1) * n + j].along_column + cells[(i - 1) * n + j].weight
                } else {
                    0.0
                };
            }
        }
        // The triangle between lines k and i grows by row i-1: its cells from column k on.
        for k in 1..n {
            let mut sum = 0.0;
            for i in k..n {
                if i > k {
                    sum += (k..i).map(|j| cells[(i - 1) * n + j].weight).sum::<f64>();
                }
                cells[i * n + k - 1].inner = sum;
            }
        }
        let virgin = [1.0, -1.0].map(|side| VirginCurve::new(plane, weights, side));
        Self { lines: plane.lines().to_vec(), cells, virgin }
    }

    /// Weight, `E_{i,j+1}`, `C_ij` and `R_ij` of each cell.
    pub fn cells(&self) -> Vec<[f64; 4]> {
        self.cells.iter().map(|cell| [cell.weight, cell.inner, cell.along_row, cell.along_column]).collect()
    }

    /// Knots and pieces of the virgin curve up and down.
    pub fn virgin_curves(&self) -> [(Vec<f64>, Vec<[f64; 3]>); 2] {
        self.virgin.each_ref().map(|curve| (curve.knots.clone(), curve.pieces.clone()))
    }

    /// Place of an input; one beyond the plane is at its edge.
    #[inline]
    pub fn place(&self, x: f64) -> LinePlace {
        let n = self.lines.len() - 1;
        let interval = self.lines[1..n].partition_point(|&line| line <= x);
        let (low, high) = (self.lines[interval], self.lines[interval + 1]);
        LinePlace { interval, share: ((x - low) / (high - low)).clamp(0.0, 1.0) }
    }

    /// `E(a, b)`, 0 unless `a > b`.
    #[inline]
    pub fn value(&self, a: LinePlace, b: LinePlace) -> f64 {
        let n = self.lines.len() - 1;
        let (i, j) = (a.interval, b.interval);
        let at = |i: usize, j: usize| &self.cells[i * n + j];
        let (s, rest) = (a.share, 1.0 - b.share);
        if i > j {
            let cell = at(i, j);
            cell.inner
                + s * cell.along_row
                + rest * cell.along_column
                + s * s * at(i, i).weight
                + rest * rest * at(j, j).weight
                + s * rest * cell.weight
        } else if i == j {
            let edge = (s - b.share).max(0.0);
            edge * edge * at(i, i).weight
        } else {
            0.0
        }
    }

    /// Output along the virgin curve up or down to `h`.
    #[inline]
    pub fn virgin(&self, h: f64) -> f64 {
        let curve = &self.virgin[usize::from(h < 0.0)];
        let piece = curve.knots.partition_point(|&knot| knot <= h.abs()).max(1) - 1;
        let [a, b, c] = curve.pieces[piece];
        let distance = if piece + 1 < curve.knots.len() { h.abs() - curve.knots[piece] } else { 0.0 };
        a + distance * (b + distance * c)
    }
}

impl VirginCurve {
    fn new(plane: &Plane, weights: &[f64], side: f64) -> Self {
        let mut knots: Vec<f64> = plane.lines().iter().map(|line| line.abs()).collect();
        knots.push(0.0);
        knots.sort_by(f64::total_cmp);
        // A line and a mirror image that differ by rounding are one knot.
        let tolerance = 1e-12 * knots[knots.len() - 1];
        knots.dedup_by(|next, kept| *next - *kept <= tolerance);
        let value = |h: f64| -> f64 {
            if h == 0.0 {
                return 0.0;
            }
            let h = h * side;
            plane.indices().zip(weights).map(|((i, j), w)| w * plane.virgin_share(i, j, h)).sum()
        };
        let mut pieces: Vec<[f64; 3]> = knots
            .windows(2)
            .map(|ends| {
                let length = ends[1] - ends[0];
                let (start, end) = (value(ends[0]), value(ends[1]));
                let middle = value(ends[0] + 0.5 * length);
                let bend = 2.0 * (start + end - 2.0 * middle);
                [start, (end - start - bend) / length, bend / (length * length)]
            })
            .collect();
        pieces.push([value(knots[knots.len() - 1]), 0.0, 0.0]);
        Self { knots, pieces }
    }
}

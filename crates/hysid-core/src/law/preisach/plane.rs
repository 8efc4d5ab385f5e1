//! The Preisach plane divided into cells: how much of each cell a swing of the input switches.
//!
//! ```text
//! a swing between b and a ≥ b switches the relays with b ≤ β ≤ α ≤ a                theory.md (7.9)
//! virgin, up to h:     those with α ≤ h and α + β > 0                               theory.md (7.11)
//! virgin, down to h:   those with β ≥ h and α + β < 0
//! ```
//!
//! `α` is the input at which a relay switches up, `β ≤ α` the one at which it switches down. Lines divide
//! both axes at the same inputs, so cell `(i, j)`, `i > j`, is a rectangle, and cell `(i, i)` a triangle at
//! the edge of the plane. The relays are spread evenly over a cell. All shares are exact.

/// A Preisach plane divided into cells by lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// Rising; one more than there are intervals.
    lines: Vec<f64>,
}

impl Plane {
    /// A plane divided at these inputs, which rise.
    pub fn new(lines: Vec<f64>) -> Self {
        Self { lines }
    }

    /// The inputs at which it is divided.
    pub fn lines(&self) -> &[f64] {
        &self.lines
    }

    /// Number of intervals `N` of each axis.
    pub fn intervals(&self) -> usize {
        self.lines.len() - 1
    }

    /// Number of cells, `N (N + 1)/2`.
    pub fn cells(&self) -> usize {
        self.intervals() * (self.intervals() + 1) / 2
    }

    /// All `(i, j)` in the order in which cells are numbered.
    pub fn indices(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        (0..self.intervals()).flat_map(|i| (0..=i).map(move |j| (i, j)))
    }

    /// Share of each interval below `x`, 0 to 1.
    pub fn below(&self, x: f64, shares: &mut [f64]) {
        for (share, ends) in shares.iter_mut().zip(self.lines.windows(2)) {
            *share = ((x - ends[0]) / (ends[1] - ends[0])).clamp(0.0, 1.0);
        }
    }

    /// Adds `factor` times the share of each cell that a swing between two inputs switches.
    /// `below_a`, `below_b` are the shares of the intervals below them, `a` the larger.
    pub fn add_swing(&self, below_a: &[f64], below_b: &[f64], factor: f64, cells: &mut [f64]) {
        let mut first = 0;
        for (i, &a) in below_a.iter().enumerate() {
            let row = &mut cells[first..=first + i];
            first += i + 1;
            if a == 0.0 {
                // So are all that follow.
                break;
            }
            let along = factor * a;
            for (cell, b) in row[..i].iter_mut().zip(below_b) {
                *cell += along * (1.0 - b);
            }
            let edge = (a - below_b[i]).max(0.0);
            row[i] += factor * edge * edge;
        }
    }

    /// Share of a cell that the virgin curve from 0 to `h` switches; `h` may be negative or infinite.
    pub fn virgin_share(&self, i: usize, j: usize, h: f64) -> f64 {
        let (alpha, beta) = ((self.lines[i], self.lines[i + 1]), (self.lines[j], self.lines[j + 1]));
        // The virgin curve downwards is the one upwards of the plane mirrored at α + β = 0.
        let ((low, high), (bottom, top)) =
            if h >= 0.0 { (alpha, beta) } else { ((-beta.1, -beta.0), (-alpha.1, -alpha.0)) };
        let end = h.abs().min(high);
        if end <= low {
            return 0.0;
        }
        let on_edge = i == j;
        // Height of the switched part above α: from max(bottom, -α) up to the top or the edge.
        let height = |alpha: f64| {
            let top = if on_edge { alpha } else { top };
            (top - bottom.max(-alpha)).max(0.0)
        };
        // Linear between its kinks, so that trapezia are exact.
        let mut ends = [low, -top, -bottom, 0.0, end].map(|kink| kink.clamp(low, end));
        ends.sort_by(f64::total_cmp);
        let area: f64 = ends
            .windows(2)
            .map(|piece| 0.5 * (piece[1] - piece[0]) * (height(piece[0]) + height(piece[1])))
            .sum();
        let whole = (high - low) * (top - bottom) * if on_edge { 0.5 } else { 1.0 };
        (area / whole).min(1.0)
    }

    /// Mean output of the relays of a cell in the virgin state: those above `α + β = 0` are down.
    pub fn virgin_mean(&self, i: usize, j: usize) -> f64 {
        1.0 - 2.0 * self.virgin_share(i, j, f64::INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shares by counting points of a cell.
    fn counted(plane: &Plane, (i, j): (usize, usize), switched: impl Fn(f64, f64) -> bool) -> f64 {
        const FINE: usize = 400;
        let at = |k: usize, t: usize| {
            let (low, high) = (plane.lines[k], plane.lines[k + 1]);
            low + (high - low) * (t as f64 + 0.5) / FINE as f64
        };
        let (mut inside, mut counted) = (0.0, 0.0);
        for s in 0..FINE {
            for t in 0..FINE {
                let (alpha, beta) = (at(i, s), at(j, t));
                // A point on the edge of the plane counts half.
                let weight = if alpha > beta {
                    1.0
                } else if alpha == beta {
                    0.5
                } else {
                    0.0
                };
                inside += weight;
                counted += if switched(alpha, beta) { weight } else { 0.0 };
            }
        }
        counted / inside
    }

    #[test]
    fn shares_are_areas() {
        let plane = Plane::new(vec![-2.0, -1.3, -0.4, 0.3, 0.9, 2.5]);
        for (a, b) in [(0.5, -0.9), (2.0, -1.7), (0.2, 0.1), (9.0, -9.0), (0.0, -0.2)] {
            let (mut below_a, mut below_b) = (vec![0.0; 5], vec![0.0; 5]);
            plane.below(a, &mut below_a);
            plane.below(b, &mut below_b);
            let mut cells = vec![0.0; plane.cells()];
            plane.add_swing(&below_a, &below_b, 1.0, &mut cells);
            for (cell, share) in plane.indices().zip(cells) {
                let exact = counted(&plane, cell, |alpha, beta| alpha <= a && beta >= b);
                assert!((share - exact).abs() < 6e-3, "{cell:?} from {b} to {a}: {share}, {exact}");
            }
        }
        for h in [0.2, 0.7, 1.5, 3.0] {
            for cell in plane.indices() {
                let up = counted(&plane, cell, |alpha, beta| alpha <= h && alpha + beta > 0.0);
                let down = counted(&plane, cell, |alpha, beta| beta >= -h && alpha + beta < 0.0);
                for (h, exact) in [(h, up), (-h, down)] {
                    let share = plane.virgin_share(cell.0, cell.1, h);
                    assert!((share - exact).abs() < 6e-3, "{cell:?} at {h}: {share}, {exact}");
                }
            }
        }
    }
}

//! Eigenvalues and eigenvectors of a small symmetric matrix, by the method of Jacobi: rotations that make one entry
//! after another 0 (Golub and Van Loan, Matrix Computations, section 8.5).

use crate::linear_algebra::Symmetric;

const SWEEPS: usize = 60;

#[derive(Debug, Clone)]
pub(super) struct Eigenvectors {
    pub values: Vec<f64>,
    pub vectors: Vec<Vec<f64>>,
}

impl Eigenvectors {
    /// Of an `n` by `n` matrix.
    pub fn of(matrix: &Symmetric, n: usize) -> Self {
        let mut a: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| matrix.at(i, j)).collect()).collect();
        let mut vectors: Vec<Vec<f64>> =
            (0..n).map(|i| (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect()).collect();
        for _ in 0..SWEEPS {
            let (mut beside, mut on) = (0.0, 0.0);
            for i in 0..n {
                on += a[i][i] * a[i][i];
                beside += a[i][..i].iter().map(|v| v * v).sum::<f64>();
            }
            if beside <= 1e-30 * on {
                break;
            }
            for p in 0..n {
                for q in p + 1..n {
                    rotate(&mut a, &mut vectors, p, q);
                }
            }
        }
        Self { values: (0..n).map(|i| a[i][i]).collect(), vectors }
    }
}

/// Makes the entry at `p` and `q` 0. `vectors` has the eigenvectors as rows.
fn rotate(a: &mut [Vec<f64>], vectors: &mut [Vec<f64>], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for row in a.iter_mut() {
        (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
    }
    for rows in [a, vectors] {
        let (before, behind) = rows.split_at_mut(q);
        for (of_p, of_q) in before[p].iter_mut().zip(&mut behind[0]) {
            (*of_p, *of_q) = (c * *of_p - s * *of_q, s * *of_p + c * *of_q);
        }
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::cos;

    use super::*;

    /// The matrix with 2 on the diagonal and -1 beside it has the eigenvalues `2 - 2 cos(kπ/(n+1))`.
    #[test]
    fn eigenvalues_of_a_chain_are_known() {
        let n = 9;
        let matrix = Symmetric::from_fn(n, |i, j| match i - j {
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        });
        let Eigenvectors { mut values, vectors } = Eigenvectors::of(&matrix, n);
        for (value, vector) in values.iter().zip(&vectors) {
            for (product, v) in matrix.times(vector).iter().zip(vector) {
                assert!((product - value * v).abs() < 1e-12);
            }
        }
        values.sort_by(f64::total_cmp);
        for (k, value) in values.iter().enumerate() {
            let exact = 2.0 - 2.0 * cos((k + 1) as f64 * std::f64::consts::PI / (n + 1) as f64);
            assert!((value - exact).abs() < 1e-12);
        }
    }

    #[test]
    fn a_matrix_of_deficient_rank_has_eigenvalues_of_nought() {
        let rows = [[1.0, 2.0, 2.0], [1.0, -1.0, -1.0], [1.0, 0.3, 0.3]];
        let matrix = Symmetric::from_fn(3, |i, j| rows.iter().map(|row| row[i] * row[j]).sum());
        let found = Eigenvectors::of(&matrix, 3);
        let least = (0..3).min_by(|&a, &b| found.values[a].total_cmp(&found.values[b])).unwrap();
        assert!(found.values[least].abs() < 1e-14);
        let vector = &found.vectors[least];
        assert!(vector[0].abs() < 1e-12 && (vector[1] + vector[2]).abs() < 1e-12);
    }
}

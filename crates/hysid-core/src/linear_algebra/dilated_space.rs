//! The matrix of a dilated space, of minimisation by sub-gradients (theory.md (3.7)).

use pulp::{Simd, WithSimd};
use serde::{Deserialize, Serialize};

use crate::linear_algebra::dot;
use crate::simd::{self, LANES};

/// Rows that are worked on together.
const ROWS: usize = 4;

/// Variables from which on the dilatations are kept in place of their matrix: a matrix of 1000 variables has 8 MB.
const MANY_VARIABLES: usize = 1000;

/// The square matrix `B` of a dilated space, which takes directions there to directions in the space of the
/// variables.
///
/// Of many variables it is kept as the product of its dilatations, `B = D R_1 R_2 ... R_k`, as long as these are fewer
/// than the variables: that takes less memory and time than the matrix.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DilatedSpace {
    n: usize,
    form: Form,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Form {
    Matrix(Matrix),
    Product(Product),
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Matrix {
    /// By rows.
    entries: Vec<f64>,
    largest: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Product {
    scales: Vec<f64>,
    /// Unit vectors of the dilatations, one after another, and the factor `γ` of each.
    along: Vec<f64>,
    gammas: Vec<f64>,
}

impl DilatedSpace {
    /// The diagonal matrix of typical lengths of the variables.
    pub fn of_scales(scales: &[f64]) -> Self {
        let n = scales.len();
        let form = match n < MANY_VARIABLES {
            true => Form::Matrix(Matrix::of_scales(scales)),
            false => {
                Form::Product(Product { scales: scales.to_vec(), along: Vec::new(), gammas: Vec::new() })
            }
        };
        Self { n, form }
    }

    /// Numbers that a space holds, for its numbers of variables and dilatations.
    pub fn numbers(variables: usize, dilatations: usize) -> usize {
        let rows = if variables < MANY_VARIABLES { variables } else { variables.min(dilatations) };
        variables.saturating_mul(rows)
    }

    /// True if it is a finite matrix for this number of variables.
    pub fn is_sound(&self, variables: usize) -> bool {
        let are_finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let is_sound = match &self.form {
            Form::Matrix(Matrix { entries, largest }) => {
                entries.len() == variables * variables
                    && are_finite(entries)
                    && *largest == largest_of(entries)
            }
            Form::Product(Product { scales, along, gammas }) => {
                scales.len() == variables
                    && along.len() == variables * gammas.len()
                    && [scales, along, gammas].into_iter().all(|values| are_finite(values))
            }
        };
        self.n == variables && is_sound
    }

    /// Magnitude of the largest entry; of a product a bound of it.
    pub fn largest_entry(&self) -> f64 {
        match &self.form {
            Form::Matrix(matrix) => matrix.largest,
            Form::Product(product) => largest_of(&product.scales),
        }
    }

    /// `B u`.
    pub fn times(&self, u: &[f64]) -> Vec<f64> {
        match &self.form {
            Form::Matrix(Matrix { entries, .. }) => {
                entries.chunks_exact(self.n).map(|row| dot(row, u)).collect()
            }
            Form::Product(product) => product.times(u),
        }
    }

    /// `Bᵀ g`.
    pub fn transpose_times(&self, g: &[f64]) -> Vec<f64> {
        match &self.form {
            Form::Matrix(matrix) => {
                let mut product = vec![0.0; self.n];
                simd::run(TransposeTimes { matrix, g, product: &mut product });
                product
            }
            Form::Product(product) => product.transpose_times(g),
        }
    }

    /// `B <- B (I + (γ - 1) along alongᵀ)` for a unit vector `along`; returns `B u` of the new matrix.
    pub fn dilate(&mut self, along: &[f64], gamma: f64, u: &[f64]) -> Vec<f64> {
        if let Form::Product(product) = &mut self.form {
            if product.gammas.len() < self.n {
                product.along.extend(along);
                product.gammas.push(gamma);
                return product.times(u);
            }
            self.form = Form::Matrix(product.matrix());
        }
        let Form::Matrix(matrix) = &mut self.form else { unreachable!("a product has become a matrix") };
        matrix.dilate(along, gamma, u)
    }

    /// Divides all entries by the largest, and returns that.
    pub fn normalise(&mut self) -> f64 {
        let largest = self.largest_entry();
        match &mut self.form {
            Form::Matrix(matrix) => {
                matrix.entries.iter_mut().for_each(|entry| *entry /= largest);
                matrix.largest = 1.0;
            }
            Form::Product(product) => product.scales.iter_mut().for_each(|scale| *scale /= largest),
        }
        largest
    }
}

impl Matrix {
    fn of_scales(scales: &[f64]) -> Self {
        let n = scales.len();
        let mut entries = vec![0.0; n * n];
        for (i, scale) in scales.iter().enumerate() {
            entries[i * n + i] = *scale;
        }
        Self { largest: largest_of(&entries), entries }
    }

    fn dilate(&mut self, along: &[f64], gamma: f64, u: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; along.len()];
        self.largest =
            simd::run(Dilate { entries: &mut self.entries, along, gamma, u, product: &mut product });
        product
    }
}

impl Product {
    /// Each dilatation with its unit vector, in their order.
    fn dilatations(&self) -> impl DoubleEndedIterator<Item = (&f64, &[f64])> {
        self.gammas.iter().zip(self.along.chunks_exact(self.scales.len()))
    }

    fn times(&self, u: &[f64]) -> Vec<f64> {
        let mut product = u.to_vec();
        for (gamma, along) in self.dilatations().rev() {
            dilate_vector(&mut product, along, *gamma);
        }
        product.iter_mut().zip(&self.scales).for_each(|(product, scale)| *product *= scale);
        product
    }

    fn transpose_times(&self, g: &[f64]) -> Vec<f64> {
        let mut product: Vec<f64> = g.iter().zip(&self.scales).map(|(g, scale)| g * scale).collect();
        for (gamma, along) in self.dilatations() {
            dilate_vector(&mut product, along, *gamma);
        }
        product
    }

    fn matrix(&self) -> Matrix {
        let mut matrix = Matrix::of_scales(&self.scales);
        for (gamma, along) in self.dilatations() {
            matrix.dilate(along, *gamma, along);
        }
        matrix
    }
}

/// Dilates a vector along the unit vector `along`: `v <- (I + (γ - 1) along alongᵀ) v`.
pub fn dilate_vector(v: &mut [f64], along: &[f64], gamma: f64) {
    let share = (gamma - 1.0) * dot(along, v);
    v.iter_mut().zip(along).for_each(|(v, along)| *v += share * along);
}

fn largest_of(entries: &[f64]) -> f64 {
    entries.iter().fold(0.0, |largest, entry| entry.abs().max(largest))
}

struct TransposeTimes<'a> {
    matrix: &'a Matrix,
    g: &'a [f64],
    product: &'a mut [f64],
}

impl WithSimd for TransposeTimes<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { matrix: Matrix { entries, .. }, g, product } = self;
        let n = product.len();
        let (blocks, rest) = g.as_chunks::<ROWS>();
        let (rows, rest_of_rows) = entries.split_at(blocks.len() * ROWS * n);
        for (g, rows) in blocks.iter().zip(rows.chunks_exact(ROWS * n)) {
            let [a, b, c, d] = rows_of(rows, n);
            for (j, product) in product.iter_mut().enumerate() {
                *product += (g[0] * a[j] + g[1] * b[j]) + (g[2] * c[j] + g[3] * d[j]);
            }
        }
        for (g, row) in rest.iter().zip(rest_of_rows.chunks_exact(n)) {
            for (product, entry) in product.iter_mut().zip(row) {
                *product += g * entry;
            }
        }
    }
}

/// Rows of equal length.
#[inline(always)]
fn rows_of(rows: &[f64], n: usize) -> [&[f64]; ROWS] {
    let (a, rest) = rows.split_at(n);
    let (b, rest) = rest.split_at(n);
    let (c, d) = rest.split_at(n);
    [a, b, c, d]
}

struct Dilate<'a> {
    entries: &'a mut [f64],
    along: &'a [f64],
    gamma: f64,
    u: &'a [f64],
    product: &'a mut [f64],
}

impl WithSimd for Dilate<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let Self { entries, along, gamma, u, product } = self;
        // B'u = Bu + (γ - 1) (B along) (alongᵀu)
        let share = dot(along, u);
        let mut largest = [0.0; LANES];
        for (row, product) in entries.chunks_exact_mut(along.len()).zip(product) {
            let [stretched, of_u] = products(row, along, u);
            let factor = (gamma - 1.0) * stretched;
            *product = of_u + factor * share;
            add_multiple(row, along, factor, &mut largest);
        }
        largest.into_iter().fold(0.0, f64::max)
    }
}

/// Scalar products of `a` with `b` and with `c`.
#[inline(always)]
fn products(a: &[f64], b: &[f64], c: &[f64]) -> [f64; 2] {
    let ((a, a_rest), (b, b_rest), (c, c_rest)) =
        (a.as_chunks::<LANES>(), b.as_chunks::<LANES>(), c.as_chunks::<LANES>());
    let (mut with_b, mut with_c) = ([0.0; LANES], [0.0; LANES]);
    for ((a, b), c) in a.iter().zip(b).zip(c) {
        for l in 0..LANES {
            with_b[l] += a[l] * b[l];
        }
        for l in 0..LANES {
            with_c[l] += a[l] * c[l];
        }
    }
    let rest = |other: &[f64]| a_rest.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
    [with_b.iter().sum::<f64>() + rest(b_rest), with_c.iter().sum::<f64>() + rest(c_rest)]
}

/// `row += factor other`; keeps the largest magnitudes.
#[inline(always)]
fn add_multiple(row: &mut [f64], other: &[f64], factor: f64, largest: &mut [f64; LANES]) {
    let (row, row_rest) = row.as_chunks_mut::<LANES>();
    let (other, other_rest) = other.as_chunks::<LANES>();
    for (row, other) in row.iter_mut().zip(other) {
        for l in 0..LANES {
            row[l] += factor * other[l];
        }
        for l in 0..LANES {
            largest[l] = if row[l].abs() > largest[l] { row[l].abs() } else { largest[l] };
        }
    }
    for (l, (row, other)) in row_rest.iter_mut().zip(other_rest).enumerate() {
        *row += factor * other;
        largest[l] = row.abs().max(largest[l]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::sin;

    fn some(n: usize, seed: usize) -> Vec<f64> {
        (0..n).map(|i| sin((i * 37 + seed * 101 + 1) as f64 * 0.61)).collect()
    }

    /// The product of the dilatations does what the matrix does, and becomes it when they are as many as variables.
    #[test]
    fn dilatations_and_their_matrix_are_the_same_space() {
        let n = 7;
        let scales: Vec<f64> = (0..n).map(|i| 1.0 + 0.3 * i as f64).collect();
        let mut matrix = DilatedSpace::of_scales(&scales);
        let mut product = DilatedSpace {
            n,
            form: Form::Product(Product { scales, along: Vec::new(), gammas: Vec::new() }),
        };
        for round in 0..12 {
            let mut along = some(n, round);
            let length = dot(&along, &along).sqrt();
            along.iter_mut().for_each(|a| *a /= length);
            let u = some(n, round + 10);
            let (a, b) = (matrix.dilate(&along, 0.4, &u), product.dilate(&along, 0.4, &u));
            let back = (matrix.transpose_times(&u), product.transpose_times(&u));
            let of_both = a.iter().chain(&back.0).zip(b.iter().chain(&back.1));
            of_both.for_each(|(a, b)| assert!((a - b).abs() < 1e-13, "{a} {b} in round {round}"));
            assert!(product.is_sound(n) && !product.is_sound(n + 1));
            assert!(product.largest_entry() >= matrix.largest_entry() - 1e-13);
            assert_eq!(matches!(product.form, Form::Product(_)), round < n);
        }
    }

    /// Against the definition, entry by entry, for sizes with and without a rest.
    #[test]
    fn dilatations_follow_their_definition() {
        for n in [1, 2, 5, 8, 13, 27, 64] {
            let scales: Vec<f64> = (0..n).map(|i| 1.0 + 0.3 * i as f64).collect();
            let mut space = DilatedSpace::of_scales(&scales);
            let mut matrix: Vec<Vec<f64>> =
                (0..n).map(|i| (0..n).map(|j| if i == j { scales[i] } else { 0.0 }).collect()).collect();
            for round in 0..5 {
                let mut along = some(n, round);
                let length = along.iter().map(|a| a * a).sum::<f64>().sqrt();
                along.iter_mut().for_each(|a| *a /= length);
                let u = some(n, round + 10);
                let product = space.dilate(&along, 0.4, &u);
                for row in &mut matrix {
                    let stretched: f64 = row.iter().zip(&along).map(|(b, a)| b * a).sum();
                    row.iter_mut().zip(&along).for_each(|(b, a)| *b += (0.4 - 1.0) * stretched * a);
                }
                let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * n as f64, "{a} {b} of {n}");
                for (i, row) in matrix.iter().enumerate() {
                    near(product[i], row.iter().zip(&u).map(|(b, u)| b * u).sum());
                }
                space.times(&u).iter().zip(&product).for_each(|(a, b)| near(*a, *b));
                let back = space.transpose_times(&u);
                for (j, back) in back.iter().enumerate() {
                    near(*back, matrix.iter().zip(&u).map(|(row, u)| row[j] * u).sum());
                }
                assert!(space.is_sound(n));
                near(space.largest_entry(), matrix.iter().flatten().fold(0.0, |most, b| b.abs().max(most)));
            }
            assert!(!space.is_sound(n + 1));
            let largest = space.largest_entry();
            assert_eq!(space.normalise(), largest);
            assert!(space.is_sound(n) && space.largest_entry() == 1.0);
        }
    }
}

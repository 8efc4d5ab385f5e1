//! The readout: tanh layer and linear output.
//!
//! ```text
//! h_i = tanh(b_i + U_i0 z_0 + Σ_j U_ij z_j)                  theory.md (2.5)
//! y   = c_0 + Σ_i c_i h_i + Σ_j d_j z_j                      theory.md (2.6)
//! ```
//!
//! The symbols are those of the [module of networks](crate::network). Rows do not depend on each other here,
//! so the lanes of a vector are rows.

use pulp::Simd;

use crate::network::memory::{BLOCK, Row, whole_lanes};
use crate::network::sweep::Block;
use crate::network::tanh::tanh;
use crate::network::{Architecture, Layout};
use crate::simd::multiply_add;

/// Vectors that a kernel keeps in registers for each neuron.
const VECTORS: usize = 4;

/// The tanh layer's parameters.
#[derive(Debug, Clone)]
pub(crate) struct Readout {
    hidden: usize,
    memory: usize,
    constant: bool,
    direct: bool,
    /// A run for each tanh neuron: bias, then the weights of the memory neurons.
    pub weights: Vec<f64>,
}

impl Readout {
    /// Takes its part of the parameters, which must fit the architecture.
    pub fn new(architecture: &Architecture, parameters: &[f64]) -> Self {
        Self {
            hidden: architecture.hidden,
            memory: architecture.memory_neurons(),
            constant: architecture.constant,
            direct: architecture.has_direct_path(),
            weights: parameters[Layout::new(*architecture).hidden].to_vec(),
        }
    }

    /// Bias and weights of a tanh neuron.
    #[inline(always)]
    pub fn neuron(&self, i: usize) -> (f64, &[f64]) {
        let run = &self.weights[i * (1 + self.memory)..(i + 1) * (1 + self.memory)];
        (run[0], &run[1..])
    }

    /// Splits output weights into the constant, those of the tanh neurons, those of the direct path.
    pub fn split<'c>(&self, output: &'c [f64]) -> (f64, &'c [f64], &'c [f64]) {
        let (constant, rest) = output.split_at(usize::from(self.constant));
        let (hidden, direct) = rest.split_at(self.hidden);
        (constant.first().copied().unwrap_or(0.0), hidden, direct)
    }

    /// Outputs of the tanh neurons for the first `rows` rows of a block (rounded up to whole
    /// vectors).
    #[inline(always)]
    pub fn tanh_layer<S: Simd>(&self, simd: S, z: &[Row], rows: usize, h: &mut [Row]) {
        let z = &z[..self.memory];
        let vectors = rows.div_ceil(S::F64_LANES);
        let mut i = 0;
        while i + 2 <= self.hidden {
            let (first, second) = h[i..i + 2].split_at_mut(1);
            weighted_sums(
                simd,
                z,
                [self.neuron(i), self.neuron(i + 1)],
                vectors,
                [&mut first[0], &mut second[0]],
            );
            i += 2;
        }
        if i < self.hidden {
            weighted_sums(simd, z, [self.neuron(i)], vectors, [&mut h[i]]);
        }
        let reached = vectors * S::F64_LANES;
        for h in &mut h[..self.hidden] {
            for value in &mut h[..reached] {
                *value = tanh::<S>(*value);
            }
        }
    }

    /// The output of the first `rows` rows of a block, in the scaled unit.
    #[inline(always)]
    pub fn output<S: Simd>(&self, output: &[f64], z: &[Row], h: &[Row], rows: usize, y: &mut Row) {
        let (constant, hidden, direct) = self.split(output);
        let y = &mut y[..whole_lanes(rows)];
        y.fill(constant);
        for (&c, h) in hidden.iter().zip(h) {
            accumulate::<S>(c, &h.0, y);
        }
        for (&d, z) in direct.iter().zip(z) {
            accumulate::<S>(d, &z.0, y);
        }
    }

    /// The features, which the output weights multiply: constant 1, tanh neurons, direct path.
    #[inline(always)]
    pub fn features(&self, z: &[Row], h: &[Row], features: &mut [Row]) {
        let (constant, rest) = features.split_at_mut(usize::from(self.constant));
        constant.fill(Row([1.0; BLOCK]));
        rest[..self.hidden].copy_from_slice(&h[..self.hidden]);
        if self.direct {
            rest[self.hidden..self.hidden + self.memory].copy_from_slice(&z[..self.memory]);
        }
    }
}

/// Backward pass of the readout: the derivatives of the output by all it depends on, times a weight for each
/// row.
#[derive(Debug, Clone)]
pub(crate) struct Backward {
    /// By the weighted sum of each tanh neuron: the weight times `c_i (1 - h_i²)`.
    pub by_sum: Vec<Row>,
    /// By the output of each memory neuron: the weight times `q_j = Σ_i c_i (1 - h_i²) U_ij + d_j` (theory.md
    /// (2.11)).
    pub by_memory: Vec<Row>,
}

impl Backward {
    pub fn new(architecture: &Architecture) -> Self {
        Self {
            by_sum: vec![Row([0.0; BLOCK]); architecture.hidden],
            by_memory: vec![Row([0.0; BLOCK]); architecture.memory_neurons()],
        }
    }

    #[inline(always)]
    pub fn run<S: Simd>(&mut self, readout: &Readout, output: &[f64], weight: &Row, block: &Block) {
        let (_, hidden, direct) = readout.split(output);
        for (j, q) in self.by_memory.iter_mut().enumerate() {
            let d = direct.get(j).copied().unwrap_or(0.0);
            for (q, weight) in q.iter_mut().zip(weight) {
                *q = d * weight;
            }
        }
        for (i, ((&c, h), slope)) in hidden.iter().zip(&block.h).zip(&mut self.by_sum).enumerate() {
            for ((slope, &h), &weight) in slope.iter_mut().zip(h).zip(weight) {
                *slope = c * multiply_add::<S>(-h, h, 1.0) * weight;
            }
            let (_, weights) = readout.neuron(i);
            for (q, &weight) in self.by_memory.iter_mut().zip(weights) {
                accumulate::<S>(weight, &slope.0, &mut q.0);
            }
        }
    }
}

/// `y += factor * x`, row by row.
#[inline(always)]
fn accumulate<S: Simd>(factor: f64, x: &[f64], y: &mut [f64]) {
    for (y, &x) in y.iter_mut().zip(x) {
        *y = multiply_add::<S>(factor, x, *y);
    }
}

/// Bias plus weighted memory outputs, for `K` tanh neurons at a time, so that each value of `z` is
/// loaded once for all of them.
#[inline(always)]
fn weighted_sums<S: Simd, const K: usize>(
    simd: S,
    z: &[Row],
    neurons: [(f64, &[f64]); K],
    vectors: usize,
    sums: [&mut Row; K],
) {
    let mut sums = sums.map(|sum| S::as_mut_simd_f64s(&mut sum.0).0);
    let mut first = 0;
    while first + VECTORS <= vectors {
        weighted_sum_of_vectors::<S, K, VECTORS>(simd, z, &neurons, first, &mut sums);
        first += VECTORS;
    }
    while first < vectors {
        weighted_sum_of_vectors::<S, K, 1>(simd, z, &neurons, first, &mut sums);
        first += 1;
    }
}

#[inline(always)]
fn weighted_sum_of_vectors<S: Simd, const K: usize, const V: usize>(
    simd: S,
    z: &[Row],
    neurons: &[(f64, &[f64]); K],
    first: usize,
    sums: &mut [&mut [S::f64s]; K],
) {
    let mut total: [[S::f64s; V]; K] = std::array::from_fn(|k| [simd.splat_f64s(neurons[k].0); V]);
    for (j, z) in z.iter().enumerate() {
        let z = &S::as_simd_f64s(&z.0).0[first..first + V];
        for k in 0..K {
            let weight = simd.splat_f64s(neurons[k].1[j]);
            for v in 0..V {
                total[k][v] = simd.mul_add_e_f64s(weight, z[v], total[k][v]);
            }
        }
    }
    for k in 0..K {
        sums[k][first..first + V].copy_from_slice(&total[k]);
    }
}

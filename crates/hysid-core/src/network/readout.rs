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

use crate::network::block::Block;
use crate::network::memory::{BLOCK, BlockValues, LANES, Lanes};
use crate::network::tanh::{tanh, tanh_of_row};
use crate::network::{Architecture, ParameterLayout};
use crate::simd::{multiply_add, multiply_add_lanes};

/// Vectors that a kernel keeps in registers for each neuron.
const VECTORS: usize = 4;

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
            weights: parameters[ParameterLayout::new(*architecture).hidden].to_vec(),
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

    /// Outputs of the tanh neurons for the first `rows` rows of a block, rounded up to whole vectors.
    #[inline(always)]
    pub fn tanh_layer<S: Simd>(&self, simd: S, z: &[BlockValues], rows: usize, h: &mut [BlockValues]) {
        let z = &z[..self.memory];
        let vectors = rows.div_ceil(S::F64_LANES);
        let reached = vectors * S::F64_LANES;
        let mut i = 0;
        let (mut rest, mut power) = (BlockValues([0.0; BLOCK]), BlockValues([0.0; BLOCK]));
        let (pairs, last) = h[..self.hidden].as_chunks_mut::<2>();
        for [first, second] in pairs {
            // (2.5), two neurons at a time
            weighted_sums(simd, z, [self.neuron(i), self.neuron(i + 1)], vectors, [first, second]);
            for neuron in [first, second] {
                tanh_of_row::<S>(&mut neuron[..reached], &mut rest[..reached], &mut power[..reached]);
            }
            i += 2;
        }
        if let [last] = last {
            weighted_sums(simd, z, [self.neuron(i)], vectors, [&mut *last]); // (2.5)
            tanh_of_row::<S>(&mut last[..reached], &mut rest[..reached], &mut power[..reached]);
        }
    }

    /// The output of the first `rows` rows of a block, in the scaled unit.
    #[inline(always)]
    pub fn output<S: Simd>(
        &self,
        simd: S,
        output: &[f64],
        z: &[BlockValues],
        h: &[BlockValues],
        rows: usize,
        y: &mut BlockValues,
    ) {
        let (constant, hidden, direct) = self.split(output);
        let y = S::as_mut_simd_f64s(&mut y.0).0;
        let vectors = rows.div_ceil(S::F64_LANES);
        let mut first = 0;
        while first + VECTORS <= vectors {
            outputs::<S, VECTORS>(simd, constant, (hidden, h), (direct, z), first, y);
            first += VECTORS;
        }
        while first < vectors {
            outputs::<S, 1>(simd, constant, (hidden, h), (direct, z), first, y);
            first += 1;
        }
    }

    /// The features, which the output weights multiply: constant 1, tanh neurons, direct path.
    #[inline(always)]
    pub fn features<'r>(
        &self,
        constant: &'r BlockValues,
        z: &'r [BlockValues],
        h: &'r [BlockValues],
    ) -> impl Iterator<Item = &'r BlockValues> {
        let direct = if self.direct { &z[..self.memory] } else { &[] };
        self.constant.then_some(constant).into_iter().chain(&h[..self.hidden]).chain(direct)
    }
}

/// Backward pass of the readout: derivatives of the output by its parts, times a weight for each row.
#[derive(Debug, Clone)]
pub(crate) struct Backward {
    /// By the weighted sum of each tanh neuron: the weight times `c_i (1 - h_i²)`.
    pub by_sum: Vec<BlockValues>,
    /// By the output of each memory neuron: the weight times `q_j = Σ_i c_i (1 - h_i²) U_ij + d_j` (theory.md
    /// (2.11)).
    pub by_memory: Vec<BlockValues>,
}

impl Backward {
    pub fn new(architecture: &Architecture) -> Self {
        Self {
            by_sum: vec![BlockValues([0.0; BLOCK]); architecture.hidden],
            by_memory: vec![BlockValues([0.0; BLOCK]); architecture.memory_neurons()],
        }
    }

    #[inline(always)]
    pub fn run<S: Simd>(&mut self, readout: &Readout, output: &[f64], weight: &BlockValues, block: &Block) {
        let (_, hidden, direct) = readout.split(output);
        for (j, q) in self.by_memory.iter_mut().enumerate() {
            let d = direct.get(j).copied().unwrap_or(0.0);
            for (q, weight) in q.iter_mut().zip(weight) {
                *q = d * weight; // (2.11): d_j
            }
        }
        for (i, ((&c, h), slope)) in hidden.iter().zip(&block.h).zip(&mut self.by_sum).enumerate() {
            for ((slope, &h), &weight) in slope.iter_mut().zip(h).zip(weight) {
                *slope = c * multiply_add::<S>(-h, h, 1.0) * weight; // (2.11): c_i (1 - h_i²)
            }
            let (_, weights) = readout.neuron(i);
            for (q, &weight) in self.by_memory.iter_mut().zip(weights) {
                accumulate::<S>(weight, &slope.0, &mut q.0); // (2.11): times U_ij
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
    z: &[BlockValues],
    neurons: [(f64, &[f64]); K],
    vectors: usize,
    sums: [&mut BlockValues; K],
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
    z: &[BlockValues],
    neurons: &[(f64, &[f64]); K],
    first: usize,
    sums: &mut [&mut [S::f64s]; K],
) {
    let biases: [[S::f64s; V]; K] = std::array::from_fn(|k| [simd.splat_f64s(neurons[k].0); V]);
    let total = add_weighted(simd, z, neurons.map(|(_, weights)| weights), first, biases);
    for k in 0..K {
        sums[k][first..first + V].copy_from_slice(&total[k]);
    }
}

/// Outputs of `V` vectors of rows from the vector `first` on: the sum over the tanh neurons, and apart from it that over
/// the memory neurons, which need not wait for it.
#[inline(always)]
fn outputs<S: Simd, const V: usize>(
    simd: S,
    constant: f64,
    (hidden, h): (&[f64], &[BlockValues]),
    (direct, z): (&[f64], &[BlockValues]),
    first: usize,
    y: &mut [S::f64s],
) {
    let [of_hidden] = add_weighted(simd, h, [hidden], first, [[simd.splat_f64s(constant); V]]);
    let [of_memory] = add_weighted(simd, z, [direct], first, [[simd.splat_f64s(0.0); V]]);
    for v in 0..V {
        y[first + v] = simd.add_f64s(of_hidden[v], of_memory[v]); // (2.6)
    }
}

/// Adds rows times weights to `K` totals of `V` vectors of rows, from the vector `first` on.
#[inline(always)]
fn add_weighted<S: Simd, const K: usize, const V: usize>(
    simd: S,
    rows: &[BlockValues],
    weights: [&[f64]; K],
    first: usize,
    mut total: [[S::f64s; V]; K],
) -> [[S::f64s; V]; K] {
    let count = weights.iter().map(|weights| weights.len()).fold(rows.len(), usize::min);
    for (j, row) in rows[..count].iter().enumerate() {
        let row = &S::as_simd_f64s(&row.0).0[first..first + V];
        for k in 0..K {
            let weight = simd.splat_f64s(weights[k][j]);
            for v in 0..V {
                total[k][v] = multiply_add_lanes(simd, weight, row[v], total[k][v]);
            }
        }
    }
    total
}

/// The readout of one row at a time, whose lanes are tanh neurons. Its outputs are those of [`Readout`] to the last bit.
#[derive(Debug, Clone)]
pub(crate) struct SampleReadout {
    memory: usize,
    /// For each group of tanh neurons: their biases, then their weights of each memory neuron.
    weights: Vec<Lanes>,
    constant: f64,
    of_hidden: Vec<f64>,
    direct: Vec<f64>,
    /// Outputs of the tanh neurons, in whole groups.
    h: Vec<Lanes>,
}

impl SampleReadout {
    /// Arranges the weights of a readout.
    pub fn new(readout: &Readout, output: &[f64]) -> Self {
        let (constant, of_hidden, direct) = readout.split(output);
        let of_group = |first: usize| {
            let lane = move |column: usize| -> Lanes {
                std::array::from_fn(|l| {
                    if first + l >= readout.hidden {
                        return 0.0;
                    }
                    let (bias, weights) = readout.neuron(first + l);
                    if column == 0 { bias } else { weights[column - 1] }
                })
            };
            (0..=readout.memory).map(lane)
        };
        Self {
            memory: readout.memory,
            weights: (0..readout.hidden).step_by(LANES).flat_map(of_group).collect(),
            constant,
            of_hidden: of_hidden.to_vec(),
            direct: direct.to_vec(),
            h: vec![[0.0; LANES]; readout.hidden.div_ceil(LANES)],
        }
    }

    /// The output for the outputs `z` of the memory neurons.
    #[inline(always)]
    pub fn output<S: Simd>(&mut self, simd: S, z: &[f64]) -> f64 {
        let z = &z[..self.memory];
        for (sums, weights) in self.h.iter_mut().zip(self.weights.chunks_exact(1 + self.memory)) {
            *sums = weights[0];
            let sums = S::as_mut_simd_f64s(sums).0;
            for (weights, &z) in weights[1..].iter().zip(z) {
                let z = simd.splat_f64s(z);
                for (sum, &weight) in sums.iter_mut().zip(S::as_simd_f64s(weights).0) {
                    *sum = multiply_add_lanes(simd, weight, z, *sum);
                }
            }
        }
        let of_memory = dot::<S>(&self.direct, z, 0.0);
        let h = self.h.as_flattened_mut();
        // One loop over all groups, of a length that the compiler does not know: it unrolls a loop over a single group
        // and then uses narrower vectors.
        for h in h.iter_mut() {
            *h = tanh::<S>(*h); // (2.5)
        }
        dot::<S>(&self.of_hidden, h, self.constant) + of_memory // (2.6)
    }
}

/// `sum + a·b`.
#[inline(always)]
fn dot<S: Simd>(a: &[f64], b: &[f64], sum: f64) -> f64 {
    a.iter().zip(b).fold(sum, |sum, (&a, &b)| multiply_add::<S>(a, b, sum))
}

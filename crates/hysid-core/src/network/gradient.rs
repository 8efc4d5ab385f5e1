//! Gradient of half the sum of squared residuals by the parameters found by search, without the Jacobian.
//!
//! ```text
//! g = Jᵀr,   r = Φc - y                                      theory.md (3.3)
//! ```
//!
//! `Φ` has one row for each row with a measured output `y`, and its columns are the terms of the output
//! (constant, tanh neurons, direct path); `c` are the output weights, held fixed; `J = ∂(Φc)/∂θ` for the
//! parameters `θ`.
//!
//! Each block of rows is propagated backward once, with its residuals, and the results are summed over the
//! rows. The cost is about that of two evaluations for any number of parameters; the cost of the Gram matrix
//! of the Jacobian grows with their square.

use pulp::{Simd, WithSimd};

use crate::network::block::Block;
use crate::network::memory::{BLOCK, BlockValues};
use crate::network::readout::{Backward, Readout};
use crate::network::sweep::{NetworkDrive, NetworkSweep, TakeBlock};
use crate::network::{Architecture, ParameterLayout};
use crate::simd::{self, LANES, multiply_add_lanes};
use crate::stop_check::StopCheck;

/// The gradient `Jᵀr` over records, `r = Φc - y`, with output weights `c` held fixed (theory.md (3.3)).
pub struct GradientOverRecords<'a> {
    /// Architecture of the network.
    pub architecture: &'a Architecture,
    /// Its parameters, in the order of [`ParameterLayout`].
    pub parameters: &'a [f64],
    /// Its output weights `c`.
    pub output: &'a [f64],
    /// Scaled inputs of each record.
    pub drives: &'a [NetworkDrive],
    /// Scaled outputs of each record.
    pub targets: &'a [Vec<f64>],
    /// Stops the computation early; the sum is then incomplete and must not be used.
    pub stop: StopCheck<'a>,
}

impl GradientOverRecords<'_> {
    /// Computes the sum over rows, one number for each parameter.
    pub fn sum(self) -> Vec<f64> {
        simd::run(self)
    }
}

impl WithSimd for GradientOverRecords<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let layout = ParameterLayout::new(*self.architecture);
        let mut sums = GradientSums {
            output: self.output,
            backward: Backward::new(self.architecture),
            residual: BlockValues([0.0; BLOCK]),
            gradient: vec![[0.0; LANES]; layout.len()],
            layout,
        };
        let walk = NetworkSweep {
            architecture: self.architecture,
            parameters: self.parameters,
            with_slopes: true,
            stop: self.stop,
        };
        walk.over(simd, self.drives, self.targets, &mut sums);
        sums.gradient.iter().map(|lanes| lanes.iter().sum()).collect()
    }
}

struct GradientSums<'a> {
    output: &'a [f64],
    layout: ParameterLayout,
    backward: Backward,
    residual: BlockValues,
    gradient: Vec<[f64; LANES]>,
}

impl TakeBlock for GradientSums<'_> {
    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, rows: usize, block: &Block, readout: &Readout) {
        let Block { u, z, h, slopes, target } = block;
        readout.output(simd, self.output, z, h, rows, &mut self.residual);
        for (residual, target) in self.residual[..rows].iter_mut().zip(target) {
            *residual -= target;
        }
        self.residual[rows..].fill(0.0);
        self.backward.run::<S>(readout, self.output, &self.residual, block);
        let by_neuron = &mut self.gradient[self.layout.hidden.clone()];
        for (sums, slope) in by_neuron.chunks_exact_mut(1 + z.len()).zip(&self.backward.by_sum) {
            add_products(simd, slope, &[BlockValues([1.0; BLOCK])], &mut sums[..1]);
            add_products(simd, slope, z, &mut sums[1..]);
        }
        let (linear, rest) = self.backward.by_memory.split_at(usize::from(!self.layout.linear.is_empty()));
        let stops = self.layout.stop_weights.len() / u.len();
        let (stops, relaxation) = rest.split_at(stops);
        for (j, (stop, sums)) in stops
            .iter()
            .zip(self.gradient[self.layout.stop_weights.clone()].chunks_exact_mut(u.len()))
            .enumerate()
        {
            for (c, sum) in sums.iter_mut().enumerate() {
                let slope = slopes.by_weight(stops.len(), u.len(), j, c);
                add_products(simd, stop, std::slice::from_ref(slope), std::slice::from_mut(sum));
            }
        }
        add_products_of_each(simd, stops, &slopes.ln_beta, &mut self.gradient[self.layout.ln_beta.clone()]);
        add_products_of_each(
            simd,
            relaxation,
            &slopes.ln_tau,
            &mut self.gradient[self.layout.ln_tau.clone()],
        );
        if let Some(linear) = linear.first() {
            add_products(simd, linear, u, &mut self.gradient[self.layout.linear.clone()]);
        }
    }
}

/// Adds to each sum the products of `a` with one of the rows of `b`, row by row of the block.
#[inline(always)]
fn add_products<S: Simd>(simd: S, a: &BlockValues, b: &[BlockValues], sums: &mut [[f64; LANES]]) {
    let a = S::as_simd_f64s(&a.0).0;
    for (b, sum) in b.iter().zip(sums) {
        let sum = S::as_mut_simd_f64s(sum).0;
        for (a, b) in a.chunks_exact(sum.len()).zip(S::as_simd_f64s(&b.0).0.chunks_exact(sum.len())) {
            for ((sum, &a), &b) in sum.iter_mut().zip(a).zip(b) {
                *sum = multiply_add_lanes(simd, a, b, *sum);
            }
        }
    }
}

/// Adds to each sum the products of its own two rows.
#[inline(always)]
fn add_products_of_each<S: Simd>(simd: S, a: &[BlockValues], b: &[BlockValues], sums: &mut [[f64; LANES]]) {
    for ((a, b), sum) in a.iter().zip(b).zip(sums) {
        add_products(simd, a, std::slice::from_ref(b), std::slice::from_mut(sum));
    }
}

//! Exact derivatives of the output by every parameter found by search, and their Gram matrix for least
//! squares.
//!
//! ```text
//! q_j = ∂y/∂z_j = Σ_i c_i (1 - h_i²) U_ij + d_j              theory.md (2.11)
//!
//! ∂y/∂w_j    = q_j ∂z_j/∂w_j                                 weights of stop j
//! ∂y/∂ln β_j = q_j ε_j s_j/β_j                               its capacity
//! ∂y/∂a      = q_0 u                                         weights of the linear neuron
//! ∂y/∂ln τ_j = q_j ∂z_j/∂ln τ_j                              time constant of a relaxation neuron
//! ∂y/∂U_ij   = c_i (1 - h_i²) z_j,   ∂y/∂b_i = c_i (1 - h_i²)
//! ```
//!
//! The symbols are those of the [module of networks](crate::network). For a stop, with `u_ref` the scaled
//! input at its last slip (0 before the first),
//!
//! ```text
//! ∂p/∂w = u_ref,   ∂ε/∂w = u - u_ref,   ∂s/∂w = Σ sign(Δp) Δu_ref
//! ∂z/∂w = (1 - s/β) ∂ε/∂w - (ε/β) ∂s/∂w                      theory.md (2.9)
//! ```
//!
//! and all derivatives are 0 once `s >= β`. That of a relaxation neuron follows from its step (theory.md
//! (2.10)).

use pulp::{Simd, WithSimd};

use crate::linear_algebra::{Batch, FewColumns, Gram};
use crate::network::block::Block;
use crate::network::memory::{BLOCK, BlockValues};
use crate::network::readout::{Backward, Readout};
use crate::network::sweep::{NetworkDrive, NetworkSweep, TakeBlock};
use crate::network::{Architecture, Network, ParameterLayout};
use crate::simd;
use crate::stop_check::{Pace, StopCheck};

/// Output and Jacobian of a network over a record, in scaled units.
#[derive(Debug, Clone)]
pub struct LinearisedNetwork {
    /// Scaled output of each row.
    pub output: Vec<f64>,
    /// Derivative of the output by each parameter, with output weights held fixed: one column for each
    /// parameter in the order of [`ParameterLayout`], with one value a row. At a kink of a stop it is one of the two
    /// one-sided derivatives (a sub-gradient).
    pub jacobian: Vec<Vec<f64>>,
}

impl Network {
    /// Simulates a record from the virgin state and computes the exact Jacobian. The result holds rows times
    /// parameters numbers: it is meant for analysis. Training sums the same derivatives without storing them.
    ///
    /// # Panics
    /// If the drive's channels are not those of the architecture.
    pub fn linearise(&self, drive: &NetworkDrive) -> LinearisedNetwork {
        let p = self.parameters.len();
        let columns = JacobianColumns {
            architecture: &self.architecture,
            parameters: &self.parameters,
            output: Some(&self.output),
        };
        let target = vec![0.0; drive.len()];
        let rows = RowsOverRecords {
            columns,
            first: columns.count() - p,
            drives: std::slice::from_ref(drive),
            targets: &[target],
            stop: StopCheck::never(),
        };
        let jacobian = rows.columns();
        let mut output = vec![0.0; drive.len()];
        let u: Vec<&[f64]> = drive.channels.iter().map(Vec::as_slice).collect();
        self.simulator().run(&u, &drive.steps, &mut output);
        LinearisedNetwork { output, jacobian }
    }
}

/// Columns computed for each row with a target: features, target and, with output weights, the Jacobian.
#[derive(Debug, Clone, Copy)]
pub struct JacobianColumns<'a> {
    /// Architecture of the network.
    pub architecture: &'a Architecture,
    /// Nonlinear parameters, in the order of [`ParameterLayout`].
    pub parameters: &'a [f64],
    /// Its output weights; `None` for no Jacobian.
    pub output: Option<&'a [f64]>,
}

impl<'a> JacobianColumns<'a> {
    /// Number of columns.
    pub fn count(&self) -> usize {
        let jacobian = if self.output.is_some() { self.parameters.len() } else { 0 };
        self.architecture.output_weights() + 1 + jacobian
    }

    fn walk(&self, stop: StopCheck<'a>) -> NetworkSweep<'a> {
        NetworkSweep {
            architecture: self.architecture,
            parameters: self.parameters,
            with_slopes: self.output.is_some(),
            stop,
        }
    }
}

/// The Gram matrix of the [`JacobianColumns`] over records. Rows with a NaN target are skipped.
pub struct GramOverRecords<'a> {
    /// The columns.
    pub columns: JacobianColumns<'a>,
    /// Scaled inputs of each record.
    pub drives: &'a [NetworkDrive],
    /// Scaled outputs of each record.
    pub targets: &'a [Vec<f64>],
    /// Stops the computation early; the matrix is then incomplete and must not be used.
    pub stop: StopCheck<'a>,
}

impl GramOverRecords<'_> {
    /// Computes the Gram matrix.
    pub fn gram(self) -> Gram {
        simd::run(self)
    }
}

impl WithSimd for GramOverRecords<'_> {
    type Output = Gram;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Gram {
        let n = self.columns.count();
        let many =
            || GramMatrix::Many { gram: Gram::new(n), batch: Batch::new(n), pace: Pace::new(self.stop) };
        let gathered = FewColumns::new(n).map_or_else(many, GramMatrix::Few);
        let mut taken = ColumnsOfBlock::new(self.columns, gathered);
        self.columns.walk(self.stop).over(simd, self.drives, self.targets, &mut taken);
        match taken.to {
            GramMatrix::Few(few) => few.gram(simd),
            GramMatrix::Many { mut gram, mut batch, mut pace } => {
                gram.add(simd, &mut batch, &mut pace);
                gram
            }
        }
    }
}

/// Takes the columns of some rows.
trait TakeRows {
    fn take<'r, S: Simd>(&mut self, simd: S, rows: usize, columns: impl Iterator<Item = &'r BlockValues>);
}

/// The Gram matrix of the rows so far.
enum GramMatrix<'a> {
    Few(FewColumns),
    Many { gram: Gram, batch: Batch, pace: Pace<'a> },
}

impl TakeRows for GramMatrix<'_> {
    #[inline(always)]
    fn take<'r, S: Simd>(&mut self, simd: S, rows: usize, columns: impl Iterator<Item = &'r BlockValues>) {
        match self {
            Self::Few(few) => few.add(simd, columns, rows),
            Self::Many { gram, batch, pace } => {
                if batch.free() < rows {
                    gram.add(simd, batch, pace);
                }
                batch.append(columns, rows);
            }
        }
    }
}

/// Keeps the columns of every row, from the first that is wanted on.
struct KeptRows {
    first: usize,
    columns: Vec<Vec<f64>>,
}

impl TakeRows for KeptRows {
    #[inline(always)]
    fn take<'r, S: Simd>(&mut self, _: S, rows: usize, columns: impl Iterator<Item = &'r BlockValues>) {
        for (kept, column) in self.columns.iter_mut().zip(columns.skip(self.first)) {
            kept.extend_from_slice(&column[..rows]);
        }
    }
}

/// The [`JacobianColumns`] of every row with a target, from column `first` on, stored; for few rows.
pub struct RowsOverRecords<'a> {
    /// The columns.
    pub columns: JacobianColumns<'a>,
    /// The first column that is stored.
    pub first: usize,
    /// Scaled inputs of each record.
    pub drives: &'a [NetworkDrive],
    /// Scaled outputs of each record.
    pub targets: &'a [Vec<f64>],
    /// Stops the computation early; rows are then missing.
    pub stop: StopCheck<'a>,
}

impl RowsOverRecords<'_> {
    /// Computes the stored columns, each with one number for each row.
    pub fn columns(self) -> Vec<Vec<f64>> {
        simd::run(self)
    }
}

impl WithSimd for RowsOverRecords<'_> {
    type Output = Vec<Vec<f64>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<Vec<f64>> {
        let rows = self.targets.iter().flatten().filter(|y| !y.is_nan()).count();
        let wanted = self.columns.count() - self.first;
        let columns = (0..wanted).map(|_| Vec::with_capacity(rows)).collect();
        let mut taken = ColumnsOfBlock::new(self.columns, KeptRows { first: self.first, columns });
        self.columns.walk(self.stop).over(simd, self.drives, self.targets, &mut taken);
        taken.to.columns
    }
}

/// Computes the columns of a block and hands them on.
struct ColumnsOfBlock<'a, T> {
    spec: JacobianColumns<'a>,
    layout: ParameterLayout,
    /// If a Jacobian is wanted.
    backward: Option<Backward>,
    constant: BlockValues,
    jacobian: Vec<BlockValues>,
    to: T,
}

impl<'a, T> ColumnsOfBlock<'a, T> {
    fn new(spec: JacobianColumns<'a>, to: T) -> Self {
        Self {
            spec,
            layout: ParameterLayout::new(*spec.architecture),
            backward: spec.output.map(|_| Backward::new(spec.architecture)),
            constant: BlockValues([1.0; BLOCK]),
            jacobian: vec![
                BlockValues([0.0; BLOCK]);
                if spec.output.is_some() { spec.parameters.len() } else { 0 }
            ],
            to,
        }
    }

    /// Columns of the Jacobian: the derivatives of the module page, by theory.md (2.11).
    #[inline(always)]
    fn jacobian<S: Simd>(&mut self, block: &Block, readout: &Readout) {
        let (Some(output), Some(backward)) = (self.spec.output, &mut self.backward) else { return };
        let jacobian = &mut self.jacobian;
        let Block { u, z, slopes, .. } = block;
        backward.run::<S>(readout, output, &BlockValues([1.0; BLOCK]), block);
        let by_neuron = &mut jacobian[self.layout.hidden.clone()];
        for (columns, slope) in by_neuron.chunks_exact_mut(1 + z.len()).zip(&backward.by_sum) {
            columns[0] = *slope;
            for (column, z) in columns[1..].iter_mut().zip(z) {
                product(slope, z, column);
            }
        }
        let (linear, rest) = backward.by_memory.split_at(usize::from(!self.layout.linear.is_empty()));
        let (stops, relaxation) = rest.split_at(self.spec.architecture.stops);
        let channels = u.len();
        for (k, column) in jacobian[self.layout.stop_weights.clone()].iter_mut().enumerate() {
            let (j, c) = (k / channels, k % channels);
            product(&stops[j], slopes.by_weight(stops.len(), channels, j, c), column);
        }
        for (j, column) in jacobian[self.layout.ln_beta.clone()].iter_mut().enumerate() {
            product(&stops[j], &slopes.ln_beta[j], column);
        }
        for (c, column) in jacobian[self.layout.linear.clone()].iter_mut().enumerate() {
            product(&linear[0], &u[c], column);
        }
        for (k, column) in jacobian[self.layout.ln_tau.clone()].iter_mut().enumerate() {
            product(&relaxation[k], &slopes.ln_tau[k], column);
        }
    }
}

impl<T: TakeRows> TakeBlock for ColumnsOfBlock<'_, T> {
    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, rows: usize, block: &Block, readout: &Readout) {
        self.jacobian::<S>(block, readout);
        let features = readout.features(&self.constant, &block.z, &block.h);
        let columns = features.chain(std::iter::once(&block.target)).chain(&self.jacobian);
        self.to.take(simd, rows, columns);
    }
}

#[inline(always)]
fn product(a: &BlockValues, b: &BlockValues, out: &mut BlockValues) {
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = a * b;
    }
}

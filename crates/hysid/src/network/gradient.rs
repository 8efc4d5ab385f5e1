//! Exact derivatives of the output by every parameter found by search, and one sweep over records
//! that gathers all that least squares needs of them.
//!
//! ```text
//! q_j = ∂y/∂z_j = Σ_i c_i (1 - h_i²) U_ij + d_j      theory.md (2.11)
//! ```
//!
//! The derivative by a parameter of a memory neuron is `q_j` times that of its output, theory.md
//! (2.9) and (2.10). Memory does not grow with the record: a block of rows is in hand at a time.

use pulp::{Simd, WithSimd};

use crate::linear_algebra::{Batch, Gram};
use crate::network::memory::{BLOCK, MemoryLayer, MemorySlopes, Row};
use crate::network::readout::{Readout, accumulate};
use crate::network::{Architecture, Layout, Network, limited};
use crate::simd::{self, multiply_add};

/// A record as a network sees it: scaled inputs by channel (first input, rate, further inputs), and
/// the time step before each row, 0 at the first.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// One column for each channel of the architecture.
    pub channels: Vec<Vec<f64>>,
    /// Time steps; empty for an architecture without relaxation neurons.
    pub steps: Vec<f64>,
}

impl Drive {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.channels.first().map_or(0, Vec::len)
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Output and Jacobian of a network over a record.
#[derive(Debug, Clone)]
pub struct Linearised {
    /// Scaled output of each row.
    pub output: Vec<f64>,
    /// Derivative of the output by each parameter in the order of [`Layout`], output weights held:
    /// one column of all rows for each parameter. At a kink of a stop, one of the two one-sided
    /// derivatives (a sub-gradient).
    pub jacobian: Vec<Vec<f64>>,
}

impl Network {
    /// Output and exact Jacobian over a record, from the virgin state. It holds rows times parameters
    /// numbers: meant for analysis; training gathers what it needs without storing it.
    ///
    /// # Panics
    /// If the drive's channels are not those of the architecture.
    pub fn linearise(&self, drive: &Drive) -> Linearised {
        let p = self.parameters.len();
        let mut rows = Rows {
            wanted: 1 + p,
            first: self.architecture.output_weights(),
            columns: vec![Vec::with_capacity(drive.len()); 1 + p],
        };
        let target = vec![0.0; drive.len()];
        let columns = Columns {
            architecture: &self.architecture,
            parameters: &self.parameters,
            output: Some(&self.output),
        };
        simd::run(CollectRows { columns, drive, target: &target, rows: &mut rows });
        let jacobian = rows.columns.split_off(1);
        let mut output = vec![0.0; drive.len()];
        let u: Vec<&[f64]> = drive.channels.iter().map(Vec::as_slice).collect();
        self.simulator().run(&u, &drive.steps, &mut output);
        Linearised { output, jacobian }
    }
}

/// What one sweep computes for every row that has a target: features, target and, if output weights
/// are given, the Jacobian; in this order, as columns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Columns<'a> {
    pub architecture: &'a Architecture,
    pub parameters: &'a [f64],
    pub output: Option<&'a [f64]>,
}

impl Columns<'_> {
    /// Number of columns.
    pub fn count(&self) -> usize {
        let jacobian = if self.output.is_some() { self.parameters.len() } else { 0 };
        self.architecture.output_weights() + 1 + jacobian
    }
}

/// Gathers the Gram matrix of the [`Columns`] over records; a target of NaN is passed over.
pub(crate) struct Sweep<'a> {
    pub columns: Columns<'a>,
    pub drives: &'a [Drive],
    pub targets: &'a [Vec<f64>],
}

impl Sweep<'_> {
    pub fn gram(self) -> Gram {
        simd::run(self)
    }
}

impl WithSimd for Sweep<'_> {
    type Output = Gram;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Gram {
        let n = self.columns.count();
        let mut gathered = Gathered { gram: Gram::new(n), batch: Batch::new(n) };
        let mut workspace = Workspace::new(self.columns);
        for (drive, target) in self.drives.iter().zip(self.targets) {
            workspace.record(simd, drive, target, &mut gathered);
        }
        workspace.flush(simd, &mut gathered);
        gathered.gram.add(simd, &mut gathered.batch);
        gathered.gram
    }
}

/// Takes the columns of some rows. A trait and no closure, because a closure would not be compiled
/// for the instruction set of the kernel that calls it.
trait TakeRows {
    fn take<S: Simd>(&mut self, simd: S, rows: usize, columns: &[Row]);
}

/// Gathers rows into a Gram matrix.
struct Gathered {
    gram: Gram,
    batch: Batch,
}

impl TakeRows for Gathered {
    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, rows: usize, columns: &[Row]) {
        if self.batch.free() < rows {
            self.gram.add(simd, &mut self.batch);
        }
        self.batch.append(columns, rows);
    }
}

/// Keeps some of the columns of every row.
struct Rows {
    first: usize,
    wanted: usize,
    columns: Vec<Vec<f64>>,
}

impl TakeRows for Rows {
    #[inline(always)]
    fn take<S: Simd>(&mut self, _: S, rows: usize, columns: &[Row]) {
        let wanted = &columns[self.first..self.first + self.wanted];
        for (kept, column) in self.columns.iter_mut().zip(wanted) {
            kept.extend_from_slice(&column[..rows]);
        }
    }
}

struct CollectRows<'a> {
    columns: Columns<'a>,
    drive: &'a Drive,
    target: &'a [f64],
    rows: &'a mut Rows,
}

impl WithSimd for CollectRows<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let mut workspace = Workspace::new(self.columns);
        workspace.record(simd, self.drive, self.target, self.rows);
        workspace.flush(simd, self.rows);
    }
}

/// A block of rows: channels, memory outputs and slopes, target.
struct Block {
    u: Vec<Row>,
    z: Vec<Row>,
    slopes: MemorySlopes,
    target: Row,
}

impl Block {
    fn new(a: &Architecture) -> Self {
        Self {
            u: vec![[0.0; BLOCK]; a.channels()],
            z: vec![[0.0; BLOCK]; a.memory_neurons()],
            slopes: MemorySlopes::new(a),
            target: [0.0; BLOCK],
        }
    }

    /// Copies one row.
    #[inline(always)]
    fn copy_row(&mut self, to: usize, other: &Block, from: usize, with_slopes: bool) {
        let copy = |to_rows: &mut [Row], from_rows: &[Row]| {
            for (a, b) in to_rows.iter_mut().zip(from_rows) {
                a[to] = b[from];
            }
        };
        copy(&mut self.z, &other.z);
        if with_slopes {
            copy(&mut self.u, &other.u);
            copy(&mut self.slopes.weights, &other.slopes.weights);
            copy(&mut self.slopes.ln_beta, &other.slopes.ln_beta);
            copy(&mut self.slopes.ln_tau, &other.slopes.ln_tau);
        }
        self.target[to] = other.target[from];
    }
}

/// Buffers of a sweep. Blocks run through every row of a record; rows with a target are gathered in
/// `pending`, so that readout and Jacobian are computed for whole blocks of them.
struct Workspace<'a> {
    spec: Columns<'a>,
    layout: Layout,
    memory: MemoryLayer,
    readout: Readout,
    block: Block,
    pending: Block,
    filled: usize,
    h: Vec<Row>,
    q: Vec<Row>,
    columns: Vec<Row>,
}

impl<'a> Workspace<'a> {
    fn new(spec: Columns<'a>) -> Self {
        let a = spec.architecture;
        Self {
            spec,
            layout: Layout::new(*a),
            memory: MemoryLayer::new(a, spec.parameters),
            readout: Readout::new(a, spec.parameters),
            block: Block::new(a),
            pending: Block::new(a),
            filled: 0,
            h: vec![[0.0; BLOCK]; a.hidden],
            q: vec![[0.0; BLOCK]; a.memory_neurons()],
            columns: vec![[0.0; BLOCK]; spec.count()],
        }
    }

    /// Runs through a record and hands on the columns of whole blocks of rows with a target.
    #[inline(always)]
    fn record<S: Simd>(&mut self, simd: S, drive: &Drive, target: &[f64], to: &mut impl TakeRows) {
        let mut state = self.memory.virgin();
        let mut sensitivity = self.memory.virgin_sensitivity();
        let mut steps = [0.0; BLOCK];
        for start in (0..drive.len()).step_by(BLOCK) {
            let rows = BLOCK.min(drive.len() - start);
            for (block, channel) in self.block.u.iter_mut().zip(&drive.channels) {
                for (block, &u) in block.iter_mut().zip(&channel[start..start + rows]) {
                    *block = limited(u);
                }
            }
            if !drive.steps.is_empty() {
                steps[..rows].copy_from_slice(&drive.steps[start..start + rows]);
            }
            self.block.target[..rows].copy_from_slice(&target[start..start + rows]);
            let Block { u, z, slopes, .. } = &mut self.block;
            if self.spec.output.is_some() {
                self.memory.forward_with_slopes(
                    simd,
                    &mut state,
                    &mut sensitivity,
                    u,
                    &steps,
                    rows,
                    z,
                    slopes,
                );
            } else {
                self.memory.forward(simd, &mut state, u, &steps, rows, z);
            }
            let wanted = self.block.target[..rows].iter().filter(|y| !y.is_nan()).count();
            if wanted == BLOCK && self.filled == 0 {
                std::mem::swap(&mut self.block, &mut self.pending);
                self.filled = BLOCK;
                self.flush(simd, to);
                continue;
            }
            if wanted == 0 {
                continue;
            }
            for t in 0..rows {
                if self.block.target[t].is_nan() {
                    continue;
                }
                self.pending.copy_row(self.filled, &self.block, t, self.spec.output.is_some());
                self.filled += 1;
                if self.filled == BLOCK {
                    self.flush(simd, to);
                }
            }
        }
    }

    /// Computes and hands on the columns of the pending rows.
    #[inline(always)]
    fn flush<S: Simd>(&mut self, simd: S, to: &mut impl TakeRows) {
        let rows = std::mem::take(&mut self.filled);
        if rows == 0 {
            return;
        }
        self.readout.tanh_layer(simd, &self.pending.z, rows, &mut self.h);
        let m = self.spec.architecture.output_weights();
        let (features, rest) = self.columns.split_at_mut(m);
        self.readout.features(&self.pending.z, &self.h, features);
        rest[0] = self.pending.target;
        if let Some(output) = self.spec.output {
            self.jacobian::<S>(output);
        }
        to.take(simd, rows, &self.columns);
    }

    /// Columns of the Jacobian of the pending rows, theory.md (2.11).
    #[inline(always)]
    fn jacobian<S: Simd>(&mut self, output: &[f64]) {
        let m = self.spec.architecture.output_weights();
        let jacobian = &mut self.columns[m + 1..];
        let Block { u, z, slopes, .. } = &self.pending;
        let (_, hidden, direct) = self.readout.split(output);
        for (j, q) in self.q.iter_mut().enumerate() {
            *q = [direct.get(j).copied().unwrap_or(0.0); BLOCK];
        }
        let by_neuron = &mut jacobian[self.layout.hidden.clone()];
        let run = 1 + z.len();
        for (i, (&c, h)) in hidden.iter().zip(&self.h).enumerate() {
            let columns = &mut by_neuron[i * run..(i + 1) * run];
            let mut slope = [0.0; BLOCK];
            for (slope, &h) in slope.iter_mut().zip(h) {
                *slope = c * multiply_add::<S>(-h, h, 1.0);
            }
            columns[0] = slope;
            for (column, z) in columns[1..].iter_mut().zip(z) {
                product(&slope, z, column);
            }
            let (_, weights) = self.readout.neuron(i);
            for (q, &weight) in self.q.iter_mut().zip(weights) {
                accumulate::<S>(weight, &slope, q);
            }
        }
        let (linear, rest) = self.q.split_at(usize::from(!self.layout.linear.is_empty()));
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

#[inline(always)]
fn product(a: &Row, b: &Row, out: &mut Row) {
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = a * b;
    }
}

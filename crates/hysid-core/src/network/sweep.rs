//! One pass of a network over records, which yields whole blocks of the rows that have a target.
//!
//! All rows of a record advance the memory. Rows with a target are collected, so that readout and derivatives
//! are computed for whole blocks of them. The storage needed does not grow with the record.
//!
//! The memory's part of a block and that of its rows with a target are operations of their own: each is compiled
//! once for an instruction set, the memory's for all kernels together. Inlined, they would be compiled at every place
//! that calls them, in every kernel.

use pulp::{Simd, WithSimd};

use crate::data::polyline::steps_between;
use crate::network::Architecture;
use crate::network::block::Block;
use crate::network::memory::{BLOCK, BlockValues, MemoryLayer, MemoryState, Sensitivity};
use crate::network::readout::Readout;
use crate::stop_check::{Pace, StopCheck};

/// Scaled inputs of a network over a record, with time steps.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkDrive {
    /// One column for each channel (first input, its rate if there is one, further inputs), each with one
    /// value a row.
    pub channels: Vec<Vec<f64>>,
    /// The time step before each row, 0 at the first, in the unit of time; infinite at the rows of a
    /// [lead-in](crate::data::initial_state). Empty for an architecture without relaxation neurons.
    pub steps: Vec<f64>,
}

impl NetworkDrive {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.channels.first().map_or(0, Vec::len)
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The drive through these rows alone, which are in order.
    pub fn through(&self, rows: &[usize]) -> Self {
        let channels = self.channels.iter().map(|u| rows.iter().map(|&row| u[row]).collect());
        let has_steps = !self.steps.is_empty();
        let steps = if has_steps { steps_between(rows, |row| self.steps[row]) } else { Vec::new() };
        Self { channels: channels.collect(), steps }
    }
}

/// A network on its way over records: its parameters, and whether derivatives are wanted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NetworkSweep<'a> {
    pub architecture: &'a Architecture,
    pub parameters: &'a [f64],
    pub with_slopes: bool,
    pub stop: StopCheck<'a>,
}

/// Takes blocks. A closure would not be compiled for the instruction set of the calling kernel.
pub(crate) trait TakeBlock {
    /// Takes the first `rows` rows of a block. What stands beyond them is finite and means nothing.
    fn take<S: Simd>(&mut self, simd: S, rows: usize, block: &Block, readout: &Readout);
}

impl NetworkSweep<'_> {
    /// Walks over every record from the virgin state; ends early once stopped.
    #[inline(always)]
    pub fn over<S: Simd>(
        &self,
        simd: S,
        records: &[NetworkDrive],
        targets: &[impl AsRef<[f64]>],
        to: &mut impl TakeBlock,
    ) {
        let mut workspace = Workspace::new(self);
        for (drive, target) in records.iter().zip(targets) {
            workspace.record(simd, drive, target.as_ref(), to);
        }
        workspace.flush(simd, to);
    }
}

struct Workspace<'a> {
    pace: Pace<'a>,
    /// Operations for a block, roughly.
    operations: usize,
    with_slopes: bool,
    memory: MemoryLayer,
    readout: Readout,
    block: Block,
    /// Rows with a target that wait until they fill a block.
    pending: Block,
    filled: usize,
}

impl<'a> Workspace<'a> {
    fn new(walk: &NetworkSweep<'a>) -> Self {
        let a = walk.architecture;
        Self {
            pace: Pace::new(walk.stop),
            operations: 2 * BLOCK * walk.parameters.len(),
            with_slopes: walk.with_slopes,
            memory: MemoryLayer::new(a, walk.parameters),
            readout: Readout::new(a, walk.parameters),
            block: Block::new(walk.architecture, walk.with_slopes),
            pending: Block::new(walk.architecture, walk.with_slopes),
            filled: 0,
        }
    }

    /// Runs through a record and hands on whole blocks of rows with a target.
    #[inline(always)]
    fn record<S: Simd>(&mut self, simd: S, drive: &NetworkDrive, target: &[f64], to: &mut impl TakeBlock) {
        let mut state = self.memory.virgin();
        let mut sensitivity = self.with_slopes.then(|| self.memory.virgin_sensitivity());
        let mut steps = BlockValues([0.0; BLOCK]);
        for start in (0..drive.len()).step_by(BLOCK) {
            if self.pace.is_over(self.operations) {
                return;
            }
            let rows = BLOCK.min(drive.len() - start);
            for (block, channel) in self.block.u.iter_mut().zip(&drive.channels) {
                block.take_channel(&channel[start..start + rows]);
            }
            if !drive.steps.is_empty() {
                steps[..rows].copy_from_slice(&drive.steps[start..start + rows]);
            }
            let mut wanted = 0;
            for (to, &y) in self.block.target.iter_mut().zip(&target[start..start + rows]) {
                *to = y;
                wanted += usize::from(!y.is_nan());
            }
            let (memory, state, steps) = (&self.memory, &mut state, &steps);
            let block = &mut self.block;
            match &mut sensitivity {
                Some(sensitivity) => {
                    simd.vectorize(AdvanceWithSlopes { memory, state, sensitivity, block, steps, rows });
                }
                None => simd.vectorize(Advance { memory, state, block, steps, rows }),
            }
            if wanted == BLOCK && self.filled == 0 {
                simd.vectorize(BlockCompletion { readout: &self.readout, block: &mut self.block, rows, to });
                continue;
            }
            if wanted == 0 {
                continue;
            }
            for t in 0..rows {
                if self.block.target[t].is_nan() {
                    continue;
                }
                self.pending.copy_row(self.filled, &self.block, t, self.with_slopes);
                self.filled += 1;
                if self.filled == BLOCK {
                    self.flush(simd, to);
                }
            }
        }
    }

    #[inline(always)]
    fn flush<S: Simd>(&mut self, simd: S, to: &mut impl TakeBlock) {
        let rows = std::mem::take(&mut self.filled);
        if rows > 0 {
            simd.vectorize(BlockCompletion { readout: &self.readout, block: &mut self.pending, rows, to });
        }
    }
}

/// Advances the memory by the rows of a block.
struct Advance<'w> {
    memory: &'w MemoryLayer,
    state: &'w mut MemoryState,
    block: &'w mut Block,
    steps: &'w BlockValues,
    rows: usize,
}

impl WithSimd for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Block { u, z, .. } = self.block;
        self.memory.forward(simd, self.state, u, self.steps, self.rows, z);
    }
}

/// The same with all derivatives. An operation of its own: its tiles would make the stack of the other one large.
struct AdvanceWithSlopes<'w> {
    memory: &'w MemoryLayer,
    state: &'w mut MemoryState,
    sensitivity: &'w mut Sensitivity,
    block: &'w mut Block,
    steps: &'w BlockValues,
    rows: usize,
}

impl WithSimd for AdvanceWithSlopes<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { memory, state, sensitivity, block, steps, rows } = self;
        let Block { u, z, slopes, .. } = block;
        memory.forward_with_slopes(simd, state, sensitivity, u, steps, rows, z, slopes);
    }
}

/// Completes a block of rows with a target and hands it on.
struct BlockCompletion<'w, T> {
    readout: &'w Readout,
    block: &'w mut Block,
    rows: usize,
    to: &'w mut T,
}

impl<T: TakeBlock> WithSimd for BlockCompletion<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { readout, block, rows, to } = self;
        readout.tanh_layer(simd, &block.z, rows, &mut block.h);
        to.take(simd, rows, block, readout);
    }
}

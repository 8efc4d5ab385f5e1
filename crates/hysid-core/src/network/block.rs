//! A block of rows of a network: inputs, outputs of neurons and derivatives, column by column.

use crate::network::Architecture;
use crate::network::memory::{BLOCK, BlockValues, MemorySlopes};

/// Intermediate results of memory and readout for a block of rows.
pub(crate) struct Block {
    /// Scaled inputs by channel; of rows with slopes only.
    pub u: Vec<BlockValues>,
    /// Outputs of the memory neurons.
    pub z: Vec<BlockValues>,
    /// Outputs of the tanh neurons.
    pub h: Vec<BlockValues>,
    /// Derivatives of the memory neurons' outputs by their own parameters, if wanted.
    pub slopes: MemorySlopes,
    pub target: BlockValues,
}

impl Block {
    pub fn new(a: &Architecture, with_slopes: bool) -> Self {
        Self {
            u: vec![BlockValues([0.0; BLOCK]); a.channels()],
            z: vec![BlockValues([0.0; BLOCK]); a.memory_neurons()],
            h: vec![BlockValues([0.0; BLOCK]); a.hidden],
            slopes: if with_slopes { MemorySlopes::new(a) } else { MemorySlopes::default() },
            target: BlockValues([0.0; BLOCK]),
        }
    }

    /// Copies one row, as it is before the readout.
    #[inline(always)]
    pub fn copy_row(&mut self, to: usize, other: &Block, from: usize, with_slopes: bool) {
        let copy = |to_rows: &mut [BlockValues], from_rows: &[BlockValues]| {
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

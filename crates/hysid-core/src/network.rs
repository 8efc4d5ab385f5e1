//! The family of neural networks: `pnn`, `gpnn`, `preisach-nn`, `xpnn` and `xpnn+` are one network, of which
//! each uses some parts (theory.md, section 2).
//!
#![doc = "<figure>"]
#![doc = include_str!("network/network.svg")]
#![doc = "</figure>"]
//!
//! ```text
//! u   = [x/X, x'/X', further inputs]                                       theory.md (2.1)
//!
//! v = w·u,   p = min(v + 1, max(v - 1, p before)),   ε = v - p             theory.md (2.2)
//! s = s before + |p - p before|,   z_j = ε max(0, 1 - s/β)
//! z_0 = a·u                                                                theory.md (2.3)
//! z'  = u_c' - z/τ                                                         theory.md (2.4)
//!
//! h_i = tanh(b_i + U_i0 z_0 + Σ_j U_ij z_j)                                theory.md (2.5)
//! y   = c_0 + Σ_i c_i h_i + Σ_j d_j z_j                                    theory.md (2.6)
//! ```
//!
//! - `u`: the inputs of the network, without unit. `x` is the first input, `x'` its rate; `X` and `X'` are
//!   their largest magnitudes in training ([`scaling::Scaling`]).
//! - `z_j`: stop neuron `j`, a [deteriorating stop](crate::operator::deteriorating_stop) of threshold 1 with
//!   the weights `w`, the play `p`, the slip `s` and the capacity `β`, driven by `v`. The index `j` is
//!   omitted in its equations.
//! - `z_0`: the linear neuron, with the weights `a`.
//! - `z` in (2.4): a relaxation neuron with the time constant `τ`, driven by one input `u_c`. Relaxation
//!   neurons are numbered behind the stops.
//! - `h_i`: tanh neuron `i`, with the bias `b_i` and the weights `U_ij`.
//! - `y`: the output, with mean 0 and standard deviation 1 in training. `c_0`, `c_i` and `d_j` are the output
//!   weights, found by least squares; all other parameters are found by search.
//!
//! | name | memory layer | readout |
//! |---|---|---|
//! | `pnn` | stops of `x` | linear |
//! | `gpnn` | deteriorating stops of `x` | linear |
//! | `preisach-nn` | linear neuron, stops of `x` | tanh layer |
//! | `xpnn` | linear neuron, deteriorating stops of `x` and `x'` | tanh layer |
//! | `xpnn+` | as `xpnn`, with relaxation neurons and further inputs | tanh layer and direct path `d_j` |
//!
//! A [`Network`] holds the parameters. Its memory, the plays, slips and relaxation states, is a
//! [`MemoryState`]. A [`Simulator`] holds both and runs the network, one sample or a whole record at a time.
//!
//! All inputs and outputs of this module are in scaled units, except those of [`free_run`];
//! [`crate::model::Model`] takes the user's units. Source: arXiv 2001.01559; the relaxation neurons, the
//! direct path and the constant are ours.

mod architecture;
mod block;
#[doc(hidden)]
pub mod decay;
pub mod free_run;
mod gradient;
#[cfg(test)]
mod instruction_sets;
mod jacobian;
mod memory;
mod parameters;
mod readout;
pub mod scaling;
mod sweep;
#[doc(hidden)]
pub mod tanh;
mod transpose;

pub use architecture::{Architecture, Family, Sizes};
pub use jacobian::LinearisedNetwork;
pub use memory::MemoryState;
pub use parameters::ParameterLayout;
pub use sweep::NetworkDrive;

pub use gradient::GradientOverRecords;
pub use jacobian::{GramOverRecords, JacobianColumns, RowsOverRecords};

use pulp::{Simd, WithSimd};

use crate::error::{Error, Result};
use crate::simd;
use memory::{BLOCK, BlockValues, MemoryLayer, limited};
use readout::{Readout, SampleReadout};

/// Largest magnitude of an output weight, which keeps a free run finite.
const LARGEST_OUTPUT_WEIGHT: f64 = 1e50;

/// A network: its architecture, its parameters found by search, and its output weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    architecture: Architecture,
    parameters: Vec<f64>,
    output: Vec<f64>,
}

impl Network {
    /// A network from its parts.
    ///
    /// `parameters` are those found by search, in the order of [`ParameterLayout`]. `output` are the output weights,
    /// in the order constant `c_0`, tanh neurons `c_i`, direct path `d_j`; parts that the architecture lacks
    /// are left out. Both are in scaled units.
    ///
    /// # Errors
    /// A length that does not fit the architecture, a parameter outside its bounds ([`ParameterLayout::bounds`]), an
    /// output weight that is not finite or beyond 1e50.
    pub fn new(architecture: Architecture, parameters: Vec<f64>, output: Vec<f64>) -> Result<Self> {
        ParameterLayout::new(architecture).check(&parameters)?;
        if output.len() != architecture.output_weights() {
            return Err(Error::Parts(format!(
                "{} output weights where the architecture has {}",
                output.len(),
                architecture.output_weights()
            )));
        }
        match output.iter().find(|weight| weight.is_nan() || weight.abs() > LARGEST_OUTPUT_WEIGHT) {
            Some(weight) => Err(Error::Parts(format!("output weight {weight} is not a usable number"))),
            None => Ok(Self { architecture, parameters, output }),
        }
    }

    /// The architecture: which parts the network has.
    pub fn architecture(&self) -> &Architecture {
        &self.architecture
    }

    /// The parameters found by search, in the order of [`ParameterLayout`].
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// The output weights: constant, tanh neurons, direct path.
    pub fn output(&self) -> &[f64] {
        &self.output
    }

    /// A simulator in the virgin state.
    pub fn simulator(&self) -> Simulator {
        let memory = MemoryLayer::new(&self.architecture, &self.parameters);
        let readout = Readout::new(&self.architecture, &self.parameters);
        Simulator {
            state: memory.virgin(),
            memory,
            sample_readout: SampleReadout::new(&readout, &self.output),
            readout,
            output: self.output.clone(),
            inputs: vec![0.0; self.architecture.channels()],
            neurons: vec![0.0; self.architecture.memory_neurons()],
            u: vec![BlockValues([0.0; BLOCK]); self.architecture.channels()],
            z: vec![BlockValues([0.0; BLOCK]); self.architecture.memory_neurons()],
            h: vec![BlockValues([0.0; BLOCK]); self.architecture.hidden],
        }
    }
}

/// A network with its memory, which runs any number of samples at a time and allocates nothing.
///
/// The outputs do not depend, to the last bit, on how a signal is divided into runs.
#[derive(Debug, Clone)]
pub struct Simulator {
    memory: MemoryLayer,
    readout: Readout,
    sample_readout: SampleReadout,
    output: Vec<f64>,
    state: MemoryState,
    /// Inputs and outputs of the memory neurons in one row.
    inputs: Vec<f64>,
    neurons: Vec<f64>,
    /// The same in a block of rows, and outputs of the tanh neurons.
    u: Vec<BlockValues>,
    z: Vec<BlockValues>,
    h: Vec<BlockValues>,
}

impl Simulator {
    /// The present memory.
    pub fn state(&self) -> &MemoryState {
        &self.state
    }

    /// Replaces the memory by one taken from a simulator of the same network.
    pub fn set_state(&mut self, state: MemoryState) {
        self.state = state;
    }

    /// Returns to the virgin state.
    pub fn reset(&mut self) {
        self.state = self.memory.virgin();
    }

    /// Simulates the next rows, from the present memory on. All values are scaled.
    ///
    /// `u` has one slice for each channel (first input, its rate if the network has one, further inputs),
    /// each with one value a row. `steps` are the time steps before each row, in the unit of time of `τ`, 0
    /// at the first row of a record; it may be empty for a network without relaxation neurons. `y` receives
    /// the output of each row.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn run(&mut self, u: &[&[f64]], steps: &[f64], y: &mut [f64]) {
        assert_eq!(u.len(), self.u.len(), "one slice for each channel");
        assert!(u.iter().all(|u| u.len() == y.len()), "as many inputs as outputs");
        assert!(steps.len() == y.len() || steps.is_empty(), "as many time steps as outputs");
        simd::run(NetworkRun { simulator: self, u, steps, y });
    }

    /// Simulates one sample and returns its scaled output: [`Simulator::run`] with one row.
    pub fn step(&mut self, u: &[f64], step: f64) -> f64 {
        assert_eq!(u.len(), self.inputs.len(), "one value for each channel");
        simd::run(NetworkStep { simulator: self, u, step })
    }

    #[inline(always)]
    fn block<S: Simd>(&mut self, simd: S, steps: &BlockValues, rows: usize, y: &mut BlockValues) {
        self.memory.forward(simd, &mut self.state, &self.u, steps, rows, &mut self.z);
        self.readout.tanh_layer(simd, &self.z, rows, &mut self.h);
        self.readout.output(simd, &self.output, &self.z, &self.h, rows, y);
    }
}

struct NetworkRun<'a> {
    simulator: &'a mut Simulator,
    u: &'a [&'a [f64]],
    steps: &'a [f64],
    y: &'a mut [f64],
}

impl WithSimd for NetworkRun<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let mut steps = BlockValues([0.0; BLOCK]);
        let mut output = BlockValues([0.0; BLOCK]);
        for (index, y) in self.y.chunks_mut(BLOCK).enumerate() {
            let (start, rows) = (index * BLOCK, y.len());
            for (block, u) in self.simulator.u.iter_mut().zip(self.u) {
                block.take_channel(&u[start..start + rows]);
            }
            if !self.steps.is_empty() {
                steps[..rows].copy_from_slice(&self.steps[start..start + rows]);
            }
            self.simulator.block(simd, &steps, rows, &mut output);
            y.copy_from_slice(&output[..rows]);
        }
    }
}

struct NetworkStep<'a> {
    simulator: &'a mut Simulator,
    u: &'a [f64],
    step: f64,
}

impl WithSimd for NetworkStep<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Simulator { memory, sample_readout, state, inputs, neurons, .. } = self.simulator;
        for (input, &u) in inputs.iter_mut().zip(self.u) {
            *input = limited(u);
        }
        memory.step::<S>(state, inputs, self.step, neurons);
        sample_readout.output(simd, neurons)
    }
}

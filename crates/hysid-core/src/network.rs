//! The family of neural networks: `pnn`, `gpnn`, `preisach-nn`, `xpnn` and `xpnn+` are one network
//! with parts switched off (`docs/theory.md` section 2).
//!
//! A [`Network`] is its parameters; what it knows of the past is a [`MemoryState`], kept apart. A
//! [`Simulator`] holds one of each and runs them, sample by sample or by the million.
//!
//! Everything here is in scaled units; [`crate::model::Model`] knows the user's.

mod architecture;
pub mod free_run;
mod gradient;
mod jacobian;
mod memory;
mod parameters;
mod readout;
pub mod scaling;
mod sweep;
mod tanh;
mod transpose;

pub use architecture::{Architecture, Family, Sizes};
pub use jacobian::Linearised;
pub use memory::MemoryState;
pub use parameters::Layout;
pub use sweep::Drive;

pub use gradient::GradientOverRecords;
pub use jacobian::{Columns, GramOverRecords, RowsOverRecords};

use pulp::{Simd, WithSimd};

use crate::error::{Error, Result};
use crate::simd;
use memory::{BLOCK, LARGEST_SCALED, MemoryLayer, Row};
use readout::Readout;

/// Largest magnitude of an output weight, which keeps a free run finite.
const LARGEST_OUTPUT_WEIGHT: f64 = 1e50;

/// A network with its weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    architecture: Architecture,
    parameters: Vec<f64>,
    output: Vec<f64>,
}

impl Network {
    /// A network from its parameters, flat in the order of [`Layout`], and its output weights:
    /// constant, tanh neurons, direct path.
    ///
    /// # Errors
    /// A length that does not fit the architecture, a parameter outside its bounds, an output weight
    /// that is not finite or beyond 1e50.
    pub fn new(architecture: Architecture, parameters: Vec<f64>, output: Vec<f64>) -> Result<Self> {
        Layout::new(architecture).check(&parameters)?;
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

    /// Its parts.
    pub fn architecture(&self) -> &Architecture {
        &self.architecture
    }

    /// The parameters found by search, flat.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// The output weights.
    pub fn output(&self) -> &[f64] {
        &self.output
    }

    /// A simulator in the virgin state.
    pub fn simulator(&self) -> Simulator {
        let memory = MemoryLayer::new(&self.architecture, &self.parameters);
        Simulator {
            state: memory.virgin(),
            memory,
            readout: Readout::new(&self.architecture, &self.parameters),
            output: self.output.clone(),
            u: vec![Row([0.0; BLOCK]); self.architecture.channels()],
            z: vec![Row([0.0; BLOCK]); self.architecture.memory_neurons()],
            h: vec![Row([0.0; BLOCK]); self.architecture.hidden],
        }
    }
}

/// A network with a state: runs any number of samples at a time, and allocates nothing.
///
/// However a signal is cut into runs, the outputs are the same to the last bit.
#[derive(Debug, Clone)]
pub struct Simulator {
    memory: MemoryLayer,
    readout: Readout,
    output: Vec<f64>,
    state: MemoryState,
    u: Vec<Row>,
    z: Vec<Row>,
    h: Vec<Row>,
}

impl Simulator {
    /// The memory.
    pub fn state(&self) -> &MemoryState {
        &self.state
    }

    /// Puts a memory in place, one taken from a simulator of the same network.
    pub fn set_state(&mut self, state: MemoryState) {
        self.state = state;
    }

    /// Back to the virgin state.
    pub fn reset(&mut self) {
        self.state = self.memory.virgin();
    }

    /// Runs on from the present state: `u` has one slice for each channel (first input, its rate if
    /// the network has one, further inputs; all scaled), `steps` the time step before each row (may
    /// be empty for a network without relaxation neurons), `y` takes the scaled output.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn run(&mut self, u: &[&[f64]], steps: &[f64], y: &mut [f64]) {
        assert_eq!(u.len(), self.u.len(), "one slice for each channel");
        assert!(u.iter().all(|u| u.len() == y.len()), "as many inputs as outputs");
        assert!(steps.len() == y.len() || steps.is_empty(), "as many time steps as outputs");
        simd::run(Run { simulator: self, u, steps, y });
    }

    /// One sample: [`Simulator::run`] with one row.
    pub fn step(&mut self, u: &[f64], step: f64) -> f64 {
        let mut y = [0.0];
        assert_eq!(u.len(), self.u.len(), "one value for each channel");
        simd::run(Step { simulator: self, u, step, y: &mut y[0] });
        y[0]
    }

    #[inline(always)]
    fn block<S: Simd>(&mut self, simd: S, steps: &Row, rows: usize, y: &mut Row) {
        self.memory.forward(simd, &mut self.state, &self.u, steps, rows, &mut self.z);
        self.readout.tanh_layer(simd, &self.z, rows, &mut self.h);
        self.readout.output::<S>(&self.output, &self.z, &self.h, rows, y);
    }
}

/// A scaled input as the network takes it.
#[inline(always)]
fn limited(u: f64) -> f64 {
    let low = if u > -LARGEST_SCALED { u } else { -LARGEST_SCALED };
    if low < LARGEST_SCALED { low } else { LARGEST_SCALED }
}

struct Run<'a> {
    simulator: &'a mut Simulator,
    u: &'a [&'a [f64]],
    steps: &'a [f64],
    y: &'a mut [f64],
}

impl WithSimd for Run<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let mut steps = Row([0.0; BLOCK]);
        let mut output = Row([0.0; BLOCK]);
        for (index, y) in self.y.chunks_mut(BLOCK).enumerate() {
            let (start, rows) = (index * BLOCK, y.len());
            for (block, u) in self.simulator.u.iter_mut().zip(self.u) {
                for (block, &u) in block.iter_mut().zip(&u[start..start + rows]) {
                    *block = limited(u);
                }
            }
            if !self.steps.is_empty() {
                steps[..rows].copy_from_slice(&self.steps[start..start + rows]);
            }
            self.simulator.block(simd, &steps, rows, &mut output);
            y.copy_from_slice(&output[..rows]);
        }
    }
}

struct Step<'a> {
    simulator: &'a mut Simulator,
    u: &'a [f64],
    step: f64,
    y: &'a mut f64,
}

impl WithSimd for Step<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for (block, &u) in self.simulator.u.iter_mut().zip(self.u) {
            block[0] = limited(u);
        }
        let mut steps = Row([0.0; BLOCK]);
        steps[0] = self.step;
        let mut output = Row([0.0; BLOCK]);
        self.simulator.block(simd, &steps, 1, &mut output);
        *self.y = output[0];
    }
}

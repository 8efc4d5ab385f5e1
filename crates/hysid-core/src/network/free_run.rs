//! Free run of a network over records in the user's units: from the virgin state, and without the measured
//! output.

use crate::data::rate::RateMethod;
use crate::data::record::Excitation;
use crate::error::{DataProblem, Result};
use crate::network::scaling::Scaling;
use crate::network::{Network, Simulator};

/// Rows scaled at a time: they stay in the first-level cache.
pub(crate) const CHUNK: usize = 1024;

/// A network with its memory, its scaling and the method of its rate.
#[derive(Debug, Clone)]
pub struct FreeRun<'a> {
    network: &'a Network,
    simulator: Simulator,
    scaling: &'a Scaling,
    rate: Option<RateMethod>,
    /// Scaled inputs of a chunk.
    channels: Vec<Vec<f64>>,
}

impl<'a> FreeRun<'a> {
    /// A run from the virgin state, with this method of the rate; `None` for a network without rate.
    pub fn new(network: &'a Network, scaling: &'a Scaling, rate: Option<RateMethod>) -> Self {
        let channels = vec![Vec::new(); network.architecture().channels()];
        Self { network, simulator: network.simulator(), scaling, rate, channels }
    }

    /// Number of inputs of a record.
    pub fn inputs(&self) -> usize {
        self.scaling.inputs.len()
    }

    /// Returns to the virgin state.
    pub fn reset(&mut self) {
        self.simulator.reset();
    }

    /// Drives the memory along a lead-in of the first input, with further inputs as at the first row.
    pub fn lead_in(&mut self, first: &[f64], others: &[f64]) {
        self.channels.iter_mut().for_each(|channel| channel.resize(first.len(), 0.0));
        self.scaling.fill_lead_in(first, others, &mut self.channels);
        let u: Vec<&[f64]> = self.channels.iter().map(Vec::as_slice).collect();
        let steps = vec![f64::INFINITY; first.len()];
        self.simulator.run(&u, &steps, &mut vec![0.0; first.len()]);
    }

    /// Simulates the rows of the excitation from `first` on, with the time step before each.
    pub fn rows(
        &mut self,
        excitation: &Excitation<'_>,
        first: usize,
        steps: &[f64],
        y: &mut [f64],
    ) -> Result<()> {
        self.channels.iter_mut().for_each(|channel| channel.resize(y.len(), 0.0));
        self.scaling.fill_channels(excitation, self.rate, first, y.len(), &mut self.channels)?;
        let u: Vec<&[f64]> = self.channels.iter().map(Vec::as_slice).collect();
        self.simulator.run(&u, steps, y);
        y.iter_mut().for_each(|y| *y = self.scaling.output(*y));
        Ok(())
    }

    /// The output of each row, in the user's unit; from the virgin state if the excitation has no lead-in.
    ///
    /// # Errors
    /// A rate that cannot be computed.
    pub fn response(&mut self, excitation: &Excitation<'_>) -> Result<Vec<f64>> {
        let (expected, found) = (self.inputs(), excitation.inputs().len());
        if expected != found {
            return Err(excitation.defect(None, None, DataProblem::Inputs { expected, found }));
        }
        let mut y = vec![0.0; excitation.len()];
        let mut steps = if self.network.architecture().relaxation > 0 { vec![0.0; CHUNK] } else { vec![] };
        self.reset();
        let lead_in = excitation.lead_in_rows();
        if !lead_in.is_empty() {
            self.lead_in(&lead_in, &excitation.others_at_first_row());
        }
        for (index, y) in y.chunks_mut(CHUNK).enumerate() {
            let first = index * CHUNK;
            let steps_here = y.len().min(steps.len());
            Scaling::fill_steps(excitation, first, &mut steps[..steps_here]);
            self.rows(excitation, first, &steps[..steps_here], y)?;
        }
        Ok(y)
    }
}

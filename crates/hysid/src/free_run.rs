//! A network run over records in the user's units, from the virgin state and without ever looking at
//! the measured output.

use crate::error::{Channel, DataProblem, Result};
use crate::metrics::{ErrorSums, Errors};
use crate::network::{Network, Simulator};
use crate::rate::RateMethod;
use crate::record::{Dataset, Excitation};
use crate::scaling::Scaling;

/// Rows scaled at a time: they stay in the first-level cache.
const CHUNK: usize = 1024;

/// A network with what it takes to run it over a record.
pub(crate) struct FreeRun<'a> {
    network: &'a Network,
    simulator: Simulator,
    scaling: &'a Scaling,
    rate: Option<RateMethod>,
}

impl<'a> FreeRun<'a> {
    pub fn new(network: &'a Network, scaling: &'a Scaling, rate: Option<RateMethod>) -> Self {
        Self { network, simulator: network.simulator(), scaling, rate }
    }

    /// The output of each row, in the user's unit.
    pub fn response(&mut self, excitation: &Excitation<'_>) -> Result<Vec<f64>> {
        let (expected, found) = (self.scaling.inputs.len(), excitation.inputs().len());
        if expected != found {
            return Err(excitation.defect(None, None, DataProblem::Inputs { expected, found }));
        }
        let mut y = vec![0.0; excitation.len()];
        let mut channels = vec![[0.0; CHUNK]; self.network.architecture().channels()];
        let mut steps = [0.0; CHUNK];
        self.simulator.reset();
        for (index, y) in y.chunks_mut(CHUNK).enumerate() {
            let first = index * CHUNK;
            let rows = y.len();
            self.scaling.fill_channels(excitation, self.rate, first, rows, &mut channels)?;
            let u: Vec<&[f64]> = channels.iter().map(|channel| &channel[..rows]).collect();
            if self.network.architecture().relaxation > 0 {
                Scaling::fill_steps(excitation, first, &mut steps[..rows]);
            }
            self.simulator.run(&u, &steps[..rows], y);
            y.iter_mut().for_each(|y| *y = self.scaling.output(*y));
        }
        Ok(y)
    }

    /// Errors over all records that have an output.
    pub fn errors(&mut self, data: &Dataset) -> Result<Errors> {
        let mut sums = ErrorSums::default();
        for record in data.records().iter().filter(|record| record.scored() > 0) {
            sums.add(record.output(), &self.response(&record.excitation())?);
        }
        sums.errors(&data.names().output)
            .ok_or_else(|| data.records()[0].defect(None, Some(Channel::Output), DataProblem::NothingToScore))
    }
}

//! A network run over records in the user's units, from the virgin state and without ever looking at
//! the measured output.

use crate::error::{Channel, DataProblem, Result};
use crate::metrics::{ErrorSums, Errors};
use crate::network::{Network, Simulator};
use crate::rate::RateMethod;
use crate::record::{Dataset, Record};
use crate::scaling::Scaling;

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
    pub fn record(&mut self, record: &Record) -> Result<Vec<f64>> {
        let (expected, found) = (self.scaling.inputs.len(), record.inputs().len());
        if expected != found {
            return Err(record.defect(None, None, DataProblem::Inputs { expected, found }));
        }
        let architecture = self.network.architecture();
        let drive = self.scaling.drive(record, architecture, self.rate)?;
        let u: Vec<&[f64]> = drive.channels.iter().map(Vec::as_slice).collect();
        let mut y = vec![0.0; record.len()];
        self.simulator.reset();
        self.simulator.run(&u, &drive.steps, &mut y);
        y.iter_mut().for_each(|y| *y = self.scaling.output(*y));
        Ok(y)
    }

    /// Errors over all records that have an output.
    pub fn errors(&mut self, data: &Dataset) -> Result<Errors> {
        let mut sums = ErrorSums::default();
        for record in data.records().iter().filter(|record| record.scored() > 0) {
            sums.add(record.output(), &self.record(record)?);
        }
        sums.errors(&data.names().output)
            .ok_or_else(|| data.records()[0].defect(None, Some(Channel::Output), DataProblem::NothingToScore))
    }
}

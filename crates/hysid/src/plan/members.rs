//! The members of an ensemble along a drive: where they disagree, the data have not decided.

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::model::{Model, Snapshot, Stepper};

/// A model at a moment of a drive.
#[derive(Clone)]
pub(super) struct Members<'m> {
    stepper: Stepper<'m>,
    at: Snapshot,
    time_step: f64,
    row: usize,
}

/// Rows of the data that the disagreement along them is computed on, at most.
const MOST_ROWS: usize = 20_000;

impl<'m> Members<'m> {
    /// At the beginning of a drive from `start`.
    ///
    /// # Errors
    /// A model that is no ensemble, takes several inputs, or needs time where there is none.
    pub fn new(model: &'m Model, start: f64, step: Option<f64>) -> Result<Self> {
        if model.ensemble().is_none() {
            let problem = "this model is no ensemble: its members cannot disagree (fit one with `auto`)";
            return Err(Error::Parts(problem.into()));
        }
        let inputs = model.names().inputs.len();
        if inputs > 1 {
            return Err(Error::Parts(format!("this model has {inputs} inputs: a plan drives one")));
        }
        if model.needs_time() && step.is_none() {
            return Err(Error::Parts("this model needs time, and the data have none".into()));
        }
        let mut stepper = model.stepper();
        stepper.step(&[start], 0.0, None)?;
        Ok(Self { at: stepper.snapshot(), stepper, time_step: step.unwrap_or(1.0), row: 0 })
    }

    /// The disagreement at inputs that follow, each so many rows from where the drive is.
    pub fn along(&mut self, inputs: &[f64], offsets: &[usize]) -> Result<Vec<f64>> {
        self.stepper.restore(&self.at);
        let mut all = Vec::with_capacity(inputs.len());
        for (&x, offset) in inputs.iter().zip(offsets) {
            self.stepper.step(&[x], (self.row + offset) as f64 * self.time_step, None)?;
            all.push(self.stepper.disagreement());
        }
        Ok(all)
    }

    /// The disagreement at all rows that follow; the drive goes on behind them.
    pub fn advance(&mut self, rows: &[f64]) -> Result<Vec<f64>> {
        let offsets: Vec<usize> = (1..=rows.len()).collect();
        let disagreement = self.along(rows, &offsets)?;
        self.at = self.stepper.snapshot();
        self.row += rows.len();
        Ok(disagreement)
    }
}

/// Root mean square of the disagreement along the test that the data are of.
pub(super) fn along_data(model: &Model, data: &Dataset) -> Result<f64> {
    let (mut squares, mut rows) = (0.0, 0);
    for record in data.records() {
        let mut stepper = model.stepper();
        for (row, &x) in record.inputs()[0].iter().enumerate().take(MOST_ROWS - rows) {
            stepper.step(&[x], record.time().map_or(row as f64, |time| time[row]), None)?;
            squares += stepper.disagreement().powi(2);
            rows += 1;
        }
    }
    Ok((squares / rows.max(1) as f64).sqrt())
}

//! A model driven by hand: a path of inputs, from rest.

use hysid::data::rate::RateMethod;
use hysid::data::record::Excitation;
use hysid::model::{Model, Prediction};
use hysid_app::BAND;
use hysid_document::{Result, problem};

/// Longest path.
pub const MOST_ROWS: usize = 20_000;

/// A path of inputs, with time if the model needs it.
pub struct Path {
    time: Option<Vec<f64>>,
    inputs: Vec<Vec<f64>>,
}

impl Path {
    /// Takes columns one after the other: time, if the model needs it, and its inputs.
    pub fn of(model: &Model, values: &[f64], rows: usize) -> Result<Self> {
        let needs_time = needs_time(model);
        let columns = model.names().inputs.len() + usize::from(needs_time);
        if rows == 0 || rows > MOST_ROWS {
            return Err(problem!("the input must have 1 to {MOST_ROWS} rows, not {rows}"));
        }
        if values.len() != columns * rows {
            return Err(problem!(
                "{columns} columns of {rows} rows are needed, not {} numbers",
                values.len()
            ));
        }
        let mut columns = values.chunks_exact(rows).map(<[f64]>::to_vec);
        let time = if needs_time { columns.next() } else { None };
        Ok(Self { time, inputs: columns.collect() })
    }

    /// Simulates a model over the drive: outputs, and the edges of the band if there is one.
    pub fn run(&self, model: &Model) -> Result<Prediction> {
        if model.rate() == Some(RateMethod::Given) {
            return Err(problem!("this model needs a measured rate; it cannot be simulated here"));
        }
        let inputs = self.inputs.iter().map(Vec::as_slice).collect();
        let mut excitation = Excitation::new("path", inputs)?;
        if let Some(time) = &self.time {
            excitation = excitation.with_time(time)?;
        }
        Ok(match model.band() {
            Some(_) => model.predict(&excitation, BAND)?,
            None => Prediction { output: model.response(&excitation)?, ..Prediction::default() },
        })
    }
}

/// True if a model depends on time: it has a rate or relaxes.
pub fn needs_time(model: &Model) -> bool {
    model.needs_time() || model.rate().is_some()
}

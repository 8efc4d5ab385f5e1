//! Inputs and rates outside the range of the training data.

use crate::data::warning::Warning;
use crate::model::Model;

/// Trained ranges, and the ranges of the rows so far.
#[derive(Debug, Clone)]
pub(super) struct Ranges {
    inputs: Vec<InputReach>,
    rate: Option<InputReach>,
}

#[derive(Debug, Clone)]
struct InputReach {
    name: String,
    trained: (f64, f64),
    seen: (f64, f64),
    rows: usize,
    outside: usize,
}

/// A rounding beyond a range, as a share of it, is not outside it.
const SLACK: f64 = 1e-9;

/// A range with the room that roundings need.
pub(super) fn with_slack((low, high): (f64, f64)) -> (f64, f64) {
    let slack = SLACK * (high - low);
    (low - slack, high + slack)
}

impl Ranges {
    pub fn of(model: &Model) -> Self {
        let inputs = model.names.inputs.iter().zip(&model.trained.inputs);
        let rate = model.rate.and(model.trained.rate);
        let rate =
            rate.map(|trained| InputReach::new(format!("the rate of {}", model.names.inputs[0]), trained));
        Self { inputs: inputs.map(|(name, &trained)| InputReach::new(name.clone(), trained)).collect(), rate }
    }

    /// Takes rows: all inputs, and the rate of the first.
    pub fn take(&mut self, inputs: &[&[f64]], rate: Option<&[f64]>) {
        self.inputs.iter_mut().zip(inputs).for_each(|(reach, values)| reach.take(values));
        if let Some((reach, values)) = self.rate.as_mut().zip(rate) {
            reach.take(values);
        }
    }

    /// Warns of what is outside.
    pub fn warnings(&self) -> Vec<Warning> {
        self.inputs.iter().chain(&self.rate).filter_map(InputReach::warning).collect()
    }
}

impl InputReach {
    fn new(name: String, trained: (f64, f64)) -> Self {
        Self { name, trained, seen: (f64::INFINITY, f64::NEG_INFINITY), rows: 0, outside: 0 }
    }

    fn take(&mut self, values: &[f64]) {
        let (low, high) = with_slack(self.trained);
        self.rows += values.len();
        self.outside += values.iter().filter(|&&value| value < low || value > high).count();
        self.seen = values.iter().fold(self.seen, |(low, high), &value| (low.min(value), high.max(value)));
    }

    fn warning(&self) -> Option<Warning> {
        let share_percent = 100.0 * self.outside as f64 / self.rows as f64;
        let (name, trained, seen) = (self.name.clone(), self.trained, self.seen);
        (self.outside > 0).then_some(Warning::OutsideTrainedRange { name, share_percent, trained, seen })
    }
}

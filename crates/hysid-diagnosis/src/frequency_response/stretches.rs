//! The rows that responses are estimated from: the beginnings of the records, because a model runs from there.

use hysid_core::data::record::Dataset;

use super::NoResponse;
use crate::resonance::{JITTER, even_step};

/// Rows of all stretches together, at most: a model is simulated over them once for each amplitude.
const MOST_ROWS: usize = 131_072;

/// Rows of a stretch, at least.
pub(super) const FEWEST_ROWS: usize = 64;

/// The first rows of a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stretch {
    pub record: usize,
    pub rows: usize,
}

/// The stretches of data, and the time between their rows. Shorter records are left out.
pub(super) fn stretches(data: &Dataset) -> Result<(Vec<Stretch>, f64), NoResponse> {
    if data.names().inputs.len() != 1 {
        return Err(NoResponse::SeveralInputs);
    }
    let share = (MOST_ROWS as f64 / data.rows() as f64).min(1.0);
    let mut found = Vec::new();
    let mut first_step = None;
    for (number, record) in data.records().iter().enumerate() {
        let rows = (share * record.len() as f64) as usize;
        if rows < FEWEST_ROWS {
            continue;
        }
        let time = record.time().ok_or(NoResponse::NoTime)?;
        let step = even_step(&time[..rows]).ok_or_else(|| NoResponse::UnevenTime(record.name().into()))?;
        let first = *first_step.get_or_insert(step);
        if (step - first).abs() > JITTER * first {
            return Err(NoResponse::OtherStep(record.name().into()));
        }
        found.push(Stretch { record: number, rows });
    }
    Ok((found, first_step.ok_or(NoResponse::TooFewRows)?))
}

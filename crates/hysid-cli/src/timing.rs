//! How long a model takes, measured.

use std::hint::black_box;
use std::time::{Duration, Instant};

use hysid::model::Model;
use hysid::record::{Excitation, Record};

/// Rows of a record that are run at most: what a long one costs, its beginning tells.
const MOST_ROWS: usize = 10_000;

/// Nanoseconds for a sample of a free run on one thread, over runs that take at least this time.
pub fn ns_per_sample(model: &Model, records: &[Record], at_least: Duration) -> hysid::Result<f64> {
    let excitations: Vec<Excitation> = records.iter().map(beginning).collect::<hysid::Result<_>>()?;
    let began = Instant::now();
    let mut samples = 0usize;
    for excitation in excitations.iter().cycle() {
        black_box(model.response(black_box(excitation))?);
        samples += excitation.len();
        if began.elapsed() >= at_least {
            break;
        }
    }
    Ok(1e9 * began.elapsed().as_secs_f64() / samples.max(1) as f64)
}

fn beginning(record: &Record) -> hysid::Result<Excitation<'_>> {
    let rows = record.len().min(MOST_ROWS);
    let inputs = record.inputs().iter().map(|input| &input[..rows]).collect();
    let mut excitation = Excitation::new(record.name(), inputs)?;
    if let Some(time) = record.time() {
        excitation = excitation.with_time(&time[..rows])?;
    }
    match record.given_rate() {
        Some(rate) => excitation.with_given_rate(&rate[..rows]),
        None => Ok(excitation),
    }
}

//! How long a model takes, measured.

use std::hint::black_box;
use std::time::{Duration, Instant};

use hysid::data::record::{Excitation, Record};
use hysid::model::Model;

/// Rows that are run at most, of all records together.
const MOST_ROWS: usize = 2_000;

/// Runs over all records of which the quickest counts, at least: what else the machine does only
/// adds to a run.
const FEWEST_RUNS: usize = 3;

/// Nanoseconds for a sample of a free run on one thread: the quickest of several runs over all records, which
/// together take at least this time.
pub fn ns_per_sample(model: &Model, records: &[Record], at_least: Duration) -> hysid::Result<f64> {
    let mut left = MOST_ROWS;
    let mut excitations = Vec::new();
    for record in records {
        if left == 0 {
            break;
        }
        excitations.push(beginning(record, left)?);
        left -= record.len().min(left);
    }
    let samples: usize = excitations.iter().map(Excitation::len).sum();
    let began = Instant::now();
    let mut quickest = Duration::MAX;
    let mut runs = 0;
    while runs < FEWEST_RUNS || began.elapsed() < at_least {
        let run = Instant::now();
        for excitation in &excitations {
            black_box(model.response(black_box(excitation))?);
        }
        quickest = quickest.min(run.elapsed());
        runs += 1;
    }
    Ok(1e9 * quickest.as_secs_f64() / samples.max(1) as f64)
}

fn beginning(record: &Record, most_rows: usize) -> hysid::Result<Excitation<'_>> {
    let rows = record.len().min(most_rows);
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

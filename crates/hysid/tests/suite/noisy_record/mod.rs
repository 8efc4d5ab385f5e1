//! A record with an error that no model can represent, so that several candidates of `auto` count.

use hysid::data::record::Record;
use hysid_core::elementary::sin;

use crate::small_models::record;

/// As [`record`], with an error of up to 0.1, some percent of the range of its output.
pub fn noisy(rows: usize, name: &str) -> Record {
    let exact = record(rows, name);
    let error = |row: usize| 0.1 * sin((row * row) as f64);
    let output = exact.output().iter().enumerate().map(|(row, y)| y + error(row)).collect();
    exact.with_output(output).unwrap()
}

/// The same with a wave over the input, which no law of few numbers has.
pub fn waved(rows: usize, name: &str) -> Record {
    let noisy = noisy(rows, name);
    let rows = noisy.inputs()[0].iter().zip(noisy.output());
    let output = rows.map(|(x, y)| y + sin(9.0 * x)).collect();
    noisy.clone().with_output(output).unwrap()
}

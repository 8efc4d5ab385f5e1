//! Which column is the input: the error on unseen data of the same records with input and output exchanged, with the
//! input in another unit, and with a command in place of the measured input.

use anyhow::Result;
use hysid::data::record::{Dataset, Record};

use super::{auto, by_specimen};
use crate::cases::{aligned, row};
use crate::rig::{Rig, error_of};

const SPECIMENS: [&str; 6] = [
    "timber-growing",
    "squat-wall-repeated",
    "structural-steel-growing",
    "thin-sheet-loops",
    "stack-reversals",
    "sma-actuator-reversals",
];
const SEEDS: u64 = 2;
const ROWS: usize = 700;

/// Deformation of the machine at the largest output, as a share of the range of the input.
const COMPLIANCE: f64 = 0.1;

/// Height by which a displacement is divided to give a drift.
const HEIGHT: f64 = 3000.0;

type Change = fn(&Dataset) -> Result<Dataset>;

const COLUMNS: [(&str, Change); 4] = [
    ("output over input", |data| Ok(data.clone())),
    ("input / 3000", |data| with_input(data, |x, _| x / HEIGHT)),
    ("command", |data| {
        let (low, high) = data.input_range(0);
        let (least, most) = data.output_range();
        let flexibility = COMPLIANCE * (high - low) / least.abs().max(most.abs());
        with_input(data, |x, y| x + flexibility * y)
    }),
    ("input over output", |data| Ok(data.exchanged()?)),
];

/// A row for each specimen.
pub fn table() -> Result<String> {
    let mut rows = vec![row("specimen", &COLUMNS.map(|(name, _)| name))];
    rows.extend(by_specimen::rows(&SPECIMENS, SEEDS, "", errors)?);
    Ok(aligned(&rows))
}

/// The unseen errors after a fit to each choice of columns.
fn errors(name: &str, seed: u64) -> Result<[f64; 4]> {
    let rig = Rig::new(name, seed, ROWS)?;
    let (train, unseen) = (rig.training(ROWS, seed)?, rig.unseen(seed)?);
    let mut errors = [0.0; 4];
    for (error, (_, change)) in errors.iter_mut().zip(COLUMNS) {
        *error = error_of(&auto(&change(&train)?, seed)?, &change(&unseen)?)?;
    }
    Ok(errors)
}

/// The data with another input, from input and output.
fn with_input(data: &Dataset, of: impl Fn(f64, f64) -> f64) -> Result<Dataset> {
    let changed = data.records().iter().map(|record| {
        let input = record.inputs()[0].iter().zip(record.output()).map(|(x, y)| of(*x, *y)).collect();
        Record::new(record.name(), vec![input], record.output().to_vec())
    });
    Ok(Dataset::new(data.names().clone(), changed.collect::<hysid::Result<_>>()?)?)
}

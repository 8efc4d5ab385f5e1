//! How many cycles does a fit need: the error on unseen data over the number of cycles of training data.

use anyhow::Result;

use super::{auto, by_specimen};
use crate::cases::{aligned, row};
use crate::rig::{Rig, drives, error_of};

const SPECIMENS: [&str; 3] = ["timber-growing", "structural-steel-growing", "stack-reversals"];
const SEEDS: u64 = 2;

/// Numbers of cycles of growing amplitude.
const COUNTS: [usize; 5] = [1, 2, 4, 8, 16];

/// Most cycles of one amplitude.
const REPEATED: usize = 8;

const COLUMNS: [&str; 7] = ["1", "2", "4", "8", "16", "8 of one amplitude", "random, rows of 8"];

/// A row for each specimen.
pub fn table() -> Result<String> {
    let mut rows = vec![row("specimen", &COLUMNS)];
    rows.extend(by_specimen::rows(&SPECIMENS, SEEDS, "", errors)?);
    Ok(aligned(&rows))
}

/// The unseen errors after each of the tests.
fn errors(name: &str, seed: u64) -> Result<[f64; 7]> {
    let rig = Rig::new(name, seed, usize::MAX)?;
    let unseen = rig.unseen(seed)?;
    let after = |drive: &[f64], noise: u64| -> Result<f64> {
        let data = rig.data([rig.measured("test", drive, noise)?])?;
        error_of(&auto(&data, seed)?, &unseen)
    };
    let growing =
        |cycles: usize| drives::cycles(&rig.path, (1..=cycles).map(|cycle| cycle as f64 / cycles as f64));
    let mut errors = [0.0; 7];
    for (error, cycles) in errors.iter_mut().zip(COUNTS) {
        *error = after(&growing(cycles), 10 * seed + cycles as u64)?;
    }
    errors[5] = after(&drives::cycles(&rig.path, [1.0; REPEATED]), 10 * seed + 1000)?;
    let rows = growing(REPEATED).len();
    errors[6] = after(&drives::random(&rig.path, rows, 1000 * seed + 500), 10 * seed + 2000)?;
    Ok(errors)
}

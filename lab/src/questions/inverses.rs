//! How to invert: the deviation of driven specimens from a wanted output, by the data that the model was fitted to.

use anyhow::Result;
use hysid::model::Reference;
use hysid::plan::DrivePath;
use hysid::{Model, Record};
use hysid_core::elementary::square;

use super::{auto, by_specimen};
use crate::cases::{aligned, row};
use crate::rig::{Rig, drives};

const SPECIMENS: [&str; 4] =
    ["stack-reversals", "sma-actuator-reversals", "creeping-piezo-frequencies", "rate-actuator-frequencies"];
const SEEDS: u64 = 2;
const ROWS: usize = 1000;

/// Cycles over the whole range, as many rows together.
const CYCLES: usize = 10;

/// Share of the range that the wanted outputs cover.
const WANTED: f64 = 0.8;

const COLUMNS: [&str; 3] = ["straight line", "fitted to one loop", "fitted to random reversals"];

/// A row for each specimen.
pub fn table() -> Result<String> {
    let mut rows = vec![row("deviation, % of the range", &COLUMNS)];
    rows.extend(by_specimen::rows(&SPECIMENS, SEEDS, "", deviations)?);
    Ok(aligned(&rows))
}

fn deviations(name: &str, seed: u64) -> Result<[f64; 3]> {
    let rig = Rig::new(name, seed, ROWS)?;
    // A response of the specimen itself, so that it can be reached.
    let wanted_path = drives::random(&drives::within(&rig.path, WANTED), ROWS, 1000 * seed + 900);
    let wanted = rig.run("wanted", &wanted_path)?;
    let one_loop = rig.measured("loop", &drives::cycles(&rig.path, [1.0; CYCLES]), seed)?;
    let reversals = rig.measured("reversals", &drives::random(&rig.path, ROWS, 1000 * seed + 500), seed)?;
    let of_line = drive_of_line(&one_loop, &rig.path, wanted.output());
    let of_loop = drive_of_model(&auto(&rig.data([one_loop.clone()])?, seed)?, &wanted)?;
    let of_reversals = drive_of_model(&auto(&rig.data([reversals])?, seed)?, &wanted)?;
    let (low, high) = rig.data([one_loop])?.output_range();
    let mut deviations = [0.0; 3];
    for (deviation, drive) in deviations.iter_mut().zip([of_line, of_loop, of_reversals]) {
        let reached = rig.run("driven", &drive)?;
        let squares = reached.output().iter().zip(wanted.output()).map(|(y, wanted)| square(y - wanted));
        *deviation = 100.0 * (squares.sum::<f64>() / ROWS as f64).sqrt() / (high - low);
    }
    Ok(deviations)
}

/// The input of the least-squares line of the output by the input, within the range.
fn drive_of_line(record: &Record, path: &DrivePath, wanted: &[f64]) -> Vec<f64> {
    let (x, y) = (&record.inputs()[0], record.output());
    let rows = x.len() as f64;
    let (mean_x, mean_y) = (x.iter().sum::<f64>() / rows, y.iter().sum::<f64>() / rows);
    let slope = x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum::<f64>()
        / x.iter().map(|x| square(x - mean_x)).sum::<f64>();
    let (low, high) = path.limits.range;
    wanted.iter().map(|wanted| (mean_x + (wanted - mean_y) / slope).clamp(low, high)).collect()
}

/// The input that drives the model along the wanted outputs.
fn drive_of_model(model: &Model, wanted: &Record) -> Result<Vec<f64>> {
    let reference = Reference { wanted: wanted.output(), others: &[], time: wanted.time() };
    let inverse = model.inverse();
    let preview = inverse.best_preview(&reference)?;
    Ok(inverse.preview(preview)?.run(&reference)?.input)
}

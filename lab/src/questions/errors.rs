//! What the error means: training, validation and unseen error, and the share of rows in the band.

use anyhow::Result;

use super::{auto, percent_in_band, validation_error};
use crate::cases::{aligned, row};
use crate::rig::{Rig, drives, error_of};
use crate::statistics::{geometric_mean, median, shown};

const SPECIMENS: [&str; 6] = [
    "timber-growing",
    "squat-wall-repeated",
    "structural-steel-growing",
    "thin-sheet-loops",
    "stack-reversals",
    "damper-random",
];
const SEEDS: u64 = 2;

/// Cycles of growing amplitude, or random reversals of as many rows.
const CYCLES: usize = 8;

/// A row for each specimen and kind of training data; unseen data are random reversals.
pub fn table() -> Result<String> {
    let columns =
        ["training, %", "validation, %", "unseen, %", "unseen / validation", "rows in the 90 % band, %"];
    let mut rows = vec![row("specimen, training data", &columns)];
    for data in ["growing cycles", "random reversals"] {
        let mut all: [Vec<f64>; 4] = Default::default();
        for name in SPECIMENS {
            let mut of_specimen: [Vec<f64>; 4] = Default::default();
            for seed in 1..=SEEDS {
                for (column, figure) in of_specimen.iter_mut().zip(figures(name, data, seed)?) {
                    column.push(figure);
                }
            }
            rows.push(row(&format!("{name}, {data}"), &cells(&of_specimen)));
            for (column, figures) in all.iter_mut().zip(of_specimen) {
                column.extend(figures);
            }
        }
        rows.push(row(&format!("all, {data}"), &cells(&all)));
    }
    Ok(aligned(&rows))
}

/// Training, validation and unseen error, and the share of unseen rows in the band in percent.
fn figures(name: &str, data: &str, seed: u64) -> Result<[f64; 4]> {
    let rig = Rig::new(name, seed, usize::MAX)?;
    let growing = drives::cycles(&rig.path, (1..=CYCLES).map(|cycle| cycle as f64 / CYCLES as f64));
    let drive = match data {
        "growing cycles" => growing,
        _ => drives::random(&rig.path, growing.len(), 1000 * seed + 500),
    };
    let train = rig.data([rig.measured("test", &drive, seed)?])?;
    let model = auto(&train, seed)?;
    let unseen = rig.unseen(seed)?;
    Ok([
        error_of(&model, &train)?,
        validation_error(&model)?,
        error_of(&model, &unseen)?,
        percent_in_band(&model, &unseen)?,
    ])
}

/// Geometric means of the errors and of their ratio, the median of the shares.
fn cells([training, validation, unseen, in_band]: &[Vec<f64>; 4]) -> [String; 5] {
    let means = [training, validation, unseen].map(|errors| geometric_mean(errors));
    let [training, validation, unseen] = means;
    [training, validation, unseen, unseen / validation]
        .map(shown)
        .into_iter()
        .chain([format!("{:.0}", median(in_band))])
        .collect::<Vec<_>>()
        .try_into()
        .expect("four means and a median")
}

//! Outside the trained range: the error over the amplitude beyond that of the training data.

use anyhow::Result;

use super::{fit, percent_in_band};
use crate::cases::{aligned, row};
use crate::rig::{Rig, drives, error_of};
use crate::statistics::{geometric_mean, median, shown};

const SPECIMENS: [&str; 4] =
    ["timber-growing", "structural-steel-growing", "thin-sheet-loops", "stack-reversals"];
const SEEDS: u64 = 2;
const ROWS: usize = 700;

/// Trained share of the range on each side of the start.
const TRAINED: f64 = 0.5;

/// Range of the unseen tests as multiples of the trained one.
const MULTIPLES: [f64; 5] = [1.0, 1.1, 1.25, 1.5, 2.0];

const MODELS: [&str; 5] = ["auto", "xpnn+", "preisach", "prandtl-ishlinskii", "bouc-wen"];

/// A row for each model, and one for the band of `auto`.
pub fn table() -> Result<String> {
    let mut rows =
        vec![row("unseen error, %, at a range of", &MULTIPLES.map(|times| format!("{times} x trained")))];
    let mut in_band: [Vec<f64>; 5] = Default::default();
    for name in MODELS {
        let mut errors: [Vec<f64>; 5] = Default::default();
        for specimen in SPECIMENS {
            for seed in 1..=SEEDS {
                let rig = Rig::new(specimen, seed, ROWS)?;
                let narrow = drives::within(&rig.path, TRAINED);
                let train = rig.measured("test", &drives::random(&narrow, ROWS, 1000 * seed + 500), seed)?;
                let model = fit(name, &rig.data([train])?, seed)?;
                for (index, times) in MULTIPLES.into_iter().enumerate() {
                    let wide = drives::within(&rig.path, times * TRAINED);
                    let drive = drives::random(&wide, ROWS, 1000 * seed + 900);
                    let unseen = rig.data([rig.run("unseen", &drive)?])?;
                    errors[index].push(error_of(&model, &unseen)?);
                    if name == "auto" {
                        in_band[index].push(percent_in_band(&model, &unseen)?);
                    }
                }
            }
        }
        rows.push(row(name, &errors.map(|errors| shown(geometric_mean(&errors)))));
    }
    let cells = in_band.map(|shares| format!("{:.0}", median(&shares)));
    rows.push(row("rows in the 90 % band of auto, %", &cells));
    Ok(aligned(&rows))
}

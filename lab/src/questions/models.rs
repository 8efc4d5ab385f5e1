//! Which model first: error on unseen data, size and time of models that are fitted with their defaults.

use anyhow::Result;

use super::fit;
use super::processor;
use crate::cases::{aligned, row};
use crate::rig::{Rig, drives, error_of};
use crate::statistics::{geometric_mean, largest, median, shown};

const SPECIMENS: [&str; 8] = [
    "timber-growing",
    "squat-wall-repeated",
    "structural-steel-growing",
    "thin-sheet-loops",
    "sma-actuator-reversals",
    "stack-reversals",
    "damper-random",
    "bush-random",
];
const SEED: u64 = 1;
const ROWS: usize = 700;

const MODELS: [&str; 12] = [
    "auto",
    "xpnn+",
    "xpnn",
    "preisach-nn",
    "pnn",
    "random-stops",
    "duhem-nn",
    "preisach",
    "modified-prandtl-ishlinskii",
    "prandtl-ishlinskii",
    "generalized-prandtl-ishlinskii",
    "bouc-wen",
];

/// A row for each model.
pub fn table() -> Result<String> {
    let columns = ["unseen, %", "largest, %", "best of all in", "numbers", "fit, processor s"];
    let rigs: Vec<Rig> = SPECIMENS.iter().map(|name| Rig::new(name, SEED, ROWS)).collect::<Result<_>>()?;
    let mut errors = Vec::new();
    let mut sizes = Vec::new();
    let mut seconds = Vec::new();
    for name in MODELS {
        let (mut of_model, mut parameters, mut time) = (Vec::new(), Vec::new(), Vec::new());
        for rig in &rigs {
            let train = rig.measured("test", &drives::random(&rig.path, ROWS, 500), SEED)?;
            let train = rig.data([train])?;
            let begun = processor::seconds()?;
            let model = fit(name, &train, SEED)?;
            time.push(processor::seconds()? - begun);
            parameters.push(model.parameters() as f64);
            of_model.push(error_of(&model, &rig.unseen(SEED)?)?);
        }
        errors.push(of_model);
        sizes.push(median(&parameters));
        seconds.push(median(&time));
    }
    let mut rows = vec![row("model", &columns)];
    for (index, name) in MODELS.iter().enumerate() {
        let is_best = |specimen: &usize| errors.iter().all(|of| errors[index][*specimen] <= of[*specimen]);
        let best = (0..SPECIMENS.len()).filter(is_best).count();
        let cells = [
            shown(geometric_mean(&errors[index])),
            shown(largest(&errors[index])),
            format!("{best} of {}", SPECIMENS.len()),
            format!("{:.0}", sizes[index]),
            format!("{:.2}", seconds[index]),
        ];
        rows.push(row(name, &cells));
    }
    Ok(aligned(&rows))
}

//! How long a fit takes over the number of rows, and a step of the fitted model.

use std::time::Instant;

use anyhow::Result;
use hysid::Fit;

use crate::cases::{aligned, row};
use crate::rig::{Rig, drives};

/// A specimen with time stamps, so that `auto` tries every candidate.
const SPECIMEN: &str = "damper-random";
const SEED: u64 = 1;
const ROWS: [usize; 4] = [250, 1000, 4000, 16_000];

const MODELS: [&str; 8] = [
    "auto",
    "xpnn+",
    "xpnn",
    "duhem-nn",
    "bouc-wen",
    "rate-dependent-prandtl-ishlinskii",
    "preisach",
    "prandtl-ishlinskii",
];

/// A row for each model, with its defaults.
pub fn table() -> Result<String> {
    let rig = Rig::new(SPECIMEN, SEED, ROWS[ROWS.len() - 1])?;
    let mut columns: Vec<String> = ROWS.iter().map(|rows| format!("{rows} rows, s")).collect();
    columns.push("a row of the model, ns".into());
    let mut lines = vec![row("model", &columns)];
    for name in MODELS {
        let mut cells = Vec::new();
        let mut nanoseconds = f64::NAN;
        for rows in ROWS {
            let record = rig.measured("test", &drives::random(&rig.path, rows, 500), SEED)?;
            let data = rig.data([record])?;
            let begun = Instant::now();
            let model = Fit::new().model(name).seed(SEED).run(&data)?;
            cells.push(format!("{:.2}", begun.elapsed().as_secs_f64()));
            let begun = Instant::now();
            model.simulate(&data.records()[0])?;
            nanoseconds = begun.elapsed().as_secs_f64() * 1e9 / rows as f64;
        }
        cells.push(format!("{nanoseconds:.0}"));
        lines.push(row(name, &cells));
    }
    Ok(aligned(&lines))
}

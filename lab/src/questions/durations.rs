//! How long a fit takes over the number of rows, and a row of the fitted model: processor time of all threads.

use anyhow::Result;
use hysid::Fit;

use super::processor;
use crate::cases::{aligned, row};
use crate::rig::{Rig, drives};

/// A specimen with time stamps, so that `auto` tries every candidate.
const SPECIMEN: &str = "damper-random";
const SEED: u64 = 1;
const ROWS: [usize; 3] = [250, 1000, 4000];

/// Simulations of which the time is taken, because that of one is too short for the clock.
const REPEATED: usize = 100;

const MODELS: [&str; 7] = ["auto", "xpnn+", "xpnn", "duhem-nn", "bouc-wen", "preisach", "prandtl-ishlinskii"];

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
            let begun = processor::seconds()?;
            let model = Fit::new().model(name).seed(SEED).run(&data)?;
            cells.push(format!("{:.2}", processor::seconds()? - begun));
            let begun = processor::seconds()?;
            (0..REPEATED).try_for_each(|_| model.simulate(&data.records()[0]).map(drop))?;
            nanoseconds = (processor::seconds()? - begun) * 1e9 / (REPEATED * rows) as f64;
        }
        cells.push(format!("{nanoseconds:.0}"));
        lines.push(row(name, &cells));
    }
    Ok(aligned(&lines))
}

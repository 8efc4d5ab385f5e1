//! What a table says, against what is true.

use anyhow::Result;
use hysid::data::record::{ColumnNames, Dataset, Record};
use hysid::diagnosis::cycles::{CycleOptions, CycleTable};

use super::protocols::Trial;

/// Relative error of a figure that is right, beside what noise does.
const RIGHT: f64 = 0.01;

/// An energy below this share of the loop's box is none.
const LINE: f64 = 2e-3;

/// Deviations of the noise within which a figure is right.
const IN_NOISE: f64 = 4.5;

/// What is said of a record.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// All cycles and all figures are right.
    Right,
    /// Cycles or figures are missing, and the table says so.
    Said(String),
    /// Something is wrong without a word.
    Wrong(String),
}

/// Judges the table of a trial.
pub fn answer(trial: &Trial) -> Result<Answer> {
    let names = ColumnNames {
        time: None,
        inputs: vec![trial.names[0].into()],
        rate: None,
        output: trial.names[1].into(),
    };
    let record = Record::new("r", vec![trial.x.clone()], trial.y.clone())?;
    let table = CycleTable::of(&Dataset::new(names, vec![record])?, &CycleOptions::default())?;
    let found: Vec<_> = table.complete().collect();
    let hidden = table.notes.iter().any(|note| note.contains("noise"));
    if found.len() != trial.cycles.len() {
        let words = format!("{} cycles of {}", found.len(), trial.cycles.len());
        return Ok(if hidden { Answer::Said(words) } else { Answer::Wrong(words) });
    }
    let mut missing = None;
    for (number, (row, truth)) in found.iter().zip(&trial.cycles).enumerate() {
        let said = !row.notes.is_empty();
        let is_open = row.notes.iter().any(|note| note.contains("open by"));
        let is_coarse = row.notes.iter().any(|note| note.contains("apart"));
        let mut compare = |name: &str, value: Option<f64>, exact: f64, allowed: f64| match value {
            None => {
                missing = Some(format!("cycle {}: no {name}", number + 1));
                said
            }
            Some(value) => (value - exact).abs() <= allowed,
        };
        let noise_of_tip = IN_NOISE * trial.noise.0 / (trial.fewest_rows as f64 / 8.0).max(1.0).sqrt();
        let amplitude =
            compare("amplitude", row.amplitude, truth.amplitude, RIGHT * truth.amplitude + noise_of_tip);
        let deviation = row.energy_deviation.unwrap_or(0.0);
        let energy = compare(
            "energy",
            row.energy,
            truth.energy,
            RIGHT * truth.energy.abs() + IN_NOISE * deviation + LINE * truth.box_area,
        );
        let coercive = match truth.coercive {
            None => true,
            Some(exact) => {
                let noise = trial.noise.0 + trial.noise.1 * exact.abs().max(10.0) / 0.3;
                let rows = (trial.fewest_rows as f64 / 20.0).max(1.0);
                compare(
                    "coercive field",
                    row.coercive_input,
                    exact,
                    RIGHT * exact + IN_NOISE * noise / rows.sqrt(),
                )
            }
        };
        let wrong = [(amplitude, "amplitude"), (energy, "energy"), (coercive, "coercive field")];
        if let Some((_, name)) = wrong.into_iter().find(|(right, _)| !right) {
            let words = format!(
                "cycle {}: {name} ({:?} {:?} ± {:?} {:?}, true {truth:?})",
                number + 1,
                row.amplitude,
                row.energy,
                row.energy_deviation,
                row.coercive_input
            );
            let is_told = hidden || is_open || is_coarse && name == "coercive field";
            return Ok(if is_told { Answer::Said(words) } else { Answer::Wrong(words) });
        }
    }
    Ok(missing.map_or(Answer::Right, Answer::Said))
}

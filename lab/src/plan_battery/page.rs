//! The tables as a page in Markdown.

use super::trial::{FirstTest, Trial};
use crate::cases::{aligned, row};
use crate::statistics::median;

const COLUMNS: [&str; 7] =
    ["before", "repeated", "planned", "random", "repeated/planned", "lowest", "highest"];

/// A table for each first test, and their medians.
pub fn tables(trials: &[Trial]) -> String {
    let sections = FirstTest::ALL.map(|first| {
        let of_first: Vec<&Trial> = trials.iter().filter(|trial| trial.first == first).collect();
        if of_first.is_empty() {
            return String::new();
        }
        format!("## First test: {}\n\n{}\n{}\n", first.name(), table(&of_first), summary(&of_first))
    });
    sections.concat()
}

/// Medians over the seeds, a row for each specimen.
fn table(trials: &[&Trial]) -> String {
    let mut rows = vec![row("specimen", &COLUMNS)];
    for of_one in trials.chunk_by(|a, b| a.name == b.name) {
        let ratios = sorted(of_one, Trial::ratio);
        let errors: [fn(&Trial) -> f64; 4] =
            [|trial| trial.before, |trial| trial.repeated, |trial| trial.planned, |trial| trial.random];
        let mut cells: Vec<String> =
            errors.iter().map(|of| format!("{:.2}", median(&sorted(of_one, of)))).collect();
        let strict = median(&sorted(of_one, Trial::strict_ratio));
        let ends = [median(&ratios), ratios[0], ratios[ratios.len() - 1], strict];
        cells.extend(ends.map(|ratio| format!("{ratio:.2}")));
        rows.push(row(of_one[0].name, &cells));
    }
    aligned(&rows)
}

/// Over all specimens and seeds.
fn summary(trials: &[&Trial]) -> String {
    let of_random = sorted(trials, |trial| trial.random / trial.planned);
    let compared = [
        ("repeated / planned", sorted(trials, Trial::ratio)),
        ("lower of before and repeated / planned", sorted(trials, Trial::strict_ratio)),
        ("random / planned", of_random),
    ];
    let mut rows =
        vec![row("over all trials", &["median", "lowest", "highest", "1.5 or more", "below 1", "trials"])];
    for (name, ratios) in compared {
        let below = |limit: f64| ratios.iter().filter(|ratio| **ratio < limit).count();
        let mut cells =
            [median(&ratios), ratios[0], ratios[ratios.len() - 1]].map(|r| format!("{r:.2}")).to_vec();
        cells.extend([ratios.len() - below(1.5), below(1.0), ratios.len()].map(|count| count.to_string()));
        rows.push(row(name, &cells));
    }
    aligned(&rows)
}

fn sorted(trials: &[&Trial], of: impl Fn(&Trial) -> f64) -> Vec<f64> {
    let mut all: Vec<f64> = trials.iter().map(|trial| of(trial)).collect();
    all.sort_by(f64::total_cmp);
    all
}

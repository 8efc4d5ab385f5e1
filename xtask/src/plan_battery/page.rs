//! The tables as a page in Markdown.

use super::trial::{FirstTest, Trial};
use crate::cases::{aligned, row};

const COLUMNS: [&str; 7] =
    ["before", "repeated", "planned", "random", "repeated/planned", "lowest", "highest"];

/// A table for each first test, and their medians.
pub fn tables(trials: &[Trial]) -> String {
    let sections = FirstTest::ALL.map(|first| {
        let of_first: Vec<&Trial> = trials.iter().filter(|trial| trial.first == first).collect();
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
            errors.iter().map(|of| format!("{:.1}", median(&sorted(of_one, of)))).collect();
        let ends = [median(&ratios), ratios[0], ratios[ratios.len() - 1]];
        cells.extend(ends.map(|ratio| format!("{ratio:.2}")));
        rows.push(row(of_one[0].name, &cells));
    }
    aligned(&rows)
}

/// Over all specimens and seeds.
fn summary(trials: &[&Trial]) -> String {
    if trials.is_empty() {
        return String::new();
    }
    let ratios = sorted(trials, Trial::ratio);
    let of_random = sorted(trials, |trial| trial.random / trial.planned);
    let at_least = |least: f64| ratios.iter().filter(|ratio| **ratio >= least).count();
    format!(
        "Over all {} trials the ratio repeated/planned has the median {:.2} and is {:.2} in the worst; it is 1.5 or more in \
         {} and below 1 in {}. The ratio random/planned has the median {:.2}.\n",
        ratios.len(),
        median(&ratios),
        ratios[0],
        at_least(1.5),
        ratios.len() - at_least(1.0),
        median(&of_random)
    )
}

fn sorted(trials: &[&Trial], of: impl Fn(&Trial) -> f64) -> Vec<f64> {
    let mut all: Vec<f64> = trials.iter().map(|trial| of(trial)).collect();
    all.sort_by(f64::total_cmp);
    all
}

fn median(sorted: &[f64]) -> f64 {
    let middle = sorted.len() / 2;
    if sorted.len() % 2 == 1 { sorted[middle] } else { 0.5 * (sorted[middle - 1] + sorted[middle]) }
}

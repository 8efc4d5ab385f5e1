//! Errors of the folds of a cross-validation as a table.

use hysid::data::metrics::Errors;
use hysid::data::unit;
use hysid::validation::{CrossValidation, FoldErrors};
use hysid_core::significant::Significant;
use hysid_document::plain::{WIDTH, aligned, wrapped};

/// The folds as a table, in 80 columns where units are short, and what its numbers mean.
pub fn folds_text(errors: &CrossValidation) -> String {
    let all = &errors.unseen;
    let unit = unit::of_column(&all.output).map_or_else(|| "RMSE".into(), |unit| unit::written(&unit));
    let headings = ["%".to_string(), unit].map(|unit| [format!("train {unit}"), format!("unseen {unit}")]);
    let row = |name: &str, numbers: [String; 4]| [vec![name.to_string()], numbers.to_vec()].concat();
    let mut rows = vec![row("held out", headings.concat().try_into().expect("two times two"))];
    rows.extend(errors.folds.iter().map(|fold| row(&fold.held_out, cells(fold))));
    let blank = String::new;
    rows.push(row("all folds", [blank(), percent(all), blank(), number(all.rmse)]));
    shorten_names(&mut rows);
    let meaning = "Errors of free runs: RMSE, and RMSE in % of the standard deviation of the output. Unseen rows \
                   are those held out of the fit. A single record is cut in time, and parts of it are held out \
                   more than once.";
    format!("{}\n\n{}\n", aligned(&rows).join("\n"), wrapped(meaning, WIDTH).join("\n"))
}

fn cells(fold: &FoldErrors) -> [String; 4] {
    [percent(&fold.train), percent(&fold.unseen), number(fold.train.rmse), number(fold.unseen.rmse)]
}

pub(crate) fn percent(errors: &Errors) -> String {
    errors.nrmse_std_percent.map_or_else(|| "-".into(), number)
}

fn number(value: f64) -> String {
    format!("{:.4}", Significant(value))
}

/// Cuts names off where a line would be too long for a terminal.
fn shorten_names(rows: &mut [Vec<String>]) {
    const FEWEST: usize = 20;
    let letters = |text: &String| text.chars().count();
    let numbers: usize = (1..rows[0].len())
        .map(|column| 2 + rows.iter().map(|row| letters(&row[column])).max().unwrap_or(0))
        .sum();
    let room = WIDTH.saturating_sub(numbers).max(FEWEST);
    for name in rows.iter_mut().map(|row| &mut row[0]) {
        if letters(name) > room {
            *name = name.chars().take(room - 1).chain(['…']).collect();
        }
    }
}

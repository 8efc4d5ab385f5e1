//! The verdict and the table of errors.

use hysid::data::metrics::Errors;
use hysid_document::{Cell, Part, Table, number, unit};

use crate::Report;

/// Error in percent of the standard deviation below which a model may be called so.
const GRADES: [(f64, &str); 4] = [
    (1.0, "almost equal to the measurement"),
    (5.0, "a close match"),
    (15.0, "a match with visible differences"),
    (40.0, "the rough shape only"),
];

/// In words how good an error is.
fn grade(percent: f64) -> &'static str {
    let found = GRADES.iter().find(|(limit, _)| percent < *limit);
    found.map_or("no match", |(_, words)| words)
}

/// One sentence: how good is it?
pub fn verdict(report: &Report) -> Part {
    let provenance = report.model.provenance();
    let mut parts = vec![format!("{} on the training data", judged(&provenance.train))];
    let behind = provenance.train_after_warm_up.as_ref();
    parts.extend(behind.map(|errors| format!("{} on the training data without the warm-up", judged(errors))));
    parts.push(match &provenance.validation {
        Some(errors) => {
            format!("{} on held-out data (cross-validation)", judged(errors))
        }
        None if provenance.options.starts() == 1 => {
            "not measured on new data, because none were held out".into()
        }
        None => "not measured on new data, because there were too few to hold any out".into(),
    });
    let unseen = report.sets.iter().filter(|set| set.name != "training");
    parts.extend(unseen.map(|set| format!("{} on the {} data", judged(&set.errors), set.name)));
    let is_one_loop = provenance.selection.as_ref().is_some_and(|selection| selection.one_loop);
    let doubt = if is_one_loop {
        " The data are one loop: the error on smaller loops is not known, and may be many times larger."
    } else {
        ""
    };
    Part::Lead(
        format!(
            "Error of a free run, in percent of the standard deviation of the output: {}.{doubt}",
            joined(&parts)
        )
        .into(),
    )
}

fn judged(errors: &Errors) -> String {
    match errors.nrmse_std_percent {
        Some(percent) => format!("{} % ({})", number(percent, 3), grade(percent)),
        None => "not defined (the output is constant)".into(),
    }
}

fn joined(parts: &[String]) -> String {
    match parts {
        [all @ .., last] if !all.is_empty() => format!("{}, and {last}", all.join(", ")),
        _ => parts.concat(),
    }
}

/// The table of errors, with what its words mean.
pub fn section(report: &Report) -> Part {
    let provenance = report.model.provenance();
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    if report.sets.iter().all(|set| set.name != "training") {
        rows.push(row("training", &provenance.train));
    }
    rows.extend(report.sets.iter().map(|set| row(&set.name, &set.errors)));
    if let Some(validation) = &provenance.validation {
        rows.insert(1, row("validation", validation));
    }
    if let Some(behind) = &provenance.train_after_warm_up {
        rows.insert(1, row("training, after warm-up", behind));
    }
    let unit = unit::of(&report.model.names().output);
    let headings = [
        "data".into(),
        "records".into(),
        "samples".into(),
        format!("RMSE ({unit})"),
        "NRMSE (% of std)".into(),
        "NRMSE (% of range)".into(),
        "fit (%)".into(),
        format!("largest error ({unit})"),
    ];
    Part::section("Errors", [Part::Table(Table::new(headings).with_rows(rows)), explanation(report)])
}

fn explanation(report: &Report) -> Part {
    let options = &report.model.provenance().options;
    let beginning = options.judged_beginning(report.model.names()).unwrap_or_default();
    let run = match crate::initial_state(report.model) {
        _ if !beginning.is_none() => {
            "the model gets the input and the first measured outputs of each record, from which it finds its state and \
             which are not scored"
        }
        None => "the model gets only the input, and starts each record in the virgin state",
        Some(_) => "the model gets only the input, and starts each record in its initial state",
    };
    let mut text = format!(
        "All errors are those of a free run: {run}. RMSE is the root mean \
         square error; NRMSE is the RMSE in percent of the standard deviation or the range of the measured \
         output; fit is 100 % minus the NRMSE in % of std. ",
    );
    let provenance = report.model.provenance();
    match (&provenance.validation, &provenance.selection) {
        (Some(_), Some(selection)) => {
            text += "“Validation” is the error on held-out data: each fold was simulated by models trained without \
                     it. ";
            text += match report.model.ensemble() {
                Some(_) => "The weights of the ensemble were chosen on the same folds",
                None => "The model was chosen among candidates on the same folds",
            };
            text += ", so this error is slightly too low.";
            if selection.beyond.is_some() {
                text += &format!(" Counted are the {}.", selection.held_out_rows());
            }
        }
        (Some(_), None) => {
            text += "“Validation” is the error on held-out data, of networks that were trained in the same way \
                     without these data.";
        }
        (None, _) => text += "No data were held out, so there is no validation.",
    }
    Part::note(text)
}

fn row(name: &str, errors: &Errors) -> Vec<Cell> {
    let number = |value: Option<f64>| Cell::number(value, 4);
    vec![
        name.into(),
        errors.records.into(),
        errors.samples.into(),
        number(Some(errors.rmse)),
        number(errors.nrmse_std_percent),
        number(errors.nrmse_range_percent),
        number(errors.fit_percent),
        number(Some(errors.max_abs_error)),
    ]
}

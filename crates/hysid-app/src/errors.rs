//! The headline and the table of errors.

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

/// The error on new data, or on the training data if there are no others, in the unit of the output; and what is doubtful
/// about it.
pub fn verdict(report: &Report) -> Vec<Part> {
    let provenance = report.model.provenance();
    let unseen = report.sets.iter().filter(|set| set.name != "training");
    let mut found: Vec<(String, &Errors)> =
        unseen.map(|set| (format!("the {} data", set.name), &set.errors)).collect();
    found.extend(provenance.validation.as_ref().map(|errors| ("held-out data".into(), errors)));
    let is_new = !found.is_empty();
    let without_warm_up = provenance.train_after_warm_up.as_ref();
    found.extend(without_warm_up.map(|errors| ("the training data without the warm-up".into(), errors)));
    found.push(("the training data".into(), &provenance.train));
    let mut found = found.into_iter();
    let lead = found.next().map_or_else(String::new, |(data, errors)| in_words(&data, errors));
    let others = found.map(|(data, errors)| format!("on {data}: {}", judged(errors)));
    let others = others.collect::<Vec<String>>().join("; ");
    let mut parts = vec![Part::Lead(lead.into())];
    parts.extend((!others.is_empty()).then(|| Part::note(format!("Error {others}."))));
    let doubts = doubts(report, is_new);
    parts.extend((!doubts.is_empty()).then(|| Part::warnings(&doubts)));
    parts
}

/// Root mean square error, its size beside the motion of the output, and how good that is.
fn in_words(data: &str, errors: &Errors) -> String {
    let rmse = unit::with(&number(errors.rmse, 3), &errors.output);
    let (name, _) = unit::split(&errors.output);
    match errors.nrmse_std_percent {
        Some(percent) => format!(
            "On {data}, the simulated {name} is {rmse} off (root mean square error), {} % of its standard deviation: {}.",
            number(percent, 3),
            grade(percent)
        ),
        None => format!(
            "On {data}, the simulated {name} is {rmse} off (root mean square error); the measured one is constant."
        ),
    }
}

/// Held-out errors so many times as large as those of the training are doubtful.
const OVERFITTED: f64 = 2.0;

/// Why the error on other data may be larger.
fn doubts(report: &Report, is_new: bool) -> Vec<String> {
    let provenance = report.model.provenance();
    let mut doubts = Vec::new();
    if provenance.selection.as_ref().is_some_and(|selection| selection.one_loop) {
        doubts.push(
            "The data are one loop: the error on smaller loops is not known, and may be many times larger."
                .into(),
        );
    }
    if !is_new {
        let why = match provenance.options.starts() {
            1 => "none were held out",
            _ => "there were too few to hold any out",
        };
        doubts.push(format!("The error on new data was not measured, because {why}."));
    }
    let trained = provenance.train_after_warm_up.as_ref().unwrap_or(&provenance.train).rmse;
    let times = provenance.validation.as_ref().map(|errors| errors.rmse / trained);
    doubts.extend(times.filter(|times| *times >= OVERFITTED && times.is_finite()).map(|times| {
        format!(
            "The error on held-out data is {} times that on the training data: the training data do not determine the \
             model, or the held-out data differ from them.",
            number(times, 2)
        )
    }));
    doubts
}

fn judged(errors: &Errors) -> String {
    let rmse = unit::with(&number(errors.rmse, 3), &errors.output);
    match errors.nrmse_std_percent {
        Some(percent) => format!("{rmse} ({} % of std)", number(percent, 3)),
        None => rmse,
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

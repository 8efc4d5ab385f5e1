//! How to go on with the model, and what it cannot do.

use std::path::Path;

use hysid::model::Model;
use hysid_document::shell::shown;
use hysid_document::{Cell, Item, Part, Table, number, span, unit};

use crate::Report;

/// Commands and limits.
pub fn sections(report: &Report) -> impl Iterator<Item = Part> {
    let commands = report.model_file.as_deref().map(|file| commands(report, file));
    commands.into_iter().chain([limits(report)])
}

fn commands(report: &Report, file: &str) -> Part {
    let file = shown(Path::new(file));
    let band = if report.model.band().is_some() { " --band 0.9" } else { "" };
    let parts = [
        Part::paragraph("Evaluate it on new measured data:"),
        Part::Command(format!("hysid evaluate {file} NEW.csv")),
        Part::paragraph(match band {
            "" => "Simulate an input; the output is added as a column:",
            _ => "Simulate an input; the output and its band are added as columns:",
        }),
        Part::Command(format!("hysid simulate {file} NEW.csv -o OUT.csv{band}")),
        Part::note(
            "NEW.csv needs the columns of the training data under the same names; evaluate needs the output too.",
        ),
    ];
    Part::section("How to use the model", parts)
}

fn limits(report: &Report) -> Part {
    let (names, trained) = (report.model.names(), report.model.trained_ranges());
    let mut rows: Vec<Vec<Cell>> = names
        .inputs
        .iter()
        .zip(&trained.inputs)
        .map(|(name, &range)| vec![unit::label(name).into(), span(range).into()])
        .collect();
    if let Some(range) = trained.rate {
        let per = names.time.as_deref().map_or("unit of time".into(), unit::of);
        let (name, _) = unit::split(&names.inputs[0]);
        let label = format!("rate of {name} ({}/{per})", unit::of(&names.inputs[0]));
        rows.push(vec![label.into(), span(range).into()]);
    }
    rows.push(vec![unit::label(&names.output).into(), span(trained.output).into()]);
    let table = Table::new(["quantity", "range in training"]).with_rows(rows);
    let mut limits = vec!["Outside these ranges the model extrapolates, and its error is unknown."];
    limits.push(match crate::initial_state(report.model) {
        None => {
            "It starts every record in the virgin state. If the specimen has a history that the record does not \
             contain, give its initial state (--initial-state)."
        }
        Some(_) if report.model.is_periodic() => {
            "It starts every record after one period of the record itself, and sample by sample (exports too) in the \
             virgin state: its first period is then a transient."
        }
        Some(_) => {
            "It starts every record in the state in which most training records begin. If the specimen is in \
             another state, give it (--initial-state)."
        }
    });
    if !report.model.needs_time() && report.model.rate().is_none() {
        limits.push("It is rate-independent: the same input path gives the same output at any speed.");
    }
    if wears_out(report.model) {
        limits.push(
            "Its stops deteriorate as they slide. A history longer or more severe than the training records \
             leads to deterioration that was not measured.",
        );
    }
    if report.model.needs_time() {
        limits.push("It needs time stamps, in the unit of the training data.");
    }
    let items = limits.into_iter().map(|limit| Item { text: limit.into(), is_warning: false });
    Part::section("Limits of the model", [Part::Table(table), Part::List(items.collect())])
}

/// Three lines on the use of a model: for which inputs, for which not, and with which error.
pub fn purpose(model: &Model) -> [String; 3] {
    let (names, trained, provenance) = (model.names(), model.trained_ranges(), model.provenance());
    let inputs = names.inputs.iter().zip(&trained.inputs);
    let mut ranges: Vec<String> = inputs
        .map(|(name, &range)| format!("{} from {}", unit::split(name).0, unit::with(&span(range), name)))
        .collect();
    if let Some(rate) = trained.rate {
        let (name, per) =
            (unit::split(&names.inputs[0]).0, names.time.as_deref().map_or("unit of time".into(), unit::of));
        ranges.push(format!("a rate of {name} from {} {}/{per}", span(rate), unit::of(&names.inputs[0])));
    }
    let speeds = match trained.rate {
        None if !model.needs_time() => {
            ". It is rate-independent: it says nothing of speeds at which the specimen was not measured"
        }
        _ => "",
    };
    let percent = |error: Option<f64>| {
        error.map(|error| format!("{} % of the standard deviation of the output", number(error, 3)))
    };
    let validation = provenance.validation.as_ref().and_then(|errors| percent(errors.nrmse_std_percent));
    let error = match (validation, percent(provenance.trained_error().nrmse_std_percent)) {
        (Some(error), _) => {
            format!("Expected error on new data like the training data: {error} (cross-validation).")
        }
        (_, Some(error)) => {
            format!(
                "Its error on new data is not known. On the training data it is {error}; judge it by measured data that it was not fitted to."
            )
        }
        _ => "Its error is not known.".into(),
    };
    [
        format!("Use it for {}, along paths like those of the training data.", ranges.join(" and ")),
        format!("Do not use it outside these ranges, where it extrapolates with an unknown error{speeds}."),
        error,
    ]
}

/// True if a network in it deteriorates.
fn wears_out(model: &Model) -> bool {
    let network = model.network().is_some_and(|network| network.architecture().deterioration);
    network || model.ensemble().is_some_and(|ensemble| ensemble.members().iter().any(wears_out))
}

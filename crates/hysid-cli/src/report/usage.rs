//! How to go on with the model, and what it cannot do.

use hysid::model::Model;

use super::{Report, unit};
use crate::page::{note, paragraph, section as section_of, span, table};
use crate::plot::escape;

/// Commands and limits.
pub fn section(report: &Report) -> String {
    commands(report) + &limits(report)
}

fn commands(report: &Report) -> String {
    let file = quoted(&report.model_file);
    let command = |text: String| format!("<pre tabindex=\"0\"><code>{}</code></pre>\n", escape(&text));
    let band = if report.model.band().is_some() { " --band 0.9" } else { "" };
    let content = [
        paragraph("Judge it on a measurement that it has not seen:"),
        command(format!("hysid evaluate {file} NEW.csv")),
        paragraph(match band {
            "" => "Simulate an input; the output is added as a column:",
            _ => "Simulate an input; the output and its band are added as columns:",
        }),
        command(format!("hysid simulate {file} NEW.csv -o OUT.csv{band}")),
        note(
            "NEW.csv needs the columns of the training data under the same names; evaluate needs the output too.",
        ),
    ];
    section_of("How to use the model", &content.concat())
}

fn limits(report: &Report) -> String {
    let (names, trained) = (report.model.names(), report.model.trained_ranges());
    let mut rows: Vec<Vec<String>> = names
        .inputs
        .iter()
        .zip(&trained.inputs)
        .map(|(name, &range)| vec![unit::label(name), span(range)])
        .collect();
    if let Some(range) = trained.rate {
        let per = names.time.as_deref().map_or("unit of time".into(), unit::of);
        let (name, _) = unit::split(&names.inputs[0]);
        rows.push(vec![format!("rate of {name} ({}/{per})", unit::of(&names.inputs[0])), span(range)]);
    }
    rows.push(vec![unit::label(&names.output), span(trained.output)]);
    let headings = ["quantity".into(), "range in training".into()];
    let mut items = vec![
        "Outside these ranges it extrapolates, and nothing vouches for the result.".to_string(),
        "Its memory is virgin at the start of every record: a specimen with a past that the record does not \
         contain is started wrongly."
            .to_string(),
    ];
    if !report.model.needs_time() && report.model.rate().is_none() {
        items.push(
            "It knows no time: the same input path gives the same output, however fast it is run.".into(),
        );
    }
    if wears_out(report.model) {
        items.push(
            "It wears out by sliding: a history longer or harsher than the training records wears it further \
             than anything measured vouches for."
                .into(),
        );
    }
    if report.model.needs_time() {
        items.push("It needs time stamps, in the unit it was trained with.".into());
    }
    let items: String = items.iter().map(|item| format!("<li>{}</li>\n", escape(item))).collect();
    section_of("What the model cannot do", &format!("{}<ul>\n{items}</ul>\n", table(&headings, &rows)))
}

/// True if a network in it deteriorates.
fn wears_out(model: &Model) -> bool {
    let network = model.network().is_some_and(|network| network.architecture().deterioration);
    network || model.ensemble().is_some_and(|ensemble| ensemble.members().iter().any(wears_out))
}

/// A file name as a shell takes it.
fn quoted(file: &str) -> String {
    let plain = |letter: char| letter.is_alphanumeric() || "._-/+:\\".contains(letter);
    if !file.is_empty() && file.chars().all(plain) {
        file.into()
    } else {
        format!("\"{}\"", file.replace('"', "\\\""))
    }
}

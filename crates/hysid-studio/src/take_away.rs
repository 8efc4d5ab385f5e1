//! Exports of a model, and the lines that make the very same model without the studio.

use std::io::{Cursor, Write};
use std::path::Path;

use hysid::model::Model;
use hysid::options::table::{OPTIONS, OptionValues};
use hysid_core::termination::Termination;
use hysid_document::shell::{flag, option, shown};
use hysid_document::{Problem, Result, problem};
use hysid_export::{InverseOptions, Options, Target};
use hysid_records::ReadingChoice;
use serde_json::{Value, json};
use zip::result::ZipError;
use zip::write::{SimpleFileOptions, ZipWriter};

use crate::project::{Begun, ProjectModel};

/// A model or its inverse for a target, as one archive; and its name.
pub fn archive(
    model: &Model,
    stored: &ProjectModel,
    target: &str,
    inverse: Option<InverseOptions>,
) -> Result<(String, Vec<u8>)> {
    let to = Target::named(target).ok_or_else(|| problem!("there is no target \"{target}\""))?;
    let name = identifier(&stored.file);
    let what = if inverse.is_some() { "_inverse" } else { "" };
    let mut options = Options::named(name.clone());
    options.inverse = inverse;
    options.source = vec![("model file".into(), stored.file.clone())];
    let export =
        hysid_export::export(model, to, &options).map_err(|error| Problem::from(error.to_string()))?;
    let folder = format!("{name}{what}_{target}");
    let failed = |error: ZipError| problem!("cannot make the archive: {error}");
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let stored = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    for file in &export.files {
        archive.start_file(format!("{folder}/{}", file.path), stored).map_err(failed)?;
        archive.write_all(&file.content).map_err(|error| failed(error.into()))?;
    }
    let content = archive.finish().map_err(failed)?.into_inner();
    Ok((format!("{folder}.zip"), content))
}

/// The name of a model's file as an identifier.
fn identifier(file: &str) -> String {
    let stem = file.strip_suffix(".json").unwrap_or(file);
    let letters: String =
        stem.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect();
    format!("model_{letters}")
}

/// Lines that make the very same model: for a shell, and for Python, in the folder of the project; `null` where Python has
/// no option for what was chosen. What was guessed is said, so that the lines do not depend on the guess. A note says why
/// they make another model, if they do.
pub fn lines(stored: &ProjectModel, model: &Model, folder: &Path) -> Value {
    let is_cut_short = stored.was_interrupted || model.provenance().termination == Termination::Stopped;
    let note = match (is_cut_short, stored.begun.request.time_limit) {
        (false, _) => None,
        (true, Some(_)) => {
            Some("The time limit ended this fit: the result depends on the speed of the machine.")
        }
        (true, None) => {
            Some("This fit was stopped early. The commands run it to its end, and give another model.")
        }
    };
    let note = match stored.begun.renamed.is_empty() {
        true => note,
        false => Some(
            "The training files name their columns differently: give the columns of all files the names of the first, and then run the command.",
        ),
    };
    json!({"shell": shell(stored, folder), "python": python(&stored.begun, &stored.file), "note": note})
}

fn shell(stored: &ProjectModel, folder: &Path) -> String {
    let (begun, columns) = (&stored.begun, &stored.begun.columns);
    let mut words = vec!["hysid fit".to_string()];
    words.extend(begun.files.iter().map(|file| shown(&Path::new("data").join(file))));
    words.extend(columns.choice().options());
    words.extend(begun.rate_method().map(|method| option("rate", method)));
    words.extend(of_reading(&begun.understanding.reading));
    for (name, value) in chosen(begun) {
        words.extend(word(name, value));
    }
    words.extend(begun.request.time_limit.map(|seconds| format!("--time-limit {seconds}")));
    words.push(format!("-o {}", shown(Path::new(&stored.file))));
    format!("cd {}\n{}", shown(folder), words.join(" "))
}

/// The options that were chosen, the model first. A project from elsewhere may name others, which would be read as code.
fn chosen(begun: &Begun) -> Vec<(&String, &Value)> {
    let is_option = |(name, _): &(&String, &Value)| OPTIONS.iter().any(|option| option.name == name.as_str());
    let mut options: Vec<(&String, &Value)> = begun.request.options.iter().filter(is_option).collect();
    options.sort_by_key(|(name, _)| *name != "model");
    options
}

/// The options of reading tables.
fn of_reading(reading: &ReadingChoice) -> Vec<String> {
    let Ok(Value::Object(named)) = serde_json::to_value(reading) else { unreachable!("it is a map") };
    let words = |(name, value): (String, Value)| match value {
        // One for each cell.
        Value::Array(cells) => {
            let cells = cells.iter().filter_map(Value::as_str);
            cells.map(|cell| option(&name, cell)).collect()
        }
        value => word(&name, &value).into_iter().collect::<Vec<String>>(),
    };
    named.into_iter().flat_map(words).collect()
}

/// An option on the command line; `None` for one that is not set.
fn word(name: &str, value: &Value) -> Option<String> {
    let is_truth =
        OPTIONS.iter().any(|option| option.name == name && matches!(option.values, OptionValues::Truth));
    let value = match value {
        Value::Null => return None,
        Value::Bool(value) if !is_truth => return value.then(|| flag(name)),
        Value::String(text) => text.clone(),
        Value::Array(all) => all.iter().map(ToString::to_string).collect::<Vec<String>>().join(","),
        other => other.to_string(),
    };
    Some(option(name, &value))
}

/// Python takes columns of arrays, so a table that is read in another way than pandas does has no line.
fn python(begun: &Begun, file: &str) -> Option<String> {
    let columns = &begun.columns;
    let [data] = begun.files.as_slice() else { return None };
    let is_csv = data.to_lowercase().ends_with(".csv");
    if !is_csv || begun.understanding.reading != ReadingChoice::default() {
        return None;
    }
    let text = |text: &str| Value::from(text).to_string();
    let column = |name: &str| format!("table[{}]", text(name));
    let inputs = columns.inputs.iter().map(|name| text(name)).collect::<Vec<String>>().join(", ");
    let mut arguments =
        vec![format!("table[[{inputs}]]"), column(columns.output.as_deref().unwrap_or_default())];
    arguments.extend(columns.time.iter().map(|name| format!("time={}", column(name))));
    arguments.extend(columns.record.iter().map(|name| format!("records={}", column(name))));
    arguments.extend(columns.rate.iter().map(|name| format!("rate={}", column(name))));
    arguments.extend(begun.rate_method().map(|method| format!("rate={}", text(method))));
    for (name, value) in chosen(begun) {
        let value = match value {
            Value::Null => continue,
            Value::Bool(true) => "True".to_string(),
            Value::Bool(false) => "False".to_string(),
            // Values of options are numbers, texts and lists of them, which Python reads as JSON does.
            other => other.to_string(),
        };
        arguments.push(format!("{name}={value}"));
    }
    arguments.extend(begun.request.time_limit.map(|seconds| format!("time_limit={seconds}")));
    Some(format!(
        "import hysid\nimport pandas\n\ntable = pandas.read_csv({})\nmodel = hysid.fit({})\nmodel.save({})\n",
        text(&format!("data/{data}")),
        arguments.join(", "),
        text(file),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fit as a project from elsewhere may have it.
    fn begun(fields: &str) -> Begun {
        let nothing = r#"{"record": null, "time": null, "inputs": ["x"], "rate": null, "output": "y"}"#;
        let text = format!(
            r#"{{"id": 1, "files": ["a.csv"], "understanding": {{}}, "columns": {nothing}, "request": {fields}}}"#
        );
        serde_json::from_str(&text).unwrap()
    }

    #[test]
    fn no_word_of_a_project_is_read_by_a_shell_or_by_python() {
        let fields = r#"{"rate": "central; touch X #", "options": {"model": "auto; touch X",
                         "seed; touch X #": true, "seed); touch(": 3}}"#;
        let stored = ProjectModel {
            begun: begun(fields),
            file: "m; touch X.json".into(),
            report: None,
            made: String::new(),
            seconds: 0.0,
            was_interrupted: false,
            name: None,
        };
        let lines = shell(&stored, Path::new("p;q"));
        let expected = "cd 'p;q'\nhysid fit data/a.csv --output y --input x --rate 'central; touch X #' \
                        --model 'auto; touch X' -o 'm; touch X.json'";
        assert_eq!(lines, expected);
        let code = python(&stored.begun, &stored.file).unwrap();
        assert!(!code.contains("touch("), "{code}");
        assert!(code.contains(r#"rate="central; touch X #", model="auto; touch X""#), "{code}");
    }
}

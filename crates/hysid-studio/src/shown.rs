//! The state of a studio as the page shows it.

use std::collections::HashMap;
use std::sync::Arc;

use hysid::model::Model;
use hysid::model::selection::CandidateResult;
use hysid_app::purpose;
use hysid_document::Result;
use hysid_document::{count, object, unit};
use hysid_records::{Data, Roles};
use serde_json::{Value, json};

use crate::drive;
use crate::fitting::FitState;
use crate::folder::Folder;
use crate::project::{ChosenColumns, Project, ProjectFile, ProjectModel};
use crate::view::{FileView, View};
use crate::words::{Said, said, shortened};

/// Of a project whose files are read as in the view. `model` gives the model of a stored one.
pub fn shown(
    project: &Project,
    folder: &Folder,
    view: &View,
    fit: Option<FitState>,
    model: impl Fn(&ProjectModel) -> Result<Arc<Model>>,
    version: u64,
) -> Value {
    let known: HashMap<u64, &FileView> = view.files.iter().map(|file| (file.id, &**file)).collect();
    let shown_file =
        |file: &ProjectFile| of_file(file, known.get(&file.id).copied(), folder.is_held_back(file.id));
    let roles = view.roles.as_ref();
    let models: Vec<Result<Arc<Model>>> = project.models.iter().map(model).collect();
    let titles = titles(project, &models);
    let stored = project.models.iter().zip(models).zip(titles);
    json!({
        "version": version,
        "name": folder.name(),
        "folder": folder.root().display().to_string(),
        "files": project.files.iter().map(shown_file).collect::<Vec<_>>(),
        "reading": project.understanding.reading,
        "columns": roles.map(ChosenColumns::of),
        "columns_are_chosen": project.understanding.columns.is_some() || project.files.iter().any(|file| !file.columns.is_empty()),
        // The file that determines the columns.
        "first": view.first,
        "problem": view.problem,
        "names": roles.map(|roles| names(roles, str::to_string)),
        "labels": roles.map(|roles| names(roles, unit::label)),
        // If its name tells.
        "output_unit": roles.and_then(|roles| unit::split(&roles.output).1),
        "rate_label": roles.map(|roles| rate_label(&roles.inputs[0], roles.time.as_deref())),
        // As long as not all files are read.
        "is_reading": !view.is_of(project),
        "models": stored.map(|((stored, model), title)| of_model(project, stored, model, title)).collect::<Vec<_>>(),
        "fit": fit,
    })
}

/// The rate of an input with its unit, as far as that is known.
fn rate_label(input: &str, time: Option<&str>) -> String {
    let ((name, unit), time) = (unit::split(input), time.and_then(|time| unit::split(time).1));
    match (unit, time) {
        (Some(unit), Some(time)) => format!("rate of {name} ({unit}/{time})"),
        _ => format!("rate of {name}"),
    }
}

fn names(roles: &Roles, shown: impl Fn(&str) -> String) -> Value {
    json!({
        "time": roles.time.as_deref().map(&shown),
        "inputs": roles.inputs.iter().map(|name| shown(name)).collect::<Vec<_>>(),
        "rate": roles.rate.as_deref().map(&shown),
        "output": shown(&roles.output),
    })
}

/// Of a file that is read, or is not yet.
fn of_file(file: &ProjectFile, view: Option<&FileView>, is_held_back: bool) -> Value {
    let table = view.and_then(|view| view.table.as_ref());
    let data = view.and_then(|view| view.data.as_ref());
    json!({
        "id": file.id,
        "name": file.name,
        "bytes": file.bytes,
        "use": file.usage,
        "problem": view.and_then(|view| view.problem.as_ref()),
        // It can be read again, which killed the studio before.
        "is_held_back": is_held_back,
        "read_as": table.map(|table| &table.read_as),
        "rows": table.map_or(0, |table| table.rows),
        "columns": table.map_or(&[][..], |table| &table.looked.columns),
        "records": data.map_or_else(Vec::new, |data| records(data)),
        "warnings": data.iter().flat_map(|data| data.warnings.iter().cloned().map(Said::from)).collect::<Vec<_>>(),
    })
}

/// Rows of each record among those of its file.
fn records(data: &Data) -> Vec<Value> {
    let mut from = 0;
    let mut record = |(name, rows): (&str, usize)| {
        let record = json!({"name": name, "from": from, "to": from + rows});
        from += rows;
        record
    };
    data.set.records().iter().map(|one| record((one.name(), one.len()))).collect()
}

/// The name of each model: the one that somebody gave it, or one that says what it is. A number tells equal ones apart.
fn titles(project: &Project, models: &[Result<Arc<Model>>]) -> Vec<String> {
    let mut counts: HashMap<String, usize> = HashMap::new();
    let title = |(stored, model): (&ProjectModel, &Result<Arc<Model>>)| {
        let title = stored.name.clone().unwrap_or_else(|| described(stored, model.as_deref().ok()));
        let count = counts.entry(title.clone()).or_default();
        *count += 1;
        if *count == 1 { title } else { format!("{title} ({count})") }
    };
    project.models.iter().zip(models).map(title).collect()
}

/// A model in words, such as "auto, 3 members, column-test".
fn described(stored: &ProjectModel, model: Option<&Model>) -> String {
    let begun = &stored.begun;
    let asked = begun.request.options.get("model").and_then(Value::as_str).unwrap_or("auto");
    let members = model.and_then(Model::ensemble).map(|ensemble| ensemble.members().len());
    let made = model.map(|model| model.name().name()).filter(|made| *made != asked && members.is_none());
    let options =
        begun.request.options.iter().filter(|(name, _)| !["model", "members"].contains(&name.as_str()));
    let option = |(name, value): (&String, &Value)| match value {
        Value::Bool(true) => name.replace('_', " "),
        Value::String(text) => format!("{} {text}", name.replace('_', " ")),
        other => format!("{} {other}", name.replace('_', " ")),
    };
    let [first, others @ ..] = begun.files.as_slice() else { return asked.into() };
    let stem = first.rsplit_once('.').map_or(first.as_str(), |(stem, _)| stem);
    let more = if others.is_empty() { String::new() } else { format!(" and {} more", others.len()) };
    let mut parts = vec![asked.to_string()];
    parts.extend(made.map(String::from));
    parts.extend(members.map(|members| count(members, "member")));
    parts.extend(options.map(option));
    parts.push(format!("{stem}{more}"));
    parts.extend(stored.was_interrupted.then(|| "interrupted".into()));
    shortened(&parts.join(", ")).into_owned()
}

fn of_model(project: &Project, stored: &ProjectModel, model: Result<Arc<Model>>, title: String) -> Value {
    let begun = &stored.begun;
    let name = model.as_ref().map_or("", |model| model.name().name());
    let shown = object! {
        id: begun.id,
        name: name,
        title: title,
        is_named: stored.name.is_some(),
        file: &stored.file,
        made: &stored.made,
        seconds: stored.seconds,
        was_interrupted: stored.was_interrupted,
        is_stale: project.is_stale(begun),
        options: &begun.request.options,
        has_report: stored.report.is_some(),
        problem: model.as_ref().err().map(said),
        #[serde(flatten)]
        facts: model.as_ref().ok().map(|model| facts(model)),
    };
    json!(shown)
}

/// Facts that the model itself holds.
fn facts(model: &Model) -> Value {
    let provenance = model.provenance();
    let selection = provenance.selection.as_ref();
    let [chosen, why] = match selection {
        Some(selection) => selection.summary().map(Some),
        None => [None, None],
    };
    let candidates = selection.iter().flat_map(|selection| &selection.candidates);
    let member = |candidate: &CandidateResult| {
        json!({
            "name": candidate.name,
            "count": candidate.members,
            "share": candidate.share.inside,
        })
    };
    let names = model.names();
    json!({
        "termination": provenance.termination.to_string(),
        "parameters": model.parameters(),
        "members": candidates.filter(|candidate| candidate.members > 0).map(member).collect::<Vec<_>>(),
        "chosen": chosen,
        "why": why,
        "notes": model.notes().iter().map(ToString::to_string).collect::<Vec<_>>(),
        "use": purpose(model),
        "train": provenance.train,
        "validation": provenance.validation,
        "has_band": model.band().is_some(),
        "needs_time": drive::needs_time(model),
        "inputs": names.inputs,
        "input_labels": names.inputs.iter().map(|name| unit::label(name)).collect::<Vec<_>>(),
        "output_label": unit::label(&names.output),
        "time_label": names.time.as_deref().map_or_else(|| "time".into(), unit::label),
        "ranges": model.trained_ranges().inputs,
        "largest_rate": model.trained_ranges().rate.map(|(low, high)| low.abs().max(high.abs())),
    })
}

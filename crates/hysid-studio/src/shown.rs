//! The state of a studio as the page shows it.

use std::collections::HashMap;
use std::sync::Arc;

use anyhow::Result;
use hysid::data::metrics::Errors;
use hysid::model::Model;
use hysid_document::unit;
use hysid_records::{Column, Data, ReadingChoice, Roles};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::drive;
use crate::fitting::FitState;
use crate::folder::Folder;
use crate::project::{ChosenColumns, Project, ProjectFile, ProjectModel, Use};
use crate::view::{FileView, View};
use crate::words::said;

#[derive(Debug, Serialize)]
pub struct Shown {
    version: u64,
    name: String,
    folder: String,
    files: Vec<ShownFile>,
    reading: ReadingChoice,
    columns: Option<ChosenColumns>,
    columns_are_chosen: bool,
    problem: Option<String>,
    names: Option<Names>,
    labels: Option<Names>,
    /// Unit of the output, if its name tells.
    output_unit: Option<String>,
    rate_label: Option<String>,
    /// True as long as not all files are read.
    is_reading: bool,
    models: Vec<ShownModel>,
    fit: Option<FitState>,
}

#[derive(Debug, Serialize)]
struct Names {
    time: Option<String>,
    inputs: Vec<String>,
    rate: Option<String>,
    output: String,
}

#[derive(Debug, Serialize)]
struct ShownFile {
    id: u64,
    name: String,
    bytes: u64,
    #[serde(rename = "use")]
    usage: Use,
    problem: Option<String>,
    /// True if it can be read again, which killed the studio before.
    is_held_back: bool,
    read_as: Option<String>,
    rows: usize,
    columns: Vec<Column>,
    records: Vec<ShownRecord>,
    warnings: Vec<String>,
}

/// Rows of a record among those of its file.
#[derive(Debug, Serialize)]
struct ShownRecord {
    name: String,
    from: usize,
    to: usize,
}

#[derive(Debug, Serialize)]
struct ShownModel {
    id: u64,
    name: String,
    title: String,
    file: String,
    made: String,
    seconds: f64,
    was_interrupted: bool,
    is_stale: bool,
    options: Map<String, Value>,
    has_report: bool,
    problem: Option<String>,
    #[serde(flatten)]
    facts: Option<Facts>,
}

/// What the model itself tells.
#[derive(Debug, Serialize)]
struct Facts {
    termination: String,
    parameters: usize,
    members: Vec<Member>,
    chosen: Option<String>,
    why: Option<String>,
    notes: Vec<String>,
    train: Errors,
    validation: Option<Errors>,
    has_band: bool,
    needs_time: bool,
    inputs: Vec<String>,
    input_labels: Vec<String>,
    output_label: String,
    time_label: String,
    ranges: Vec<(f64, f64)>,
    largest_rate: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Member {
    name: String,
    count: usize,
    share: f64,
}

impl Shown {
    /// Of a project whose files are read as in the view. `model` gives the model of a stored one.
    pub fn of(
        project: &Project,
        folder: &Folder,
        view: &View,
        fit: Option<FitState>,
        model: impl Fn(&ProjectModel) -> Result<Arc<Model>>,
        version: u64,
    ) -> Self {
        let known: HashMap<u64, &FileView> = view.files.iter().map(|file| (file.id, &**file)).collect();
        let files = project
            .files
            .iter()
            .map(|file| ShownFile::of(file, known.get(&file.id).copied(), folder.is_held_back(file.id)));
        let models = project.models.iter().map(|stored| ShownModel::of(project, stored, model(stored)));
        let roles = view.roles.as_ref();
        Self {
            version,
            name: folder.name(),
            folder: folder.root().display().to_string(),
            files: files.collect(),
            reading: project.understanding.reading.clone(),
            columns: roles.map(ChosenColumns::of),
            columns_are_chosen: project.understanding.columns.is_some(),
            problem: view.problem.clone(),
            names: roles.map(|roles| names(roles, str::to_string)),
            labels: roles.map(|roles| names(roles, unit::label)),
            output_unit: roles.and_then(|roles| unit::split(&roles.output).1),
            rate_label: roles.map(|roles| rate_label(&roles.inputs[0], roles.time.as_deref())),
            is_reading: !view.is_of(project),
            models: models.collect(),
            fit,
        }
    }
}

/// The rate of an input with its unit, as far as that is known.
fn rate_label(input: &str, time: Option<&str>) -> String {
    let ((name, unit), time) = (unit::split(input), time.and_then(|time| unit::split(time).1));
    match (unit, time) {
        (Some(unit), Some(time)) => format!("rate of {name} ({unit}/{time})"),
        _ => format!("rate of {name}"),
    }
}

fn names(roles: &Roles, shown: impl Fn(&str) -> String) -> Names {
    Names {
        time: roles.time.as_deref().map(&shown),
        inputs: roles.inputs.iter().map(|name| shown(name)).collect(),
        rate: roles.rate.as_deref().map(&shown),
        output: shown(&roles.output),
    }
}

impl ShownFile {
    /// Of a file that is read, or is not yet.
    fn of(file: &ProjectFile, view: Option<&FileView>, is_held_back: bool) -> Self {
        let table = view.and_then(|view| view.table.as_ref());
        let data = view.and_then(|view| view.data.as_ref());
        let columns = table.map_or(&[][..], |table| &table.looked.columns);
        Self {
            id: file.id,
            name: file.name.clone(),
            bytes: file.bytes,
            usage: file.usage,
            problem: view.and_then(|view| view.problem.clone()),
            is_held_back,
            read_as: table.map(|table| table.read_as.clone()),
            rows: table.map_or(0, |table| table.rows),
            columns: columns.to_vec(),
            records: data.map_or_else(Vec::new, |data| records(data)),
            warnings: data.map_or_else(Vec::new, |data| data.warnings.clone()),
        }
    }
}

fn records(data: &Data) -> Vec<ShownRecord> {
    let mut from = 0;
    let mut record = |(name, rows): (&str, usize)| {
        let record = ShownRecord { name: name.into(), from, to: from + rows };
        from += rows;
        record
    };
    data.set.records().iter().map(|one| record((one.name(), one.len()))).collect()
}

impl ShownModel {
    fn of(project: &Project, stored: &ProjectModel, model: Result<Arc<Model>>) -> Self {
        let begun = &stored.begun;
        let name = model.as_ref().map_or_else(|_| String::new(), |model| model.name().name().into());
        let problem = model.as_ref().err().map(said);
        let end = if stored.was_interrupted { ", interrupted" } else { "" };
        Self {
            id: begun.id,
            title: format!("{} {name}{end}", begun.id),
            name,
            file: stored.file.clone(),
            made: stored.made.clone(),
            seconds: stored.seconds,
            was_interrupted: stored.was_interrupted,
            is_stale: project.is_stale(begun),
            options: begun.request.options.clone(),
            has_report: stored.report.is_some(),
            problem,
            facts: model.ok().map(|model| Facts::of(&model)),
        }
    }
}

impl Facts {
    fn of(model: &Model) -> Self {
        let provenance = model.provenance();
        let selection = provenance.selection.as_ref();
        let [chosen, why] = match selection {
            Some(selection) => selection.summary().map(Some),
            None => [None, None],
        };
        let members = selection.map_or_else(Vec::new, |selection| {
            let counted = selection.candidates.iter().filter(|candidate| candidate.members > 0);
            let member = |candidate: &hysid::model::selection::CandidateResult| Member {
                name: candidate.name.clone(),
                count: candidate.members,
                share: candidate.share.inside,
            };
            counted.map(member).collect()
        });
        let names = model.names();
        Self {
            termination: provenance.termination.to_string(),
            parameters: model.parameters(),
            members,
            chosen,
            why,
            notes: model.notes().iter().map(ToString::to_string).collect(),
            train: provenance.train.clone(),
            validation: provenance.validation.clone(),
            has_band: model.band().is_some(),
            needs_time: drive::needs_time(model),
            inputs: names.inputs.clone(),
            input_labels: names.inputs.iter().map(|name| unit::label(name)).collect(),
            output_label: unit::label(&names.output),
            time_label: names.time.as_deref().map_or_else(|| "time".into(), unit::label),
            ranges: model.trained_ranges().inputs.clone(),
            largest_rate: model.trained_ranges().rate.map(|(low, high)| low.abs().max(high.abs())),
        }
    }
}

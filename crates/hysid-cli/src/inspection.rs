//! Content of a model file, for `hysid models MODEL.json`.

use std::path::Path;

use anyhow::Result;
use hysid::data::metrics::Errors;
use hysid::data::unit;
use hysid::law::Parameter;
use hysid::model::{Model, ParameterInUnits, Predictor, Provenance, Weights};
use hysid_app::{initial_state, parameters, provenance};
use hysid_core::significant::Significant;
use hysid_document::plain::rendered;
use hysid_document::{Cell, Part, Table, count, object};
use serde::{Deserialize, Serialize};

use hysid_app::errors_table::{AFTER_WARM_UP, errors_table};

/// A model and its file.
pub struct Inspected<'m> {
    file: String,
    bytes: usize,
    header: Header,
    model: &'m Model,
}

/// Format version and program of the file.
#[derive(Deserialize)]
struct Header {
    version: u64,
    written_by: String,
}

/// Errors on stored sets of data, by name: the training data and what was held out.
pub fn stored_errors(provenance: &Provenance) -> Vec<(&'static str, &Errors)> {
    let mut sets = vec![("train", &provenance.train)];
    sets.extend(provenance.train_after_warm_up.as_ref().map(|errors| (AFTER_WARM_UP, errors)));
    sets.extend(provenance.validation.as_ref().map(|errors| ("validation", errors)));
    sets
}

impl<'m> Inspected<'m> {
    /// The model that was read from the content of a file.
    pub fn of(path: &Path, content: &[u8], model: &'m Model) -> Result<Self> {
        let header = serde_json::from_slice(content)?;
        Ok(Self { file: path.display().to_string(), bytes: content.len(), header, model })
    }

    /// All of it as text within 80 columns, as far as names allow.
    pub fn text(&self) -> String {
        let provenance = self.model.provenance();
        let head = [
            Part::section(format!("Model file {}", self.file), [Part::Definitions(self.facts())]),
            Part::section("Columns", [Part::Table(self.columns())]),
        ];
        let mut text =
            rendered(&head) + "\nErrors of free runs\n\n" + &errors_table(&stored_errors(provenance));
        let mut parts = Vec::new();
        if let Some(selection) = &provenance.selection {
            let lines = ["Chosen", "Why"].into_iter().map(String::from).zip(selection.summary()).collect();
            parts.push(Part::section("Selection", [Part::Definitions(lines)]));
        }
        parts.extend(self.members().map(|table| Part::section("Members", [Part::Table(table)])));
        if let Some(table) = parameters::table(self.model, None) {
            let more = parameters::left_out(self.model).map(Part::note);
            let content: Vec<Part> = std::iter::once(Part::Table(table)).chain(more).collect();
            parts.push(Part::section("Parameters", content));
        }
        parts.push(Part::section(
            "Options and provenance",
            [Part::Definitions(provenance::of_model(self.model))],
        ));
        let notes = self.model.notes();
        if !notes.is_empty() {
            parts.push(Part::section("Notes", [Part::warnings(&notes)]));
        }
        text += "\n";
        text + &rendered(&parts)
    }

    /// Kind, size and origin of the model, label and text.
    fn facts(&self) -> Vec<(String, String)> {
        let model = self.model;
        let mut facts = Vec::new();
        let mut say = |name: &str, text: String| facts.push((name.to_string(), text));
        say("Model", self.kind());
        say("Parameters", model.parameters().to_string());
        say(
            "Size of the file",
            format!("{} kB", Significant((self.bytes as f64 / 1000.0 * 10.0).ceil() / 10.0)),
        );
        let Header { version, written_by } = &self.header;
        say("Written by", format!("{written_by}, format version {version}; a model file has no date"));
        say("Needs time stamps", if model.needs_time() { "yes" } else { "no" }.into());
        let band = model.band().map(|band| band.rows());
        say(
            "Prediction band",
            band.map_or_else(
                || "none".into(),
                |(inside, outside)| {
                    format!("from {inside} held-out rows inside the trained range and {outside} outside")
                },
            ),
        );
        facts
    }

    fn kind(&self) -> String {
        let name = self.model.name().name();
        match self.model.predictor() {
            Predictor::Network { network, .. } => {
                let a = network.architecture();
                let relaxation = match a.relaxation {
                    0 => String::new(),
                    neurons => format!(", {}", count(neurons, "relaxation neuron")),
                };
                format!(
                    "{name}: network of {}, {}{relaxation}",
                    count(a.stops, "stop"),
                    count(a.hidden, "tanh neuron")
                )
            }
            Predictor::Law(_) => format!("{name}: a law"),
            Predictor::Ensemble(ensemble) => {
                format!("{name}: ensemble of {}", count(ensemble.members().len(), "member"))
            }
        }
    }

    /// Columns of the data, with units and trained ranges.
    fn columns(&self) -> Table {
        let (names, ranges) = (self.model.names(), self.model.trained_ranges());
        let mut table = Table::new(["role", "column", "unit", "trained from", "to"]);
        let mut push = |role: &str, name: &str, range: Option<(f64, f64)>| {
            let unit = unit::of_column(name).map_or_else(String::new, |unit| unit::written(&unit));
            let (low, high) = range.map_or((None, None), |(low, high)| (Some(low), Some(high)));
            table.push([role.into(), name.into(), unit.into(), Cell::number(low, 5), Cell::number(high, 5)]);
        };
        if let Some(time) = &names.time {
            push("time", time, None);
        }
        for (name, &range) in names.inputs.iter().zip(&ranges.inputs) {
            push("input", name, Some(range));
        }
        if self.model.rate().is_some() {
            push("rate", names.rate.as_deref().unwrap_or("(computed)"), ranges.rate);
        }
        push("output", &names.output, Some(ranges.output));
        table
    }

    /// The members of an ensemble, those with the largest weight first.
    fn members(&self) -> Option<Table> {
        let members = members(self.model);
        if members.is_empty() {
            return None;
        }
        let percent = |share: f64| Cell::number(100.0 * share, 3);
        let row = |member: &Member| {
            vec![
                member.model.into(),
                member.parameters.into(),
                percent(member.weights.inside),
                percent(member.weights.outside),
            ]
        };
        let columns = ["model", "parameters", "weight inside (%)", "weight outside (%)"];
        Some(Table::new(columns).with_rows(members.iter().map(row)))
    }

    /// The object that `--json` prints.
    pub fn printed(&self) -> impl Serialize {
        let (model, names, provenance) = (self.model, self.model.names(), self.model.provenance());
        let ranges = model.trained_ranges();
        let unit = |name: &String| unit::of_column(name);
        object! {
            file: &self.file,
            bytes: self.bytes,
            written_by: &self.header.written_by,
            format_version: self.header.version,
            model: model.name().name(),
            parameters: model.parameters(),
            needs_time: model.needs_time(),
            columns: names,
            units: object! {
                time: names.time.as_ref().and_then(unit),
                inputs: names.inputs.iter().map(unit).collect::<Vec<_>>(),
                output: unit(&names.output),
            },
            rate: model.rate(),
            trained_ranges: object! { inputs: &ranges.inputs, rate: ranges.rate, output: ranges.output },
            initial_state: initial_state(model).unwrap_or_else(|| "virgin".into()),
            /// Rows with an output that it was trained on.
            samples: provenance.samples,
            records: provenance.records,
            termination: provenance.termination.to_string(),
            options: &provenance.options,
            train: &provenance.train,
            train_after_warm_up: provenance.train_after_warm_up.as_ref(),
            validation: provenance.validation.as_ref(),
            selection: provenance.selection.as_ref(),
            has_band: model.band().is_some(),
            /// Empty unless it is an ensemble.
            members: members(model),
            /// Empty unless it is a law.
            law_parameters: law_parameters(model),
            notes: model.notes(),
        }
    }
}

#[derive(Serialize)]
struct Member {
    model: &'static str,
    parameters: usize,
    /// Shares in the whole ensemble, 0 to 1.
    weights: Weights,
}

fn members(model: &Model) -> Vec<Member> {
    let Some(ensemble) = model.ensemble() else { return Vec::new() };
    let member = |(index, weights): (usize, Weights)| {
        let member = &ensemble.members()[index];
        Member { model: member.name().name(), parameters: member.parameters(), weights }
    };
    let mut members: Vec<Member> = ensemble.group().shares().into_iter().map(member).collect();
    members.sort_by(|a, b| b.weights.inside.total_cmp(&a.weights.inside));
    members
}

fn law_parameters(model: &Model) -> Vec<impl Serialize> {
    let all = model.law_parameters().into_iter().flatten();
    let printed = |ParameterInUnits { parameter, unit, .. }| {
        let Parameter { symbol, meaning, value, .. } = parameter;
        object! { symbol: symbol, meaning: meaning, value: value, unit: unit }
    };
    all.map(printed).collect()
}

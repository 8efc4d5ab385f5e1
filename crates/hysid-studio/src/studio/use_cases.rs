//! Further use cases of the page: the inverse along a wanted output, the next measurement, the restoring force.

use std::path::Path;

use hysid::data::summary::Summary;
use hysid::model::Model;
use hysid::plan::{LimitOptions, Plan, PlanOptions, Protocol, ProtocolOptions};
use hysid_app::inversion::{self, DriveTable, InputBounds, Inverted, Preview, ReferenceOutputs};
use hysid_app::plan::{self as planning, Planned};
use hysid_app::restoring_force::{
    self as force, ForceTable, MeasuredMotion, MotionChoice, RestoringForceRequest,
};
use hysid_document::shell::shown;
use hysid_document::{Face, Part, Problem, Result, html, problem, span, unit};
use hysid_records::{ColumnChoice, Roles, UnitFactors, header_line, understanding};
use hysid_tables::Table;
use serde::{Deserialize, Serialize};

use super::Studio;
use crate::project::{ProjectFile, Use};
use crate::view::read;

/// A result for the page: its parts as HTML, and a table to be saved.
#[derive(Serialize)]
pub struct Made {
    html: String,
    file: String,
    table: String,
}

impl Made {
    fn new(parts: &[Part], stem: &str, ending: &str, table: Vec<u8>) -> Self {
        let table = String::from_utf8(table).expect("a table is text");
        Self { html: html::parts(parts), file: format!("{}.{ending}.csv", stem_of(stem)), table }
    }
}

fn stem_of(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

/// A wanted output, and the bounds of the input; the trained range where none is given.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InverseAsked {
    file: u64,
    low: Option<f64>,
    high: Option<f64>,
    slew: Option<f64>,
}

/// Limits of a drive: those of the training data, or of a first test of a kind of specimen.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanAsked {
    kind: Option<String>,
    low: Option<f64>,
    high: Option<f64>,
    length: Option<usize>,
    step: Option<f64>,
    max_rate: Option<f64>,
}

/// The motion of a mass in a file; columns that are not named are found.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceAsked {
    file: u64,
    mass: String,
    displacement: Option<String>,
    velocity: Option<String>,
    acceleration: Option<String>,
    absolute_acceleration: Option<String>,
    base_acceleration: Option<String>,
    applied_force: Option<String>,
}

/// Bounds of the input of an inverse; one that is missing is that of the training data.
pub fn limits(model: &Model, low: Option<f64>, high: Option<f64>) -> Option<(f64, f64)> {
    let trained = model.trained_ranges().inputs[0];
    (low.is_some() || high.is_some()).then(|| (low.unwrap_or(trained.0), high.unwrap_or(trained.1)))
}

impl Studio {
    /// A file of the project as it is read, whatever its columns are.
    fn table_of(&self, id: u64) -> Result<(ProjectFile, Table)> {
        let (file, reading) = {
            let project = self.project();
            (project.file(id)?.clone(), project.understanding.reading.clone())
        };
        let table = read(&file, &self.folder, &reading.reading()?)?;
        Ok((file, table))
    }

    /// The input that drives a model along the output of a file.
    pub fn inverse(&self, id: u64, asked: &InverseAsked) -> Result<Made> {
        let (model, stored) = (self.model(id)?, self.stored_model(id)?);
        let (file, table) = self.table_of(asked.file)?;
        let limits = limits(&model, asked.low, asked.high);
        let bounds = InputBounds { limits, slew: asked.slew, preview: Preview::Auto, band: None };
        let all = stored.columns_in(&model, &table, &file);
        let columns = ColumnChoice { input: all.input.into_iter().skip(1).collect(), ..all };
        let roles = Roles::of_inverse(&model, bounds.need_time(&model)?, &table, &columns)?;
        let factors = UnitFactors::of(&model, &roles, &table.file, true, false)?;
        let wanted = ReferenceOutputs::of(&table, &roles, &factors)?;
        let inverted = Inverted::of(&model, &wanted, &bounds)?;
        let input = &model.names().inputs[0];
        let (range, of) = match limits {
            Some(range) => (range, ""),
            None => (model.trained_ranges().inputs[0], ", the trained range"),
        };
        let understood = [
            ("model".to_string(), stored.file.clone()),
            ("wanted".into(), format!("{} of {}", roles.output, file.name)),
            ("drive".into(), format!("{}, from {}{of}", unit::label(input), span(range))),
        ];
        let mut warnings = inverted.warnings();
        warnings.extend(model.stepping_note().map(String::from));
        let page = inversion::page(&model, &wanted, &inverted, &bounds, &understood, &warnings);
        let drive = DriveTable::of(&model, &table, false)?;
        let text = [drive.header(&table), drive.rows(&table, &wanted, &inverted)].concat();
        Ok(Made::new(&page.parts, &file.name, "drive", text))
    }

    /// The drive of the next test, or of a first one.
    pub fn plan(&self, asked: &PlanAsked) -> Result<Made> {
        let refused = |error: hysid::Error| Problem::request(error.to_string());
        let range = match (asked.low, asked.high) {
            (Some(low), Some(high)) => Some((low, high)),
            (None, None) => None,
            _ => return Err(problem!("the range of the input needs both a lowest and a highest value")),
        };
        let PlanAsked { length, step, max_rate, .. } = *asked;
        let limits = LimitOptions { range, step, max_rate, length };
        let (plan, understood, name, next) = match &asked.kind {
            Some(kind) => {
                let protocol = Protocol::named(kind).map_err(refused)?;
                if range.is_none() {
                    return Err(problem!("a first test needs the range of the input"));
                }
                let plan = protocol.plan(&ProtocolOptions { limits, wave: None }).map_err(refused)?;
                (plan, Vec::new(), protocol.name().to_string(), "hysid fit NEW.csv".to_string())
            }
            None => {
                let data = self.training_data()?;
                data.unused_inputs("the plan drives", "driven")
                    .map_or(Ok(()), |words| Err(Problem::Request(words)))?;
                let options = PlanOptions { limits, ..PlanOptions::default() };
                let plan = Plan::of(&data.set, &options).map_err(|error| data.explain(error))?;
                let understood = understanding::of_data(&data, &Summary::of(&data.set), Face::Studio);
                let files: Vec<String> = self
                    .project()
                    .files_for(Use::Training)
                    .map(|file| shown(Path::new(&file.name)))
                    .collect();
                let next = format!("hysid fit {} NEW.csv", files.join(" "));
                (plan, understood, data.source.tables[0].file.clone(), next)
            }
        };
        let columns = plan.names.time.iter().chain(&plan.names.inputs[..1]).map(String::as_str);
        let text = [header_line(b',', columns), planning::rows(&plan)].concat();
        let planned = Planned { plan: &plan, title: "What to measure next".into(), understood, next };
        Ok(Made::new(&planning::page(&planned).parts, &name, "drive", text))
    }

    /// The restoring force of an element from the motion of a mass.
    pub fn restoring_force(&self, asked: &ForceAsked) -> Result<Made> {
        let (file, table) = self.table_of(asked.file)?;
        let columns = MotionChoice {
            displacement: asked.displacement.clone(),
            velocity: asked.velocity.clone(),
            acceleration: asked.acceleration.clone(),
            absolute_acceleration: asked.absolute_acceleration.clone(),
            base_acceleration: asked.base_acceleration.clone(),
            applied_force: asked.applied_force.clone(),
            ..MotionChoice::default()
        };
        let mass = asked.mass.parse().map_err(|needed: String| Problem::option("mass", needed))?;
        let zero = self.project().understanding.reading.zero;
        let request = RestoringForceRequest { columns, mass, same_units: false, window: None, zero };
        let motion = MeasuredMotion::of(&table, &request)?;
        let written = ForceTable::of(&table, &motion)?;
        let found = motion.restoring_force(&request)?;
        let warnings = force::warnings(&motion, &found, None, Face::Studio);
        let understood = force::understood(&table, &motion, &request.mass, &found, Face::Studio);
        let mut parts = vec![
            Part::Command(force::summary(&motion, &found, None)),
            Part::chart(force::chart(&motion, &found)),
        ];
        parts.extend((!warnings.is_empty()).then(|| Part::warnings(&warnings)));
        parts.push(Part::section("How the data were read", [Part::Definitions(understood)]));
        let text = [written.header(), written.rows(&table, &motion, &found, zero)].concat();
        Ok(Made::new(&parts, &file.name, "force", text))
    }
}

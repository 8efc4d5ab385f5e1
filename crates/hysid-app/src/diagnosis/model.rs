//! Diagnosis of a fitted model.

use std::path::Path;

use hysid::data::unit;
use hysid::diagnosis::Finding;
use hysid::diagnosis::model::{ModelDiagnosis, TimeScale, WidthAtSpeed};
use hysid::model::Model;
use hysid_core::significant::Significant;
use hysid_document::plain::columns;
use hysid_document::unit::label as unit_label;
use hysid_document::{Cell, Page, Part, Problem, Result, Table, object};

use super::cards::{EXPLANATION, cards, sentence, verdicts};
use super::{findings, invertibility, paragraph};
use crate::quantities::{Quantities, text_label};

/// A diagnosis of a model, and the text around it.
pub struct DiagnosedModel<'a> {
    file: String,
    model: &'a Model,
    diagnosis: ModelDiagnosis,
    quantities: Quantities,
}

impl<'a> DiagnosedModel<'a> {
    /// Diagnoses the model of a file.
    pub fn of(path: &Path, model: &'a Model) -> Result<Self> {
        let file = path.display().to_string();
        let diagnosis =
            ModelDiagnosis::of(model).map_err(|error| Problem::in_file(&file, error.to_string()))?;
        Ok(Self { file, model, diagnosis, quantities: Quantities::of(model.names()) })
    }

    /// Which model it is and what it was driven with, label and text.
    pub fn understood(&self) -> Vec<(String, String)> {
        let (names, probing) = (self.model.names(), &self.diagnosis.probing);
        let value = |value: f64, name: &str| {
            format!("{:.4}{}", Significant(value), unit::suffix(unit::split(name).1.as_deref()))
        };
        let speed = |speed: f64| value(speed, &self.quantities.as_speed("speed"));
        let mut lines = vec![
            ("file".to_string(), self.file.clone()),
            (
                "model".to_string(),
                format!("{}: {} parameters", self.model.name().name(), self.model.parameters()),
            ),
        ];
        let mut say = |label: &str, text: String| lines.push((label.to_string(), text));
        let (low, high) = probing.input;
        say(
            "input",
            format!(
                "{}: driven over {:.4} to {}",
                names.inputs[0],
                Significant(low),
                value(high, &names.inputs[0])
            ),
        );
        for (name, &held) in names.inputs.iter().skip(1).zip(&probing.held) {
            say("input", format!("{name}: held at {}", value(held, name)));
        }
        say("output", names.output.clone());
        let from = match probing.time_scale {
            TimeScale::TrainedRates => "the trained rates",
            TimeScale::RelaxationTimes => "its relaxation times",
            TimeScale::None => "any: the model has neither rate nor time as an input",
        };
        let speeds: Vec<String> = probing.speeds.iter().map(|&v| speed(v)).collect();
        say(
            "speeds",
            if speeds.is_empty() { from.into() } else { format!("{}, from {from}", speeds.join(", ")) },
        );
        if let Some(rows) = probing.rows_in_words() {
            say("rows", rows);
        }
        if let Some(outside) = &probing.outside {
            say("outside", outside.clone());
        }
        lines
    }

    /// The properties, the verdicts from equations, and the widths of the loops.
    pub fn diagnosis(&self) -> &ModelDiagnosis {
        &self.diagnosis
    }

    /// All of it within 80 columns.
    pub fn text(&self) -> String {
        let mut parts = vec![findings::text(self.diagnosis.findings())];
        if !self.diagnosis.promises.is_empty() {
            let lines = columns(&self.promises(), Cell::ascii);
            let lines: String = lines.iter().map(|line| format!("{line}\n")).collect();
            parts.push(format!("verdicts from equations (! where probing contradicts)\n{lines}"));
        }
        let widths = self.widths(text_label).map_or_else(Vec::new, |widths| columns(&widths, Cell::ascii));
        let widths: String = widths.iter().map(|line| format!("{line}\n")).collect();
        parts.push(paragraph(&self.widths_heading()) + &widths);
        parts.join("\n")
    }

    pub fn json(&self) -> Result<String> {
        let printed = object! {
            input: &self.quantities.input,
            output: &self.quantities.output,
            parameters: self.model.parameters(),
            #[serde(flatten)]
            diagnosis: &self.diagnosis,
        };
        Ok(hysid_document::json(&printed)?)
    }

    pub fn page(&self) -> Page {
        let mut cards = cards(&self.diagnosis.properties, &self.quantities, |_: &Finding| String::new());
        cards.push(invertibility::card(&self.diagnosis.invertibility, &self.quantities));
        let mut widths = vec![Part::paragraph(sentence(&self.widths_heading()))];
        widths.extend(self.widths(unit_label).map(Part::Table));
        let mut parts = vec![
            Part::section("Verdicts", [verdicts(self.diagnosis.findings())]),
            Part::section("Property by property", [Part::Cards(cards), Part::note(EXPLANATION)]),
        ];
        parts.extend(self.promises_section());
        parts.push(Part::section("Widths of the loop", widths));
        parts.push(Part::section("Inputs of the probing", [Part::Definitions(self.understood())]));
        Page { title: format!("Diagnosis: {}", self.file), parts }
    }

    /// Structural properties that the equations guarantee.
    fn promises(&self) -> Table {
        let rows = self.diagnosis.promises.iter().map(|promise| {
            let contradicted = if promise.agrees == Some(false) { " !" } else { "" };
            vec![promise.property.name().into(), format!("{}{contradicted}", promise.verdict).into()]
        });
        Table::new(["property", "equations"]).with_rows(rows)
    }

    fn promises_section(&self) -> Option<Part> {
        let words = "These properties follow from the equations for all parameters. An ! marks a verdict that \
                     probing contradicts.";
        let has_any = !self.diagnosis.promises.is_empty();
        has_any.then(|| {
            Part::section("Verdicts from equations", [Part::Table(self.promises()), Part::note(words)])
        })
    }

    fn widths_heading(&self) -> String {
        let widths = &self.diagnosis.loop_widths;
        let unit = unit::suffix(unit::of_column(&self.quantities.input).as_deref());
        let speed = if widths.dynamic.is_empty() { "at any speed" } else { "as the speed goes to 0" };
        let at_speed = if widths.dynamic.is_empty() { "" } else { "; P is the additional width at a speed" };
        let width = match widths.static_width {
            Some(width) => format!("K = {:.4}{unit}", Significant(width)),
            None => "no K, because a branch does not cross its half height".into(),
        };
        format!("width of the loop over the whole range, {speed}: {width}{at_speed}")
    }

    /// The paper's P at each speed; `None` for a model that does not see the speed.
    fn widths(&self, label: fn(&str) -> String) -> Option<Table> {
        let widths = &self.diagnosis.loop_widths;
        let headings = [
            self.quantities.as_speed("speed"),
            self.quantities.as_input("width"),
            self.quantities.as_input("P"),
        ];
        let at_speed = |at: &WidthAtSpeed| {
            vec![Cell::number(at.speed, 4), Cell::number(at.width, 4), Cell::number(at.widening, 4)]
        };
        let table =
            Table::new(headings.map(|name| label(&name))).with_rows(widths.dynamic.iter().map(at_speed));
        (!widths.dynamic.is_empty()).then_some(table)
    }
}

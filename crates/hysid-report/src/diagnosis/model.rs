//! What is told of a fitted model.

use std::path::Path;

use anyhow::{Result, anyhow};
use hysid::data::unit;
use hysid::diagnosis::model::{Basis, Claim, Criterion, ModelDiagnosis, NeuronKind, TimeScale, WidthAtSpeed};
use hysid::diagnosis::{Finding, Property, Verdict};
use hysid::model::Model;
use hysid::significant::Significant;
use hysid_document::plain::{columns, indented};
use hysid_document::unit::label as unit_label;
use hysid_document::{Cell, Page, Part, Table};
use serde::Serialize;

use super::cards::{EXPLANATION, cards, sentence, verdicts};
use super::{findings, invertibility, paragraph};
use crate::quantities::{Quantities, text_label};
use hysid_document::visible::listed;

/// Neurons in the table of a page; of more, those that matter most.
const MOST_NEURONS: usize = 40;

/// A diagnosis of a model, and what is told with it.
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
        let diagnosis = ModelDiagnosis::of(model).map_err(|error| anyhow!("{file}: {error}"))?;
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
        if let Some(outside) = &probing.outside {
            say("outside", outside.clone());
        }
        lines
    }

    /// All of it within 80 columns.
    pub fn text(&self) -> String {
        let mut parts = vec![findings::text(self.diagnosis.findings())];
        let inside = self.inside();
        if !inside.rows.is_empty() {
            let mut text =
                String::from("verdicts from equations and weights (! where probing contradicts)\n");
            let statements = self.inside_statements();
            for (line, statement) in
                columns(&inside, Cell::ascii).iter().zip(std::iter::once(None).chain(statements))
            {
                text += &format!("{line}\n{}", statement.map_or_else(String::new, |text| indented(&text, 4)));
            }
            parts.push(text);
        }
        if let Some(weights) = &self.diagnosis.weights {
            let kinds = NEURON_KINDS.iter().filter_map(|&kind| {
                let of_kind = weights.neurons.iter().filter(|neuron| neuron.kinds.contains(&kind));
                let names: Vec<&str> = of_kind.map(|neuron| neuron.name.as_str()).collect();
                (!names.is_empty())
                    .then(|| paragraph(&format!("{} {}: {}", names.len(), kind_name(kind), listed(&names))))
            });
            parts.push(format!("neurons\n{}", kinds.collect::<String>()));
        }
        let widths = self.widths(text_label).map_or_else(Vec::new, |widths| columns(&widths, Cell::ascii));
        let widths: String = widths.iter().map(|line| format!("{line}\n")).collect();
        parts.push(paragraph(&self.widths_heading()) + &widths);
        let claims = self.claims();
        let claims = claims.iter().map(|(name, text)| indented(&format!("{name}: {text}"), 2));
        parts.push(format!("memory\n{}", claims.collect::<String>()));
        parts.join("\n")
    }

    /// All of it as one JSON object.
    pub fn json(&self) -> Result<String> {
        let printed = Printed {
            input: &self.quantities.input,
            output: &self.quantities.output,
            parameters: self.model.parameters(),
            diagnosis: &self.diagnosis,
        };
        Ok(hysid_document::json(&printed)?)
    }

    /// The page.
    pub fn page(&self) -> Page {
        let mut cards = cards(&self.diagnosis.properties, &self.quantities, |_: &Finding| String::new());
        cards.push(invertibility::card(&self.diagnosis.invertibility, &self.quantities));
        let claims: Vec<(String, String)> =
            self.claims().into_iter().map(|(name, text)| (name.to_string(), sentence(&text))).collect();
        let mut widths = vec![Part::paragraph(sentence(&self.widths_heading()))];
        widths.extend(self.widths(unit_label).map(Part::Table));
        let mut parts = vec![
            Part::section("Verdicts", [verdicts(self.diagnosis.findings())]),
            Part::section("Memory", [Part::Definitions(claims)]),
            Part::section("Property by property", [Part::Cards(cards), Part::note(EXPLANATION)]),
        ];
        parts.extend(self.inside_section());
        parts.extend(self.neurons_section());
        parts.push(Part::section("Widths of the loop", widths));
        parts.push(Part::section("Inputs of the probing", [Part::Definitions(self.understood())]));
        Page { title: format!("Diagnosis: {}", self.file), parts }
    }

    /// What equations promise and weights say of each property.
    fn inside(&self) -> Table {
        let mut table = Table::new(["property", "equations", "weights", "value", "threshold"]);
        for property in self.inside_properties() {
            let said = |said: Option<(Verdict, Option<bool>)>| {
                said.map_or(Cell::Missing, |(verdict, agrees)| {
                    format!("{verdict}{}", if agrees == Some(false) { " !" } else { "" }).into()
                })
            };
            let promise = self.diagnosis.promises.iter().find(|promise| promise.property == property);
            let criterion = self.criterion(property);
            table.push([
                property.name().into(),
                said(promise.map(|promise| (promise.verdict, promise.agrees))),
                said(criterion.map(|criterion| (criterion.verdict, criterion.agrees))),
                criterion.map(|criterion| criterion.value).into(),
                criterion.map(|criterion| criterion.threshold).into(),
            ]);
        }
        table
    }

    fn criterion(&self, property: Property) -> Option<&Criterion> {
        let criteria = self.diagnosis.weights.iter().flat_map(|weights| &weights.criteria);
        criteria.into_iter().find(|criterion| criterion.property == property)
    }

    /// Properties that equations or weights say something of.
    fn inside_properties(&self) -> impl Iterator<Item = Property> + use<'_, 'a> {
        let promised = |property| self.diagnosis.promises.iter().any(|promise| promise.property == property);
        Property::ALL
            .into_iter()
            .filter(move |&property| promised(property) || self.criterion(property).is_some())
    }

    /// What the number of each criterion is.
    fn inside_statements(&self) -> impl Iterator<Item = Option<String>> + use<'_, 'a> {
        self.inside_properties()
            .map(|property| self.criterion(property).map(|criterion| criterion.statement.clone()))
    }

    fn inside_section(&self) -> Option<Part> {
        let table = self.inside();
        if table.rows.is_empty() {
            return None;
        }
        let properties = self.inside_properties().map(|property| property.name().to_string());
        let statements = properties.zip(self.inside_statements());
        let statements: Vec<(String, String)> =
            statements.filter_map(|(property, statement)| Some((property, sentence(&statement?)))).collect();
        let words = "Some properties follow from the equations for all parameters, others from the weights \
                     of the network. An ! marks a verdict that probing contradicts.";
        let parts = [Part::Table(table), Part::Definitions(statements), Part::note(words)];
        Some(Part::section("Verdicts from equations and weights", parts))
    }

    fn neurons_section(&self) -> Option<Part> {
        let weights = self.diagnosis.weights.as_ref()?;
        let mut order: Vec<usize> = (0..weights.neurons.len()).collect();
        order.sort_by(|&a, &b| weights.neurons[b].influence.total_cmp(&weights.neurons[a].influence));
        let more = order.len().saturating_sub(MOST_NEURONS);
        order.truncate(MOST_NEURONS);
        let time = named_time(self.model.names().time.as_deref());
        let mut table = Table::new([
            "neuron",
            "without it, %",
            "travel by input",
            "travel by rate",
            "wear, %",
            &time,
            "kind",
        ]);
        for neuron in order.iter().map(|&place| &weights.neurons[place]) {
            let kinds: Vec<&str> = neuron.kinds.iter().map(|&kind| kind_name(kind)).collect();
            table.push([
                neuron.name.as_str().into(),
                (100.0 * neuron.influence).into(),
                neuron.input_swing.into(),
                neuron.rate_swing.into(),
                neuron.wear.map(|wear| 100.0 * wear).into(),
                neuron.relaxation_time.into(),
                kinds.join(", ").into(),
            ]);
        }
        let mut words = "“Without it”: change of the output without the neuron, in percent of its range. \
                         “Travel”: how far the input or the rate moves a stop, in multiples of its \
                         threshold; a stop slips in a slow loop if the travel by the input exceeds 2. \
                         “Wear”: slip in 25 loops over the whole range, in percent of the capacity of the \
                         stop."
            .to_string();
        if more > 0 {
            words += &format!(" {more} neurons of less influence are not shown.");
        }
        Some(Part::section("Neurons", [Part::Table(table), Part::note(words)]))
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

    /// What is certain of the memory, a claim and its words.
    fn claims(&self) -> Vec<(&'static str, String)> {
        let memory = &self.diagnosis.memory;
        let output = &self.quantities.output;
        let suffix = unit::suffix(unit::of_column(output).as_deref());
        let span =
            |(low, high): (f64, f64)| format!("{:.4} to {:.4}{suffix}", Significant(low), Significant(high));
        let bound = &memory.bound;
        let ever = match bound.whatever_the_input {
            Some(all) => format!("{} for any input", span(all)),
            None => "outside these ranges it may grow with the input without bound".into(),
        };
        let reached = span(bound.reached);
        let basis = basis_name(bound.basis);
        let bounded = match bound.in_trained_ranges {
            None => format!(
                "no bound: {output} may grow with the path of the input without limit ({basis}). Range \
                 found by probing: {reached}"
            ),
            Some(range) if width(range) > USELESS * width(bound.reached) => format!(
                "within the trained ranges {output} is bounded, but the bound is {:.0} times as wide as the \
                 range found by probing, which is too wide to be useful ({basis}). Range found by probing: \
                 {reached}",
                Significant(width(range) / width(bound.reached))
            ),
            Some(range) => format!(
                "within the trained ranges {output} stays within {}; {ever} ({basis}). Range found by \
                 probing: {reached}",
                span(range)
            ),
        };
        let claim = |claim: &Claim| {
            let holds = if claim.holds { "yes" } else { "no" };
            format!("{holds} ({}): {}", basis_name(claim.basis), claim.statement)
        };
        vec![
            ("bounded", bounded),
            ("independent of the step", claim(&memory.refinement.independent)),
            ("rate-independent", claim(&memory.rate_independent)),
            ("return-point memory", claim(&memory.return_point_memory)),
        ]
    }
}

/// A bound so many times as wide as the outputs that were reached says nothing.
const USELESS: f64 = 5.0;

fn width((low, high): (f64, f64)) -> f64 {
    high - low
}

/// The object that `--json` prints of a model.
#[derive(Serialize)]
struct Printed<'a> {
    input: &'a str,
    output: &'a str,
    parameters: usize,
    #[serde(flatten)]
    diagnosis: &'a ModelDiagnosis,
}

fn named_time(time: Option<&str>) -> String {
    let unit = time.and_then(unit::of_column);
    unit.map_or("relaxation time".into(), |unit| unit_label(&format!("relaxation time [{unit}]")))
}

fn basis_name(basis: Basis) -> &'static str {
    match basis {
        Basis::Structure => "by its equations",
        Basis::Weights => "by its weights",
        Basis::Probing => "by probing",
    }
}

/// All kinds, in the order in which they are told.
const NEURON_KINDS: [NeuronKind; 7] = [
    NeuronKind::Static,
    NeuronKind::Dynamic,
    NeuronKind::Deteriorating,
    NeuronKind::Relaxation,
    NeuronKind::NeverSlips,
    NeuronKind::DiesAtOnce,
    NeuronKind::Idle,
];

fn kind_name(kind: NeuronKind) -> &'static str {
    match kind {
        NeuronKind::Static => "static",
        NeuronKind::Dynamic => "dynamic",
        NeuronKind::Deteriorating => "deteriorating",
        NeuronKind::NeverSlips => "never slipping",
        NeuronKind::DiesAtOnce => "worn out after the first loop",
        NeuronKind::Relaxation => "relaxing",
        NeuronKind::Idle => "without influence",
    }
}

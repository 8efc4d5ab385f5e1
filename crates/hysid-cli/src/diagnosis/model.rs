//! What is told of a fitted model.

use std::path::Path;

use anyhow::{Result, anyhow};
use hysid::data::unit;
use hysid::diagnosis::model::{Basis, Claim, Criterion, ModelDiagnosis, NeuronKind, TimeScale, WidthAtSpeed};
use hysid::diagnosis::{Finding, Property, Verdict};
use hysid::model::Model;
use hysid::significant::Significant;
use serde::Serialize;

use super::cards::{EXPLANATION, cards, sentence, verdicts};
use super::quantities::{Quantities, text_label};
use super::{findings, paragraph};
use crate::lines::{aligned, indented};
use crate::page::{self, definitions, note, number, section};
use crate::report::unit_label;
use crate::terminal::{self, listed};

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
            TimeScale::TrainedRates => "the rates it was trained on",
            TimeScale::RelaxationTimes => "its relaxation times",
            TimeScale::None => "any: it sees neither rate nor time",
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
        let mut parts = vec![findings::text(&self.diagnosis.properties)];
        let inside = self.inside();
        if inside.len() > 1 {
            let mut text = String::from("what equations and weights say (! where probing says otherwise)\n");
            let statements = self.inside_statements();
            for (line, statement) in aligned(&inside).iter().zip(std::iter::once(None).chain(statements)) {
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
        let widths: String =
            aligned(&self.widths(text_label)).iter().map(|line| format!("{line}\n")).collect();
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
        terminal::json(&printed)
    }

    /// The page.
    pub fn page(&self) -> String {
        let found = &self.diagnosis.properties;
        let cards = cards(found, &self.quantities, |_: &Finding| String::new());
        let claims: Vec<(String, String)> =
            self.claims().into_iter().map(|(name, text)| (name.to_string(), sentence(&text))).collect();
        let content = [
            section("Verdicts", &verdicts(found)),
            section("Memory", &definitions(&claims)),
            section("Property by property", &(cards + &note(EXPLANATION))),
            self.inside_section(),
            self.neurons_section(),
            section(
                "Widths of the loop",
                &(page::paragraph(&sentence(&self.widths_heading())) + &rows(&self.widths(unit_label))),
            ),
            section("What was driven, and how", &definitions(&self.understood())),
        ];
        page::whole(&format!("Diagnosis: {}", self.file), &content.concat())
    }

    /// What equations promise and weights say of each property, with headings.
    fn inside(&self) -> Vec<Vec<String>> {
        let headings = ["property", "equations", "weights", "value", "threshold"];
        let mut table = vec![headings.map(String::from).to_vec()];
        for property in self.inside_properties() {
            let said = |said: Option<(Verdict, Option<bool>)>| {
                said.map_or("-".into(), |(verdict, agrees)| {
                    format!("{verdict}{}", if agrees == Some(false) { " !" } else { "" })
                })
            };
            let promise = self.diagnosis.promises.iter().find(|promise| promise.property == property);
            let criterion = self.criterion(property);
            let value = |value: Option<f64>| value.map_or("-".into(), |v| format!("{:.3}", Significant(v)));
            table.push(vec![
                property.name().to_string(),
                said(promise.map(|promise| (promise.verdict, promise.agrees))),
                said(criterion.map(|criterion| (criterion.verdict, criterion.agrees))),
                value(criterion.map(|criterion| criterion.value)),
                value(criterion.map(|criterion| criterion.threshold)),
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

    fn inside_section(&self) -> String {
        let table = self.inside();
        if table.len() == 1 {
            return String::new();
        }
        let properties = self.inside_properties().map(|property| property.name().to_string());
        let statements = properties.zip(self.inside_statements());
        let statements: Vec<(String, String)> =
            statements.filter_map(|(property, statement)| Some((property, sentence(&statement?)))).collect();
        let words = "Equations decide some properties whatever the parameters; the weights of a network tell more. An ! marks where \
                     probing says otherwise.";
        section("What equations and weights say", &(rows(&table) + &definitions(&statements) + &note(words)))
    }

    fn neurons_section(&self) -> String {
        let Some(weights) = &self.diagnosis.weights else { return String::new() };
        let mut order: Vec<usize> = (0..weights.neurons.len()).collect();
        order.sort_by(|&a, &b| weights.neurons[b].influence.total_cmp(&weights.neurons[a].influence));
        let more = order.len().saturating_sub(MOST_NEURONS);
        order.truncate(MOST_NEURONS);
        let cell = |value: Option<f64>| value.map_or("–".into(), |value| number(value, 3));
        let time = named_time(self.model.names().time.as_deref());
        let headings = [
            "neuron",
            "without it, %",
            "moved by the input",
            "by the rate",
            "wear, %",
            &time,
            "what it does",
        ];
        let mut table = vec![headings.map(String::from).to_vec()];
        table.extend(order.iter().map(|&place| {
            let neuron = &weights.neurons[place];
            let kinds: Vec<&str> = neuron.kinds.iter().map(|&kind| kind_name(kind)).collect();
            vec![
                neuron.name.clone(),
                number(100.0 * neuron.influence, 3),
                cell(neuron.input_swing),
                cell(neuron.rate_swing),
                cell(neuron.wear.map(|wear| 100.0 * wear)),
                cell(neuron.relaxation_time),
                kinds.join(", "),
            ]
        }));
        let mut words = "“Without it” is how much the output changes without the neuron, in percent of its range. Input and rate move a stop \
                         so many times its threshold; beyond 2 it slips at rest. Wear is the slip of 25 loops over the whole range, in percent of \
                         what the stop can bear."
            .to_string();
        if more > 0 {
            words += &format!(" {more} neurons of less influence are not shown.");
        }
        section("Neurons", &(rows(&table) + &note(&words)))
    }

    fn widths_heading(&self) -> String {
        let widths = &self.diagnosis.loop_widths;
        let unit = unit::suffix(unit::of_column(&self.quantities.input).as_deref());
        let speed = if widths.dynamic.is_empty() { "at any speed" } else { "as the speed goes to 0" };
        let at_speed = if widths.dynamic.is_empty() { "" } else { "; P is by how much it is wider at speed" };
        let width = match widths.static_width {
            Some(width) => format!("K = {:.4}{unit}", Significant(width)),
            None => "no K, because a branch does not pass the middle of its height".into(),
        };
        format!("width of the loop over the whole range, {speed}: {width}{at_speed}")
    }

    /// The paper's P at each speed, with headings; none for a model that does not see the speed.
    fn widths(&self, label: fn(&str) -> String) -> Vec<Vec<String>> {
        let widths = &self.diagnosis.loop_widths;
        let shown =
            |value: Option<f64>| value.map_or("-".into(), |value| format!("{:.4}", Significant(value)));
        let headings = [
            self.quantities.as_speed("speed"),
            self.quantities.as_input("width"),
            self.quantities.as_input("P"),
        ];
        if widths.dynamic.is_empty() {
            return Vec::new();
        }
        let mut table = vec![headings.map(|name| label(&name)).to_vec()];
        let at_speed = |at: &WidthAtSpeed| vec![shown(Some(at.speed)), shown(at.width), shown(at.widening)];
        table.extend(widths.dynamic.iter().map(at_speed));
        table
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
            Some(all) => format!("{} whatever the input", span(all)),
            None => "outside of them it may grow with the input for ever".into(),
        };
        let reached = span(bound.reached);
        let basis = basis_name(bound.basis);
        let bounded = match bound.in_trained_ranges {
            None => format!(
                "no bound: {output} may grow with the path of the input for ever ({basis}). Reached was {reached}"
            ),
            Some(range) if width(range) > USELESS * width(bound.reached) => format!(
                "within the trained ranges {output} is bounded, but the bound is {:.0} times as wide as what was reached, \
                 which is too wide to be of use ({basis}). Reached was {reached}",
                Significant(width(range) / width(bound.reached))
            ),
            Some(range) => format!(
                "within the trained ranges {output} stays within {}; {ever} ({basis}). Reached was {reached}",
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

/// A table from its headings and rows; nothing without them.
fn rows(table: &[Vec<String>]) -> String {
    table.split_first().map_or_else(String::new, |(headings, rows)| page::table(headings, rows))
}

fn named_time(time: Option<&str>) -> String {
    let unit = time.and_then(unit::of_column);
    unit.map_or("relaxation time".into(), |unit| unit_label(&format!("relaxation time [{unit}]")))
}

fn basis_name(basis: Basis) -> &'static str {
    match basis {
        Basis::Structure => "by its equations",
        Basis::Weights => "by its weights",
        Basis::Probing => "as probed",
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
        NeuronKind::DiesAtOnce => "dead after the first loop",
        NeuronKind::Relaxation => "relaxing",
        NeuronKind::Idle => "without influence",
    }
}

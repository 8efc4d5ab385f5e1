//! The model file: readable JSON with a version and a checksum.
//!
//! It contains everything needed to simulate the model. Every later version of Hysid reads the files of all
//! released versions: when the layout changes, [`FORMAT_VERSION`] increases and the reader of the earlier
//! layout is kept.

use serde::{Deserialize, Serialize};

use crate::data::known_beginning::KnownBeginning;
use crate::data::rate::RateMethod;
use crate::data::record::ColumnNames;
use crate::data::unit;
use crate::error::{Error, LARGEST_VALUE, MOST_TURNS, Result};
use crate::law::Classical;
use crate::model::input_transform::InputTransform;
use crate::model::{Band, Ensemble, Group, Model, Predictor, Provenance, TrainedRanges};
use crate::network::scaling::Scaling;
use crate::network::{Architecture, Network, ParameterLayout};
use crate::options::ModelName;

/// Version of the layout.
pub const FORMAT_VERSION: u64 = 1;

const FORMAT: &str = "hysid-model";
const CHECKSUM_KEY: &str = "\"checksum\"";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: String,
    version: u64,
    written_by: String,
    model: ModelName,
    columns: ColumnNames,
    units: Units,
    rate: Option<RateMethod>,
    #[serde(default, skip_serializing_if = "InputTransform::is_none")]
    preprocessing: InputTransform,
    trained_ranges: TrainedRanges,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    lead_in: Vec<f64>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    periodic: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    network: Option<NetworkParts>,
    #[serde(skip_serializing_if = "Option::is_none")]
    law: Option<Classical>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ensemble: Option<EnsembleParts>,
    #[serde(skip_serializing_if = "Option::is_none")]
    band: Option<Band>,
    training: Provenance,
    checksum: String,
}

/// The members of an ensemble, how they are combined, and the range outside which the outside weights count.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct EnsembleParts {
    range: (f64, f64),
    group: Group,
    members: Vec<MemberParts>,
}

/// A member: a file without what it shares with the others.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MemberParts {
    model: ModelName,
    rate: Option<RateMethod>,
    #[serde(default, skip_serializing_if = "InputTransform::is_none")]
    preprocessing: InputTransform,
    trained_ranges: TrainedRanges,
    #[serde(skip_serializing_if = "Option::is_none")]
    network: Option<NetworkParts>,
    #[serde(skip_serializing_if = "Option::is_none")]
    law: Option<Classical>,
    training: Provenance,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NetworkParts {
    scaling: Scaling,
    architecture: Architecture,
    memory: Memory,
    readout: Readout,
}

/// Units in the names of the columns, for readers of the file; the program uses the names.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Units {
    time: Option<String>,
    inputs: Vec<Option<String>>,
    output: Option<String>,
}

impl Units {
    fn of(names: &ColumnNames) -> Self {
        Self {
            time: names.time.as_deref().and_then(unit::of_column),
            inputs: names.inputs.iter().map(|name| unit::of_column(name)).collect(),
            output: unit::of_column(&names.output),
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Memory {
    stops: Vec<Stop>,
    linear: Option<Vec<f64>>,
    /// Natural logarithms of the relaxation times, in the unit of time.
    relaxation_ln_tau: Vec<f64>,
}

/// A stop neuron: weights of the first input, its rate, further inputs; ln β.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stop {
    weights: Vec<f64>,
    ln_beta: Option<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Readout {
    /// Bias, then weights of linear neuron, stops, relaxation neurons.
    hidden: Vec<Vec<f64>>,
    /// Constant, then weights of the tanh neurons, then of the direct path.
    output: Vec<f64>,
}

/// Checksum of a file's text up to the checksum itself, without white space between its parts.
fn checksum(text: &str) -> Option<u32> {
    let end = text.rfind(CHECKSUM_KEY)?;
    let (mut is_within_text, mut is_escaped) = (false, false);
    let counts = |byte: &u8| {
        let is_quote = *byte == b'"' && !is_escaped;
        is_escaped = *byte == b'\\' && is_within_text && !is_escaped;
        is_within_text ^= is_quote;
        !byte.is_ascii_whitespace() || is_within_text
    };
    let content: Vec<u8> = text[..end].bytes().filter(counts).collect();
    Some(crc32fast::hash(&content))
}

impl NetworkParts {
    fn of(network: &Network, scaling: &Scaling) -> Self {
        let architecture = *network.architecture();
        let layout = ParameterLayout::new(architecture);
        let parameters = network.parameters();
        let ln_beta = &parameters[layout.ln_beta];
        let stop = |(j, weights): (usize, &[f64])| Stop {
            weights: weights.to_vec(),
            ln_beta: ln_beta.get(j).copied(),
        };
        let stops = parameters[layout.stop_weights].chunks_exact(architecture.channels());
        let run = 1 + architecture.memory_neurons();
        Self {
            scaling: scaling.clone(),
            architecture,
            memory: Memory {
                stops: stops.enumerate().map(stop).collect(),
                linear: architecture.linear.then(|| parameters[layout.linear].to_vec()),
                relaxation_ln_tau: parameters[layout.ln_tau].to_vec(),
            },
            readout: Readout {
                hidden: parameters[layout.hidden].chunks_exact(run).map(<[f64]>::to_vec).collect(),
                output: network.output().to_vec(),
            },
        }
    }

    fn network(&self) -> Result<Network> {
        self.architecture.check()?;
        let (channels, run) = (self.architecture.channels(), 1 + self.architecture.memory_neurons());
        if self.memory.stops.iter().any(|stop| stop.weights.len() != channels) {
            return Err(Error::Parts(format!("not every stop has {channels} weights")));
        }
        if self.readout.hidden.iter().any(|neuron| neuron.len() != run) {
            return Err(Error::Parts(format!("not every hidden neuron has {run} weights")));
        }
        let mut parameters = Vec::with_capacity(ParameterLayout::new(self.architecture).len());
        parameters.extend(self.memory.stops.iter().flat_map(|stop| &stop.weights));
        parameters.extend(self.memory.stops.iter().filter_map(|stop| stop.ln_beta));
        parameters.extend(self.memory.linear.iter().flatten());
        parameters.extend(&self.memory.relaxation_ln_tau);
        parameters.extend(self.readout.hidden.iter().flatten());
        Network::new(self.architecture, parameters, self.readout.output.clone())
    }
}

/// The parts of a predictor: a network, a law or an ensemble.
fn parts(body: &Predictor) -> (Option<NetworkParts>, Option<Classical>, Option<EnsembleParts>) {
    match body {
        Predictor::Network { network, scaling } => (Some(NetworkParts::of(network, scaling)), None, None),
        Predictor::Law(law) => (None, Some(law.clone()), None),
        Predictor::Ensemble(ensemble) => {
            let members = ensemble.members().iter().map(MemberParts::of).collect();
            let (range, group) = (ensemble.range(), ensemble.group().clone());
            (None, None, Some(EnsembleParts { range, group, members }))
        }
    }
}

impl MemberParts {
    fn of(model: &Model) -> Self {
        let (network, law, _) = parts(&model.body);
        Self {
            model: model.name(),
            rate: model.rate,
            preprocessing: model.preprocessing.clone(),
            trained_ranges: model.trained.clone(),
            network,
            law,
            training: model.provenance.clone(),
        }
    }

    fn model(self, columns: &ColumnNames) -> Result<Model> {
        let model = Model {
            body: single(self.network, self.law)?,
            preprocessing: self.preprocessing,
            rate: self.rate,
            names: columns.clone(),
            trained: self.trained_ranges,
            lead_in: Vec::new(),
            is_periodic: false,
            beginning: KnownBeginning::default(),
            band: None,
            provenance: self.training,
        };
        checked(model, self.model)
    }
}

/// Indented JSON with the numbers of a list in one line instead of a line for each, which would double the file.
fn with_numbers_in_line(indented: &str) -> String {
    let is_number = |line: &str| line.starts_with(|first: char| first == '-' || first.is_ascii_digit());
    let mut text = String::with_capacity(indented.len());
    let mut is_in_list = false;
    for line in indented.lines() {
        let content = line.trim_start();
        match (is_number(content), is_in_list) {
            (true, true) => text.extend([" ", content]),
            (true, false) | (false, true) => text.push_str(content),
            (false, false) if text.is_empty() => text.push_str(line),
            (false, false) => text.extend(["\n", line]),
        }
        is_in_list = is_number(content);
    }
    text
}

pub(super) fn write(model: &Model) -> String {
    let (network, law, ensemble) = parts(&model.body);
    let file = File {
        format: FORMAT.into(),
        version: FORMAT_VERSION,
        written_by: format!("hysid {}", env!("CARGO_PKG_VERSION")),
        model: model.name(),
        columns: model.names.clone(),
        units: Units::of(&model.names),
        rate: model.rate,
        preprocessing: model.preprocessing.clone(),
        trained_ranges: model.trained.clone(),
        lead_in: model.lead_in.clone(),
        periodic: model.is_periodic,
        network,
        law,
        ensemble,
        band: model.band.clone(),
        training: model.provenance.clone(),
        checksum: "00000000".into(),
    };
    let text = serde_json::to_string_pretty(&file).expect("a model has no map with keys other than strings");
    let mut text = with_numbers_in_line(&text);
    let sum = checksum(&text).expect("the key is there");
    let end = text.rfind("00000000").expect("the value is there");
    text.replace_range(end..end + 8, &format!("{sum:08x}"));
    text.push('\n');
    text
}

pub(super) fn read(text: &str) -> Result<Model> {
    let damaged = |what: String| {
        Error::ModelFile(format!("{what} (fit the model anew, or restore the file from a copy)"))
    };
    if text.trim().is_empty() {
        return Err(damaged("the model file is empty".into()));
    }
    let value: serde_json::Value = serde_json::from_str(text).map_err(|error| {
        if error.is_eof() {
            damaged(format!("the model file is cut off at line {}", error.line()))
        } else if !text.trim_start().starts_with('{') {
            Error::ModelFile(
                "this is not a Hysid model file (expected the JSON that `hysid fit` writes)".into(),
            )
        } else {
            damaged(format!("the model file is damaged at line {}, column {}", error.line(), error.column()))
        }
    })?;
    if value.get("format").and_then(|format| format.as_str()) != Some(FORMAT) {
        return Err(Error::ModelFile(
            "this is not a Hysid model file (expected the JSON that `hysid fit` writes)".into(),
        ));
    }
    let version = match value.get("version").and_then(serde_json::Value::as_u64) {
        Some(version @ 1..=FORMAT_VERSION) => version,
        Some(version) if version > FORMAT_VERSION => {
            return Err(Error::ModelFile(format!(
                "the model file has format version {version}, this program reads up to {FORMAT_VERSION}: use a newer hysid"
            )));
        }
        _ => return Err(damaged("the model file has no valid format version".into())),
    };
    let written = value.get("checksum").and_then(|sum| sum.as_str()).unwrap_or_default();
    if checksum(text).map(|sum| format!("{sum:08x}")).as_deref() != Some(written) {
        return Err(damaged(
            "the model file was changed after it was written: its checksum does not match".into(),
        ));
    }
    // From the text, not from the value: the text tells the place of an error.
    let file: File = serde_json::from_str(text).map_err(|error| {
        damaged(format!("the model file does not have the layout of version {version}: {error}"))
    })?;
    assemble(file).map_err(|error| damaged(format!("the model file contradicts itself: {error}")))
}

fn single(network: Option<NetworkParts>, law: Option<Classical>) -> Result<Predictor> {
    match (network, law) {
        (Some(parts), None) => {
            parts.scaling.check()?;
            Ok(Predictor::Network { network: parts.network()?, scaling: parts.scaling })
        }
        (None, Some(law)) => Ok(Predictor::Law(law.validated()?)),
        _ => Err(Error::Parts("it must have either a network or a law".into())),
    }
}

fn assemble(file: File) -> Result<Model> {
    let body = match file.ensemble {
        None => single(file.network, file.law)?,
        Some(parts) if file.network.is_none() && file.law.is_none() => {
            let members = parts.members.into_iter().map(|member| member.model(&file.columns));
            Predictor::Ensemble(Ensemble::new(members.collect::<Result<_>>()?, parts.group, parts.range)?)
        }
        Some(_) => return Err(Error::Parts("it is an ensemble and has parts of another model".into())),
    };
    let model = Model {
        body,
        preprocessing: file.preprocessing,
        rate: file.rate,
        names: file.columns,
        trained: file.trained_ranges,
        lead_in: file.lead_in,
        is_periodic: file.periodic,
        beginning: KnownBeginning::default(),
        band: file.band.map(Band::validated).transpose()?,
        provenance: file.training,
    };
    checked(model, file.model)
}

/// Most elementary operations of a row in which the input travels through the trained range: about 0.1 s.
const LARGEST_WORK: f64 = 1e8;

fn checked(model: Model, name: ModelName) -> Result<Model> {
    model.preprocessing.check()?;
    model.trained.check()?;
    if model.lead_in.iter().any(|value| value.is_nan() || value.abs() > LARGEST_VALUE) {
        return Err(Error::Parts("its lead-in has a value that is none".into()));
    }
    if model.lead_in.len() > MOST_TURNS {
        let found = model.lead_in.len();
        return Err(Error::Parts(format!(
            "its lead-in has {found} turning points, at most {MOST_TURNS} are possible"
        )));
    }
    if model.work_of_longest_row() > LARGEST_WORK {
        return Err(Error::Parts("it is too slow: a row would take longer than 0.1 s".into()));
    }
    if model.is_periodic && !model.lead_in.is_empty() {
        return Err(Error::Parts("its records begin in two states".into()));
    }
    let added = model.preprocessing.added_inputs();
    let inputs = match &model.body {
        Predictor::Network { network, scaling } if network.architecture().inputs == scaling.inputs.len() => {
            network.architecture().inputs.saturating_sub(added)
        }
        Predictor::Network { .. } => 0,
        Predictor::Law(law) => (1 + law.further_inputs()).saturating_sub(added),
        Predictor::Ensemble(_) => model.inputs(),
    };
    if inputs == 0 || [model.names.inputs.len(), model.trained.inputs.len()] != [inputs; 2] {
        return Err(Error::Parts(format!("it does not describe {inputs} inputs throughout")));
    }
    if ![0, inputs].contains(&model.preprocessing.origins.len()) {
        return Err(Error::Parts(format!(
            "its preprocessing does not have an origin for each of {inputs} inputs"
        )));
    }
    if let Predictor::Network { network, scaling } = &model.body
        && (network.architecture().rate != model.rate.is_some()
            || model.rate.is_some() != scaling.rate.is_some())
    {
        return Err(Error::Parts("it has a rate in some places only".into()));
    }
    if name != model.name() {
        return Err(Error::Parts("it names two different models".into()));
    }
    Ok(model)
}

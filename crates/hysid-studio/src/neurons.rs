//! Inside a network: thresholds, what each stop does along a path, and the widths of loops, the paper's `K` and `P`.

use anyhow::{Result, anyhow};
use hysid::data::record::{Dataset, Record};
use hysid::diagnosis::model::ModelDiagnosis;
use hysid::model::{Model, Predictor};
use hysid::network::scaling::Scaling;
use hysid::network::{Layout, Network};
use hysid::operator::{DeterioratingStop, Operator};
use serde::Serialize;

/// The networks of a model: itself, or members of an ensemble.
pub fn networks(model: &Model) -> Vec<(String, &Model)> {
    let is_network = |model: &&Model| model.network().is_some();
    match model.ensemble() {
        Some(ensemble) => {
            let numbered = ensemble.members().iter().enumerate().filter(|(_, member)| is_network(member));
            numbered
                .map(|(number, member)| (format!("{} {}", number + 1, member.name().name()), member))
                .collect()
        }
        None => Some(model)
            .into_iter()
            .filter(is_network)
            .map(|model| (model.name().name().into(), model))
            .collect(),
    }
}

/// A network's stops.
#[derive(Debug, Serialize)]
pub struct Neurons {
    name: String,
    stops: Vec<Stop>,
    /// Width of the loop over the whole trained range as the rate goes to zero; `null` if there is none.
    #[serde(rename = "K")]
    k: Option<f64>,
    /// Speed, and the width at it minus `K`.
    #[serde(rename = "P")]
    p: Vec<(f64, f64)>,
}

/// A stop. The threshold is in the unit of the first input.
#[derive(Debug, Serialize)]
struct Stop {
    name: String,
    threshold: f64,
    /// Weights of the scaled channels: the input, and its rate if the network has it.
    weights: Vec<f64>,
    /// Capacity; `null` without deterioration.
    beta: Option<f64>,
    /// Change of the output without it, as a share of its range.
    influence: Option<f64>,
}

impl Neurons {
    /// Of a network, by its name.
    pub fn of(name: String, model: &Model) -> Option<Self> {
        let Predictor::Network { network, scaling } = model.predictor() else { return None };
        let diagnosis = ModelDiagnosis::of(model).ok();
        let influences = diagnosis.as_ref().and_then(|diagnosis| diagnosis.weights.as_ref());
        let parts = StopParts::of(network);
        let stop = |(index, part): (usize, &StopParts)| {
            let name = format!("stop {}", index + 1);
            let known =
                influences.and_then(|weights| weights.neurons.iter().find(|neuron| neuron.name == name));
            Stop {
                threshold: scaling.inputs[0] / part.weights[0].abs(),
                weights: part.weights.clone(),
                beta: part.beta,
                influence: known.map(|neuron| neuron.influence),
                name,
            }
        };
        let widths = diagnosis.as_ref().map(|diagnosis| &diagnosis.loop_widths);
        let k = widths.and_then(|widths| widths.static_width);
        let p = widths.map_or_else(Vec::new, |widths| {
            widths.dynamic.iter().filter_map(|at| Some((at.speed, at.widening?))).collect()
        });
        Some(Self { name, stops: parts.iter().enumerate().map(stop).collect(), k, p })
    }
}

/// The numbers of a stop.
struct StopParts {
    weights: Vec<f64>,
    beta: Option<f64>,
}

impl StopParts {
    fn of(network: &Network) -> Vec<Self> {
        let architecture = *network.architecture();
        let (layout, parameters) = (Layout::new(architecture), network.parameters());
        let betas = &parameters[layout.ln_beta.clone()];
        let weights = parameters[layout.stop_weights.clone()].chunks(architecture.channels().max(1));
        let part = |(index, weights): (usize, &[f64])| Self {
            weights: weights.to_vec(),
            beta: betas.get(index).map(|ln_beta| ln_beta.exp()),
        };
        weights.enumerate().map(part).collect()
    }
}

/// What each stop of a network gives along a path, by its name, in units of its threshold.
///
/// # Errors
/// A network that the model does not have; a path that it cannot run on.
pub fn along(model: &Model, network: usize, record: Record) -> Result<Vec<(String, Vec<f64>)>> {
    let all = networks(model);
    let (_, member) = all.get(network).ok_or_else(|| anyhow!("there is no network {network}"))?;
    let Predictor::Network { network, scaling } = member.predictor() else { unreachable!("it is a network") };
    let drive = drive(member, network, scaling, record)?;
    let run = |(index, part): (usize, StopParts)| {
        let beta = part.beta.unwrap_or(f64::INFINITY);
        let mut stop = DeterioratingStop::new(1.0, beta)?;
        let at =
            |row: usize| part.weights.iter().zip(&drive).map(|(weight, channel)| weight * channel[row]).sum();
        let rows = drive.first().map_or(0, Vec::len);
        Ok((format!("stop {}", index + 1), (0..rows).map(|row| stop.step(at(row))).collect()))
    };
    StopParts::of(network).into_iter().enumerate().map(run).collect()
}

/// The scaled channels along a path.
fn drive(model: &Model, network: &Network, scaling: &Scaling, record: Record) -> Result<Vec<Vec<f64>>> {
    let data = Dataset::new(model.names().clone(), vec![record])?;
    let (seen, rate) = model.input_transform().data(&data, model.rate())?;
    Ok(scaling.drive(&seen.records()[0], network.architecture(), rate)?.channels)
}

//! Inside a network: thresholds, what each stop contributes along a path, and the widths of loops, the paper's `K` and `P`.

use anyhow::{Result, anyhow};
use hysid::data::record::{Dataset, Record};
use hysid::diagnosis::model::ModelDiagnosis;
use hysid::model::{Ensemble, Model, Predictor};
use hysid::network::{Drive, Layout, Network};
use hysid_report::Stop;
use serde::Serialize;

/// The networks of a model: itself, or members of an ensemble.
pub fn networks(model: &Model) -> Vec<(String, &Model)> {
    let all = match model.ensemble() {
        Some(ensemble) => numbered(ensemble).collect(),
        None => vec![(model.name().name().to_string(), model)],
    };
    all.into_iter().filter(|(_, model)| model.network().is_some()).collect()
}

/// The members of an ensemble, each named by its number and its model.
pub fn numbered(ensemble: &Ensemble) -> impl Iterator<Item = (String, &Model)> {
    let members = ensemble.members().iter().enumerate();
    members.map(|(number, member)| (format!("{} {}", number + 1, member.name().name()), member))
}

/// A network's stops.
#[derive(Debug, Serialize)]
pub struct Neurons {
    name: String,
    stops: Vec<ShownStop>,
    /// Width of the loop over the whole trained range as the rate goes to zero; `null` if there is none.
    #[serde(rename = "K")]
    k: Option<f64>,
    /// Speed, and the width at it minus `K`.
    #[serde(rename = "P")]
    p: Vec<(f64, f64)>,
}

/// A stop. The threshold is in the unit of the first input.
#[derive(Debug, Serialize)]
struct ShownStop {
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
        let stop = |stop: Stop| {
            let name = format!("stop {}", stop.number);
            let known =
                influences.and_then(|weights| weights.neurons.iter().find(|neuron| neuron.name == name));
            ShownStop {
                threshold: stop.threshold,
                weights: stop.weights,
                beta: stop.beta.is_finite().then_some(stop.beta),
                influence: known.map(|neuron| neuron.influence),
                name,
            }
        };
        let widths = diagnosis.as_ref().map(|diagnosis| &diagnosis.loop_widths);
        let k = widths.and_then(|widths| widths.static_width);
        let p = widths.map_or_else(Vec::new, |widths| {
            widths.dynamic.iter().filter_map(|at| Some((at.speed, at.widening?))).collect()
        });
        Some(Self { name, stops: Stop::all(network, scaling).into_iter().map(stop).collect(), k, p })
    }
}

/// What each stop of a network contributes along a path, by its name: the output minus that without the stop, in the unit of
/// the output.
///
/// # Errors
/// A network that the model does not have; a path that it cannot run on.
pub fn along(model: &Model, network: usize, record: Record) -> Result<Vec<(String, Vec<f64>)>> {
    let all = networks(model);
    let (_, member) = all.get(network).ok_or_else(|| anyhow!("there is no network {network}"))?;
    let Predictor::Network { network, scaling } = member.predictor() else { unreachable!("it is a network") };
    let data = Dataset::new(member.names().clone(), vec![record])?;
    let (seen, rate) = member.input_transform().data(&data, member.rate())?;
    let drive = scaling.drive(&seen.records()[0], network.architecture(), rate)?;
    let whole = run(network, &drive);
    let contribution = |stop: usize| {
        let rest = run(&without(network, stop)?, &drive);
        let deviation = scaling.output_deviation;
        let difference = whole.iter().zip(&rest).map(|(whole, rest)| deviation * (whole - rest));
        Ok((format!("stop {}", stop + 1), difference.collect()))
    };
    (0..network.architecture().stops).map(contribution).collect()
}

/// The scaled output along a drive, from the virgin state.
fn run(network: &Network, drive: &Drive) -> Vec<f64> {
    let channels: Vec<&[f64]> = drive.channels.iter().map(Vec::as_slice).collect();
    let mut output = vec![0.0; drive.len()];
    network.simulator().run(&channels, &drive.steps, &mut output);
    output
}

/// The same network with zero output weights of a stop.
fn without(network: &Network, stop: usize) -> Result<Network> {
    let a = *network.architecture();
    let neuron = usize::from(a.linear) + stop;
    let (mut parameters, mut output) = (network.parameters().to_vec(), network.output().to_vec());
    let hidden = Layout::new(a).hidden;
    for weights in parameters[hidden].chunks_exact_mut(1 + a.memory_neurons()) {
        // The bias comes first.
        weights[1 + neuron] = 0.0;
    }
    if a.has_direct_path() {
        output[usize::from(a.constant) + a.hidden + neuron] = 0.0;
    }
    Ok(Network::new(a, parameters, output)?)
}

#[cfg(test)]
mod tests {
    use hysid::Fit;

    use super::*;

    /// A spring and a slider.
    fn data() -> Dataset {
        let x: Vec<f64> = (0..400).map(|k| 0.01 * f64::from(k) * (0.1 * f64::from(k)).sin()).collect();
        let mut play = 0.0f64;
        let y: Vec<f64> = x
            .iter()
            .map(|x| {
                play = play.clamp(x - 0.5, x + 0.5);
                x + 3.0 * (x - play)
            })
            .collect();
        Dataset::from_slices(&x, &y).unwrap()
    }

    #[test]
    fn contributions_of_a_linear_readout_add_up_to_the_output() {
        let data = data();
        let fit = Fit::new().model("pnn").option("stops", 4).option("epochs", 5).option("starts", 1);
        let model = fit.run(&data).unwrap();
        let record = data.records()[0].clone();
        let output = model.simulate(&record).unwrap();
        let stops = along(&model, 0, record).unwrap();
        assert_eq!(stops.len(), 4);
        let sum = |row: usize| stops.iter().map(|(_, of_stop)| of_stop[row]).sum::<f64>();
        // What is left is the constant of the output.
        let constant = output[0] - sum(0);
        let largest =
            (0..output.len()).map(|row| (output[row] - sum(row) - constant).abs()).fold(0.0, f64::max);
        assert!(largest < 1e-9, "{largest}");
    }

    #[test]
    fn without_all_its_stops_a_network_is_no_longer_hysteretic() {
        let data = data();
        let fit = Fit::new().model("xpnn").option("stops", 3).option("epochs", 5).option("starts", 1);
        let model = fit.run(&data).unwrap();
        let Predictor::Network { network, scaling } = model.predictor() else { panic!("a network") };
        let bare = (0..3).fold(network.clone(), |rest, stop| without(&rest, stop).unwrap());
        let (seen, rate) = model.input_transform().data(&data, model.rate()).unwrap();
        let drive = scaling.drive(&seen.records()[0], network.architecture(), rate).unwrap();
        let (bare, whole) = (run(&bare, &drive), run(network, &drive));
        // Rows with nearly the same input have nearly the same output.
        let mut rows: Vec<usize> = (0..bare.len()).collect();
        rows.sort_by(|&a, &b| drive.channels[0][a].total_cmp(&drive.channels[0][b]));
        let jump = |output: &[f64]| {
            let near =
                rows.windows(2).filter(|pair| drive.channels[0][pair[1]] - drive.channels[0][pair[0]] < 1e-4);
            near.map(|pair| (output[pair[1]] - output[pair[0]]).abs()).fold(0.0, f64::max)
        };
        assert!(jump(&bare) < 0.01 && jump(&whole) > 0.1, "{} {}", jump(&bare), jump(&whole));
        assert!(along(&model, 1, data.records()[0].clone()).is_err());
    }
}

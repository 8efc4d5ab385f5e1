//! What the weights of a network say about its properties, and whether probing agrees, theory.md (10.37) to
//! (10.41).

use serde::Serialize;

use super::direct::about_zero;
use super::neurons::{Inside, MATTERS, Neuron, NeuronKind, SLIPS};
use super::probe::Probe;
use crate::diagnosis::{Finding, Property, Verdict};
use crate::error::Result;
use crate::model::Body;

/// A rate that moves a stop by less than this share of its threshold is none.
const NO_RATE: f64 = 0.02;

/// Wear that matters, as a share of a stop's strength.
const WEAR: f64 = 0.05;

/// Curvature of the readout that matters, as a share of the range of the output.
const CURVED: f64 = 0.01;

/// Unevenness of the readout that matters, as a share of the range of the output.
const UNEVEN: f64 = 0.02;

/// What the weights of a network say.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WeightDiagnosis {
    /// Criteria on properties.
    pub criteria: Vec<Criterion>,
    /// Stops and relaxation neurons.
    pub neurons: Vec<Neuron>,
}

/// A number computed from weights that says whether a network has a property.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Criterion {
    /// The property.
    #[serde(rename = "name")]
    pub property: Property,
    /// The number.
    pub value: f64,
    /// Where it decides otherwise.
    pub threshold: f64,
    /// What it says.
    pub verdict: Verdict,
    /// Whether probing says the same; `None` where it could not tell.
    pub agrees: Option<bool>,
    /// What the number is, in words.
    pub statement: String,
}

impl WeightDiagnosis {
    /// `None` for a classical law.
    ///
    /// # Errors
    /// A rate that cannot be computed.
    pub(super) fn of(probe: &Probe, findings: &[Finding]) -> Result<Option<Self>> {
        let Body::Network { network, scaling } = probe.model.body() else { return Ok(None) };
        let inside = Inside::new(probe, network, scaling)?;
        let neurons = inside.neurons();
        let wears = wear(&neurons);
        let mut criteria = vec![static_loop(&neurons), rate(probe, &inside, &neurons), wears.clone()];
        let unworn = wears.verdict == Verdict::No;
        criteria.extend([
            straight_readout(&inside, Property::Congruency, unworn),
            straight_readout(&inside, Property::Masing, unworn),
        ]);
        if about_zero(probe) {
            criteria.push(even_readout(&inside));
        }
        for criterion in &mut criteria {
            let found = findings.iter().find(|finding| finding.property == criterion.property);
            criterion.agrees = found
                .filter(|finding| finding.verdict != Verdict::NotTestable)
                .map(|finding| finding.verdict == criterion.verdict);
        }
        Ok(Some(Self { criteria, neurons }))
    }
}

fn criterion(property: Property, value: f64, threshold: f64, holds: bool, statement: String) -> Criterion {
    let verdict = if holds { Verdict::Yes } else { Verdict::No };
    Criterion { property, value, threshold, verdict, agrees: None, statement }
}

/// Largest of a number of the neurons that matter.
fn largest(neurons: &[Neuron], of: impl Fn(&Neuron) -> Option<f64>) -> f64 {
    let matters = neurons.iter().filter(|neuron| neuron.influence >= MATTERS);
    matters.filter_map(of).fold(0.0, f64::max)
}

/// `max |w_x| ptp(x) > 2`, theory.md (10.37).
fn static_loop(neurons: &[Neuron]) -> Criterion {
    let living = |neuron: &Neuron| {
        neuron.input_swing.filter(|_| !neuron.kinds.contains(&NeuronKind::DiesAtOnce))
    };
    let value = largest(neurons, living);
    let statement = format!("the input moves a stop by up to {value:.2}; it slips beyond {SLIPS}");
    criterion(Property::StaticHysteresis, value, SLIPS, value > SLIPS, statement)
}

/// `max |w_rate| max|rate|` of stops, the rate's share in the linear neuron, relaxation neurons, theory.md (10.38).
fn rate(probe: &Probe, inside: &Inside, neurons: &[Neuron]) -> Criterion {
    let stops = largest(neurons, |neuron| neuron.rate_swing);
    let relaxing = neurons.iter().filter(|neuron| neuron.relaxation_time.is_some());
    let relaxing = relaxing.filter(|neuron| neuron.influence >= MATTERS).count();
    let linear = inside.influence_of_linear_rate();
    let value = stops.max(if linear >= MATTERS { linear } else { 0.0 }).max(relaxing as f64);
    let statement = if probe.speeds.matter() {
        format!(
            "the rate moves a stop by up to {stops:.3} of its threshold and the output past the stops by {:.2} % of its range; \
             {relaxing} relaxation neurons matter",
            100.0 * linear
        )
    } else {
        "no neuron sees rate or time".into()
    };
    criterion(Property::RateDependence, value, NO_RATE, value > NO_RATE, statement)
}

/// `max s/β`, theory.md (10.39).
fn wear(neurons: &[Neuron]) -> Criterion {
    let value = largest(neurons, |neuron| neuron.wear);
    let statement = format!("25 loops use up to {:.2} % of a stop's capacity to slip", 100.0 * value);
    criterion(Property::Deterioration, value, WEAR, value > WEAR, statement)
}

/// How far the tanh neurons are from straight lines over their arguments; for congruency only as far as memory
/// goes into them, theory.md (10.40).
fn straight_readout(inside: &Inside, property: Property, unworn: bool) -> Criterion {
    let shares = inside.shares_of_memory();
    let of_one = |(argument, share): (&Vec<f64>, f64)| {
        let low = argument.iter().copied().fold(f64::INFINITY, f64::min);
        let high = argument.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let chord = |s: f64| {
            let rise = high.tanh() - low.tanh();
            low.tanh() + if high > low { rise * (s - low) / (high - low) } else { 0.0 }
        };
        let off = argument.iter().map(|&s| (s.tanh() - chord(s)).abs()).fold(0.0, f64::max);
        if property == Property::Congruency { off * share } else { off }
    };
    let (c, _) = inside.output_weights();
    let neurons = c.iter().zip(inside.arguments.iter().zip(shares));
    let value = neurons.map(|(c, neuron)| c.abs() * of_one(neuron)).sum::<f64>() / inside.height;
    let readout =
        if property == Property::Congruency { "the readout of the memory" } else { "the readout" };
    let worn = if unworn { "" } else { ", and slip wears the stops" };
    let statement = format!("{readout} is off a straight line by up to {:.1} % of the output's range{worn}", 100.0 * value);
    criterion(property, value, CURVED, value <= CURVED && unworn, statement)
}

/// The even part of the tanh neurons, which their biases make, theory.md (10.41).
fn even_readout(inside: &Inside) -> Criterion {
    let even = |(bias, argument): (f64, &Vec<f64>)| {
        let reach = argument.iter().map(|s| (s - bias).abs()).fold(0.0, f64::max);
        (0.5 * ((bias + reach).tanh() + (bias - reach).tanh()) - bias.tanh()).abs()
    };
    let (c, _) = inside.output_weights();
    let neurons = inside.tanh_neurons().map(|(bias, _)| bias).zip(&inside.arguments);
    let value = c.iter().zip(neurons).map(|(c, neuron)| 2.0 * c.abs() * even(neuron)).sum::<f64>()
        / inside.height;
    let statement =
        format!("biases make the readout uneven by at most {:.1} % of the output's range", 100.0 * value);
    criterion(Property::OddSymmetry, value, UNEVEN, value <= UNEVEN, statement)
}

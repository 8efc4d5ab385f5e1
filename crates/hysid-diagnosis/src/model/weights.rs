//! What the weights of a network say about its properties, and whether probing agrees, theory.md (10.37) to
//! (10.41).

use serde::Serialize;

use super::direct::about_origin;
use super::neurons::{Inside, MATTERS, Neuron, NeuronKind, SLIPS};
use super::probe::Probe;
use crate::{Finding, Property, Verdict};
use hysid_core::error::Result;
use hysid_core::model::Predictor;

/// What the rate may move the output by without mattering, as a share of its range; as in probing.
const NO_RATE: f64 = 0.01;

/// Wear that matters, as a share of what the stops do; as in probing.
const WEAR: f64 = 0.05;

/// Curvature of the readout that cannot matter: what is one twentieth of a loop as high as a twentieth of the
/// range of the output.
const STRAIGHT: f64 = 0.0025;

/// Unevenness of the readout that matters, as a share of the range of the output; as in probing.
const UNEVEN: f64 = 0.02;

/// A range whose middle is no further from 0, as a share of half of it, is centred.
const CENTRED: f64 = 0.01;

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
    /// What it says; not testable where it is an upper bound that does not tell.
    pub verdict: Verdict,
    /// Whether probing says the same; `None` where one of them could not tell.
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
        let Predictor::Network { network, scaling } = probe.model.predictor() else { return Ok(None) };
        let inside = Inside::new(probe, network, scaling)?;
        let neurons = inside.neurons();
        let wears = wear(&neurons);
        let mut criteria = vec![static_loop(&neurons), rate(probe, &inside, &neurons), wears.clone()];
        let unworn = wears.verdict == Verdict::No;
        criteria.extend([
            straight_readout(&inside, Property::Congruency, unworn),
            straight_readout(&inside, Property::Masing, unworn),
        ]);
        if about_origin(probe) {
            criteria.push(even_readout(probe, &inside));
        }
        for criterion in &mut criteria {
            let found = findings.iter().find(|finding| finding.property == criterion.property);
            criterion.agrees = found
                .filter(|finding| finding.verdict != Verdict::NotTestable)
                .filter(|_| criterion.verdict != Verdict::NotTestable)
                .map(|finding| finding.verdict == criterion.verdict);
        }
        Ok(Some(Self { criteria, neurons }))
    }
}

fn criterion(
    property: Property,
    value: f64,
    threshold: f64,
    verdict: Verdict,
    statement: String,
) -> Criterion {
    Criterion { property, value, threshold, verdict, agrees: None, statement }
}

fn yes_if(holds: bool) -> Verdict {
    if holds { Verdict::Yes } else { Verdict::No }
}

/// Never -0, which the sum of nothing is.
fn sum(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |sum, value| sum + value)
}

/// `max |w_x| ptp(x) > 2` of stops that matter and live, theory.md (10.37).
fn static_loop(neurons: &[Neuron]) -> Criterion {
    let living = neurons
        .iter()
        .filter(|neuron| neuron.influence >= MATTERS && !neuron.kinds.contains(&NeuronKind::DiesAtOnce));
    let value = living.filter_map(|neuron| neuron.input_swing).fold(0.0, f64::max);
    let statement = format!(
        "the input moves a stop by up to {value:.2} times its threshold; it slips \
                             beyond {SLIPS}"
    );
    criterion(Property::StaticHysteresis, value, SLIPS, yes_if(value > SLIPS), statement)
}

/// How far the rate moves stops, times what they do; the linear neuron's and the relaxation neurons' part,
/// theory.md (10.38).
fn rate(probe: &Probe, inside: &Inside, neurons: &[Neuron]) -> Criterion {
    let moved = neurons.iter().filter_map(|neuron| Some(neuron.influence * neuron.rate_swing?.min(1.0)));
    let stops = sum(moved);
    let relaxing = neurons.iter().filter(|neuron| neuron.relaxation_time.is_some());
    let relaxing = sum(relaxing.map(|neuron| neuron.influence));
    let linear = inside.influence_of_linear_rate();
    let value = stops + relaxing + linear;
    let statement = if probe.speeds.matter() {
        let [stops, linear, relaxing] = [stops, linear, relaxing].map(|part| 100.0 * part);
        format!(
            "shares of the output's range: rate through stops {stops:.2} %, rate past the stops {linear:.2} \
             %, relaxation neurons {relaxing:.2} %"
        )
    } else {
        "no neuron has rate or time as an input".into()
    };
    criterion(Property::RateDependence, value, NO_RATE, yes_if(value > NO_RATE), statement)
}

/// `s/β` in the mean of the stops that slip, by what they do, theory.md (10.39).
fn wear(neurons: &[Neuron]) -> Criterion {
    let slips = |neuron: &&Neuron| {
        neuron.kinds.contains(&NeuronKind::Static) || neuron.kinds.contains(&NeuronKind::Dynamic)
    };
    let slipping = || neurons.iter().filter(slips);
    let worn = sum(slipping().map(|neuron| neuron.influence * neuron.wear.unwrap_or(0.0).min(1.0)));
    let all = sum(slipping().map(|neuron| neuron.influence));
    let value = worn / all.max(f64::MIN_POSITIVE);
    let statement =
        format!("25 loops use {:.2} % of the capacity of the slipping stops, on average", 100.0 * value);
    criterion(Property::Deterioration, value, WEAR, yes_if(value > WEAR), statement)
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
    let value = sum(neurons.map(|(c, neuron)| c.abs() * of_one(neuron))) / inside.height;
    let readout = if property == Property::Congruency { "the readout of the memory" } else { "the readout" };
    let worn = if unworn { "" } else { ", and the stops deteriorate as they slip" };
    let statement = format!(
        "{readout} deviates from a straight line by at most {:.2} % of the output's range{worn}",
        100.0 * value
    );
    // What bends may cancel: above the threshold the weights do not tell.
    let verdict = if unworn && value <= STRAIGHT { Verdict::Yes } else { Verdict::NotTestable };
    criterion(property, value, STRAIGHT, verdict, statement)
}

/// Stops and springs answer the mirrored input with the opposite: what the output and its mirror image add up to
/// follows from biases and weights, theory.md (10.41).
fn even_readout(probe: &Probe, inside: &Inside) -> Criterion {
    let (c, _) = inside.output_weights();
    let neurons = || c.iter().zip(inside.tanh_neurons()).zip(&inside.arguments);
    let settled = inside.settled();
    let at = |row: usize| {
        sum(neurons().map(|((c, (bias, _)), a)| c * (a[row].tanh() + (2.0 * bias - a[row]).tanh())))
    };
    let sums: Vec<f64> = settled.map(at).collect();
    let count = (sums.len() as f64).max(1.0);
    let mean = sum(sums.iter().copied()) / count;
    let value = (sum(sums.iter().map(|even| (even - mean).powi(2))) / count).sqrt() / inside.height;
    let statement = format!(
        "about x = 0, biases make the readout asymmetric by {:.2} % of the output's range",
        100.0 * value
    );
    // An output that is not odd about 0 may be odd about the middle of the range.
    let same_place = probe.centre.abs() <= CENTRED * probe.half;
    let verdict = match yes_if(value <= UNEVEN) {
        Verdict::No if !same_place => Verdict::NotTestable,
        told => told,
    };
    criterion(Property::OddSymmetry, value, UNEVEN, verdict, statement)
}

//! Bounds of a model's output for bounded inputs, from its parameters alone, theory.md (10.42).

use hysid_core::law::interval::Interval;
use hysid_core::model::{Model, Predictor};
use hysid_core::network::scaling::Scaling;
use hysid_core::network::{Layout, Network};

/// What rounding may add to a bound, as a share of its magnitude.
const ROUNDING: f64 = 1e-9;

/// Outputs that are possible while inputs and the rate of the first stay within the trained ranges.
pub(super) fn within_trained_ranges(model: &Model) -> Interval {
    let trained = model.trained_ranges();
    let inputs: Vec<Interval> = trained.inputs.iter().map(|&(low, high)| Interval(low, high)).collect();
    // A model may be run at rest, whatever the rates in training.
    let rate = trained.rate.map_or(Interval::point(0.0), |(low, high)| Interval(low, high).with_zero());
    possible(model, &inputs, rate)
}

/// Outputs that are possible at all; `None` if there is no bound.
pub(super) fn whatever_the_input(model: &Model) -> Option<Interval> {
    let all = possible(model, &vec![Interval::ALL; model.trained_ranges().inputs.len()], Interval::ALL);
    (all.0.is_finite() && all.1.is_finite()).then_some(all)
}

fn possible(model: &Model, inputs: &[Interval], rate: Interval) -> Interval {
    let preprocessing = model.input_transform();
    let seen = inputs.iter().enumerate();
    let mut seen: Vec<Interval> =
        seen.map(|(input, range)| range.rising(|value| preprocessing.input_as_seen(input, value))).collect();
    if let Some((largest, _)) = preprocessing.history {
        let from_origin = inputs[0].rising(|x| x - preprocessing.origin(0));
        let farthest = from_origin.0.abs().max(from_origin.1.abs());
        // The path has no end.
        seen.extend([Interval(0.0, farthest / largest), Interval(0.0, f64::INFINITY)]);
    }
    let seen_rate = rate.rising(|rate| preprocessing.rate(rate));
    let exact = match model.predictor() {
        Predictor::Network { network, scaling } => network_output(network, scaling, &seen, seen_rate),
        Predictor::Law(law) => law.output_bound(seen[0], seen_rate),
        // A median lies among the values it is taken of.
        Predictor::Ensemble(ensemble) => ensemble
            .members()
            .iter()
            .map(|member| possible(member, inputs, rate))
            .reduce(|a, b| Interval(a.0.min(b.0), a.1.max(b.1)))
            .unwrap_or(Interval::ALL),
    };
    let slack = ROUNDING * exact.0.abs().max(exact.1.abs());
    Interval(exact.0 - slack, exact.1 + slack)
}

fn network_output(network: &Network, scaling: &Scaling, inputs: &[Interval], rate: Interval) -> Interval {
    let a = network.architecture();
    let layout = Layout::new(*a);
    let parameters = network.parameters();
    let scaled: Vec<Interval> =
        inputs.iter().zip(&scaling.inputs).map(|(input, scale)| input.times(1.0 / scale)).collect();
    let mut u = scaled.clone();
    if a.rate {
        u.insert(1, rate.times(1.0 / scaling.rate.unwrap_or(1.0)));
    }
    let weighted =
        |weights: &[f64], of: &[Interval]| Interval::sum(weights.iter().zip(of).map(|(w, z)| z.times(*w)));
    let mut z = Vec::with_capacity(a.memory_neurons());
    z.extend(a.linear.then(|| weighted(&parameters[layout.linear.clone()], &u)));
    z.extend(parameters[layout.stop_weights.clone()].chunks_exact(a.channels()).map(|weights| {
        let stop = weighted(weights, &u).stop(1.0);
        if a.deterioration { stop.with_zero() } else { stop }
    }));
    z.extend((0..a.relaxation_neurons()).map(|m| scaled[m / a.relaxation].relaxation()));
    let hidden = parameters[layout.hidden.clone()].chunks_exact(1 + a.memory_neurons());
    let hidden = hidden.map(|run| weighted(&run[1..], &z).plus(Interval::point(run[0])).rising(f64::tanh));
    let features: Vec<Interval> = a
        .constant
        .then_some(Interval::point(1.0))
        .into_iter()
        .chain(hidden)
        .chain(if a.has_direct_path() { z.clone() } else { Vec::new() })
        .collect();
    weighted(network.output(), &features).rising(|y| scaling.output(y))
}

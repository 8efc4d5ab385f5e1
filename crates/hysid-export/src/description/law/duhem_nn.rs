//! Duhem neural network: states that approach targets, which a tanh layer gives.

use hysid_core::law::duhem_nn::{ACCELERATION_GAIN, DuhemNn, FurtherInput, LARGEST_DERIVATIVE};

use super::prandtl_ishlinskii::follow;
use super::tanh_layer::{Slice, add_columns, layer, partial_sums, product};
use crate::description::PartInputs;
use crate::description::network::tanh;
use crate::program::expression::{Real, Whole, fused};
use crate::program::{Array, Builder};

/// Scaled inputs are limited to this magnitude, as in the library.
const LARGEST_INPUT: f64 = 1e6;

/// theory.md (8.29) to (8.32)
pub(super) fn step(builder: &mut Builder, name: &str, law: &DuhemNn, sample: &PartInputs) -> Real {
    let (cell, shape) = (&law.cell, law.cell.shape());
    let scaled = |builder: &mut Builder, value: Real, scale: f64| {
        let value = builder.value(value / scale);
        builder.value(value.clamp(-LARGEST_INPUT, LARGEST_INPUT))
    };
    let x = scaled(builder, &sample.inputs[0] - law.input_centre, law.input_scale);
    let from_origin = scaled(builder, sample.inputs[0].clone(), law.input_scale);
    let rate = law.rate_scale.map(|scale| scaled(builder, sample.rate.clone(), scale));
    let moved = moved(builder, name, &x, &sample.step);
    let elapsed = moved.1.clone();

    // `1, x, v, a, d, e, s, h, m x, m v, m a`: what the output weights multiply.
    let terms = builder.scratch(&format!("{name}_term"), shape.terms());
    let first = shape.constants();
    if first > 0 {
        builder.set(terms, 0_usize, 1.0);
    }
    let mut signals = vec![x.clone()];
    signals.extend(rate.clone());
    if let Some(scale) = cell.acceleration_scale {
        signals.push(acceleration(builder, name, &moved.2, &elapsed, scale));
    }
    let (direct, modulating) = further(builder, law, sample);
    for (place, value) in (first..).zip(signals.iter().chain(&direct)) {
        builder.set(terms, place, value);
    }
    if shape.stops > 0 {
        stops(builder, name, law, (&from_origin, rate.as_ref()), terms);
    }
    let states = builder.state(&format!("{name}_state"), cell.initial.clone());
    let first_state = shape.first_state();
    builder.each(0_usize, shape.states, |builder, i| builder.set(terms, &i + first_state, states.at(&i)));

    let hidden = builder.constants(&format!("{name}_hidden"), cell.hidden.clone());
    let (inputs, neurons) = (shape.inputs(), shape.neurons);
    let target_factors = match modulating.is_empty() && !shape.is_odd {
        true => {
            layer(builder, hidden, (terms, inputs), (Slice(terms, inputs), neurons));
            None
        }
        false => modulated_layer(builder, name, law, (hidden, terms), (&signals, &modulating)),
    };

    let targets = builder.constants(&format!("{name}_target"), cell.targets.clone());
    let path_leaks = builder.constants(&format!("{name}_leak"), cell.path_leaks.clone());
    let times = (!cell.relaxation_times.is_empty())
        .then(|| builder.constants(&format!("{name}_time"), cell.relaxation_times.clone()));
    let gains = (!cell.rate_gains.is_empty())
        .then(|| builder.constants(&format!("{name}_gain"), cell.rate_gains.clone()));
    let sums = partial_sums(builder, name);
    builder.each(0_usize, shape.states, |builder, i| {
        let row = Whole::from(builder.whole_variable(&i * neurons));
        let first = Whole::from(inputs);
        let target = product(builder, (targets, &row), (terms, &first), (neurons, sums));
        let target = match target_factors {
            Some(factors) => builder.value(target * factors.at(&i)),
            None => target,
        };
        let target = match (&gains, &rate) {
            (Some(gains), Some(rate)) => builder.value(fused(gains.at(&i), rate, target)),
            _ => target,
        };
        let of_path = path_leaks.at(&i) * &moved.0;
        let leak = match times {
            Some(times) => builder.value(of_path + &elapsed / times.at(&i)),
            None => builder.value(of_path),
        };
        let half = builder.value(0.5 * leak);
        let t = tanh(builder, &half);
        let leak = builder.value(2.0 * &t / (1.0 + &t));
        let before = builder.value(states.at(&i));
        let after = builder.value(fused(leak, target - &before, &before));
        builder.set(states, &i, &after);
        builder.set(terms, &i + first_state, &after);
    });
    let output = builder.constants(&format!("{name}_output"), cell.output.clone());
    let zero = Whole::from(0_usize);
    let y = product(builder, (output, &zero), (terms, &zero), (shape.terms(), sums));
    builder.value(law.output_mean + law.output_scale * y)
}

/// The scaled further inputs: direct and modulating.
fn further(builder: &mut Builder, law: &DuhemNn, sample: &PartInputs) -> (Vec<Real>, Vec<Real>) {
    let mut of = |is_used: fn(&FurtherInput) -> bool| -> Vec<Real> {
        let used = law.further.iter().zip(&sample.inputs[1..]).filter(|(input, _)| is_used(input));
        used.map(|(input, value)| {
            let scaled = builder.value((value - input.centre) / input.scale);
            builder.value(scaled.clamp(-LARGEST_INPUT, LARGEST_INPUT))
        })
        .collect()
    };
    (of(|input| input.is_direct), of(|input| input.is_modulating))
}

/// Shortest time step after which a slope contains what the acceleration adds.
const SHORTEST_STEP_OF_SLOPES: f64 = 1e-15;

/// theory.md (8.61), from the change of the input.
fn acceleration(builder: &mut Builder, name: &str, change: &Real, elapsed: &Real, scale: f64) -> Real {
    let velocity = builder.state(&format!("{name}_velocity"), vec![0.0]);
    let has_velocity = builder.state(&format!("{name}_has_velocity"), vec![0.0]);
    let acceleration = builder.variable(0.0);
    builder.when_else(
        elapsed.above(0.0),
        |builder| {
            // The slope by so short a time step could overflow: it leaves out what the derivatives add.
            let change = &elapsed.above(SHORTEST_STEP_OF_SLOPES).choose(change, change.detached());
            let now = builder.value(limited(change / elapsed));
            builder.when(has_velocity.at(0_usize).above(0.0), |builder| {
                let second = builder.value(limited((&now - velocity.at(0_usize)) / elapsed / scale));
                builder.assign(acceleration, ACCELERATION_GAIN * second.asinh());
            });
            builder.set(velocity, 0_usize, &now);
            builder.set(has_velocity, 0_usize, 1.0);
        },
        |builder| {
            builder.set(velocity, 0_usize, 0.0);
            builder.set(has_velocity, 0_usize, 0.0);
        },
    );
    acceleration.into()
}

fn limited(derivative: Real) -> Real {
    derivative.clamp(-LARGEST_DERIVATIVE, LARGEST_DERIVATIVE)
}

/// The tanh neurons of a cell that is odd or has modulating inputs, and the products of these with the signals; the factors of
/// the targets, if there are modulating inputs.
fn modulated_layer(
    builder: &mut Builder,
    name: &str,
    law: &DuhemNn,
    (hidden, terms): (Array, Array),
    (signals, modulating): (&[Real], &[Real]),
) -> Option<Array> {
    let (cell, shape) = (&law.cell, law.cell.shape());
    let (inputs, neurons) = (shape.inputs(), shape.neurons);
    let layer_sums = builder.scratch(&format!("{name}_layer"), neurons);
    builder.each(0_usize, neurons, |builder, i| builder.set(layer_sums, &i, 0.0));
    add_columns(builder, hidden, (terms, inputs), (layer_sums, neurons));
    let factors = |builder: &mut Builder, part: &str, weights: &[f64], length: usize| {
        let weights = builder.constants(&format!("{name}_{part}_modulation"), weights.to_vec());
        let factors = builder.scratch(&format!("{name}_{part}_factor"), length);
        builder.each(0_usize, length, |builder, i| builder.set(factors, &i, 1.0));
        for (m, value) in modulating.iter().enumerate() {
            builder.each(0_usize, length, |builder, i| {
                builder.set(factors, &i, fused(weights.at(&i + m * length), value, factors.at(&i)));
            });
        }
        factors
    };
    let is_modulated = !modulating.is_empty();
    let of_layer = is_modulated.then(|| factors(builder, "layer", &cell.layer_modulation, neurons));
    let of_targets = is_modulated.then(|| factors(builder, "target", &cell.target_modulation, shape.states));
    builder.each(0_usize, neurons, |builder, i| {
        let sum = builder.value(layer_sums.at(&i));
        let sum = match of_layer {
            Some(factors) => builder.value(factors.at(&i) * sum),
            None => sum,
        };
        let neuron = tanh(builder, &sum);
        builder.set(terms, &i + inputs, neuron);
    });
    let products = modulating.iter().flat_map(|m| signals.iter().map(move |signal| m * signal));
    for (place, product) in (inputs + neurons..).zip(products) {
        builder.set(terms, place, product);
    }
    of_targets
}

/// `|x_k - x_{k-1}|`, `t_k - t_{k-1}` and `x_k - x_{k-1}`; 0 at the first sample.
fn moved(builder: &mut Builder, name: &str, x: &Real, step: &Real) -> (Real, Real, Real) {
    let last = builder.state(&format!("{name}_input"), vec![0.0]);
    let has_last = builder.state(&format!("{name}_has_input"), vec![0.0]);
    let (moved, elapsed, change) = (builder.variable(0.0), builder.variable(0.0), builder.variable(0.0));
    builder.when(has_last.at(0_usize).above(0.0), |builder| {
        builder.assign(change, x - last.at(0_usize));
        builder.assign(moved, Real::from(change).abs());
        builder.assign(elapsed, step.above(0.0).choose(step, 0.0));
    });
    builder.set(last, 0_usize, x);
    builder.set(has_last, 0_usize, 1.0);
    (moved.into(), elapsed.into(), change.into())
}

fn stops(
    builder: &mut Builder,
    name: &str,
    law: &DuhemNn,
    (from_origin, rate): (&Real, Option<&Real>),
    terms: Array,
) {
    let shape = law.cell.shape();
    let weights = builder.constants(&format!("{name}_stop"), law.cell.stops.clone());
    let plays = builder.state(&format!("{name}_play"), vec![0.0; shape.stops]);
    builder.each(0_usize, shape.stops, |builder, i| {
        let drive = builder.value(weights.at(&i) * from_origin);
        let drive = match rate {
            Some(rate) => builder.value(fused(weights.at(&i + shape.stops), rate, drive)),
            None => drive,
        };
        let play = follow(builder, plays, &i, &drive, &Real::Constant(1.0));
        let elongation = builder.value(drive - play);
        builder.set(terms, &i + shape.first_stop(), elongation.clamp(-1.0, 1.0));
    });
}

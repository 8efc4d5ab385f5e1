//! Duhem neural network: states that approach targets, which a tanh layer gives.

use hysid_core::law::duhem_nn::DuhemNn;

use super::prandtl_ishlinskii::follow;
use super::tanh_layer::{Slice, layer, partial_sums, product};
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
    let (moved, elapsed) = moved(builder, name, &x, &sample.step);

    // `1, x, v, e, s, h`: what the output weights multiply.
    let terms = builder.scratch(&format!("{name}_term"), shape.terms());
    builder.set(terms, 0_usize, 1.0);
    builder.set(terms, 1_usize, &x);
    if let Some(rate) = &rate {
        builder.set(terms, 2_usize, rate);
    }
    if shape.stops > 0 {
        stops(builder, name, law, (&from_origin, rate.as_ref()), terms);
    }
    let states = builder.state(&format!("{name}_state"), cell.initial.clone());
    let first_state = 1 + shape.channels + shape.stops;
    builder.each(0_usize, shape.states, |builder, i| builder.set(terms, &i + first_state, states.at(&i)));

    let hidden = builder.constants(&format!("{name}_hidden"), cell.hidden.clone());
    let (inputs, neurons) = (shape.inputs(), shape.neurons);
    layer(builder, hidden, (terms, inputs), (Slice(terms, inputs), neurons));

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
        let target = match (&gains, &rate) {
            (Some(gains), Some(rate)) => builder.value(fused(gains.at(&i), rate, target)),
            _ => target,
        };
        let of_path = path_leaks.at(&i) * &moved;
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

/// `|x_k - x_{k-1}|` and `t_k - t_{k-1}`; 0 at the first sample.
fn moved(builder: &mut Builder, name: &str, x: &Real, step: &Real) -> (Real, Real) {
    let last = builder.state(&format!("{name}_input"), vec![0.0]);
    let has_last = builder.state(&format!("{name}_has_input"), vec![0.0]);
    let (moved, elapsed) = (builder.variable(0.0), builder.variable(0.0));
    builder.when(has_last.at(0_usize).above(0.0), |builder| {
        builder.assign(moved, (x - last.at(0_usize)).abs());
        builder.assign(elapsed, step.above(0.0).choose(step, 0.0));
    });
    builder.set(last, 0_usize, x);
    builder.set(has_last, 0_usize, 1.0);
    (moved.into(), elapsed.into())
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
        builder.set(terms, &i + (1 + shape.channels), elongation.clamp(-1.0, 1.0));
    });
}

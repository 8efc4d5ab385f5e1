//! Networks of all families, with the operations of the library's kernels in their order.

use hysid_core::elementary::exp;
use hysid_core::network::decay::{LN_2, SQUARE_AND_UP};
use hysid_core::network::scaling::Scaling;
use hysid_core::network::tanh::CUBIC_AND_UP;
use hysid_core::network::{Network, ParameterLayout};

use crate::description::PartInputs;
use crate::program::expression::{Real, fused};
use crate::program::{Array, Builder, Precision};

/// Largest magnitude of a scaled input in each precision.
const LARGEST_SCALED: f64 = 1e50;
const LARGEST_SCALED_SINGLE: f64 = 1e9;

/// From this many relaxation times on, nothing is left: `e^{-φ}` is 0.
const LONGEST: f64 = 700.0;
const LONGEST_SINGLE: f64 = 80.0;

/// Writes a step of a network. The sample is in the user's units, transformed; the result is the output in its unit.
pub(super) fn step(
    builder: &mut Builder,
    name: &str,
    network: &Network,
    scaling: &Scaling,
    sample: &PartInputs,
) -> Real {
    let a = *network.architecture();
    let layout = ParameterLayout::new(a);
    let parameters = network.parameters();
    let mut u = Vec::with_capacity(a.channels());
    for (input, (x, scale)) in sample.inputs.iter().zip(&scaling.inputs).enumerate() {
        u.push(limited(builder, x * (1.0 / scale)));
        if let (0, true, Some(scale)) = (input, a.rate, scaling.rate) {
            u.push(limited(builder, &sample.rate * (1.0 / scale)));
        }
    }

    let z = builder.scratch(&format!("{name}_memory"), a.memory_neurons());
    stops(builder, name, network, &layout, &u, sample, z);
    if a.linear {
        let weights =
            builder.constants(&format!("{name}_linear"), parameters[layout.linear.clone()].to_vec());
        let mut sum = Real::Constant(0.0);
        for (channel, u) in u.iter().enumerate() {
            sum = fused(weights.at(channel), u, sum);
        }
        builder.set(z, 0_usize, sum);
    }
    relaxation(builder, name, network, &layout, &u, sample, z);

    let y = readout(builder, name, network, z);
    builder.value(scaling.output_mean + scaling.output_deviation * y)
}

fn limited(builder: &mut Builder, u: Real) -> Real {
    let largest = match builder.precision() {
        Precision::Double => LARGEST_SCALED,
        Precision::Single => LARGEST_SCALED_SINGLE,
    };
    let u = builder.value(u);
    let low = builder.value(u.above(-largest).choose(&u, -largest));
    builder.value(low.below(largest).choose(&low, largest))
}

fn stops(
    builder: &mut Builder,
    name: &str,
    network: &Network,
    layout: &ParameterLayout,
    u: &[Real],
    sample: &PartInputs,
    z: Array,
) {
    let a = network.architecture();
    let parameters = network.parameters();
    let by_stop = &parameters[layout.stop_weights.clone()];
    let weights: Vec<Array> = (0..u.len())
        .map(|c| {
            let of_channel = (0..a.stops).map(|j| by_stop[j * u.len() + c]).collect();
            builder.constants(&format!("{name}_stop_weight_{c}"), of_channel)
        })
        .collect();
    let play = builder.state(&format!("{name}_play"), vec![0.0; a.stops]);
    let v = builder.scratch(&format!("{name}_drive"), a.stops);
    builder.each(0_usize, a.stops, |builder, j| {
        let mut sum = weights[0].at(&j) * &u[0];
        for (weights, u) in weights.iter().zip(u).skip(1) {
            sum = fused(weights.at(&j), u, sum);
        }
        builder.set(v, &j, sum);
    });
    builder.when(sample.is_first.clone(), |builder| {
        builder.each(0_usize, a.stops, |builder, j| {
            let v = builder.value(v.at(&j));
            let after = follow(builder, &Real::Constant(0.0), &v);
            builder.set(play, &j, after);
        });
    });
    let first = usize::from(a.linear);
    let deterioration = a.deterioration.then(|| {
        let inverse_beta = parameters[layout.ln_beta.clone()].iter().map(|ln_beta| exp(-ln_beta)).collect();
        (
            builder.state(&format!("{name}_slip"), vec![0.0; a.stops]),
            builder.constants(&format!("{name}_inverse_beta"), inverse_beta),
        )
    });
    builder.each(0_usize, a.stops, |builder, j| {
        let v = builder.value(v.at(&j));
        let before = builder.value(play.at(&j));
        let after = follow(builder, &before, &v);
        builder.set(play, &j, &after);
        let mut output = &v - &after;
        if let Some((slip, inverse_beta)) = deterioration {
            let sum = builder.value(slip.at(&j) + (&after - &before).abs());
            builder.set(slip, &j, &sum);
            let strength = builder.value(fused(-sum, inverse_beta.at(&j), 1.0));
            output = output * strength.above(0.0).choose(&strength, 0.0);
        }
        builder.set(z, j + first, output);
    });
}

fn follow(builder: &mut Builder, play: &Real, v: &Real) -> Real {
    let lower = builder.value(v - 1.0);
    let upper = builder.value(v + 1.0);
    let pushed_up = builder.value(lower.above(play).choose(&lower, play));
    builder.value(upper.below(&pushed_up).choose(&upper, &pushed_up))
}

fn relaxation(
    builder: &mut Builder,
    name: &str,
    network: &Network,
    layout: &ParameterLayout,
    u: &[Real],
    sample: &PartInputs,
    z: Array,
) {
    let a = network.architecture();
    if a.relaxation == 0 {
        return;
    }
    let inverse_tau = network.parameters()[layout.ln_tau.clone()].iter().map(|ln_tau| exp(-ln_tau)).collect();
    let inverse_tau = builder.constants(&format!("{name}_inverse_tau"), inverse_tau);
    let stress = builder.state(&format!("{name}_stress"), vec![0.0; a.relaxation_neurons()]);
    let last = builder.state(&format!("{name}_last"), vec![0.0; a.inputs]);
    let behind = usize::from(a.linear) + a.stops;
    for input in 0..a.inputs {
        let u = &u[if input == 0 { 0 } else { input + usize::from(a.rate) }];
        let increment = builder.value(u - last.at(input));
        builder.set(last, input, u);
        let first = input * a.relaxation;
        builder.each(first, first + a.relaxation, |builder, m| {
            let (left, gain) = decay(builder, &sample.step * inverse_tau.at(&m));
            let after = builder.value(left * stress.at(&m) + gain * &increment);
            builder.set(stress, &m, &after);
            builder.set(z, m + behind, &after);
        });
    }
}

/// `e^{-φ}` and `(1 - e^{-φ})/φ`, as `hysid_core::network::decay`.
fn decay(builder: &mut Builder, phi: Real) -> (Real, Real) {
    let longest = match builder.precision() {
        Precision::Double => LONGEST,
        Precision::Single => LONGEST_SINGLE,
    };
    let phi = builder.value(phi);
    let phi = builder.value(phi.above(0.0).choose(&phi, 0.0));
    let bounded = builder.value(phi.below(longest).choose(&phi, longest));
    let k = nearest_whole(builder, &bounded, -std::f64::consts::LOG2_E);
    let power = builder.value(k.power_of_two());
    let s = builder.value(fused(-&k, LN_2[1], fused(-&k, LN_2[0], -&bounded)));
    let square = polynomial(builder, &SQUARE_AND_UP, &s);
    let m = builder.value(fused(&s * &s, square, &s));
    let left = builder.value(fused(&power, &m, &power));
    let lost = builder.value(fused(-&power, &m, 1.0 - &power));
    let stress = builder.value(phi.below(longest).choose(left, 0.0));
    let increment = builder.value(phi.above(0.0).choose(lost / &phi, 1.0));
    (stress, increment)
}

/// The whole number next to `a * b`, whose magnitude is below 1000; halves go to the even one. Its derivative is 0.
fn nearest_whole(builder: &mut Builder, a: &Real, b: f64) -> Real {
    let round = builder.precision().rounding();
    builder.value((fused(a, b, round) - round).detached())
}

fn polynomial(builder: &mut Builder, coefficients: &[f64], x: &Real) -> Real {
    let mut value = Real::Constant(coefficients[0]);
    for &coefficient in &coefficients[1..] {
        value = builder.value(fused(value, x, coefficient));
    }
    value
}

/// tanh, as `hysid_core::network::tanh`.
pub(super) fn tanh(builder: &mut Builder, x: &Real) -> Real {
    let magnitude = builder.value(x.abs());
    let a = builder.value(magnitude.below(20.0).choose(&magnitude, 20.0));
    let k = nearest_whole(builder, &a, 2.0 * std::f64::consts::LOG2_E);
    let power = builder.value(k.power_of_two());
    let s = builder.value(fused(-&k, 0.5 * std::f64::consts::LN_2, &a));
    let square = builder.value(&s * &s);
    let cubic = polynomial(builder, &CUBIC_AND_UP, &square);
    let t = builder.value(fused(&square * &s, cubic, &s));
    let less = builder.value(&power - 1.0);
    let more = builder.value(&power + 1.0);
    builder.value((fused(&more, &t, &less) / fused(&less, &t, &more)).copysign(x))
}

/// The scaled output of the memory neurons' outputs `z`.
fn readout(builder: &mut Builder, name: &str, network: &Network, z: Array) -> Real {
    let a = network.architecture();
    let (constant, rest) = network.output().split_at(usize::from(a.constant));
    let (of_hidden, direct) = rest.split_at(a.hidden);
    let y = builder.variable(constant.first().copied().unwrap_or(0.0));
    if a.hidden > 0 {
        let hidden = &network.parameters()[ParameterLayout::new(*a).hidden];
        let memory = a.memory_neurons();
        let bias = (0..a.hidden).map(|i| hidden[i * (1 + memory)]).collect();
        let bias = builder.constants(&format!("{name}_bias"), bias);
        // For each memory neuron in turn, its weights in all tanh neurons: neighbours are computed together.
        let by_memory =
            (0..memory).flat_map(|j| (0..a.hidden).map(move |i| hidden[i * (1 + memory) + 1 + j]));
        let weights = builder.constants(&format!("{name}_hidden"), by_memory.collect());
        let output = builder.constants(&format!("{name}_output"), of_hidden.to_vec());
        let h = builder.scratch(&format!("{name}_tanh"), a.hidden);
        builder.each(0_usize, a.hidden, |builder, i| builder.set(h, &i, bias.at(&i)));
        builder.each(0_usize, memory, |builder, j| {
            let z = builder.value(z.at(&j));
            builder.each(0_usize, a.hidden, |builder, i| {
                builder.set(h, &i, fused(weights.at(&j * a.hidden + &i), &z, h.at(&i)));
            });
        });
        builder.each(0_usize, a.hidden, |builder, i| {
            let sum = builder.value(h.at(&i));
            let value = tanh(builder, &sum);
            builder.set(h, &i, value);
        });
        builder.each(0_usize, a.hidden, |builder, i| {
            builder.assign(y, fused(output.at(&i), h.at(&i), y));
        });
    }
    if direct.is_empty() {
        return y.into();
    }
    let weights = builder.constants(&format!("{name}_direct"), direct.to_vec());
    let of_memory = builder.variable(0.0);
    builder.each(0_usize, direct.len(), |builder, j| {
        builder.assign(of_memory, fused(weights.at(&j), z.at(&j), of_memory));
    });
    Real::from(y) + Real::from(of_memory)
}

//! Neuro-Madelung: a network gives the slope of the chord of each branch.

use hysid_core::law::neuro_madelung::NeuroMadelung;

use super::turning_points::TurningPoints;
use crate::description::PartInputs;
use crate::program::Builder;
use crate::program::expression::{Real, Whole};

/// Scaled inputs are limited to this magnitude, as in the library.
const LARGEST_INPUT: f64 = 1e6;

/// `y = y_t + (x - x_t) N(x, x_t, y_t[, x'])` (theory.md (8.19))
pub(super) fn step(builder: &mut Builder, name: &str, law: &NeuroMadelung, sample: &PartInputs) -> Real {
    let points = TurningPoints::new(builder, name);
    let mut scaled = |value: &Real, scale: f64| {
        let value = builder.value(value / scale);
        builder.value(value.clamp(-LARGEST_INPUT, LARGEST_INPUT))
    };
    let x = scaled(&sample.inputs[0], law.input_scale);
    let rate = law.rate_scale.map(|scale| scaled(&sample.rate, scale));
    let n = Whole::from(points.advance(builder, &x));
    let (x_t, y_t) = (builder.variable(0.0), builder.variable(law.virgin_output));
    builder.when(n.above(0_usize), |builder| {
        let (x, y) = points.last(&n);
        builder.assign(x_t, x);
        builder.assign(y_t, y);
    });
    let (x_t, y_t) = (Real::from(x_t), Real::from(y_t));

    let (low, high) = law.branch().range();
    let mut seen = vec![builder.value(x.clamp(-1.0, 1.0)), builder.value(x_t.clamp(-1.0, 1.0))];
    seen.push(builder.value(y_t.clamp(low, high)));
    seen.extend(rate.map(|rate| builder.value(rate.clamp(-1.0, 1.0))));
    let slope = slope(builder, name, law, &seen);

    let y = builder.value(y_t + (x - x_t) * slope);
    let (least, most) = law.branch().limits();
    let y = builder.value(y.clamp(least, most));
    points.set_value(builder, &y);
    builder.value(law.output_mean + law.output_scale * y)
}

/// `N` (theory.md (8.20))
fn slope(builder: &mut Builder, name: &str, law: &NeuroMadelung, seen: &[Real]) -> Real {
    let run = 1 + seen.len();
    let hidden = builder.constants(&format!("{name}_hidden"), law.hidden.clone());
    let output = builder.constants(&format!("{name}_output"), law.output.clone());
    let slope = builder.variable(law.output[0]);
    builder.each(0_usize, law.output.len() - 1, |builder, neuron| {
        let first = Whole::from(builder.whole_variable(&neuron * run));
        let weighted = |j: usize| hidden.at(&first + (1 + j)) * &seen[j];
        let sum = (1..seen.len()).fold(weighted(0), |sum, j| sum + weighted(j));
        let argument = builder.value(hidden.at(&first) + sum);
        builder.assign(slope, Real::from(slope) + output.at(&neuron + 1) * argument.tanh());
    });
    slope.into()
}

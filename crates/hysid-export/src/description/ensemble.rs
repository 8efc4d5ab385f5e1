//! Ensembles: nested weighted medians, whose weights depend on how far the input has been outside the trained range.

use hysid_core::model::{Ensemble, Group, NodeKind};

use crate::program::expression::{Real, Whole};
use crate::program::{Array, Builder};

/// Distance outside the trained range, as a share of its width, from which a record counts as fully outside.
const WAY_OUT: f64 = 0.06;

/// The degree of having been outside a range, 0 to 1 (theory.md (11.4)).
pub(super) fn excursion(builder: &mut Builder, (low, high): (f64, f64), x: &Real) -> Real {
    let farthest = builder.state("farthest", vec![0.0]);
    let below = builder.value(low - x);
    let above = builder.value(x - high);
    let before = builder.value(farthest.at(0_usize));
    let with_below = builder.value(before.max(&below));
    let now = builder.value(with_below.max(&above));
    builder.set(farthest, 0_usize, &now);
    let share = builder.value(now / (WAY_OUT * (high - low)));
    builder.value(share.clamp(0.0, 1.0))
}

/// The output of a group: the weighted median of its nodes.
pub(super) fn output(builder: &mut Builder, group: &Group, outside: &Real, of_members: Array) -> Real {
    let nodes: Vec<Real> = group
        .nodes
        .iter()
        .map(|node| match &node.kind {
            NodeKind::Member(member) => of_members.at(*member),
            NodeKind::Group(group) => output(builder, group, outside, of_members),
        })
        .collect();
    if let [only] = nodes.as_slice() {
        return builder.value(only);
    }
    builder.remark(format!("weighted median: {}", group.name));
    let count = nodes.len();
    let values = builder.scratch("median_value", count);
    let weights = node_weights(builder, group, outside);
    for (k, value) in nodes.into_iter().enumerate() {
        insert(builder, k, value, values, weights);
    }
    quantile(builder, count, values, weights, 0.5)
}

/// Disagreement of the members: half the distance between the 15.9 % and 84.1 % quantiles of their outputs.
pub(super) fn disagreement(
    builder: &mut Builder,
    ensemble: &Ensemble,
    outside: &Real,
    of_members: Array,
) -> Real {
    builder.remark("disagreement of the members");
    let mut shares = Vec::new();
    weights_in_whole(builder, ensemble.group(), outside, &Real::Constant(1.0), &mut shares);
    let count = shares.len();
    let values = builder.scratch("member_value", count);
    let weights = builder.scratch("member_weight", count);
    for (k, (_, share)) in shares.iter().enumerate() {
        builder.set(weights, k, share);
    }
    for (k, (member, _)) in shares.iter().enumerate() {
        insert(builder, k, of_members.at(*member), values, weights);
    }
    let low = quantile(builder, count, values, weights, 0.159);
    let high = quantile(builder, count, values, weights, 0.841);
    builder.value(0.5 * (high - low))
}

fn weights_in_whole(
    builder: &mut Builder,
    group: &Group,
    outside: &Real,
    share: &Real,
    all: &mut Vec<(usize, Real)>,
) {
    let weights = node_weights(builder, group, outside);
    let total = builder.variable(0.0);
    builder.each(0_usize, group.nodes.len(), |builder, k| {
        builder.assign(total, Real::from(total) + weights.at(&k));
    });
    for (k, node) in group.nodes.iter().enumerate() {
        let share = builder.value(share * weights.at(k) / Real::from(total));
        match &node.kind {
            NodeKind::Member(member) => all.push((*member, share)),
            NodeKind::Group(group) => weights_in_whole(builder, group, outside, &share, all),
        }
    }
}

fn node_weights(builder: &mut Builder, group: &Group, outside: &Real) -> Array {
    let count = group.nodes.len();
    let weights = builder.scratch("median_weight", count);
    let of_inside = builder.constants("inside", group.nodes.iter().map(|node| node.weights.inside).collect());
    let of_outside =
        builder.constants("outside", group.nodes.iter().map(|node| node.weights.outside).collect());
    builder.each(0_usize, count, |builder, k| {
        let (a, b) = (of_inside.at(&k), of_outside.at(&k));
        let between = a.powf(1.0 - outside) * b.powf(outside);
        let weight = outside.equals(0.0).choose(a, outside.equals(1.0).choose(b, between));
        builder.set(weights, &k, weight);
    });
    // Only where no node has a weight both inside and outside can all weights in between be 0.
    if group.nodes.iter().all(|node| node.weights.inside == 0.0 || node.weights.outside == 0.0) {
        blend_where_all_are_zero(builder, group, outside, weights);
    }
    weights
}

/// The weights `(1-o) a/Σa + o b/Σb` (theory.md (11.9)).
fn blend_where_all_are_zero(builder: &mut Builder, group: &Group, outside: &Real, weights: Array) {
    let sum = |of: fn(&hysid_core::model::Weights) -> f64| -> f64 {
        group.nodes.iter().map(|node| of(&node.weights)).sum()
    };
    let (a, b) = (sum(|weights| weights.inside), sum(|weights| weights.outside));
    let total = builder.variable(0.0);
    builder.each(0_usize, group.nodes.len(), |builder, k| {
        builder.assign(total, Real::from(total) + weights.at(&k))
    });
    builder.when(Real::from(total).equals(0.0), |builder| {
        for (k, node) in group.nodes.iter().enumerate() {
            let weights_of = &node.weights;
            let of_inside = if a > 0.0 { weights_of.inside / a } else { weights_of.outside / b };
            let of_outside = if b > 0.0 { weights_of.outside / b } else { weights_of.inside / a };
            builder.set(weights, k, (1.0 - outside) * of_inside + outside * of_outside);
        }
    });
}

/// Inserts the value `k` with its weight among those before it, which are sorted.
fn insert(builder: &mut Builder, k: usize, value: Real, values: Array, weights: Array) {
    let value = builder.value(value);
    let weight = builder.value(weights.at(k));
    let place = builder.whole_variable(k);
    let here = || Whole::from(place);
    builder.while_true(here().above(0_usize).and(values.at(here() - 1_usize).above(&value)), |builder| {
        builder.set(values, here(), values.at(here() - 1_usize));
        builder.set(weights, here(), weights.at(here() - 1_usize));
        builder.assign_whole(place, here() - 1_usize);
    });
    builder.set(values, here(), value);
    builder.set(weights, here(), weight);
}

/// A quantile of sorted values, with linear interpolation between the levels of their weights (theory.md (11.3)).
fn quantile(builder: &mut Builder, count: usize, values: Array, weights: Array, level_wanted: f64) -> Real {
    let total = builder.variable(0.0);
    builder.each(0_usize, count, |builder, k| builder.assign(total, Real::from(total) + weights.at(&k)));
    let wanted = builder.value(level_wanted * Real::from(total));
    let passed = builder.variable(0.0);
    let level = builder.variable(0.0);
    let result = builder.variable(values.at(0_usize));
    let has_below = builder.variable(0.0);
    let k = builder.whole_variable(0_usize);
    builder.while_true(Whole::from(k).below(count), |builder| {
        let weight = builder.value(weights.at(k));
        let next = builder.whole_variable(Whole::from(k) + 1_usize);
        builder.when(weight.equals(0.0).negated(), |builder| {
            let place = builder.value(Real::from(passed) + 0.5 * &weight);
            let value = builder.value(values.at(k));
            builder.when_else(
                place.at_least(&wanted),
                |builder| {
                    let share = (&wanted - Real::from(level)) / (&place - Real::from(level));
                    let between = Real::from(result) + (&value - Real::from(result)) * share;
                    builder.assign(result, Real::from(has_below).above(0.0).choose(between, &value));
                    builder.assign_whole(next, count);
                },
                |builder| {
                    builder.assign(result, &value);
                    builder.assign(level, &place);
                    builder.assign(has_below, 1.0);
                    builder.assign(passed, Real::from(passed) + &weight);
                },
            );
        });
        builder.assign_whole(k, next);
    });
    result.into()
}

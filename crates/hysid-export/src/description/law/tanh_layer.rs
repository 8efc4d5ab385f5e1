//! A layer of tanh neurons and scalar products, as in the library's `law::tanh_layer`.

use crate::description::network::tanh;
use crate::program::expression::{Real, Whole, fused};
use crate::program::{Array, Builder};

/// Partial sums of the library's vectors.
const LANES: usize = 8;

/// Numbers of an array from an index on.
#[derive(Clone, Copy)]
pub(super) struct Slice(pub Array, pub usize);

/// `tanh(b + A inputs)`, from the weights of each input in turn; the first input is the constant.
pub(super) fn layer(
    builder: &mut Builder,
    weights: Array,
    (inputs, count): (Array, usize),
    (Slice(neurons, first), width): (Slice, usize),
) {
    let place = |builder: &mut Builder, i: &Whole| match first {
        0 => i.clone(),
        _ => builder.whole_variable(i + first).into(),
    };
    builder.each(0_usize, width, |builder, i| {
        let at = place(builder, &i);
        builder.set(neurons, &at, weights.at(&i));
    });
    builder.each(1_usize, count, |builder, k| {
        let input = builder.value(inputs.at(&k));
        builder.each(0_usize, width, |builder, i| {
            let at = place(builder, &i);
            builder.set(neurons, &at, fused(weights.at(&k * width + &i), &input, neurons.at(&at)));
        });
    });
    builder.each(0_usize, width, |builder, i| {
        let at = place(builder, &i);
        let sum = builder.value(neurons.at(&at));
        let value = tanh(builder, &sum);
        builder.set(neurons, &at, value);
    });
}

/// Adds the columns of `weights`, each times its input.
pub(super) fn add_columns(
    builder: &mut Builder,
    weights: Array,
    (inputs, count): (Array, usize),
    (sums, width): (Array, usize),
) {
    builder.each(0_usize, count, |builder, k| {
        let input = builder.value(inputs.at(&k));
        builder.each(0_usize, width, |builder, i| {
            builder.set(sums, &i, fused(weights.at(&k * width + &i), &input, sums.at(&i)));
        });
    });
}

/// Scalar product of numbers of two arrays from an index on. `sums` is scratch, see [`partial_sums`].
pub(super) fn product(
    builder: &mut Builder,
    (a, from_a): (Array, &Whole),
    (b, from_b): (Array, &Whole),
    (length, sums): (usize, Array),
) -> Real {
    let whole = length - length % LANES;
    let rest = builder.variable(0.0);
    let add_rest = |builder: &mut Builder| {
        builder.each(whole, length, |builder, k| {
            builder.assign(rest, fused(a.at(from_a + &k), b.at(from_b + &k), rest));
        });
    };
    if whole == 0 {
        add_rest(builder);
        return rest.into();
    }
    builder.each(0_usize, LANES, |builder, l| builder.set(sums, &l, 0.0));
    builder.each(0_usize, whole / LANES, |builder, group| {
        builder.each(0_usize, LANES, |builder, l| {
            let k = Whole::from(builder.whole_variable(&group * LANES + &l));
            builder.set(sums, &l, fused(a.at(from_a + &k), b.at(from_b + &k), sums.at(&l)));
        });
    });
    add_rest(builder);
    let s = |l: usize| sums.at(l);
    let [first, second] = [(s(0) + s(4)) + (s(1) + s(5)), (s(2) + s(6)) + (s(3) + s(7))];
    builder.value(first + second + Real::from(rest))
}

/// Scratch of [`product`].
pub(super) fn partial_sums(builder: &mut Builder, name: &str) -> Array {
    builder.scratch(&format!("{name}_sum"), LANES)
}

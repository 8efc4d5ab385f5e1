//! Prandtl-Ishlinskii: a weighted sum of plays.

use hysid_core::law::prandtl_ishlinskii::PrandtlIshlinskii;

use crate::description::{PartInputs, limited};
use crate::program::expression::{Real, Whole};
use crate::program::{Array, Builder};

/// Partial sums of the library's vectors.
const LANES: usize = 8;

/// `y = c + w_0 x + Σ_i w_i p_{r_i}[x]` (theory.md (7.4))
pub(super) fn step(builder: &mut Builder, name: &str, law: &PrandtlIshlinskii, sample: &PartInputs) -> Real {
    let x = limited(builder, &sample.inputs[0]);
    let sum = sum_of_plays(builder, name, law.thresholds(), law.weights(), &x);
    builder.value(law.constant() + law.linear() * x + sum)
}

/// Advances plays and gives their weighted sum, in eight partial sums as the library does.
pub(super) fn sum_of_plays(
    builder: &mut Builder,
    name: &str,
    thresholds: &[f64],
    weights: &[f64],
    x: &Real,
) -> Real {
    let plays = builder.state(&format!("{name}_play"), vec![0.0; thresholds.len()]);
    let thresholds_of = builder.constants(&format!("{name}_threshold"), thresholds.to_vec());
    let weights_of = builder.constants(&format!("{name}_weight"), weights.to_vec());
    let groups = thresholds.len() / LANES;
    let total = builder.variable(0.0);
    if groups > 0 {
        let sums = builder.scratch(&format!("{name}_sum"), LANES);
        builder.each(0_usize, LANES, |builder, l| builder.set(sums, &l, 0.0));
        builder.each(0_usize, groups, |builder, group| {
            builder.each(0_usize, LANES, |builder, l| {
                let index = Whole::from(builder.whole_variable(&group * LANES + &l));
                let after = follow(builder, plays, &index, x, &thresholds_of.at(&index));
                builder.set(sums, &l, sums.at(&l) + weights_of.at(&index) * after);
            });
        });
        builder.each(0_usize, LANES, |builder, l| builder.assign(total, Real::from(total) + sums.at(&l)));
    }
    builder.each(groups * LANES, thresholds.len(), |builder, index| {
        let after = follow(builder, plays, &index, x, &thresholds_of.at(&index));
        builder.assign(total, Real::from(total) + weights_of.at(&index) * after);
    });
    total.into()
}

/// Moves one of the plays, and returns it.
pub(super) fn follow(builder: &mut Builder, plays: Array, index: &Whole, x: &Real, r: &Real) -> Real {
    let r = builder.value(r);
    let before = builder.value(plays.at(index));
    let lower = builder.value(x - &r);
    let upper = builder.value(x + &r);
    let pushed_up = builder.value(lower.above(&before).choose(&lower, &before));
    let after = builder.value(upper.below(&pushed_up).choose(&upper, &pushed_up));
    builder.set(plays, index, &after);
    after
}

//! Ramberg-Osgood: a power curve with Masing's rules.

use hysid_core::law::ramberg_osgood::{LARGEST_RATIO, MOST_STEPS, RambergOsgood};

use super::turning_points::TurningPoints;
use crate::description::{PartInputs, limited};
use crate::program::Builder;
use crate::program::expression::{Real, Whole};

/// `y = c0 + F v`, or `v = v* + 2 g((x - x*)/2)` from a turning point (theory.md (8.60))
pub(super) fn step(builder: &mut Builder, name: &str, law: &RambergOsgood, sample: &PartInputs) -> Real {
    let points = TurningPoints::new(builder, name);
    let x = limited(builder, &sample.inputs[0]);
    let n = Whole::from(points.advance(builder, &x));
    let v = builder.variable(0.0);
    builder.when_else(
        n.equals(0_usize),
        |builder| {
            let value = skeleton(builder, law, &x);
            builder.assign(v, value);
        },
        |builder| {
            let (start, at_start) = points.last(&n);
            let half = builder.value(0.5 * (&x - start));
            let value = skeleton(builder, law, &half);
            builder.assign(v, at_start + 2.0 * value);
        },
    );
    let v = Real::from(v);
    points.set_value(builder, &v);
    builder.value(law.offset + law.strength * v)
}

/// `v` of the skeleton curve (theory.md (8.59)) by Newton's method.
fn skeleton(builder: &mut Builder, law: &RambergOsgood, x: &Real) -> Real {
    let r = law.exponent;
    let ratio = builder.value(x / law.yield_displacement);
    let ratio = builder.value(ratio.clamp(-LARGEST_RATIO, LARGEST_RATIO));
    let u = builder.value(ratio.abs());
    let newton = |builder: &mut Builder, v: &Real| {
        let power = builder.value(v.powf(r - 1.0));
        builder.value(v - (v + v * &power - &u) / (1.0 + r * &power))
    };
    let bound = builder.value(u.powf(1.0 / r));
    let v = builder.variable(u.min(bound));
    let first = newton(builder, &v.into());
    let (next, steps) = (builder.variable(first), builder.whole_variable(0_usize));
    let goes_on = Real::from(next).below(v).and(Whole::from(steps).below(MOST_STEPS));
    builder.while_true(goes_on, |builder| {
        builder.assign(v, next);
        let after = newton(builder, &v.into());
        builder.assign(next, after);
        builder.assign_whole(steps, Whole::from(steps) + 1);
    });
    builder.value(ratio.below(0.0).choose(-Real::from(v), v))
}

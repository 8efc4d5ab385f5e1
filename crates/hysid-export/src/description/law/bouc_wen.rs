//! Bouc-Wen, with degradation and pinching after Baber and Noori.

mod degradation;

use hysid_core::law::bouc_wen::BoucWen;

use crate::description::{PartInputs, limited};
use crate::program::Builder;
use crate::program::expression::{Real, RealVariable, Whole};
use degradation::{DegradingElement, ElementProperties};

// Numbers of the library's solver.
const LONGEST_PART: f64 = 0.1;
const SATURATED: f64 = 60.0;
const YIELDED: f64 = 1.0 - 1e-14;
const MOST_PARTS: f64 = 600.0;

/// `y = c0 + α k x + (1 - α) k z + c x'` (theory.md (8.4))
pub(super) fn step(builder: &mut Builder, name: &str, law: &BoucWen, sample: &PartInputs) -> Real {
    let last = builder.state(&format!("{name}_input"), vec![0.0]);
    let z_of = builder.state(&format!("{name}_z"), vec![0.0]);
    let energy = law.degradation.map(|_| builder.state(&format!("{name}_energy"), vec![0.0]));
    let x = limited(builder, &sample.inputs[0]);
    let rate = limited(builder, &sample.rate);
    let by = builder.value((&x - last.at(0_usize)) / law.yield_displacement);
    builder.set(last, 0_usize, &x);
    builder.when(by.equals(0.0).negated(), |builder| {
        // The law is odd: downwards is upwards in a mirror.
        let direction = builder.value(by.signum());
        let z = builder.variable(&direction * z_of.at(0_usize));
        let e = builder.variable(energy.map_or(Real::Constant(0.0), |energy| energy.at(0_usize)));
        let by = builder.value(by.abs());
        upwards(builder, law, (z, e), &by);
        builder.set(z_of, 0_usize, &direction * Real::from(z));
        if let Some(energy) = energy {
            builder.set(energy, 0_usize, e);
        }
    });
    let z = law.hysteretic_stiffness * (law.yield_displacement * z_of.at(0_usize));
    builder.value(law.offset + law.elastic_stiffness * &x + z + law.damping * &rate)
}

fn upwards(builder: &mut Builder, law: &BoucWen, (z, e): (RealVariable, RealVariable), by: &Real) {
    match &law.degradation {
        None if law.n == 1.0 => {
            let end = exponential_branches(builder, law, &z.into(), by);
            builder.assign(z, end);
        }
        None => {
            builder.when(Real::from(z).below(YIELDED), |builder| {
                let part = LONGEST_PART / quickness(law).max(1.0);
                let (part, parts) = parts(builder, by, &part.into());
                let index = builder.variable(0.0);
                let goes_on = Real::from(index).below(&parts).and(Real::from(z).below(YIELDED));
                builder.while_true(goes_on, |builder| {
                    let (end, _) = self::part(builder, law, (&z.into(), &e.into()), &part);
                    builder.assign(z, end);
                    builder.assign(index, Real::from(index) + 1.0);
                });
            });
        }
        Some(degradation) => {
            let element = DegradingElement { degradation, n: law.n };
            let quicker = element.quickness(builder, &z.into(), &e.into());
            let quickness = builder.value(quickness(law) * quicker);
            let longest = builder.value(LONGEST_PART / quickness.max(element.narrowness()));
            let (part, _) = parts(builder, by, &longest);
            degrading_upwards(builder, law, &element, (z, e), (&part, by));
        }
    }
}

/// Length and number of the parts of a step.
fn parts(builder: &mut Builder, by: &Real, longest: &Real) -> (Real, Real) {
    let travel = builder.value(by.min(SATURATED));
    let parts = builder.value((&travel / longest).ceil());
    let parts = builder.value(parts.clamp(1.0, MOST_PARTS));
    (builder.value(travel / &parts), parts)
}

/// How much faster than `x/z_u` the element comes to rest at its yield force, without degradation.
fn quickness(law: &BoucWen) -> f64 {
    0.5 * law.n.max((2.0 * law.b - 1.0).abs())
}

/// In parts, or along the yield force where the element follows it.
fn degrading_upwards(
    builder: &mut Builder,
    law: &BoucWen,
    element: &DegradingElement<'_>,
    (z, e): (RealVariable, RealVariable),
    (part, by): (&Real, &Real),
) {
    let travel = builder.value(by.min(SATURATED));
    let left = builder.variable(&travel);
    let is_done = builder.variable(0.0);
    let goes_on = Real::from(left).above(1e-9 * &travel).and(Real::from(is_done).equals(0.0));
    builder.while_true(goes_on, |builder| {
        let rests = element.is_at_rest(builder, &z.into(), &e.into());
        builder.when_else(
            rests.above(0.0),
            |builder| {
                let way = builder.value(Real::from(left) + (by - &travel));
                element.yields(builder, (z, e), &way);
                builder.assign(is_done, 1.0);
            },
            |builder| {
                let before = builder.value(z);
                let length = builder.value(part.min(left));
                let (end, energy) = self::part(builder, law, (&z.into(), &e.into()), &length);
                builder.assign(z, end);
                builder.assign(e, energy);
                builder.assign(left, Real::from(left) - part);
                element.follows(builder, (z, e), left, (&before, part));
            },
        );
    });
    builder.when(by.above(&travel).and(Real::from(is_done).equals(0.0)), |builder| {
        let way = builder.value(by - &travel);
        element.yields(builder, (z, e), &way);
    });
}

/// The exact solution for `n = 1` without degradation (theory.md (8.7)).
fn exponential_branches(builder: &mut Builder, law: &BoucWen, z: &Real, by: &Real) -> Real {
    let m = 2.0 * law.b - 1.0;
    let is_straight = m.abs() < 1e-9;
    let (start, way) = (builder.variable(z), builder.variable(by));
    let end = builder.variable(0.0);
    let passes = builder.variable(1.0);
    builder.when(z.below(0.0), |builder| {
        let to_zero = if is_straight { -z } else { (-m * z).ln_1p() / m };
        let to_zero = builder.value(to_zero);
        builder.when_else(
            by.below(&to_zero),
            |builder| {
                let gained = if is_straight { by.clone() } else { -(-m * by).exp_m1() / m };
                let value = builder.value(z * (-m * by).exp() + gained);
                builder.assign(end, value.min(0.0));
                builder.assign(passes, 0.0);
            },
            |builder| {
                builder.assign(start, 0.0);
                builder.assign(way, by - &to_zero);
            },
        );
    });
    builder.when(Real::from(passes).above(0.0), |builder| {
        builder.assign(end, 1.0 - (1.0 - Real::from(start)) * (-Real::from(way)).exp());
    });
    end.into()
}

/// Moves up by a small part; the kink at `z = 0` is stepped onto.
fn part(builder: &mut Builder, law: &BoucWen, start: (&Real, &Real), by: &Real) -> (Real, Real) {
    let (end_z, end_e) = runge_kutta(builder, law, start, by);
    let (z, e) = (builder.variable(&end_z), builder.variable(&end_e));
    builder.when(start.0.below(0.0).and(end_z.above(0.0)), |builder| {
        let low = (builder.variable(0.0), builder.variable(start.0));
        let high = (builder.variable(by), builder.variable(&end_z));
        let (way, energy) = (builder.variable(0.0), builder.variable(start.1));
        let index = builder.whole_variable(0_usize);
        builder.while_true(Whole::from(index).below(3), |builder| {
            let [low_0, low_1, high_0, high_1] = [low.0, low.1, high.0, high.1].map(Real::from);
            builder.assign(way, &low_0 - &low_1 * (&high_0 - &low_0) / (&high_1 - &low_1));
            let (middle, energy_there) = runge_kutta(builder, law, start, &way.into());
            builder.assign(energy, energy_there);
            builder.when_else(
                middle.below(0.0),
                |builder| {
                    builder.assign(low.0, way);
                    builder.assign(low.1, &middle);
                },
                |builder| {
                    builder.assign(high.0, way);
                    builder.assign(high.1, &middle);
                },
            );
            builder.assign_whole(index, Whole::from(index) + 1);
            builder.when(high_1.at_most(&low_1), |builder| builder.assign_whole(index, 3));
        });
        let left = builder.value(by - Real::from(way));
        let (from_zero, energy) = runge_kutta(builder, law, (&Real::Constant(0.0), &energy.into()), &left);
        builder.assign(z, from_zero);
        builder.assign(e, energy);
    });
    (z.into(), e.into())
}

fn runge_kutta(builder: &mut Builder, law: &BoucWen, (z, e): (&Real, &Real), by: &Real) -> (Real, Real) {
    let properties = law.degradation.as_ref().map(|degradation| {
        let energy = builder.value(e + 0.5 * by * z);
        DegradingElement { degradation, n: law.n }.properties(builder, &energy)
    });
    let within = |builder: &mut Builder, z: Real| {
        let z = builder.value(z);
        builder.value(z.clamp(-1.0, 1.0))
    };
    let k1 = slope(builder, law, properties.as_ref(), z);
    let z2 = within(builder, z + 0.5 * by * &k1);
    let k2 = slope(builder, law, properties.as_ref(), &z2);
    let z3 = within(builder, z + 0.5 * by * &k2);
    let k3 = slope(builder, law, properties.as_ref(), &z3);
    let z4 = within(builder, z + by * &k3);
    let k4 = slope(builder, law, properties.as_ref(), &z4);
    let end = within(builder, z + by * (k1 + 2.0 * (k2 + k3) + k4) / 6.0);
    let energy = match properties {
        None => Real::Constant(0.0),
        Some(_) => {
            let work = by * (z + 2.0 * (z2 + z3) + z4) / 6.0;
            let energy = builder.value(e + work);
            degradation::limited(builder, &energy)
        }
    };
    (end, energy)
}

/// `dz/dx` on the way up (theory.md (8.5), (8.6)).
fn slope(builder: &mut Builder, law: &BoucWen, properties: Option<&ElementProperties>, z: &Real) -> Real {
    let share = z.below(0.0).choose(1.0 - 2.0 * law.b, 1.0);
    let softening = builder.value(z.abs().powf(law.n) * share);
    match properties {
        None => builder.value(1.0 - softening),
        Some(properties) => properties.slope(builder, z, &softening),
    }
}

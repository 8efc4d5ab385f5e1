//! Jiles-Atherton: magnetisation, by a differential equation in the field.

use hysid_core::law::jiles_atherton::{JilesAtherton, JilesAthertonForm};

use crate::description::{PartInputs, limited};
use crate::program::Builder;
use crate::program::expression::Real;

// Numbers of the library's solver.
const LONGEST_PART: f64 = 0.05;
const MOST_PARTS: f64 = 4000.0;
const SATURATED: f64 = 300.0;

/// Most parts of a step that has the slope of the parts.
const PARTS_WITH_SLOPE: f64 = 200.0;

const LEAST_PINNING: f64 = 0.02;
const LARGEST_FEEDBACK: f64 = 0.98;

/// `y = c0 + μ H + M` (theory.md (8.22))
pub(super) fn step(builder: &mut Builder, name: &str, law: &JilesAtherton, sample: &PartInputs) -> Real {
    let field = builder.state(&format!("{name}_field"), vec![0.0]);
    let magnetisation = builder.state(&format!("{name}_magnetisation"), vec![0.0]);
    let h = limited(builder, &sample.inputs[0]);
    let before = builder.value(field.at(0_usize));
    let direction = builder.value((&h - &before).signum());
    let end = SATURATED * (law.a + law.k + law.coupling());
    let from = builder.value(&direction * &before);
    let from = builder.value(from.clamp(-end, end));
    let to = builder.value(&direction * &h);
    let to = builder.value(to.clamp(-end, end));
    builder.set(field, 0_usize, &h);
    builder.when(to.above(&from), |builder| {
        // The law is odd: downwards is upwards in a mirror.
        let part = LONGEST_PART * law.a.min(law.k);
        let parts = builder.value(((&to - &from) / part).ceil());
        let parts = builder.value(parts.clamp(1.0, MOST_PARTS));
        // Over a long way the slope is that of the differential equation at the end: that of all parts could overflow.
        let end = builder.value(parts.at_most(PARTS_WITH_SLOPE).choose(&to, to.detached()));
        let part = builder.value((&end - &from) / &parts);
        let m = builder.variable(&direction * magnetisation.at(0_usize));
        builder.each(0_usize, parts.to_whole(), |builder, index| {
            let h = builder.value(&from + &part * index.to_real());
            let next = runge_kutta(builder, law, &h, &m.into(), &part);
            builder.assign(m, next);
        });
        let m = Real::from(m);
        let slope = slope(builder, law, &end, &m);
        builder.set(magnetisation, 0_usize, &direction * (&m + slope * (&to - &end)));
    });
    builder.value(law.offset + law.permeability * &h + law.saturation * magnetisation.at(0_usize))
}

fn runge_kutta(builder: &mut Builder, law: &JilesAtherton, h: &Real, m: &Real, by: &Real) -> Real {
    let half = builder.value(h + 0.5 * by);
    let end = builder.value(h + by);
    let k1 = slope(builder, law, h, m);
    let m2 = builder.value(m + 0.5 * by * &k1);
    let k2 = slope(builder, law, &half, &m2);
    let m3 = builder.value(m + 0.5 * by * &k2);
    let k3 = slope(builder, law, &half, &m3);
    let m4 = builder.value(m + by * &k3);
    let k4 = slope(builder, law, &end, &m4);
    let next = builder.value(m + by * (k1 + 2.0 * (k2 + k3) + k4) / 6.0);
    builder.value(next.clamp(-1.0, 1.0))
}

/// `d(M/M_s)/dH` on the way up (theory.md (8.23) to (8.25)).
fn slope(builder: &mut Builder, law: &JilesAtherton, h: &Real, m: &Real) -> Real {
    let effective = builder.value((h + law.coupling() * m) / law.a);
    let (langevin, steepness) = langevin(builder, &effective);
    let anhysteretic = builder.value(steepness / law.a);
    let missing = builder.value(langevin - m);
    let missing = builder.value(missing.max(0.0));
    match law.form {
        JilesAthertonForm::Original => {
            let pinning = builder.value(law.k - law.coupling() * &missing);
            let pinning = pinning.max(LEAST_PINNING * law.k);
            let reversible = builder.value(law.c * anhysteretic);
            let feedback = builder.value(law.coupling() * &reversible);
            builder.value(
                ((1.0 - law.c) * missing / pinning + reversible) / (1.0 - feedback.min(LARGEST_FEEDBACK)),
            )
        }
        JilesAthertonForm::Differential => {
            let n = builder.value(missing / law.k + law.c * anhysteretic);
            let feedback = builder.value(law.coupling() * &n);
            builder.value(n / (1.0 - feedback.min(LARGEST_FEEDBACK)))
        }
    }
}

/// `coth x - 1/x` and its derivative.
fn langevin(builder: &mut Builder, x: &Real) -> (Real, Real) {
    let square = builder.value(x * x);
    let (value, derivative) = (builder.variable(0.0), builder.variable(0.0));
    builder.when_else(
        square.below(0.0025),
        |builder| {
            let series = 1.0 - &square / 15.0 * (1.0 - 2.0 / 21.0 * &square);
            builder.assign(value, x / 3.0 * series);
            builder.assign(derivative, 1.0 / 3.0 - &square / 15.0 + 2.0 / 189.0 * &square * &square);
        },
        |builder| {
            let decline = builder.value((-2.0 * x.abs()).exp());
            let rest = builder.value(1.0 - &decline);
            let magnitude = builder.value((1.0 + &decline) / &rest - 1.0 / x.abs());
            builder.assign(value, magnitude.copysign(x));
            builder.assign(derivative, 1.0 / &square - 4.0 * &decline / (&rest * &rest));
        },
    );
    (value.into(), derivative.into())
}

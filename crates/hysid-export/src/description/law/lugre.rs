//! LuGre: friction of bristles that deflect before they slide.

use hysid_core::law::lugre::Lugre;

use crate::description::{PartInputs, limited};
use crate::program::Builder;
use crate::program::expression::Real;

/// `y = c0 + k x + σ0 z + σ1 dz/dt + σ2 v` (theory.md (8.27), (8.28))
pub(super) fn step(builder: &mut Builder, name: &str, law: &Lugre, sample: &PartInputs) -> Real {
    let last = builder.state(&format!("{name}_input"), vec![0.0]);
    let deflection = builder.state(&format!("{name}_deflection"), vec![0.0]);
    let x = limited(builder, &sample.inputs[0]);
    let rate = limited(builder, &sample.rate);
    let by = builder.value(&x - last.at(0_usize));
    builder.set(last, 0_usize, &x);
    let share = builder.value(&rate / law.stribeck_velocity);
    let steady = builder.value(1.0 + law.stribeck * (-&share * &share).exp());
    builder.when(by.equals(0.0).negated(), |builder| {
        let end = builder.value(by.signum() * &steady);
        let decay = builder.value((-by.abs() / (law.presliding * &steady)).exp());
        builder.set(deflection, 0_usize, &end + (deflection.at(0_usize) - &end) * decay);
    });
    let z = builder.value(deflection.at(0_usize));
    let of_bristles = builder.value((&rate - rate.abs() * &z / &steady) / law.presliding);
    let damping = builder.value(law.bristle_damping * of_bristles);
    let force = builder.value(law.sliding * &z + damping + law.viscous * &rate);
    let y = builder.value(law.offset + law.spring * &x + force);
    builder.value(y.clamp(-f64::MAX, f64::MAX))
}

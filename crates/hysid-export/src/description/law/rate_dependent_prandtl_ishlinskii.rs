//! Rate-dependent Prandtl-Ishlinskii: plays whose thresholds grow with the rate.

use hysid_core::law::rate_dependent_prandtl_ishlinskii::{RateDependentPrandtlIshlinskii, Thresholds};

use crate::description::{PartInputs, limited};
use crate::program::Builder;
use crate::program::expression::Real;

/// `y = c + a0 x + Σ_i a_i p_i` (theory.md (8.18))
pub(super) fn step(
    builder: &mut Builder,
    name: &str,
    law: &RateDependentPrandtlIshlinskii,
    sample: &PartInputs,
) -> Real {
    let count = law.weights.plays();
    let plays = builder.state(&format!("{name}_play"), vec![0.0; count]);
    let at_rest = (0..count).map(|index| law.spacing * (index + 1) as f64).collect();
    let at_rest = builder.constants(&format!("{name}_threshold"), at_rest);
    let weights = builder.constants(&format!("{name}_weight"), law.weights.values(law.spacing, 1));
    let x = limited(builder, &sample.inputs[0]);
    let rate = limited(builder, &sample.rate);
    let speed = builder.value(rate.abs());
    let (added, factor) = growth(builder, &law.thresholds, &speed);
    let y = builder.variable(law.offset + law.spring * x.clone());
    builder.each(0_usize, count, |builder, i| {
        let r = builder.value(at_rest.at(&i) * &factor + &added);
        let (low, high) = (builder.value(&x - &r), builder.value(&x + &r));
        let lowered = builder.value(high.min(plays.at(&i)));
        let play = builder.value(low.max(lowered));
        builder.set(plays, &i, &play);
        builder.assign(y, Real::from(y) + weights.at(&i) * play);
    });
    y.into()
}

/// The sum and the factor by which all thresholds change (theory.md (8.16), (8.17)).
fn growth(builder: &mut Builder, thresholds: &Thresholds, speed: &Real) -> (Real, Real) {
    match *thresholds {
        Thresholds::Linear { beta } => (builder.value(beta * speed), Real::Constant(1.0)),
        Thresholds::Logarithmic { beta, lambda, epsilon } => {
            let factor = builder.value((beta + lambda * speed.powf(epsilon)).ln());
            (Real::Constant(0.0), builder.value(factor.max(0.0)))
        }
    }
}

//! Modified Prandtl-Ishlinskii: dead zones of a sum of plays.

use hysid_core::law::modified_prandtl_ishlinskii::ModifiedPrandtlIshlinskii;

use super::prandtl_ishlinskii;
use crate::description::PartInputs;
use crate::program::Builder;
use crate::program::expression::{Real, RealVariable};

/// `y = S(H[x])`, `S(z) = c_S + w_S0 z + Σ_j w_Sj S_{r_Sj}(z)`
pub(super) fn step(
    builder: &mut Builder,
    name: &str,
    law: &ModifiedPrandtlIshlinskii,
    sample: &PartInputs,
) -> Real {
    let z = prandtl_ishlinskii::step(builder, name, law.hysteresis(), sample);
    let parts = law.superposition().parts();
    let sum = builder.variable(-0.0);
    add_dead_zones(builder, name, &parts.thresholds, &parts.weights, &z, sum);
    builder.value(parts.constant + parts.linear * z + Real::from(sum))
}

/// Adds `w_j S_{r_j}(z)` to a sum.
pub(super) fn add_dead_zones(
    builder: &mut Builder,
    name: &str,
    thresholds: &[f64],
    weights: &[f64],
    z: &Real,
    sum: RealVariable,
) {
    if thresholds.is_empty() {
        return;
    }
    let thresholds_of = builder.constants(&format!("{name}_dead_zone"), thresholds.to_vec());
    let weights_of = builder.constants(&format!("{name}_dead_zone_weight"), weights.to_vec());
    builder.each(0_usize, thresholds.len(), |builder, j| {
        let r = builder.value(thresholds_of.at(&j));
        let beyond = builder.value(z - &r);
        let zone = r.above(0.0).choose(beyond.max(0.0), beyond.min(0.0));
        builder.assign(sum, Real::from(sum) + weights_of.at(&j) * zone);
    });
}

//! Modified Prandtl-Ishlinskii: dead zones of a sum of plays.

use hysid_core::law::modified_prandtl_ishlinskii::ModifiedPrandtlIshlinskii;

use super::prandtl_ishlinskii;
use crate::description::Sample;
use crate::program::Builder;
use crate::program::expression::Real;

/// `y = S(H[x])`, `S(z) = c_S + w_S0 z + Σ_j w_Sj S_{r_Sj}(z)`
pub(super) fn step(
    builder: &mut Builder,
    name: &str,
    law: &ModifiedPrandtlIshlinskii,
    sample: &Sample,
) -> Real {
    let z = prandtl_ishlinskii::step(builder, name, law.hysteresis(), sample);
    let parts = law.superposition().parts();
    let sum = builder.variable(-0.0);
    if !parts.thresholds.is_empty() {
        let thresholds = builder.constants(&format!("{name}_dead_zone"), parts.thresholds.clone());
        let weights = builder.constants(&format!("{name}_dead_zone_weight"), parts.weights.clone());
        builder.each(0_usize, parts.thresholds.len(), |builder, j| {
            let r = builder.value(thresholds.at(&j));
            let beyond = builder.value(&z - &r);
            let zone = r.above(0.0).choose(beyond.max(0.0), beyond.min(0.0));
            builder.assign(sum, Real::from(sum) + weights.at(&j) * zone);
        });
    }
    builder.value(parts.constant + parts.linear * z + Real::from(sum))
}

//! Generalized Prandtl-Ishlinskii: plays between two envelopes.

use hysid_core::law::generalized_prandtl_ishlinskii::{Envelope, GeneralizedPrandtlIshlinskii};

use crate::description::{PartInputs, limited};
use crate::program::Builder;
use crate::program::expression::Real;

/// `y = c + Σ_j p(r_j) S_j` (theory.md (8.14))
pub(super) fn step(
    builder: &mut Builder,
    name: &str,
    law: &GeneralizedPrandtlIshlinskii,
    sample: &PartInputs,
) -> Real {
    let count = law.weights.plays();
    let plays = builder.state(&format!("{name}_play"), vec![law.initial; count]);
    let thresholds = (0..count).map(|index| law.spacing * index as f64).collect();
    let thresholds = builder.constants(&format!("{name}_threshold"), thresholds);
    let weights = builder.constants(&format!("{name}_weight"), law.weights.values(law.spacing, 0));
    let x = limited(builder, &sample.inputs[0]);
    let (left, right) = (envelope(builder, &law.left, &x), envelope(builder, &law.right, &x));
    let y = builder.variable(law.offset);
    builder.each(0_usize, count, |builder, j| {
        let r = builder.value(thresholds.at(&j));
        let (low, high) = (builder.value(&left - &r), builder.value(&right + &r));
        let lowered = builder.value(high.min(plays.at(&j)));
        let play = builder.value(low.max(lowered));
        builder.set(plays, &j, &play);
        builder.assign(y, Real::from(y) + weights.at(&j) * play);
    });
    y.into()
}

/// `γ(x) = a0 tanh(a1 x + a2) + a3` (theory.md (8.13))
fn envelope(builder: &mut Builder, envelope: &Envelope, x: &Real) -> Real {
    let Envelope { a0, a1, a2, a3 } = *envelope;
    builder.value(a0 * (a1 * x + a2).tanh() + a3)
}

//! The curve of elastic loading that becomes yielding, `z/(1 + z^n)^{1/n}` (theory.md (8.38), (8.48)).

use crate::program::Builder;
use crate::program::expression::Real;

/// The curve at `z ≥ 0`, as `hysid_core::law::yield_curve`. At 0 its slope is 1.
pub(super) fn yielding(builder: &mut Builder, z: &Real, n: &Real) -> Real {
    let value = builder.variable(z);
    builder.when(z.above(0.0), |builder| {
        let beyond = builder.value((-n * z.ln().abs()).exp());
        builder.assign(value, z.min(1.0) * (-beyond.ln_1p() / n).exp());
    });
    value.into()
}

//! TODO

use hysid_core::law::rate_dependent_prandtl_ishlinskii::RateDependentPrandtlIshlinskii;

use crate::description::Sample;
use crate::error::Error;
use crate::program::Builder;
use crate::program::expression::Real;

pub(super) fn step(
    _: &mut Builder,
    _: &str,
    _: &RateDependentPrandtlIshlinskii,
    _: &Sample,
) -> Result<Real, Error> {
    Err(Error::NoDescription("rate-dependent-prandtl-ishlinskii"))
}

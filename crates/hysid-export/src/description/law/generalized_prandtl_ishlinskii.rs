//! TODO

use hysid_core::law::generalized_prandtl_ishlinskii::GeneralizedPrandtlIshlinskii;

use crate::description::Sample;
use crate::error::Error;
use crate::program::Builder;
use crate::program::expression::Real;

pub(super) fn step(
    _: &mut Builder,
    _: &str,
    _: &GeneralizedPrandtlIshlinskii,
    _: &Sample,
) -> Result<Real, Error> {
    Err(Error::NoDescription("generalized-prandtl-ishlinskii"))
}

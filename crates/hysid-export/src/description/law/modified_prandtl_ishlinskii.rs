//! TODO

use hysid_core::law::modified_prandtl_ishlinskii::ModifiedPrandtlIshlinskii;

use crate::description::Sample;
use crate::error::Error;
use crate::program::Builder;
use crate::program::expression::Real;

pub(super) fn step(
    _: &mut Builder,
    _: &str,
    _: &ModifiedPrandtlIshlinskii,
    _: &Sample,
) -> Result<Real, Error> {
    Err(Error::NoDescription("modified-prandtl-ishlinskii"))
}

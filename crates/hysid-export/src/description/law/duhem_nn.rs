//! TODO

use hysid_core::law::duhem_nn::DuhemNn;

use crate::description::Sample;
use crate::error::Error;
use crate::program::Builder;
use crate::program::expression::Real;

pub(super) fn step(_: &mut Builder, _: &str, _: &DuhemNn, _: &Sample) -> Result<Real, Error> {
    Err(Error::NoDescription("duhem-nn"))
}

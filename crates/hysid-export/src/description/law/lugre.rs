//! TODO

use hysid_core::law::lugre::Lugre;

use crate::description::Sample;
use crate::error::Error;
use crate::program::Builder;
use crate::program::expression::Real;

pub(super) fn step(_: &mut Builder, _: &str, _: &Lugre, _: &Sample) -> Result<Real, Error> {
    Err(Error::NoDescription("lugre"))
}

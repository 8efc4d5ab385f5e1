//! TODO

use hysid_core::law::jiles_atherton::JilesAtherton;

use crate::description::Sample;
use crate::error::Error;
use crate::program::Builder;
use crate::program::expression::Real;

pub(super) fn step(_: &mut Builder, _: &str, _: &JilesAtherton, _: &Sample) -> Result<Real, Error> {
    Err(Error::NoDescription("jiles-atherton"))
}

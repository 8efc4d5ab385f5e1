//! TODO

use hysid_core::law::menegotto_pinto::MenegottoPinto;

use crate::description::Sample;
use crate::error::Error;
use crate::program::Builder;
use crate::program::expression::Real;

pub(super) fn step(_: &mut Builder, _: &str, _: &MenegottoPinto, _: &Sample) -> Result<Real, Error> {
    Err(Error::NoDescription("menegotto-pinto"))
}

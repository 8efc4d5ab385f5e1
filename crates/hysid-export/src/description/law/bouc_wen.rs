//! TODO

use hysid_core::law::bouc_wen::BoucWen;

use crate::description::Sample;
use crate::error::Error;
use crate::program::Builder;
use crate::program::expression::Real;

pub(super) fn step(_: &mut Builder, _: &str, _: &BoucWen, _: &Sample) -> Result<Real, Error> {
    Err(Error::NoDescription("bouc-wen"))
}

//! TODO

use hysid_core::law::neuro_madelung::NeuroMadelung;

use crate::description::Sample;
use crate::error::Error;
use crate::program::Builder;
use crate::program::expression::Real;

pub(super) fn step(_: &mut Builder, _: &str, _: &NeuroMadelung, _: &Sample) -> Result<Real, Error> {
    Err(Error::NoDescription("neuro-madelung"))
}

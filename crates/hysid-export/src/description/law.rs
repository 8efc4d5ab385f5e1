//! Classical laws, one a file. Each writes the operations of its law in `hysid_core::law`, in their order.

mod prandtl_ishlinskii;

use hysid_core::law::Classical;

use crate::description::Sample;
use crate::error::Error;
use crate::program::Builder;
use crate::program::expression::Real;

/// Writes a step of a law. The sample is in the user's units; the result is the output in its unit.
pub(super) fn step(builder: &mut Builder, name: &str, law: &Classical, sample: &Sample) -> Result<Real, Error> {
    match law {
        Classical::PrandtlIshlinskii(law) => Ok(prandtl_ishlinskii::step(builder, name, law, sample)),
        other => Err(Error::NoDescription(other.facts().name)),
    }
}

//! A step of a hysteretic state space model.

use hysid_core::law::hysteretic_state_space::HystereticStateSpace;

use crate::description::PartInputs;
use crate::description::law::hysteretic_dynamics;
use crate::program::Builder;
use crate::program::expression::Real;

pub fn step(builder: &mut Builder, name: &str, law: &HystereticStateSpace, sample: &PartInputs) -> Real {
    hysteretic_dynamics::step(builder, name, &law.0, sample)
}

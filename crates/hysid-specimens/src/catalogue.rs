//! The catalogue of specimens: those of the paper's examples.

use crate::specimen::Specimen;
use crate::{
    concrete, ferromagnet, magnetostrictive_actuator, piezo_actuator, rate_dependent_actuator,
    reinforced_concrete_joint, shape_memory_actuator, terfenol_actuator, terfenol_rod, two_wire_actuator,
};

/// All specimens, in the order of the paper's examples.
static ALL: [&Specimen; 12] = [
    &ferromagnet::SPECIMEN,
    &reinforced_concrete_joint::SPECIMEN,
    &reinforced_concrete_joint::CYCLES,
    &terfenol_actuator::SPECIMEN,
    &terfenol_rod::SPECIMEN,
    &shape_memory_actuator::SPECIMEN,
    &two_wire_actuator::SPECIMEN,
    &concrete::SPECIMEN,
    &piezo_actuator::SPECIMEN,
    &rate_dependent_actuator::SPECIMEN,
    &rate_dependent_actuator::TONES,
    &magnetostrictive_actuator::SPECIMEN,
];

impl Specimen {
    /// All specimens, in the order of the paper's examples.
    pub fn all() -> &'static [&'static Specimen] {
        &ALL
    }

    /// The specimen of this name; `None` if there is none.
    pub fn named(name: &str) -> Option<&'static Specimen> {
        ALL.into_iter().find(|specimen| specimen.name == name)
    }
}

//! The catalogue of specimens: those of the paper's examples, then further ones.

use crate::specimen::Specimen;
use crate::{
    bouc_wen_oscillator, concrete, duffing_oscillator, ferromagnet, magnetostrictive_actuator,
    piezo_actuator, piezo_stage, rate_dependent_actuator, reinforced_concrete_joint, shape_memory_actuator,
    shear_building, terfenol_actuator, terfenol_rod, two_wire_actuator,
};

const OF_THE_PAPER: usize = 12;

/// All specimens: those of the paper's examples, in their order, then the structures with inertia.
static ALL: [&Specimen; OF_THE_PAPER + 4] = [
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
    &bouc_wen_oscillator::SPECIMEN,
    &shear_building::SPECIMEN,
    &piezo_stage::SPECIMEN,
    &duffing_oscillator::SPECIMEN,
];

impl Specimen {
    /// All specimens: those [of the paper's examples](Specimen::of_the_paper), then further ones.
    pub fn all() -> &'static [&'static Specimen] {
        &ALL
    }

    /// The specimens that replace measured ones of the paper, in the order of its examples.
    pub fn of_the_paper() -> &'static [&'static Specimen] {
        &ALL[..OF_THE_PAPER]
    }

    /// The specimen of this name; `None` if there is none.
    pub fn named(name: &str) -> Option<&'static Specimen> {
        ALL.into_iter().find(|specimen| specimen.name == name)
    }
}

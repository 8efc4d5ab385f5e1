//! Synthetic specimens: materials and devices with hysteresis whose laws are known, as sources of records for
//! tests of identification.
//!
//! Each law and each set of parameters states its source: *published*, with a reference, or *designed*,
//! chosen in this project. [`Specimen::all`] is the catalogue.
//!
//! `theory.md (6.1)` on these pages is the number of an equation in `docs/theory.md` of the repository.

pub mod bouc_wen_oscillator;
mod catalogue;
pub mod concrete;
mod decimation;
mod draw;
pub mod duffing_oscillator;
mod earthquake;
pub mod ferromagnet;
pub mod generalized_play;
pub mod magnetostrictive_actuator;
mod multisine;
mod noise;
pub mod path;
pub mod piezo_actuator;
pub mod piezo_stage;
pub mod rate_dependent_actuator;
pub mod reinforced_concrete_joint;
mod runge_kutta;
pub mod shape_memory_actuator;
pub mod shear_building;
pub mod specimen;
pub mod terfenol_actuator;
pub mod terfenol_rod;
pub mod tones;
pub mod two_wire_actuator;

pub use bouc_wen_oscillator::BoucWenOscillator;
pub use concrete::{Concrete, ConcreteParameters};
pub use duffing_oscillator::DuffingOscillator;
pub use ferromagnet::{Everett, Ferromagnet};
pub use generalized_play::GeneralizedPlays;
pub use magnetostrictive_actuator::MagnetostrictiveActuator;
pub use noise::with_noise;
pub use piezo_actuator::PiezoActuator;
pub use piezo_stage::PiezoStage;
pub use rate_dependent_actuator::RateDependentActuator;
pub use reinforced_concrete_joint::{BoucWenBaberNoori, ReinforcedConcreteJoint};
pub use shear_building::ShearBuilding;
pub use specimen::Specimen;

//! Tests of the library as its users call it, in one program.

mod automatic;
mod checkpoint;
mod classical_linear;
mod classical_nonlinear;
mod data_doctor;
mod diagnosis;
mod duhem_nn;
mod dynamic_plays;
mod examples;
mod gradient;
mod hysteretic_dynamics;
mod initial_state;
mod intervals;
mod inverse;
mod long_records;
mod model_diagnosis;
mod model_file;
mod model_file_page;
mod network_family;
mod noisy_record;
mod offset;
mod operator_laws;
mod plan;
mod progress;
mod restoring_force;
mod rivals;
mod scaffold;
mod simulation;
mod small_models;
mod space_dilatation;
mod specimens;
mod stopping;
mod structural_laws;
mod tracking;
mod training;

/// The models of the tests of `hysid-export`.
#[path = "../../../hysid-export/tests/suite/models/mod.rs"]
mod models;

//! Terfenol-D rod under a magnetic bias: the strain is proportional to the square of a magnetisation that
//! follows the Preisach model. Unlike the [`terfenol_actuator`], which a generalized Prandtl-Ishlinskii model
//! can represent exactly, this specimen is outside that model, as a real rod is.
//!
//! ```text
//! H = 250 + 450 I,   J = Preisach[H],   y = 26 J²                          theory.md (6.28)
//! ```
//!
//! `I` is the current in A, `H` the field in A/m, `J` the polarisation in T, `y` the displacement in µm.
//!
//! *Published*: that the strain of such an actuator at low speed is proportional to the square of its
//! magnetisation, which a Preisach operator describes (Tan and Baras); the Everett function of
//! [`Ferromagnet::vacoflux17`]. *Designed*: its use for Terfenol-D, the bias, both factors.

use super::ferromagnet::Ferromagnet;
use super::specimen::{Specimen, SpecimenColumns};
use super::terfenol_actuator;

/// Field without current, in A/m.
const BIAS: f64 = 250.0;

/// Field of a current of 1 A, in A/m.
const COIL: f64 = 450.0;

/// Displacement for a squared polarisation of 1 T², in µm.
const STRAIN: f64 = 26.0;

/// The displacements in µm of a rod that was demagnetised before the bias was applied, at all currents
/// in A.
pub fn run(current: &[f64]) -> Vec<f64> {
    let mut rod = Ferromagnet::vacoflux17();
    let displacement = |&current: &f64| {
        rod.step(BIAS + COIL * current);
        STRAIN * rod.polarisation() * rod.polarisation()
    };
    current.iter().map(displacement).collect()
}

pub(super) static SPECIMEN: Specimen = Specimen {
    name: "terfenol-rod",
    example: Some("example 3"),
    summary: "magnetostrictive rod under a bias: the displacement goes with the square of a Preisach model",
    published: "the square of a Preisach model (Tan and Baras), the Everett function of Vacoflux 17 (Modelica Standard \
                Library), the range of the current (the paper)",
    designed: "that Everett function for Terfenol-D, the bias and both factors, the turning points",
    training: "as for terfenol-actuator",
    testing: "as for terfenol-actuator",
    columns: SpecimenColumns { time: Some("t_s"), input: "current_A", output: "displacement_um" },
    train: |_| Ok(vec![terfenol_actuator::PATH.records(run)?.0]),
    test: |_| Ok(vec![terfenol_actuator::PATH.records(run)?.1]),
};

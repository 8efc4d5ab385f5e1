//! Rotary actuator of two shape-memory wires that pull against each other: a positive current heats one wire,
//! a negative current the other. Unlike the [`shape_memory_actuator`], which a generalized Prandtl-Ishlinskii
//! model can represent exactly, this specimen is outside that model, as a real actuator is.
//!
//! ```text
//! H_a = 1000 max(I, 0) - 500,   H_b = 1000 max(-I, 0) - 500
//! y   = 40 c_a - 28 c_b,   c = (1 + J[H]/1.5)/2                            theory.md (6.29)
//! ```
//!
//! `I` is the current in A, `c` the contraction of a wire from 0 to 1, `y` the angle in degrees. A wire
//! contracts when hot, and stays contracted until it is much cooler: this is the loop of [`Ferromagnet`],
//! with the temperature instead of the field.
//!
//! *Published*: two wires against each other, heated by currents of either sign between -1 and 1 A (Gorbet,
//! as cited in the paper). *Designed*: the law of a wire, which takes the Everett function of
//! [`Ferromagnet::vacoflux17`], and all factors; one wire is weaker than the other, so that the loops are not
//! symmetric.
//!
//! [`shape_memory_actuator`]: super::shape_memory_actuator

use super::ferromagnet::Ferromagnet;
use super::path::Continued;
use super::specimen::{Specimen, SpecimenColumns};

/// Angles of the two wires, fully contracted, in degrees.
const PULL: [f64; 2] = [40.0, 28.0];

/// Field in the place of the temperature of a cold wire.
const COLD: f64 = -500.0;

/// How much a current of 1 A adds to it.
const HEATING: f64 = 1000.0;

/// Polarisation in T in the place of a wire fully contracted.
const CONTRACTED: f64 = 1.5;

/// The angles in degrees at all currents in A, both wires cold at first.
pub fn run(current: &[f64]) -> Vec<f64> {
    let mut wires = [Ferromagnet::vacoflux17(), Ferromagnet::vacoflux17()];
    for wire in &mut wires {
        wire.step(COLD);
    }
    let angle = |&current: &f64| {
        let mut pull = |index: usize, current: f64| {
            wires[index].step(COLD + HEATING * current.max(0.0));
            PULL[index] * 0.5 * (1.0 + wires[index].polarisation() / CONTRACTED)
        };
        pull(0, current) - pull(1, -current)
    };
    current.iter().map(angle).collect()
}

pub(super) static SPECIMEN: Specimen = Specimen {
    name: "two-wire-actuator",
    example: Some("example 4"),
    summary: "two shape-memory wires that pull against each other: a loop on either side, one weaker than the other",
    published: "two wires heated by currents of either sign between -1 and 1 A (Gorbet, as the paper tells)",
    designed: "the law of the wires, a borrowed Everett function, and all factors; the turning points of the current",
    training: "from -1 to 1 A, shrinking swings, then 40 pairs of turning points all over the range; 5 mA/s",
    testing: "the current goes on to other turning points in the same range; the training part comes first, with \
              blank outputs, so that the memory is carried over",
    columns: SpecimenColumns { time: Some("t_s"), input: "current_A", output: "angle_deg" },
    train: |_| Ok(vec![PATH.records(run)?.0]),
    test: |_| Ok(vec![PATH.records(run)?.1]),
};

/// The current in A.
const PATH: Continued = Continued {
    record: "heating and cooling",
    training: &[0.0, 1.0, -1.0, 1.0, -0.8, 0.8, -0.65, 0.65, -0.5, 0.5, 0.0],
    further: (40, (-1.0, 1.0)),
    test: &[
        0.9, 0.35, 0.7, -0.7, -0.3, -0.55, 0.95, 0.5, 0.6, -0.9, -0.4, -0.75, 0.45, 0.2, 0.85, -0.6, 0.55,
        -0.95, 0.75, 0.0,
    ],
    longest_step: 0.02,
    sampling: 4.0,
};

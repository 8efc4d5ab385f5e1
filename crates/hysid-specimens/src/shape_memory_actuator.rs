//! Shape-memory-alloy actuator of a morphing wing: the generalized Prandtl-Ishlinskii law that Basaeri
//! and co-workers identified on their measurements.
//!
//! ```text
//! γ_l = 0.8380 tanh(6.4364 v - 9.9631) + 0.5618
//! γ_r = 15.7940 tanh(2.7649 v - 5.6356) + 15.5400
//! y   = 17.72 + Σ_j p_j S_j,   r_j = 0.0395 j,   p_j = 10.9590 e^{-2.5785 r_j},   j = 0 ... 20
//! ```
//!
//! `v` is the voltage in V, 0 to 2.4; `y` is the output of their test stand, 17.7 to 132.2 in the
//! measurements, whose unit they do not state. The law is that of
//! [`generalized_play`](super::generalized_play), theory.md (6.13), (6.14) and (6.15). The plays begin
//! on `γ_r + r`, as in their program, and not virgin.
//!
//! *Published*: the law and all its values (`PI_11P.m` of Genetic-Algorithm-System-Identification,
//! Basaeri et al., Journal of Computational Applied Mechanics, 2019). Along the voltages of that file
//! the law differs from the measurements by 2.259 rms; the measurements themselves are not here, their
//! licence is not stated. *Designed*: our path of the voltage
//! and its speed.

use super::generalized_play::{Envelope, GeneralizedPlays, PlayStart};
use super::path::Continued;
use super::specimen::{Specimen, SpecimenColumns};

/// The actuator before its first sample: voltage in V to the published output, whose unit is not
/// stated. All values are published.
pub fn law() -> GeneralizedPlays {
    let envelopes = [
        Envelope::new([0.8380, 6.4364, -9.9631, 0.5618]),
        Envelope::new([15.7940, 2.7649, -5.6356, 15.5400]),
    ];
    let weights = GeneralizedPlays::exponential(21, 0.0395, 10.9590, 2.5785);
    GeneralizedPlays::new(envelopes, 0.0395, weights, 17.72, PlayStart::Lowered)
}

pub(super) static SPECIMEN: Specimen = Specimen {
    name: "shape-memory-actuator",
    example: Some("example 4"),
    summary: "shape-memory-alloy actuator of a morphing wing: steep, wide loops that saturate at both ends",
    published: "the generalized Prandtl-Ishlinskii law and all its values, identified on measurements (PI_11P.m, \
                Basaeri et al. 2019), and the range 0 to 2.4 V",
    designed: "the turning points of the voltage and its speed of 5 mV/s",
    training: "from 0 to 2.4, 2, 1.8, 1.7, 1.6 and 1.5 V and back each, then minor loops that start \
               inside, then 40 pairs of turning points all over the range",
    testing: "the voltage goes on to other peaks and other minor loops in the same range; the training part comes \
              first, with blank outputs, so that the memory is carried over",
    columns: SpecimenColumns { time: Some("t_s"), input: "voltage_V", output: "output" },
    train: |_| Ok(vec![PATH.records(|voltage| law().run(voltage))?.0]),
    test: |_| Ok(vec![PATH.records(|voltage| law().run(voltage))?.1]),
};

/// The voltage in V.
const PATH: Continued = Continued {
    record: "heating and cooling",
    training: &[
        0.0, 2.4, 0.0, 2.0, 0.0, 1.8, 0.0, 1.7, 0.0, 1.6, 0.0, 1.5, 0.0, 2.2, 1.0, 1.6, 0.8, 2.0, 0.0,
    ],
    further: (40, (0.0, 2.4)),
    test: &[1.9, 0.0, 1.75, 0.0, 1.65, 0.0, 1.55, 0.0, 2.3, 1.2, 1.5, 1.1, 1.8, 0.0],
    longest_step: 0.025,
    sampling: 5.0,
};

//! Terfenol-D actuator at low speed: a generalized Prandtl-Ishlinskii law that replaces the
//! paper's example 3, whose identified parameters are not published.
//!
//! ```text
//! γ_l = 4 tanh(1.35 v - 0.35),   γ_r = 4 tanh(1.25 v + 0.05) + 0.15
//! y   = 24 + Σ_j p_j S_j,   r_j = 0.25 j,   p_j = 2.4 e^{-0.55 r_j},   j = 0 ... 10
//! ```
//!
//! `v` is the current in A, `y` the displacement in µm; the law is that of
//! [`generalized_play`](super::generalized_play), theory.md (6.13), (6.14) and (6.15).
//!
//! *Published*: the law, and that triangular currents between -0.7 and 1.2 A drove the actuator.
//! *Designed*: all values, and the turning points of the current.

use super::generalized_play::{Envelope, GeneralizedPlays, PlayStart};
use super::path::Continued;
use super::specimen::{Specimen, SpecimenColumns};

/// The actuator, virgin: current in A to displacement in µm. All values are designed.
pub fn law() -> GeneralizedPlays {
    let envelopes = [Envelope::new([4.0, 1.35, -0.35, 0.0]), Envelope::new([4.0, 1.25, 0.05, 0.15])];
    let weights = GeneralizedPlays::exponential(11, 0.25, 2.4, 0.55);
    GeneralizedPlays::new(envelopes, 0.25, weights, 24.0, PlayStart::Virgin)
}

pub(super) static SPECIMEN: Specimen = Specimen {
    name: "terfenol-actuator",
    example: Some("example 3"),
    summary: "magnetostrictive actuator at low speed: saturating, asymmetric loops of current and displacement",
    published: "the generalized Prandtl-Ishlinskii law (Al Janaideh, Rakheja, Su) and the range of the current, -0.7 \
                to 1.2 A (the paper)",
    designed: "all values of the law, the turning points and the speed of the current",
    training: "triangles between -0.7 and 1.2 A, then shrinking ones, then 40 pairs of turning points all over the range; from \
               the virgin state, at 1.6 A/s",
    testing: "the current goes on to other turning points in the same range; the training part comes first, with \
              blank outputs, so that the memory is carried over",
    columns: SpecimenColumns { time: Some("t_s"), input: "current_A", output: "displacement_um" },
    train: |_| Ok(vec![PATH.records(|current| law().run(current))?.0]),
    test: |_| Ok(vec![PATH.records(|current| law().run(current))?.1]),
};

/// The current in A; the first seven swings have the paper's extremes.
pub(super) const PATH: Continued = Continued {
    record: "triangles",
    training: &[0.0, 1.2, -0.7, 1.2, -0.7, 1.2, -0.5, 1.0, -0.3, 0.8, -0.1, 0.6, 1.2],
    further: (40, (-0.7, 1.2)),
    test: &[-0.6, 0.9, -0.2, 0.5, -0.4, 1.1, 0.0, 0.7, 0.2, 1.0, -0.65, 0.3, -0.05, 1.15],
    longest_step: 0.016,
    sampling: 0.01,
};

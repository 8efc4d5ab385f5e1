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

use hysid_core::data::record::Record;
use hysid_core::error::Result;

use super::generalized_play::{Envelope, GeneralizedPlays, Start};
use super::path;
use super::specimen::{Columns, Specimen};

/// The actuator, virgin: current in A to displacement in µm. All values are designed.
pub fn law() -> GeneralizedPlays {
    let envelopes = [Envelope::new([4.0, 1.35, -0.35, 0.0]), Envelope::new([4.0, 1.25, 0.05, 0.15])];
    let weights = GeneralizedPlays::exponential(11, 0.25, 2.4, 0.55);
    GeneralizedPlays::new(envelopes, 0.25, weights, 24.0, Start::Virgin)
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
    columns: Columns { time: Some("t_s"), input: "current_A", output: "displacement_um" },
    train: |_| Ok(vec![parts()?.0]),
    test: |_| Ok(vec![parts()?.1]),
};

/// Turning points of the current in A to begin training with; the first seven swings have the paper's extremes.
const TRAIN: [f64; 13] = [0.0, 1.2, -0.7, 1.2, -0.7, 1.2, -0.5, 1.0, -0.3, 0.8, -0.1, 0.6, 1.2];

/// Turning points of training that follow, all over the paper's range in A.
const FURTHER: (usize, (f64, f64)) = (40, (-0.7, 1.2));

/// Turning points that follow.
const TEST: [f64; 14] = [-0.6, 0.9, -0.2, 0.5, -0.4, 1.1, 0.0, 0.7, 0.2, 1.0, -0.65, 0.3, -0.05, 1.15];

/// Largest step of the current between two rows, in A.
const STEP: f64 = 0.016;

/// Time between two rows in s.
const SAMPLING: f64 = 0.01;

fn parts() -> Result<(Record, Record)> {
    driven(|current| law().run(current))
}

/// The triangles of training and of the test, with the displacements of this law.
pub(super) fn driven(law: impl Fn(&[f64]) -> Vec<f64>) -> Result<(Record, Record)> {
    let (pairs, range) = FURTHER;
    let train = [&TRAIN[..], &path::covering(pairs, range)].concat();
    let (current, trained) = path::continued(&train, &TEST, STEP);
    let displacement = law(&current);
    let time = path::every(SAMPLING, current.len());
    let whole = Record::new("triangles", vec![current], displacement)?.with_time(time)?;
    Ok(path::cut(&whole, trained))
}

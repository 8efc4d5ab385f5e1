//! Magnetostrictive actuator from 10 to 300 Hz: hysteresis between a lag (eddy currents) and the resonance of
//! the moving mass.
//!
//! ```text
//! τ i' = I - i                                                             theory.md (6.20)
//! w    = Γ[i]
//! y'' + 2 ξ ω0 y' + ω0² y = ω0² w                                          theory.md (6.21)
//! ```
//!
//! `I` is the current in A, `i` the part of it that magnetises the rod, `w` the drive and `y` the
//! displacement in µm. `Γ` is the law of the [`terfenol_actuator`]. Both linear equations are solved exactly
//! for a current, and a `w`, that are linear between steps (theory.md (6.22), (6.23)).
//!
//! *Published*: that a hysteresis operator is coupled with the dynamics of the thin rod and of a mass on a
//! spring (Tan and Baras), and the current of 0.1 A ± 0.8 A at eight frequencies from 10 to 300 Hz (the
//! paper). *Designed*: our simple coupling instead of theirs, all values, and the frequencies; their
//! constants are not published.

use std::f64::consts::TAU;

use hysid_core::data::record::Record;
use hysid_core::elementary::{exp, sin, sin_cos};
use hysid_core::error::Result;

use super::generalized_play::GeneralizedPlays;
use super::specimen::{Specimen, SpecimenColumns};
use super::terfenol_actuator;

/// An actuator with its memory, initially at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct MagnetostrictiveActuator {
    /// `τ`: time constant of the lag in s.
    pub lag: f64,
    /// `ω0`: undamped angular resonance in rad/s.
    pub resonance: f64,
    /// `ξ`: damping ratio, 0 to below 1.
    pub damping: f64,
    hysteresis: GeneralizedPlays,
    current: f64,
    magnetising: f64,
    drive: f64,
    displacement: f64,
    velocity: f64,
}

impl MagnetostrictiveActuator {
    /// An actuator at rest under a steady current in A, with the lag in s, the resonance in rad/s and the
    /// damping ratio.
    pub fn at_rest(
        mut hysteresis: GeneralizedPlays,
        lag: f64,
        resonance: f64,
        damping: f64,
        current: f64,
    ) -> Self {
        hysteresis.reset();
        let drive = hysteresis.step(current);
        Self {
            lag,
            resonance,
            damping,
            hysteresis,
            current,
            magnetising: current,
            drive,
            displacement: drive,
            velocity: 0.0,
        }
    }

    /// The actuator of the catalogue, at rest under a current in A: a lag of 0.15 ms, a resonance at
    /// 1.5 kHz with damping 0.1. Designed.
    pub fn designed(current: f64) -> Self {
        Self::at_rest(terfenol_actuator::law(), 1.5e-4, TAU * 1500.0, 0.1, current)
    }

    /// The displacement in µm after `duration` seconds, in which the current changes linearly to `current` in
    /// A. The drive `w` is assumed to be linear as well, so steps must be short where it bends. A value that
    /// is not finite, or a duration that is not positive, gives NaN and leaves the memory unchanged.
    pub fn step(&mut self, current: f64, duration: f64) -> f64 {
        if !(current.is_finite() && duration.is_finite() && duration > 0.0) {
            return f64::NAN;
        }
        // (6.22): around the steady lag behind a ramp, deviations fade.
        let ramp = (current - self.current) / duration;
        let deviation = self.magnetising - (self.current - ramp * self.lag);
        self.magnetising = current - ramp * self.lag + deviation * exp(-duration / self.lag);
        self.current = current;

        // (6.23): around the steady lag behind a ramp, deviations swing and fade.
        let drive = self.hysteresis.step(self.magnetising);
        let ramp = (drive - self.drive) / duration;
        let behind = 2.0 * self.damping * ramp / self.resonance;
        let (d, v) = (self.displacement - (self.drive - behind), self.velocity - ramp);
        let decay = self.damping * self.resonance;
        let damped = self.resonance * (1.0 - self.damping * self.damping).sqrt();
        let (sine, cosine) = sin_cos(damped * duration);
        let fade = exp(-decay * duration);
        let swing = fade * (d * cosine + (v + decay * d) / damped * sine);
        self.velocity =
            ramp + fade * (v * cosine - (self.resonance * self.resonance * d + decay * v) / damped * sine);
        self.displacement = drive - behind + swing;
        self.drive = drive;
        self.displacement
    }
}

/// The displacements in µm at times in s, from rest at the first current, where the current in A is a straight line
/// between them.
pub fn run(time: &[f64], current: &[f64]) -> Vec<f64> {
    let Some(&first) = current.first() else { return Vec::new() };
    let mut actuator = MagnetostrictiveActuator::designed(first);
    let mut displacement = vec![actuator.displacement];
    for (times, currents) in time.windows(2).zip(current.windows(2)) {
        let row_time = times[1] - times[0];
        let steps = (row_time / LONGEST_STEP).ceil().max(1.0);
        for step in 1..=steps as usize {
            actuator.step(currents[0] + (currents[1] - currents[0]) * step as f64 / steps, row_time / steps);
        }
        displacement.push(actuator.displacement);
    }
    displacement
}

pub(super) static SPECIMEN: Specimen = Specimen {
    name: "magnetostrictive-actuator",
    example: Some("example 7"),
    summary: "magnetostrictive actuator from 10 to 300 Hz: hysteresis, a lag, and a resonance at 1.5 kHz",
    published: "that hysteresis is coupled with a lag and a resonance (Tan and Baras), and the current of 0.1 A ± 0.8 A \
                at eight frequencies from 10 to 300 Hz (the paper)",
    designed: "the coupling, all values, the eight frequencies and the two left out",
    training: "sines at 10, 25, 100, 150, 250 and 300 Hz, a record each: a period with blank outputs, then one that \
               counts",
    testing: "sines at 50 and 200 Hz, likewise",
    columns: SpecimenColumns { time: Some("t_s"), input: "current_A", output: "displacement_um" },
    train: |_| [10.0, 25.0, 100.0, 150.0, 250.0, 300.0].into_iter().map(sine).collect(),
    test: |_| [50.0, 200.0].into_iter().map(sine).collect(),
};

/// Mean of the current in A.
const BIAS: f64 = 0.1;

/// Amplitude of the current in A.
const AMPLITUDE: f64 = 0.8;

const ROWS: usize = 250;

/// Longest step of the simulation in s.
const LONGEST_STEP: f64 = 1e-5;

fn sine(frequency: f64) -> Result<Record> {
    let row_time = 1.0 / (frequency * ROWS as f64);
    let steps = (row_time / LONGEST_STEP).ceil().max(1.0);
    let current = |row: f64| BIAS + AMPLITUDE * sin(TAU * row / ROWS as f64);
    let mut actuator = MagnetostrictiveActuator::designed(BIAS);
    let mut displacement = vec![actuator.displacement];
    for row in 1..2 * ROWS {
        for step in 1..=steps as usize {
            actuator.step(current((row - 1) as f64 + step as f64 / steps), row_time / steps);
        }
        displacement.push(actuator.displacement);
    }
    displacement[..ROWS].fill(f64::NAN);
    let currents = (0..2 * ROWS).map(|row| current(row as f64)).collect();
    let time = (0..2 * ROWS).map(|row| row as f64 * row_time).collect();
    Record::new(format!("{frequency} Hz"), vec![currents], displacement)?.with_time(time)
}

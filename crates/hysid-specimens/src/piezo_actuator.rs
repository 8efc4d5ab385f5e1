//! Piezo actuator under sines of 0.5 to 300 Hz: an ellipse that shrinks and opens with frequency.
//!
//! ```text
//! u = 40 + 40 sin ωt,   y = 6 + Y sin(ωt - φ),   ω = 2πf                   theory.md (6.18)
//! Y = 6 (1 - 2e-4 f),   φ = 0.10 + 6e-4 f
//! ```
//!
//! `u` is the voltage in V, `y` the displacement in µm, `f` the frequency in Hz. The law is known for a
//! steady sine only.
//!
//! *Published*: the form of the law (Gu and Zhu). *Designed*: all values; theirs are not published. Designed too is the
//! response to other periodic voltages: that of the sum of its sines, each by itself ([`periodic_response`]).

use std::f64::consts::{PI, TAU};

use hysid_core::data::record::Record;
use hysid_core::elementary::{sin, sin_cos};
use hysid_core::error::Result;

use super::specimen::{Specimen, SpecimenColumns};

/// Mean and amplitude of the voltage in V.
const VOLTAGE: f64 = 40.0;

/// Mean displacement, and amplitude at frequency 0, in µm.
const DISPLACEMENT: f64 = 6.0;

/// The actuator under a steady sine of the voltage between 0 and 80 V.
///
/// ```
/// use hysid_specimens::PiezoActuator;
/// let actuator = PiezoActuator { frequency: 100.0 };
/// assert_eq!(actuator.voltage(0.0025), 80.0);
/// assert!(actuator.displacement(0.0025) < 6.0 + actuator.amplitude());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PiezoActuator {
    /// Frequency `f` in Hz, 0.5 to 300.
    pub frequency: f64,
}

impl PiezoActuator {
    /// The voltage in V at a time in s.
    pub fn voltage(&self, time: f64) -> f64 {
        VOLTAGE + VOLTAGE * sin(TAU * self.frequency * time)
    }

    /// The displacement in µm at a time in s: `6 + Y sin(ωt - φ)` (theory.md (6.18)).
    pub fn displacement(&self, time: f64) -> f64 {
        DISPLACEMENT + self.amplitude() * sin(TAU * self.frequency * time - self.lag())
    }

    /// Amplitude `Y` of the displacement in µm. Designed.
    pub fn amplitude(&self) -> f64 {
        DISPLACEMENT * (1.0 - 2e-4 * self.frequency)
    }

    /// Lag `φ` of the displacement in rad. Designed.
    pub fn lag(&self) -> f64 {
        0.10 + 6e-4 * self.frequency
    }

    /// Area of the loop of voltage and displacement in V µm: `π U Y sin φ`, with the amplitude `U` of the
    /// voltage (theory.md (6.19)).
    pub fn loop_area(&self) -> f64 {
        PI * VOLTAGE * self.amplitude() * sin(self.lag())
    }
}

/// The displacements in µm at equally spaced times of one period of a voltage in V; `period` is in s. Each sine of the
/// voltage has the response of theory.md (6.18), its amplitude and lag by themselves. Designed: the law is published for
/// one sine.
pub fn periodic_response(voltage: &[f64], period: f64) -> Vec<f64> {
    let rows = voltage.len();
    let turns: Vec<(f64, f64)> = (0..rows).map(|row| sin_cos(TAU * row as f64 / rows as f64)).collect();
    let mean = voltage.iter().sum::<f64>() / rows.max(1) as f64;
    let mut displacement = vec![DISPLACEMENT + (mean - VOLTAGE) * DISPLACEMENT / VOLTAGE; rows];
    for order in 1..=rows / 2 {
        let (mut sine, mut cosine) = (0.0, 0.0);
        for (row, voltage) in voltage.iter().enumerate() {
            let (s, c) = turns[order * row % rows];
            sine += voltage * s;
            cosine += voltage * c;
        }
        let share = if 2 * order == rows { 1.0 } else { 2.0 } / rows as f64;
        let actuator = PiezoActuator { frequency: order as f64 / period };
        let gain = share * actuator.amplitude().max(0.0) / VOLTAGE;
        let (lag_sine, lag_cosine) = sin_cos(actuator.lag());
        for (row, displacement) in displacement.iter_mut().enumerate() {
            let (s, c) = turns[order * row % rows];
            let lagging_sine = s * lag_cosine - c * lag_sine;
            let lagging_cosine = c * lag_cosine + s * lag_sine;
            *displacement += gain * (sine * lagging_sine + cosine * lagging_cosine);
        }
    }
    displacement
}

pub(super) static SPECIMEN: Specimen = Specimen {
    name: "piezo-actuator",
    example: Some("example 6"),
    summary: "piezo actuator from 0.5 to 300 Hz: elliptic loops that shrink and open with frequency",
    published: "the elliptic law (Gu and Zhu), and that 50 and 200 Hz are not trained on (the paper)",
    designed: "all values, and the frequencies to train on",
    training: "sines of 0.5, 1, 5, 10, 25, 75, 100, 150, 250 and 300 Hz, a record each: a period with blank outputs, \
               then one that counts",
    testing: "sines of 50 and 200 Hz, likewise",
    columns: SpecimenColumns { time: Some("t_s"), input: "voltage_V", output: "displacement_um" },
    train: |_| [0.5, 1.0, 5.0, 10.0, 25.0, 75.0, 100.0, 150.0, 250.0, 300.0].into_iter().map(sine).collect(),
    test: |_| [50.0, 200.0].into_iter().map(sine).collect(),
};

const ROWS: usize = 160;

fn sine(frequency: f64) -> Result<Record> {
    let actuator = PiezoActuator { frequency };
    let time: Vec<f64> = (0..2 * ROWS).map(|row| row as f64 / (frequency * ROWS as f64)).collect();
    let voltage = time.iter().map(|&t| actuator.voltage(t)).collect();
    let mut displacement: Vec<f64> = time.iter().map(|&t| actuator.displacement(t)).collect();
    displacement[..ROWS].fill(f64::NAN);
    Record::new(format!("{frequency} Hz"), vec![voltage], displacement)?.with_time(time)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_response_to_a_sine_is_the_law() {
        let actuator = PiezoActuator { frequency: 50.0 };
        let time: Vec<f64> = (0..200).map(|row| 0.04 * f64::from(row) / 200.0).collect();
        let voltage: Vec<f64> = time.iter().map(|&t| actuator.voltage(t)).collect();
        for (found, &t) in periodic_response(&voltage, 0.04).iter().zip(&time) {
            assert!((found - actuator.displacement(t)).abs() < 1e-10);
        }
    }
}

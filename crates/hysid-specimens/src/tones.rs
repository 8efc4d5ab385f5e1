//! Sums of sines: inputs of rate-dependent specimens, with their exact rate.

use std::f64::consts::TAU;

use hysid_core::elementary::{cos, sin};

/// A sine `amplitude sin(2π frequency t + phase)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    /// Amplitude, in the unit of the input.
    pub amplitude: f64,
    /// Frequency, in Hz.
    pub frequency: f64,
    /// Phase at time 0, in rad.
    pub phase: f64,
}

impl Tone {
    /// A sine that rises through 0 at time 0.
    pub fn sine(amplitude: f64, frequency: f64) -> Self {
        Self { amplitude, frequency, phase: 0.0 }
    }

    fn angle(&self, t: f64) -> f64 {
        TAU * self.frequency * t + self.phase
    }
}

/// The sum of the tones at a time in s.
pub fn value(tones: &[Tone], t: f64) -> f64 {
    tones.iter().map(|tone| tone.amplitude * sin(tone.angle(t))).sum()
}

/// Its rate per s.
pub fn rate(tones: &[Tone], t: f64) -> f64 {
    tones.iter().map(|tone| TAU * tone.frequency * tone.amplitude * cos(tone.angle(t))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_the_derivative() {
        let tones = [Tone { amplitude: 2.0, frequency: 0.3, phase: 1.0 }, Tone::sine(0.7, 1.1)];
        for k in 0..50 {
            let t = 0.1 * f64::from(k);
            let difference = (value(&tones, t + 1e-6) - value(&tones, t - 1e-6)) / 2e-6;
            assert!((rate(&tones, t) - difference).abs() < 1e-7);
        }
    }
}

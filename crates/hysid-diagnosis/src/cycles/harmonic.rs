//! First harmonic of a cycle.
//!
//! ```text
//! c = 2/T ∫ v e^(-iωt) dt,    ω = 2π/T                     by the trapezoidal rule over the rows
//! E' + i E'' = c_y / c_x                                   storage and loss modulus (ASTM D4092)
//! ```

use std::f64::consts::TAU;

use hysid_core::elementary::{atan2, cos, hypot, sin, square};

/// Largest RMS difference of an input and its first harmonic, as a share of the RMS of the harmonic, for which the input is a
/// sine.
const SINE: f64 = 0.05;

/// Fewest rows of a cycle.
const FEWEST: usize = 8;

/// Complex modulus of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ComplexModulus {
    pub storage: f64,
    pub loss: f64,
}

impl ComplexModulus {
    /// Loss angle in degrees.
    pub fn angle(&self) -> f64 {
        atan2(self.loss, self.storage).to_degrees()
    }

    /// The modulus of one cycle, whose times span its period; `None` for an input that is no sine.
    pub fn of(time: &[f64], x: &[f64], y: &[f64]) -> Option<Self> {
        let (input, output) = (Harmonic::of(time, x)?, Harmonic::of(time, y)?);
        if !is_sine(time, x) {
            return None;
        }
        let size = square(input.cosine) + square(input.sine);
        let modulus = Self {
            storage: (output.cosine * input.cosine + output.sine * input.sine) / size,
            loss: (output.cosine * input.sine - output.sine * input.cosine) / size,
        };
        (modulus.storage.is_finite() && modulus.loss.is_finite()).then_some(modulus)
    }
}

/// True if the values of one period are nearly a sine.
pub(super) fn is_sine(time: &[f64], values: &[f64]) -> bool {
    Harmonic::of(time, values).is_some_and(|harmonic| harmonic.distance(time, values) <= SINE)
}

/// `mean + cosine cos ωt + sine sin ωt`.
#[derive(Debug, Clone, Copy)]
struct Harmonic {
    mean: f64,
    cosine: f64,
    sine: f64,
}

impl Harmonic {
    fn of(time: &[f64], values: &[f64]) -> Option<Self> {
        let period = time.last()? - time.first()?;
        if time.len() < FEWEST || period <= 0.0 {
            return None;
        }
        let mean = |of: &dyn Fn(usize) -> f64| {
            let step = |k: usize| 0.5 * (of(k) + of(k + 1)) * (time[k + 1] - time[k]);
            (0..time.len() - 1).map(step).sum::<f64>() / period
        };
        let angle = |k: usize| TAU * (time[k] - time[0]) / period;
        Some(Self {
            mean: mean(&|k| values[k]),
            cosine: 2.0 * mean(&|k| values[k] * cos(angle(k))),
            sine: 2.0 * mean(&|k| values[k] * sin(angle(k))),
        })
    }

    /// RMS difference of the values and the harmonic, as a share of the RMS of the harmonic.
    fn distance(&self, time: &[f64], values: &[f64]) -> f64 {
        let period = time[time.len() - 1] - time[0];
        let rest = |(t, value): (&f64, &f64)| {
            let angle = TAU * (t - time[0]) / period;
            square(value - self.mean - self.cosine * cos(angle) - self.sine * sin(angle))
        };
        let squares: f64 = time.iter().zip(values).map(rest).sum();
        (2.0 * squares / time.len() as f64).sqrt() / hypot(self.cosine, self.sine)
    }
}

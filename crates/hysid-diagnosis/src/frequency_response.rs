//! Frequency responses: of measured input and output, of a linear oscillator, and of a model at several amplitudes.
//! theory.md (10.46) to (10.49).
//!
//! The response of measured data is the linear system that explains most of the output for this very input (the best linear
//! approximation). If the input repeats itself, whole periods after the first are transformed, without a window and without
//! leakage; otherwise overlapping segments with a Hann window (Welch's method). A simulated output is transformed over the
//! same rows in the same way, so that both can be compared.
//!
//! ```
//! use hysid_diagnosis::frequency_response::{Segments, resolution};
//! use hysid_diagnosis::resonance::Resonance;
//! use hysid_specimens::Specimen;
//! let data = Specimen::named("duffing-oscillator").unwrap().train();
//! let oscillator = Resonance::of(&data).unwrap().oscillator;
//! let resolution = resolution(&oscillator);
//! let response = Segments::of(&data, Some(resolution))?.measured(&data, resolution);
//! let peak = response.peak(oscillator.compared).unwrap();
//! assert!((55.0..85.0).contains(&peak.frequency)); // Hz
//! # Ok::<(), hysid_diagnosis::frequency_response::NoResponse>(())
//! ```

mod of_model;
mod period;
mod segments;
mod spectra;
mod stretches;

use std::fmt;

pub use of_model::{AtAmplitude, ModelResponses};
pub use segments::{Segments, resolution};
pub use spectra::Window;

use hysid_core::elementary::{atan2, hypot};

use crate::resonance::{ComparedSignal, LinearOscillator};

/// The response at a frequency: output per unit of input, a complex number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResponsePoint {
    /// Cycles per unit of time.
    pub frequency: f64,
    /// Real part, in the unit of the output divided by that of the input.
    pub real: f64,
    /// Imaginary part, in the same unit.
    pub imaginary: f64,
    /// Share of the power of the output that the response explains, between 0 and 1; at a single line of a periodic input,
    /// what noise leaves of it. `None` where a single transform gave the response, which explains all.
    pub coherence: Option<f64>,
}

impl ResponsePoint {
    /// In the unit of the output divided by that of the input.
    pub fn magnitude(&self) -> f64 {
        hypot(self.real, self.imaginary)
    }

    /// In degrees, from -180 to 180; negative where the output lags behind the input.
    pub fn phase(&self) -> f64 {
        atan2(self.imaginary, self.real).to_degrees()
    }
}

/// A frequency response: complex ratio of output to input over frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyResponse {
    /// Its points, by rising frequency: only those at which the input has power.
    pub points: Vec<ResponsePoint>,
}

impl FrequencyResponse {
    /// The response of an oscillator at these frequencies, theory.md (10.48).
    pub fn of_oscillator(oscillator: &LinearOscillator, frequencies: impl Iterator<Item = f64>) -> Self {
        let point = |frequency: f64| {
            // K / (1 - q² + 2 ζ q i), q = f/f0.
            let share = frequency / oscillator.natural_frequency;
            let (stiff, viscous) = (1.0 - share * share, 2.0 * oscillator.damping_ratio * share);
            let square = stiff * stiff + viscous * viscous;
            ResponsePoint {
                frequency,
                real: oscillator.direct + oscillator.gain * stiff / square,
                imaginary: -oscillator.gain * viscous / square,
                coherence: None,
            }
        };
        Self { points: frequencies.map(point).collect() }
    }

    /// The point where the response of the output, or that of its changes, has its largest magnitude; `None` if it is the
    /// first or the last one, which is no peak.
    ///
    /// The response of the changes is that of the output times a factor in proportion to the frequency, as long as this is
    /// far below half the sampling rate. It shows the resonance of a structure whose output drifts.
    pub fn peak(&self, compared: ComparedSignal) -> Option<ResponsePoint> {
        self.peak_index(compared).map(|peak| self.points[peak])
    }

    /// Uncertainty of the frequency of the peak: its mean distance from the frequencies of the points beside it.
    pub fn peak_resolution(&self, compared: ComparedSignal) -> Option<f64> {
        let peak = self.peak_index(compared)?;
        Some(0.5 * (self.points[peak + 1].frequency - self.points[peak - 1].frequency))
    }

    fn peak_index(&self, compared: ComparedSignal) -> Option<usize> {
        let magnitude = |point: &ResponsePoint| match compared {
            ComparedSignal::Output => point.magnitude(),
            ComparedSignal::Changes => point.frequency * point.magnitude(),
        };
        let magnitudes = self.points.iter().map(magnitude).enumerate();
        let (largest, _) = magnitudes.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (largest > 0 && largest + 1 < self.points.len()).then_some(largest)
    }

    /// Phases in degrees at the points, continuous where the response of an oscillator turns by 180 degrees: those within
    /// 180 degrees of its phase; without one, within 180 degrees of the phase at the point before.
    pub fn phases(&self, oscillator: Option<&LinearOscillator>) -> Vec<f64> {
        let mut before = 0.0;
        let phase = |point: &ResponsePoint| {
            let near = oscillator.map_or(before, |oscillator| motion_phase(oscillator, point.frequency));
            let phase = point.phase();
            before = phase + 360.0 * ((near - phase) / 360.0).round();
            before
        };
        self.points.iter().map(phase).collect()
    }
}

/// Phase in degrees of an oscillator without its direct part: from 0 to -180, or from 180 to 0 for a negative gain.
fn motion_phase(oscillator: &LinearOscillator, frequency: f64) -> f64 {
    let share = frequency / oscillator.natural_frequency;
    let lag = atan2(2.0 * oscillator.damping_ratio * share, 1.0 - share * share);
    let first = if oscillator.gain < 0.0 { 180.0 } else { 0.0 };
    first - lag.to_degrees()
}

/// Why data have no frequency response.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoResponse {
    /// The data have more than one input.
    SeveralInputs,
    /// The data have no time stamps.
    NoTime,
    /// The time stamps of this record are not evenly spaced.
    UnevenTime(String),
    /// The time step of this record differs from that of the first.
    OtherStep(String),
    /// The records are too short, or too many of their rows have no output.
    TooFewRows,
    /// The input, or the output, is constant.
    Constant,
}

impl fmt::Display for NoResponse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SeveralInputs => f.write_str("the data have more than one input"),
            Self::NoTime => f.write_str("the data have no time stamps"),
            Self::UnevenTime(record) => {
                write!(
                    f,
                    "the time stamps of record \"{record}\" are not evenly spaced to 1/1000 of a step; resample it"
                )
            }
            Self::OtherStep(record) => {
                write!(f, "the time step of record \"{record}\" differs from that of the first; resample it")
            }
            Self::TooFewRows => f.write_str("there are too few contiguous rows with an output"),
            Self::Constant => f.write_str("the input or the output is constant"),
        }
    }
}

impl std::error::Error for NoResponse {}

#[cfg(test)]
mod tests;

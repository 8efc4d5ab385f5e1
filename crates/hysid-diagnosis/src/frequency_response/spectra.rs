//! Sums of spectra over segments, theory.md (10.47).

use std::f64::consts::TAU;
use std::sync::Arc;

use hysid_core::elementary::cos;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

/// How the rows of a segment are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Window {
    /// All alike: a segment is a period of the input.
    WholePeriods,
    /// Hann's window; segments overlap by half.
    Hann,
}

/// Power of input and output and their product at the multiples of `1/length`, each a sum over the segments so far.
/// The constant and the highest frequency are left out.
pub(super) struct Spectra {
    transform: Arc<dyn Fft<f64>>,
    window: Vec<f64>,
    segment: Vec<Complex<f64>>,
    space: Vec<Complex<f64>>,
    /// Sums from the multiple 1 on.
    pub lines: Vec<SpectralLine>,
}

/// Sums at a frequency.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SpectralLine {
    /// `Σ |U|²`
    pub input: f64,
    /// `Σ |Y|²`
    pub output: f64,
    /// `Σ Y U*`
    pub product: Complex<f64>,
}

impl SpectralLine {
    pub fn add(&mut self, other: &Self) {
        self.input += other.input;
        self.output += other.output;
        self.product += other.product;
    }
}

impl Spectra {
    /// Without segments yet, which will have so many rows.
    pub fn empty(length: usize, window: Window) -> Self {
        let transform = FftPlanner::new().plan_fft_forward(length);
        let weight = |row: usize| match window {
            Window::WholePeriods => 1.0,
            Window::Hann => 0.5 - 0.5 * cos(TAU * row as f64 / length as f64),
        };
        Self {
            segment: Vec::with_capacity(length),
            space: vec![Complex::default(); transform.get_inplace_scratch_len()],
            window: (0..length).map(weight).collect(),
            lines: vec![SpectralLine::default(); length.div_ceil(2).saturating_sub(1)],
            transform,
        }
    }

    /// Adds a segment. Its input and its output are divided by these scales, which should be near their sizes: one
    /// transform of `u + i y` gives the spectra of both, and the rounding of the larger would be in that of the smaller.
    pub fn add(&mut self, input: &[f64], output: &[f64], scales: [f64; 2]) {
        let [middle, level] = [input, output].map(mean);
        let scaled = input.iter().zip(output).zip(&self.window).map(|((u, y), weight)| {
            Complex::new(weight * (u - middle) / scales[0], weight * (y - level) / scales[1])
        });
        self.segment.clear();
        self.segment.extend(scaled);
        self.transform.process_with_scratch(&mut self.segment, &mut self.space);
        let backwards = self.segment[1..].iter().rev();
        for ((line, z), mirrored) in self.lines.iter_mut().zip(&self.segment[1..]).zip(backwards) {
            let mirrored = mirrored.conj();
            let u = 0.5 * (z + mirrored);
            let y = Complex::new(0.0, -0.5) * (z - mirrored);
            line.add(&SpectralLine { input: u.norm_sqr(), output: y.norm_sqr(), product: y * u.conj() });
        }
    }
}

/// Divided before it is summed, so that large values do not overflow.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().map(|value| value / values.len() as f64).sum()
}

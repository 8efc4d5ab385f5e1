//! Random-phase multisines: periodic excitations with the same amplitude on all lines of a band.
//!
//! ```text
//! u(t) = A Σ_k cos(2π k t/T + φ_k),   A = rms √(2/K)
//! ```
//!
//! `T` is the period, `k` runs over the `K` lines of the band, and every phase `φ_k` is drawn evenly from `0 ... 2π`.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use hysid_core::elementary::sin_cos;

use super::draw::Draw;

#[derive(Debug, Clone)]
pub(super) struct Multisine {
    rows: usize,
    lines: RangeInclusive<usize>,
    phases: Vec<f64>,
    amplitude: f64,
}

impl Multisine {
    /// A multisine with a period of `rows` rows, a power of 2, on lines above 0 and below half of `rows`. `rms` is in the
    /// unit of the signal.
    pub fn new(draw: &mut Draw, rows: usize, lines: RangeInclusive<usize>, rms: f64) -> Self {
        let phases: Vec<f64> = lines.clone().map(|_| draw.between(0.0, TAU)).collect();
        let amplitude = rms * (2.0 / phases.len() as f64).sqrt();
        Self { rows, lines, phases, amplitude }
    }

    /// One period with `per_row` equally spaced values a row, the first at the row.
    pub fn period(&self, per_row: usize) -> Vec<f64> {
        let mut period = vec![0.0; self.rows * per_row];
        for part in 0..per_row {
            let rows = self.at_rows(part as f64 / (per_row * self.rows) as f64);
            period.iter_mut().skip(part).step_by(per_row).zip(rows).for_each(|(value, row)| *value = row);
        }
        period
    }

    /// The values at all rows, each later by a share of the period.
    fn at_rows(&self, later: f64) -> impl Iterator<Item = f64> {
        let mut spectrum = vec![(0.0, 0.0); self.rows];
        for (line, phase) in self.lines.clone().zip(&self.phases) {
            let (sin, cos) = sin_cos(phase + TAU * line as f64 * later);
            spectrum[line] = (self.amplitude * cos, self.amplitude * sin);
        }
        inverse_fourier_sum(spectrum).into_iter().map(|(real, _)| real)
    }
}

/// `x_n = Σ_k X_k e^{2πi kn/N}` for complex numbers `(real, imaginary)`; `N` is a power of 2. Halves of even and odd `k`
/// are summed by themselves (Cooley and Tukey).
fn inverse_fourier_sum(spectrum: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let count = spectrum.len();
    if count == 1 {
        return spectrum;
    }
    let half = |first: usize| inverse_fourier_sum(spectrum.iter().skip(first).step_by(2).copied().collect());
    let (even, odd) = (half(0), half(1));
    let turned = |(n, (re, im)): (usize, &(f64, f64))| {
        let (sin, cos) = sin_cos(TAU * n as f64 / count as f64);
        (re * cos - im * sin, re * sin + im * cos)
    };
    let odd: Vec<_> = odd.iter().enumerate().map(turned).collect();
    let sum = even.iter().zip(&odd).map(|(a, b)| (a.0 + b.0, a.1 + b.1));
    let difference = even.iter().zip(&odd).map(|(a, b)| (a.0 - b.0, a.1 - b.1));
    sum.chain(difference).collect()
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::cos;

    use super::*;

    #[test]
    fn a_multisine_is_the_sum_of_its_sines() {
        let multisine = Multisine::new(&mut Draw::new(3, 0), 64, 5..=12, 2.0);
        let period = multisine.period(3);
        assert_eq!(period.len(), 192);
        for (n, value) in period.iter().enumerate() {
            let t = n as f64 / 192.0;
            let sines = (5..=12).zip(&multisine.phases).map(|(k, phase)| cos(TAU * f64::from(k) * t + phase));
            let expected = multisine.amplitude * sines.sum::<f64>();
            assert!((value - expected).abs() < 1e-12, "{n}: {value} {expected}");
        }
        let rms = (period.iter().map(|u| u * u).sum::<f64>() / 192.0).sqrt();
        assert!((rms - 2.0).abs() < 1e-12, "{rms}");
    }
}

//! The period of an input that repeats itself.
//!
//! With `E` the energy of rows and `r` the autocorrelation, the mean square difference between rows a lag `p` apart is
//!
//! ```text
//! D(p) = (E(0 … n-p) + E(p … n) - 2 r(p))/(n - p)                           theory.md (10.46)
//! ```
//!
//! A Fourier transform gives it for all lags at a cost of `n log n`, whatever the input.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// Periods may differ by this share of the standard deviation of the input (root mean square).
const LARGEST_DIFFERENCE: f64 = 1e-3;

/// A lag below which rows are still alike is no period: first `D` must exceed this share of the variance.
const UNLIKE: f64 = 0.2;

/// The shortest period that occurs at least twice, in rows.
pub(super) fn period(input: &[f64]) -> Option<usize> {
    let rows = input.len();
    let mean = input.iter().map(|x| x / rows as f64).sum::<f64>();
    let scale = input.iter().map(|x| (x - mean).abs()).fold(0.0, f64::max);
    if !scale.is_normal() {
        return None;
    }
    let centred: Vec<f64> = input.iter().map(|x| (x - mean) / scale).collect();
    let difference = differences(&centred);
    let variance = centred.iter().map(|x| x * x).sum::<f64>() / rows as f64;
    let unlike = (1..=rows / 2).find(|&lag| difference(lag) > UNLIKE * variance)?;
    let limit = LARGEST_DIFFERENCE * LARGEST_DIFFERENCE * variance;
    let mut lag = (unlike..=rows / 2).find(|&lag| difference(lag) <= limit)?;
    while lag < rows / 2 && difference(lag + 1) < difference(lag) {
        lag += 1;
    }
    Some(lag)
}

/// Mean square differences between values a lag apart, as a function of the lag.
fn differences(values: &[f64]) -> impl Fn(usize) -> f64 {
    let rows = values.len();
    let correlation = autocorrelation(values);
    let mut energy = Vec::with_capacity(rows + 1);
    energy.push(0.0);
    for value in values {
        energy.push(energy[energy.len() - 1] + value * value);
    }
    move |lag| {
        let sum = energy[rows - lag] + energy[rows] - energy[lag] - 2.0 * correlation[lag];
        sum / (rows - lag) as f64
    }
}

/// Sums of products of values a lag apart, for all lags.
fn autocorrelation(values: &[f64]) -> Vec<f64> {
    // Zeros behind the values keep their end apart from their beginning.
    let length = (2 * values.len()).next_power_of_two();
    let mut spectrum: Vec<Complex<f64>> = values.iter().map(|&value| Complex::new(value, 0.0)).collect();
    spectrum.resize(length, Complex::default());
    let mut planner = FftPlanner::new();
    planner.plan_fft_forward(length).process(&mut spectrum);
    spectrum.iter_mut().for_each(|value| *value = Complex::new(value.norm_sqr() / length as f64, 0.0));
    planner.plan_fft_inverse(length).process(&mut spectrum);
    spectrum[..values.len()].iter().map(|value| value.re).collect()
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{cos, sin};

    use super::*;

    /// A slow sine with faster ones on it, repeated; `moved` rows are added to the period for the sines.
    fn repeated(period: usize, rows: usize) -> Vec<f64> {
        let phase = |k: usize| std::f64::consts::TAU * (k % period) as f64 / period as f64;
        (0..rows).map(|k| sin(phase(k)) + 0.3 * cos(7.0 * phase(k)) + 40.0).collect()
    }

    #[test]
    fn periods_are_found_to_a_row() {
        for (period_rows, rows) in [(97, 194), (1000, 5300), (256, 4096)] {
            assert_eq!(period(&repeated(period_rows, rows)), Some(period_rows));
        }
        assert_eq!(period(&repeated(1000, 1999)), None, "less than two periods");
    }

    #[test]
    fn what_changes_or_does_not_move_has_no_period() {
        let sweep: Vec<f64> = (0..4000).map(|k| sin(1e-5 * f64::from(k) * f64::from(k))).collect();
        assert_eq!(period(&sweep), None);
        let pulse: Vec<f64> =
            (0..4000).map(|k| if k < 300 { sin(0.1 * f64::from(k)) } else { 0.0 }).collect();
        assert_eq!(period(&pulse), None);
        assert_eq!(period(&[3.0; 500]), None);
        assert_eq!(period(&[]), None);
        assert_eq!(period(&[1.0]), None);
        let growing: Vec<f64> = repeated(100, 1000)
            .iter()
            .enumerate()
            .map(|(k, x)| (x - 40.0) * (1.0 + 1e-4 * k as f64))
            .collect();
        assert_eq!(period(&growing), None, "each period is 1 % larger");
    }
}

//! Low-pass and decimation without phase, as `decimate(x, r, 'fir')` of MATLAB with its default order does it.
//!
//! ```text
//! b_k = w_k sin(π (k - 15)/r)/(π (k - 15)),   k = 0 ... 30,   Σ b_k = 1
//! w_k = 0.54 - 0.46 cos(2π k/30)
//! y_j = Σ_k b_k x_{jr + k - 15}
//! ```
//!
//! The coefficients `b` are those of `fir1(30, 1/r)`: a window design with the window `w` of Hamming and the gain 1 at
//! frequency 0. Beyond its ends the signal is continued by its rotation about the end, `2 x_0 - x_{-i}`.

use std::f64::consts::{PI, TAU};

use hysid_core::elementary::{cos, sin};

/// Order of the filter, an even number.
const ORDER: usize = 30;

/// Coefficients of the filter whose cut-off is the Nyquist frequency of the decimated signal.
fn low_pass(factor: usize) -> [f64; ORDER + 1] {
    let coefficient = |k: usize| {
        let place = k as f64 - 0.5 * ORDER as f64;
        let angle = PI * place / factor as f64;
        let sinc = if place == 0.0 { 1.0 } else { sin(angle) / angle };
        sinc * (0.54 - 0.46 * cos(TAU * k as f64 / ORDER as f64))
    };
    let coefficients: [f64; ORDER + 1] = std::array::from_fn(coefficient);
    let gain: f64 = coefficients.iter().sum();
    coefficients.map(|coefficient| coefficient / gain)
}

/// Every `factor`-th value of the low-passed signal, the first at the first value. The signal has more than 15 values.
pub(super) fn decimate(signal: &[f64], factor: usize) -> Vec<f64> {
    let coefficients = low_pass(factor);
    let last = signal.len() - 1;
    let continued = |place: isize| match usize::try_from(place) {
        Err(_) => 2.0 * signal[0] - signal[place.unsigned_abs()],
        Ok(place) if place > last => 2.0 * signal[last] - signal[2 * last - place],
        Ok(place) => signal[place],
    };
    let filtered = |centre: usize| -> f64 {
        let first = centre as isize - (ORDER / 2) as isize;
        (first..).zip(coefficients).map(|(place, coefficient)| coefficient * continued(place)).sum()
    };
    (0..signal.len()).step_by(factor).map(filtered).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line has no curvature at its ends, and a filter of gain 1 without phase leaves it unchanged.
    #[test]
    fn a_line_keeps_its_values_up_to_both_ends() {
        let line: Vec<f64> = (0..101).map(|k| 3.0 - 0.25 * f64::from(k)).collect();
        for factor in [2, 5] {
            let decimated = decimate(&line, factor);
            assert_eq!(decimated.len(), 100 / factor + 1);
            for (y, x) in decimated.iter().zip(line.iter().step_by(factor)) {
                assert!((y - x).abs() < 1e-12, "{y} {x}");
            }
        }
    }

    /// A cosine in the middle of the signal is multiplied by `b_15 + 2 Σ_i b_{15+i} cos(iω)`.
    #[test]
    fn a_cosine_keeps_its_phase() {
        for (factor, omega) in [(2, 0.3), (2, 2.5), (5, 0.5), (5, 1.5)] {
            let b = low_pass(factor);
            let gain = b[15] + 2.0 * (1..=15).map(|i| b[15 + i] * cos(omega * i as f64)).sum::<f64>();
            let signal: Vec<f64> = (0..200).map(|k| cos(omega * f64::from(k))).collect();
            let decimated = decimate(&signal, factor);
            for row in 15 / factor + 1..(200 - 16) / factor {
                let expected = gain * signal[row * factor];
                assert!((decimated[row] - expected).abs() < 1e-13, "{factor} {omega} {row}");
            }
        }
    }
}

//! The rounded triangle, and the sums of sines that it is one of.

use std::f64::consts::TAU;

use hysid_core::elementary::sin;

pub(super) use hysid::specimens::tones::{Tone, rate, value};

/// A triangle whose corners are round: the first three terms of its series, scaled to the amplitude.
pub(super) fn rounded_triangle(amplitude: f64, frequency: f64) -> Vec<Tone> {
    let shares = [(1.0, 1.0), (3.0, -1.0 / 9.0), (5.0, 1.0 / 25.0)];
    let peak: f64 = shares.iter().map(|(order, share)| share * sin(0.25 * TAU * order)).sum();
    shares.map(|(order, share)| Tone::sine(amplitude * share / peak, order * frequency)).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_reaches_its_amplitude_and_no_more() {
        let tones = rounded_triangle(3.0, 0.5);
        let largest = (0..=4000).map(|k| value(&tones, 0.0005 * f64::from(k))).fold(0.0, f64::max);
        assert!((largest - 3.0).abs() < 1e-12, "{largest}");
        assert!((value(&tones, 0.5) - 3.0).abs() < 1e-12);
    }
}

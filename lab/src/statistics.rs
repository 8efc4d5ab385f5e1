//! Means of errors over specimens and seeds, and how they are shown.

use hysid_core::elementary::{exp, ln};

/// The geometric mean.
pub fn geometric_mean(values: &[f64]) -> f64 {
    exp(values.iter().map(|value| ln(*value)).sum::<f64>() / values.len() as f64)
}

/// The median; the mean of the middle two of an even number.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    if sorted.len() % 2 == 1 { sorted[middle] } else { 0.5 * (sorted[middle - 1] + sorted[middle]) }
}

/// The largest value.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// Two significant digits, at least one decimal: `0.034`, `0.34`, `3.4`, `34.2`.
pub fn shown(value: f64) -> String {
    let decimals = if value.abs() < 0.0995 {
        3
    } else if value.abs() < 0.995 {
        2
    } else {
        1
    };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_those_of_their_definitions() {
        assert!((geometric_mean(&[1.0, 4.0, 16.0]) - 4.0).abs() < 1e-12);
        assert_eq!((median(&[3.0, 1.0, 2.0]), median(&[4.0, 1.0, 3.0, 2.0])), (2.0, 2.5));
        assert_eq!([0.0343, 0.346, 3.46, 34.6].map(shown), ["0.034", "0.35", "3.5", "34.6"]);
    }
}

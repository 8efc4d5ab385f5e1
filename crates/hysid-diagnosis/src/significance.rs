//! Quantiles of the normal distribution: what is noise, and what is not.

use hysid_core::elementary::ln;

/// A loss up to so many times the one that matters may be hidden by noise where none is found. Designed.
pub const HIDDEN: f64 = 1.5;

/// Median of the magnitude of a standard normal number.
pub const MEDIAN_OF_NORMAL: f64 = 0.674_489_750_196_081_7;

/// Median, of the upper two where there is no middle one; NaN for no value.
pub fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Magnitude that the largest of `count` independent standard normal numbers exceeds with probability 1 in 100,000
/// (Bonferroni bound).
pub fn critical_value(count: usize) -> f64 {
    upper_quantile(5e-6 / count.max(1) as f64)
}

/// The same with probability 1 in 500. Differences below this value are consistent with noise.
pub fn doubtful_value(count: usize) -> f64 {
    upper_quantile(1e-3 / count.max(1) as f64)
}

/// Magnitude that the largest of `count` independent standard normal numbers has, typically.
pub fn typical_largest(count: usize) -> f64 {
    upper_quantile(0.25 / count.max(1) as f64)
}

/// Value that a standard normal number exceeds with probability `p`, to three digits: rational
/// approximation of Hastings (Abramowitz and Stegun 26.2.23).
pub(crate) fn upper_quantile(p: f64) -> f64 {
    let t = (-2.0 * ln(p)).sqrt();
    let above = 2.515_517 + t * (0.802_853 + t * 0.010_328);
    let below = 1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308));
    t - above / below
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        assert!((upper_quantile(0.025) - 1.95996).abs() < 5e-4);
        assert!((upper_quantile(1e-6) - 4.75342).abs() < 5e-4);
        assert!((critical_value(1) - 4.4172).abs() < 5e-4);
    }
}

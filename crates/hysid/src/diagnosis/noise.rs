//! How much a measured column jumps from row to row beyond what its course explains.

/// Median of the magnitude of a standard normal number.
const MEDIAN_OF_NORMAL: f64 = 0.674_489_750_196_081_7;

/// More differences than these tell the noise no better.
const MOST: usize = 200_000;

/// Differences that are tried, each as coefficients: the course of the values is less in the higher ones, and
/// corners of it are in fewer of the lower ones.
const DIFFERENCES: [&[f64]; 3] =
    [&[1.0, -2.0, 1.0], &[1.0, -3.0, 3.0, -1.0], &[1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0]];

/// Standard deviation of white noise on values in a row, theory.md (10.1): from the median magnitude of
/// differences of several orders, whichever gives least (the course of the values adds to each). In the unit
/// of the values; 0 for fewer than 8 of them. Runs of rows are kept apart: no difference is taken across
/// their ends.
pub fn deviation<'a>(runs: impl Iterator<Item = &'a [f64]> + Clone) -> f64 {
    let rows: usize = runs.clone().map(<[f64]>::len).sum();
    if rows < 8 {
        return 0.0;
    }
    let stride = rows.div_ceil(MOST);
    let of = |coefficients: &&[f64]| {
        let difference =
            |window: &[f64]| window.iter().zip(*coefficients).map(|(v, c)| v * c).sum::<f64>().abs();
        let windows = runs.clone().flat_map(|run| run.windows(coefficients.len()).step_by(stride));
        let mut differences: Vec<f64> = windows.map(difference).collect();
        let norm = coefficients.iter().map(|c| c * c).sum::<f64>().sqrt();
        median(&mut differences) / (MEDIAN_OF_NORMAL * norm)
    };
    let deviation = DIFFERENCES.iter().map(of).filter(|d| d.is_finite()).fold(f64::INFINITY, f64::min);
    if deviation.is_finite() { deviation } else { 0.0 }
}

/// Median, of the upper two where there is no middle one; NaN for no value.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Largest magnitude that `count` independent standard normal numbers exceed with a chance of 1 in 100,000
/// all together (Bonferroni).
pub fn critical_value(count: usize) -> f64 {
    upper_quantile(5e-6 / count.max(1) as f64)
}

/// The same with a chance of 1 in 500: what is below is what noise does.
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
    let t = (-2.0 * p.ln()).sqrt();
    let above = 2.515_517 + t * (0.802_853 + t * 0.010_328);
    let below = 1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308));
    t - above / below
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn noise_on_a_curve_is_found_within_its_sampling_error() {
        let mut generator = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(1);
        let values: Vec<f64> = (0..4000)
            .map(|k| (0.01 * k as f64).sin() + 0.02 * crate::random::normal(&mut generator))
            .collect();
        assert!((deviation(std::iter::once(values.as_slice())) / 0.02 - 1.0).abs() < 0.05);
    }

    #[test]
    fn a_smooth_curve_has_hardly_any() {
        let values: Vec<f64> = (0..4000).map(|k| (0.01 * k as f64).sin()).collect();
        assert!(deviation(std::iter::once(values.as_slice())) < 1e-6);
        assert_eq!(deviation([[1.0, 2.0].as_slice()].into_iter()), 0.0);
    }

    #[test]
    fn quantiles_are_those_of_the_tables() {
        assert!((upper_quantile(0.025) - 1.95996).abs() < 5e-4);
        assert!((upper_quantile(1e-6) - 4.75342).abs() < 5e-4);
        assert!((critical_value(1) - 4.4172).abs() < 5e-4);
    }
}

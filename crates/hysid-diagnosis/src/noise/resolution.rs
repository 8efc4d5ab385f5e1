//! Resolution of an instrument: the step between its values.

/// Gaps between values are multiples of one step to within this share of it.
const ON_THE_GRID: f64 = 0.02;

/// Values that are looked at.
const MOST: usize = 50_000;

/// The step of which all differences between values are multiples; 0 where there is none.
pub fn resolution<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let mut values: Vec<f64> = values.copied().filter(|value| !value.is_nan()).collect();
    let stride = values.len().div_ceil(MOST).max(1);
    values = values.into_iter().step_by(stride).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let gaps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let Some(step) = gaps.iter().copied().reduce(f64::min) else {
        return 0.0;
    };
    // A step like the rounding of the numbers themselves is none.
    let largest = values[0].abs().max(values[values.len() - 1].abs());
    let is_multiple =
        |gap: &f64| (gap / step - (gap / step).round()).abs() <= ON_THE_GRID * (gap / step).sqrt();
    if step > 1e-9 * largest && gaps.iter().all(is_multiple) { step } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;

    #[test]
    fn values_of_an_instrument_of_few_bits_have_its_step() {
        let values: Vec<f64> = (0..500).map(|k| (sin(0.05 * k as f64) * 127.0).round() / 127.0).collect();
        approx::assert_relative_eq!(resolution(values.iter()), 1.0 / 127.0, max_relative = 1e-9);
    }

    #[test]
    fn values_as_they_come_have_none() {
        let values: Vec<f64> = (0..500).map(|k| sin(0.05 * k as f64)).collect();
        assert_eq!(resolution(values.iter()), 0.0);
        assert_eq!(resolution([1.0, 1.0].iter()), 0.0);
    }
}

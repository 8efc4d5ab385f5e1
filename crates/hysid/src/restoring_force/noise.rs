//! Noise of a measured channel, from its divided differences: a course that is smooth over a few rows adds little to
//! those of a high order, whatever the time steps, and noise adds to all of them.

use hysid_diagnosis::resolution;
use hysid_diagnosis::significance::{MEDIAN_OF_NORMAL, median};

/// Orders of the differences: the course adds less to the higher ones, and its kinks are in fewer of the lower ones.
const ORDERS: [usize; 5] = [2, 3, 4, 6, 8];

/// Differences of an order that are taken at most.
const MOST: usize = 20_000;

/// Standard deviation of independent noise with the rounding of an instrument, from time and values of each record.
pub fn deviation(records: &[(&[f64], &[f64])]) -> f64 {
    // Without differences it is NaN, which is no minimum.
    let of_order = |&order: &usize| median(&mut differences(records, order)) / MEDIAN_OF_NORMAL;
    let least = ORDERS.iter().map(of_order).fold(f64::INFINITY, f64::min);
    // Where the values rest between two steps of the instrument, the median does not show its rounding.
    let step = resolution(records.iter().flat_map(|(_, values)| values.iter()));
    let rounding = step / 12f64.sqrt();
    if least.is_finite() { least.max(rounding) } else { rounding }
}

/// Magnitudes of divided differences whose coefficients have unit length.
fn differences(records: &[(&[f64], &[f64])], order: usize) -> Vec<f64> {
    let rows: usize = records.iter().map(|(_, values)| values.len()).sum();
    let stride = rows.div_ceil(MOST).max(1);
    let mut sizes = Vec::new();
    for (time, values) in records {
        for row in (0..values.len().saturating_sub(order)).step_by(stride) {
            let (time, values) = (&time[row..=row + order], &values[row..=row + order]);
            let coefficients = coefficients(time);
            let norm = coefficients.iter().map(|c| c * c).sum::<f64>().sqrt();
            let difference: f64 = coefficients.iter().zip(values).map(|(c, x)| c * x).sum();
            if difference.is_finite() && norm > 0.0 {
                sizes.push(difference.abs() / norm);
            }
        }
    }
    sizes
}

/// Coefficients `1/Π_{j≠i} (t_i - t_j)` of the divided difference, with times in units of their mean step.
fn coefficients(time: &[f64]) -> Vec<f64> {
    let unit = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
    let product = |&at: &f64| {
        let steps = time.iter().filter(|&&other| other != at).map(|other| (at - other) / unit);
        steps.product::<f64>().recip()
    };
    time.iter().map(product).collect()
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use hysid_core::elementary::{cos, sin};

    use super::*;
    use crate::optimise::random::{generator, normal};

    #[test]
    fn the_noise_of_a_vibration_is_found_at_uneven_times() {
        let mut generator = generator(4, 0);
        let time: Vec<f64> = (0..4000).map(|k| 0.01 * (k as f64 + 0.3 * sin(2.1 * k as f64))).collect();
        let smooth: Vec<f64> = time.iter().map(|t| 20.0 * sin(9.0 * t) + 3.0 * cos(25.0 * t)).collect();
        let noisy: Vec<f64> = smooth.iter().map(|x| x + 0.05 * normal(&mut generator)).collect();
        assert_relative_eq!(deviation(&[(&time, &noisy)]), 0.05, max_relative = 0.1);
        assert!(deviation(&[(&time, &smooth)]) < 1e-4);
    }

    #[test]
    fn the_rounding_of_an_instrument_is_noise() {
        let time: Vec<f64> = (0..3000).map(|k| 0.001 * f64::from(k)).collect();
        let rounded: Vec<f64> = time.iter().map(|t| (40.0 * sin(2.0 * t)).round() / 8.0).collect();
        assert!(deviation(&[(&time, &rounded)]) >= 0.125 / 12f64.sqrt());
    }
}

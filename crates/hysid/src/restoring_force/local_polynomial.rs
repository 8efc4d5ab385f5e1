//! Weights of the derivatives of a local polynomial, for time steps that need not be equal.
//!
//! The polynomial of degree `M` that fits the rows of a window best is a sum of polynomials `Q_j` that are orthogonal
//! over the times of the window. Its derivative of order `J` at the time of a row is `Σ_i K_i x_i`,
//! theory.md (15.21).

use hysid_core::elementary::powi;

/// Weights of the rows of a window: the derivative of an order, at the time of row `centre`, of the polynomial of a
/// degree that fits best.
///
/// `time` has more rows than the degree, in increasing order. The weights have the unit of time to the power `-order`.
pub fn weights(time: &[f64], centre: usize, degree: usize, order: usize) -> Vec<f64> {
    let origin = time[centre];
    let unit = time[time.len() - 1] - time[0];
    let t: Vec<f64> = time.iter().map(|t| (t - origin) / unit).collect();
    let mut weights = vec![0.0; t.len()];
    // Values of two successive polynomials at the rows, and their derivatives of all orders at the centre.
    let (mut before, mut now) = (vec![0.0; t.len()], vec![1.0; t.len()]);
    let (mut slopes_before, mut slopes) = (vec![0.0; order + 1], vec![0.0; order + 1]);
    slopes[0] = 1.0;
    let mut norm_before = 1.0;
    for j in 0..=degree {
        let norm: f64 = now.iter().map(|q| q * q).sum();
        for (weight, q) in weights.iter_mut().zip(&now) {
            *weight += slopes[order] * q / norm;
        }
        // Q_{j+1} = (t - a) Q_j - b Q_{j-1}
        let a = t.iter().zip(&now).map(|(t, q)| t * q * q).sum::<f64>() / norm;
        let b = if j == 0 { 0.0 } else { norm / norm_before };
        let next = t.iter().zip(now.iter().zip(&before)).map(|(t, (q, before))| (t - a) * q - b * before);
        let next: Vec<f64> = next.collect();
        before = std::mem::replace(&mut now, next);
        // The derivatives of a product with t at t = 0.
        let derivative = |k: usize| {
            let product = if k == 0 { 0.0 } else { k as f64 * slopes[k - 1] };
            product - a * slopes[k] - b * slopes_before[k]
        };
        let next = (0..=order).map(derivative).collect();
        slopes_before = std::mem::replace(&mut slopes, next);
        norm_before = norm;
    }
    let scale = powi(unit, -(order as i32));
    weights.iter_mut().for_each(|weight| *weight *= scale);
    weights
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use hysid_core::elementary::{sin, square};

    use super::*;

    fn sum(weights: &[f64], values: impl Fn(usize) -> f64) -> f64 {
        weights.iter().enumerate().map(|(row, weight)| weight * values(row)).sum()
    }

    #[test]
    fn weights_are_those_of_savitzky_and_golay() {
        let time = [0.0, 0.5, 1.0, 1.5, 2.0];
        // Savitzky and Golay 1964, tables of the first and second derivative, five points, quadratic.
        for (order, table, norm) in
            [(1, [-2.0, -1.0, 0.0, 1.0, 2.0], 10.0), (2, [2.0, -1.0, -2.0, -1.0, 2.0], 7.0)]
        {
            let step = powi(0.5, order as i32);
            for (weight, expected) in weights(&time, 2, 2, order).iter().zip(table) {
                assert_relative_eq!(*weight, expected / norm / step, epsilon = 1e-12);
            }
        }
        // Seven points, quartic, second derivative.
        let time: Vec<f64> = (0..7).map(f64::from).collect();
        let table = [-13.0, 67.0, -19.0, -70.0, -19.0, 67.0, -13.0];
        for (weight, expected) in weights(&time, 3, 4, 2).iter().zip(table) {
            assert_relative_eq!(*weight, expected / 132.0, epsilon = 1e-12);
        }
    }

    #[test]
    fn polynomials_of_the_degree_have_their_exact_derivatives_at_uneven_times() {
        let time: Vec<f64> = (0..15).map(|k| 3.0 + 0.02 * k as f64 + 0.008 * sin(1.7 * k as f64)).collect();
        for centre in [0, 4, 7, 14] {
            let t = |row: usize| time[row] - 3.1;
            let x = |row: usize| {
                1.0 - 2.0 * t(row) + 0.5 * square(t(row)) - 3.0 * powi(t(row), 3) + 4.0 * powi(t(row), 4)
            };
            let at = t(centre);
            let first = -2.0 + at - 9.0 * square(at) + 16.0 * powi(at, 3);
            let second = 1.0 - 18.0 * at + 48.0 * square(at);
            assert_relative_eq!(sum(&weights(&time, centre, 4, 0), x), x(centre), epsilon = 1e-12);
            assert_relative_eq!(sum(&weights(&time, centre, 4, 1), x), first, epsilon = 1e-9);
            assert_relative_eq!(sum(&weights(&time, centre, 4, 2), x), second, epsilon = 1e-7);
        }
    }
}

//! Derivatives of measured channels by Savitzky-Golay filters whose window is chosen from the data, theory.md (15.21)
//! and (15.22): a longer window has less noise and a larger smoothing error.

use super::filter::{Filter, RowWeights, SMALLEST_WINDOW};
use super::search::{Channel, Search, Trial};

/// Rows on each side that are tried: up to the smallest of these by one, then by this factor, up to the largest.
const BY_ONE: usize = 6;
const BY_FACTOR: f64 = 1.2;
const MOST_ON_A_SIDE: usize = 400;

/// A window has at most this share of the shortest record.
const SHARE_OF_RECORD: f64 = 0.25;

/// A channel that was differentiated.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivative {
    /// The derivative in each row; near an end, that of the first or last window's polynomial.
    pub values: Vec<Vec<f64>>,
    pub filter: Filter,
    /// Standard deviation of its noise within the record: the noise of the channel times the gain of the filter.
    pub noise: f64,
    /// Smoothing error of the derivative (root mean square), as estimated from polynomials of a higher degree.
    pub smoothing: f64,
}

/// The derivative of an order of a channel with white noise of this deviation. `window` is the rows of the window, an odd
/// number; without it, the window with the least sum of both errors is chosen.
///
/// Every record has at least as many rows as the window, or [`SMALLEST_WINDOW`].
pub fn derivative(records: &[Channel<'_>], order: usize, noise: f64, window: Option<usize>) -> Derivative {
    let shortest = records.iter().map(|(time, _)| time.len()).min().unwrap_or(0);
    let sides = sides((SHARE_OF_RECORD * shortest as f64) as usize / 2);
    let given = window.map(|window| window / 2);
    let most = sides.iter().copied().chain(given).max().unwrap_or(SMALLEST_WINDOW / 2);
    let search = Search::new(records, most, order, noise);
    let best = search.best(&sides, None);
    let (chosen, smoothing) = match given {
        None => {
            let smoothing = best.smoothing.max(search.smoothing_by_longer(&best));
            (best, smoothing)
        }
        Some(on_a_side) => {
            let chosen = search.best(&[on_a_side], Some(&best));
            // The filter that would be chosen follows what a longer window hides.
            let smoothing = match chosen.noise < best.noise {
                true => chosen.smoothing,
                false => chosen.smoothing.max(search.smoothing_by_longer(&chosen)),
            };
            (chosen, smoothing)
        }
    };
    let Trial { filter, noise, .. } = chosen;
    let values = |&(time, values): &Channel<'_>| {
        let weights = RowWeights::new(time, filter, order);
        (0..time.len()).map(|row| weights.sum(values, row)).collect()
    };
    Derivative { values: records.iter().map(values).collect(), filter, noise, smoothing }
}

fn sides(most: usize) -> Vec<usize> {
    let smallest = SMALLEST_WINDOW / 2;
    let most = most.clamp(smallest, MOST_ON_A_SIDE);
    let next = |side: &usize| {
        let longer = (*side as f64 * BY_FACTOR).round() as usize;
        Some(if *side < BY_ONE { side + 1 } else { longer })
    };
    std::iter::successors(Some(smallest), next).take_while(|side| *side <= most).collect()
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{hypot, sin, square};

    use super::super::search::DEGREES;
    use super::*;
    use crate::optimise::random::{generator, normal};
    use crate::restoring_force::noise;

    fn vibration(time: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let tones = [(1.0, 6.0, 0.0), (0.4, 17.0, 1.0), (0.15, 31.0, 2.0)];
        let sum = |t: &f64, of: &dyn Fn(f64, f64, f64) -> f64| {
            tones.iter().map(|&(size, pace, phase)| of(size, pace, pace * t + phase)).sum::<f64>()
        };
        let x = time.iter().map(|t| sum(t, &|size, _, angle| size * sin(angle))).collect();
        let second =
            time.iter().map(|t| sum(t, &|size, pace, angle| -size * pace * pace * sin(angle))).collect();
        (x, second)
    }

    fn rms_error(found: &[f64], exact: &[f64], margin: usize) -> f64 {
        let rows = margin..exact.len() - margin;
        let square = |row: usize| square(found[row] - exact[row]);
        (rows.clone().map(square).sum::<f64>() / rows.len() as f64).sqrt()
    }

    #[test]
    fn the_chosen_window_is_nearly_the_best_and_its_error_is_told() {
        let jittered = |k: usize| 0.005 * (k as f64 + 0.2 * sin(2.3 * k as f64));
        for (case, size) in [1e-5, 1e-4, 1e-3, 1e-2].into_iter().enumerate() {
            let time: Vec<f64> =
                (0..2000).map(|k| if case % 2 == 0 { 0.005 * k as f64 } else { jittered(k) }).collect();
            let (smooth, exact) = vibration(&time);
            let mut generator = generator(7, case);
            let x: Vec<f64> = smooth.iter().map(|x| x + size * normal(&mut generator)).collect();
            let channel = [(time.as_slice(), x.as_slice())];
            let deviation = noise::deviation(&channel);
            let chosen = derivative(&channel, 2, deviation, None);
            let margin = 100;
            let error = rms_error(&chosen.values[0], &exact, margin);
            let all = DEGREES
                .iter()
                .flat_map(|&degree| sides(60).into_iter().map(move |on_a_side| Filter { degree, on_a_side }));
            let error_of = |filter: Filter| {
                let weights = RowWeights::new(&time, filter, 2);
                let values: Vec<f64> = (0..time.len()).map(|row| weights.sum(&x, row)).collect();
                rms_error(&values, &exact, margin)
            };
            let best = all.filter(Filter::is_possible).map(error_of).fold(f64::INFINITY, f64::min);
            let told = hypot(chosen.noise, chosen.smoothing);
            assert!(error < 1.2 * best, "{size}: {error} {best} {:?}", chosen.filter);
            assert!((0.6..1.7).contains(&(told / error)), "{size}: {told} {error}");
        }
    }

    #[test]
    fn noise_is_not_taken_for_smoothing() {
        let time: Vec<f64> = (0..4000).map(|k| 0.002 * f64::from(k)).collect();
        let mut generator = generator(3, 0);
        let x: Vec<f64> = time.iter().map(|t| sin(6.0 * t) + 1e-3 * normal(&mut generator)).collect();
        let found = derivative(&[(&time, &x)], 2, 1e-3, Some(7));
        assert!(found.smoothing < 0.1 * found.noise, "{} {}", found.smoothing, found.noise);
    }

    #[test]
    fn the_smoothing_error_of_a_window_longer_than_the_motion_is_told() {
        let time: Vec<f64> = (0..3000).map(|k| 0.005 * f64::from(k)).collect();
        let (smooth, exact) = vibration(&time);
        let mut generator = generator(5, 0);
        let x: Vec<f64> = smooth.iter().map(|x| x + 1e-3 * normal(&mut generator)).collect();
        for window in [101, 201, 501] {
            let found = derivative(&[(&time, &x)], 2, 1e-3, Some(window));
            let error = rms_error(&found.values[0], &exact, 260);
            assert!((0.8..1.2).contains(&(found.smoothing / error)), "{window}: {} {error}", found.smoothing);
        }
    }

    #[test]
    fn short_records_have_a_derivative() {
        let time = [0.0, 1.0, 2.5, 3.0, 4.0];
        let x = time.map(|t| 2.0 - t + 3.0 * t * t);
        let derivative = derivative(&[(&time, &x)], 2, 0.0, None);
        for value in &derivative.values[0] {
            approx::assert_relative_eq!(*value, 6.0, epsilon = 1e-10);
        }
    }
}

//! Derivatives of measured channels by Savitzky-Golay filters whose window is chosen from the data, theory.md (15.21)
//! and (15.22): a longer window lets less noise through and smooths more of the motion away.

use std::borrow::Cow;
use std::ops::Range;

use super::local_polynomial::weights;

/// Degrees of the polynomials that are tried.
const DEGREES: [usize; 2] = [2, 4];

/// Rows on each side that are tried: up to the smallest of these by one, then by this factor, up to the largest.
const BY_ONE: usize = 6;
const BY_FACTOR: f64 = 1.2;
const MOST_ON_A_SIDE: usize = 400;

/// A window has at most this share of the shortest record.
const SHARE_OF_RECORD: f64 = 0.25;

/// Rows on which a filter is tried.
const TRIED_ROWS: usize = 2000;

/// No longer window is tried once it smooths away so many times the error of the best.
const HOPELESS: f64 = 4.0;

/// Smoothing is told from noise where two filters are apart by so many times the variance that noise explains.
const TOLD: f64 = 3.0;

/// A window is so many times as long where a polynomial of the next higher degree lets as much noise through.
const LONGER: f64 = 1.7;

/// Time steps that differ by less than this share are equal.
const EVEN: f64 = 1e-6;

/// Fewest rows of a window.
pub const SMALLEST_WINDOW: usize = 5;

/// A Savitzky-Golay filter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Filter {
    /// Degree of its polynomial.
    pub degree: usize,
    /// Rows on each side of the one whose derivative it gives.
    pub on_a_side: usize,
}

impl Filter {
    /// Rows of its window.
    pub fn window(&self) -> usize {
        2 * self.on_a_side + 1
    }

    /// The filter by whose difference the smoothing of this one is estimated.
    fn reference(&self) -> Self {
        Self { degree: self.degree + 2, ..*self }
    }

    /// True if the window is long enough for the polynomial of the reference.
    fn is_possible(&self) -> bool {
        self.window() > self.reference().degree
    }
}

/// A channel that was differentiated.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivative {
    /// The derivative in each row of each record. Within half a window of an end, the polynomial is that of the first or
    /// last window.
    pub values: Vec<Vec<f64>>,
    /// The filter.
    pub filter: Filter,
    /// Standard deviation of its noise within the record: the noise of the channel times the gain of the filter.
    pub noise: f64,
    /// Root mean square of what the filter smooths away, as estimated from polynomials of a higher degree.
    pub smoothing: f64,
}

/// The channel of each record: its time stamps and values.
pub type Channel<'a> = (&'a [f64], &'a [f64]);

/// The derivative of an order of a channel with white noise of this deviation. `window` is the rows of the window, an odd
/// number; without it, the window with the least sum of both errors is chosen.
///
/// Every record has at least as many rows as the window, or [`SMALLEST_WINDOW`].
pub fn derivative(records: &[Channel<'_>], order: usize, noise: f64, window: Option<usize>) -> Derivative {
    let shortest = records.iter().map(|(time, _)| time.len()).min().unwrap_or(0);
    let sides = match window {
        Some(window) => vec![window / 2],
        None => sides((SHARE_OF_RECORD * shortest as f64) as usize / 2),
    };
    let most = sides.last().copied().unwrap_or(SMALLEST_WINDOW / 2);
    let rows = tried_rows(records, most);
    let mut best: Option<Trial> = None;
    for degree in DEGREES {
        for &on_a_side in &sides {
            let filter = Filter { degree, on_a_side };
            if !filter.is_possible() {
                continue;
            }
            let trial = Trial::of(filter, records, &rows, order, noise, best.as_ref());
            let (error, least) = (trial.error(), best.as_ref().map_or(f64::INFINITY, Trial::error));
            if error < least {
                best = Some(trial);
            } else if trial.is_told && trial.smoothing > HOPELESS * least {
                break;
            }
        }
    }
    let smallest = Filter { degree: DEGREES[0], on_a_side: SMALLEST_WINDOW / 2 };
    let chosen = best.unwrap_or_else(|| Trial::of(smallest, records, &rows, order, noise, None));
    let smoothing = chosen.smoothing.min(chosen.smoothing_by_longer(records, &rows, order, noise));
    let Trial { filter, noise, .. } = chosen;
    let values = |&(time, values): &Channel<'_>| {
        let weights = RowWeights::new(time, filter, order);
        (0..time.len()).map(|row| weights.sum(values, row)).collect()
    };
    Derivative { values: records.iter().map(values).collect(), filter, noise, smoothing }
}

/// Rows on a side that are tried, up to this number.
fn sides(most: usize) -> Vec<usize> {
    let smallest = SMALLEST_WINDOW / 2;
    let most = most.clamp(smallest, MOST_ON_A_SIDE);
    let next = |side: &usize| {
        let longer = (*side as f64 * BY_FACTOR).round() as usize;
        Some(if *side < BY_ONE { side + 1 } else { longer })
    };
    std::iter::successors(Some(smallest), next).take_while(|side| *side <= most).collect()
}

/// Rows of each record on which filters are tried: those with a whole window on both sides, or the middle one.
fn tried_rows(records: &[Channel<'_>], on_a_side: usize) -> Vec<Vec<usize>> {
    let inner = |rows: usize| -> Range<usize> {
        let margin = on_a_side.min((rows - 1) / 2);
        margin..rows - margin
    };
    let total: usize = records.iter().map(|(time, _)| inner(time.len()).len()).sum();
    let stride = total.div_ceil(TRIED_ROWS).max(1);
    records.iter().map(|(time, _)| inner(time.len()).step_by(stride).collect()).collect()
}

/// A filter and its errors.
struct Trial {
    filter: Filter,
    /// The derivative in the tried rows.
    values: Vec<f64>,
    noise: f64,
    smoothing: f64,
    /// The smoothing is larger than what noise alone can feign.
    is_told: bool,
}

impl Trial {
    /// Tries a filter; `best` is the best of those that were tried before.
    fn of(
        filter: Filter,
        records: &[Channel<'_>],
        rows: &[Vec<usize>],
        order: usize,
        noise: f64,
        best: Option<&Self>,
    ) -> Self {
        let (mut derivatives, mut gain) = (Vec::new(), 0.0);
        let (mut apart, mut apart_by_noise) = (0.0, 0.0);
        for (&(time, values), rows) in records.iter().zip(rows) {
            let own = RowWeights::new(time, filter, order);
            let reference = RowWeights::new(time, filter.reference(), order);
            for &row in rows {
                let (first, own) = own.at(row);
                let (_, reference) = reference.at(row);
                let (mut derivative, mut difference) = (0.0, 0.0);
                for ((own, reference), value) in own.iter().zip(&*reference).zip(&values[first..]) {
                    derivative += own * value;
                    difference += (reference - own) * value;
                    gain += own * own;
                    apart_by_noise += (reference - own).powi(2);
                }
                derivatives.push(derivative);
                apart += difference * difference;
            }
        }
        let count = derivatives.len() as f64;
        let variance = noise * noise;
        let own = Self {
            noise: (variance * gain / count).sqrt(),
            smoothing: 0.0,
            is_told: false,
            filter,
            values: derivatives,
        };
        // What two filters are apart is the smoothing of the longer one and the noise that the other lets through. A
        // window longer than the motion hides it from the polynomials of both degrees, but not from a shorter window.
        let from_reference = Apart { total: apart / count, by_others: variance * apart_by_noise / count };
        let from_best = best.filter(|best| own.noise < best.noise).map(|best| own.apart_from(best));
        let all = || [Some(from_reference), from_best].into_iter().flatten();
        Self {
            smoothing: all().map(Apart::smoothing).fold(0.0, f64::max),
            is_told: all().any(Apart::is_told),
            ..own
        }
    }

    /// The smoothing by the difference from a polynomial of the higher degree on a longer window, which lets about as much
    /// noise through; above the truth where that one smooths, too.
    fn smoothing_by_longer(
        &self,
        records: &[Channel<'_>],
        rows: &[Vec<usize>],
        order: usize,
        noise: f64,
    ) -> f64 {
        let shortest = records.iter().map(|(time, _)| time.len()).min().unwrap_or(0);
        let on_a_side = (LONGER * self.filter.on_a_side as f64).ceil() as usize;
        let filter = Filter { on_a_side, ..self.filter.reference() };
        if filter.window() > shortest {
            return self.smoothing;
        }
        let longer = Trial::of(filter, records, rows, order, noise, None);
        let total = self.apart_from(&longer).total;
        // Both have the rows of the shorter window, so that less noise than that of both is in the difference.
        let by_others = self.noise.powi(2).max(longer.noise.powi(2));
        Apart { total, by_others }.smoothing()
    }

    /// The mean square of the difference from a filter that lets more noise through.
    fn apart_from(&self, other: &Self) -> Apart {
        let squares = self.values.iter().zip(&other.values).map(|(a, b)| (a - b).powi(2));
        Apart { total: squares.sum::<f64>() / self.values.len() as f64, by_others: other.error().powi(2) }
    }

    fn error(&self) -> f64 {
        self.noise.hypot(self.smoothing)
    }
}

/// Mean square of the difference of two filters.
#[derive(Debug, Clone, Copy)]
struct Apart {
    total: f64,
    /// What noise, and smoothing by the other filter, add to it.
    by_others: f64,
}

impl Apart {
    fn smoothing(self) -> f64 {
        (self.total - self.by_others).max(0.0).sqrt()
    }

    fn is_told(self) -> bool {
        self.total > TOLD * self.by_others
    }
}

/// The weights of a filter in the rows of a record.
struct RowWeights<'t> {
    time: &'t [f64],
    filter: Filter,
    order: usize,
    /// Those of rows with a whole window around them, if time steps are equal.
    inner: Option<Vec<f64>>,
}

impl<'t> RowWeights<'t> {
    fn new(time: &'t [f64], filter: Filter, order: usize) -> Self {
        let window = filter.window().min(time.len());
        let is_even = has_even_steps(time) && time.len() >= filter.window();
        let inner = is_even.then(|| weights(&time[..window], filter.on_a_side, filter.degree, order));
        Self { time, filter, order, inner }
    }

    /// The first row of the window of a row, and the weights.
    fn at(&self, row: usize) -> (usize, Cow<'_, [f64]>) {
        let window = self.filter.window().min(self.time.len());
        let first = row.saturating_sub(self.filter.on_a_side).min(self.time.len() - window);
        match &self.inner {
            Some(inner) if row - first == self.filter.on_a_side => (first, Cow::Borrowed(inner)),
            _ => {
                let time = &self.time[first..first + window];
                (first, Cow::Owned(weights(time, row - first, self.filter.degree, self.order)))
            }
        }
    }

    fn sum(&self, values: &[f64], row: usize) -> f64 {
        let (first, weights) = self.at(row);
        weights.iter().zip(&values[first..]).map(|(weight, value)| weight * value).sum()
    }
}

fn has_even_steps(time: &[f64]) -> bool {
    let mean = (time[time.len() - 1] - time[0]) / (time.len() - 1).max(1) as f64;
    time.windows(2).all(|pair| (pair[1] - pair[0] - mean).abs() <= EVEN * mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimise::random::{generator, normal};
    use crate::restoring_force::noise;

    /// A vibration of three tones, and its second derivative.
    fn vibration(time: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let tones = [(1.0, 6.0, 0.0), (0.4, 17.0, 1.0), (0.15, 31.0, 2.0)];
        let sum = |t: &f64, of: &dyn Fn(f64, f64, f64) -> f64| {
            tones.iter().map(|&(size, pace, phase)| of(size, pace, pace * t + phase)).sum::<f64>()
        };
        let x = time.iter().map(|t| sum(t, &|size, _, angle| size * angle.sin())).collect();
        let second =
            time.iter().map(|t| sum(t, &|size, pace, angle| -size * pace * pace * angle.sin())).collect();
        (x, second)
    }

    fn rms_error(found: &[f64], exact: &[f64], margin: usize) -> f64 {
        let rows = margin..exact.len() - margin;
        let square = |row: usize| (found[row] - exact[row]).powi(2);
        (rows.clone().map(square).sum::<f64>() / rows.len() as f64).sqrt()
    }

    #[test]
    fn the_chosen_window_is_nearly_the_best_and_its_error_is_told() {
        let jittered = |k: usize| 0.005 * (k as f64 + 0.2 * (2.3 * k as f64).sin());
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
            let told = chosen.noise.hypot(chosen.smoothing);
            assert!(error < 1.2 * best, "{size}: {error} {best} {:?}", chosen.filter);
            assert!((0.6..1.7).contains(&(told / error)), "{size}: {told} {error}");
        }
    }

    #[test]
    fn noise_is_not_taken_for_smoothing() {
        let time: Vec<f64> = (0..4000).map(|k| 0.002 * f64::from(k)).collect();
        let mut generator = generator(3, 0);
        let x: Vec<f64> = time.iter().map(|t| (6.0 * t).sin() + 1e-3 * normal(&mut generator)).collect();
        let found = derivative(&[(&time, &x)], 2, 1e-3, Some(7));
        assert!(found.smoothing < 0.1 * found.noise, "{} {}", found.smoothing, found.noise);
    }

    #[test]
    fn a_given_window_is_kept() {
        let time: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let (x, _) = vibration(&time);
        let derivative = derivative(&[(&time, &x)], 1, 1e-3, Some(31));
        assert_eq!(derivative.filter.window(), 31);
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

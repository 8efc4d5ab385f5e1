//! Noise of a measured channel: how large it is, and how strongly it is correlated from row
//! to row.
//!
//! It is a sum of parts: white noise, noise whose correlation decays with the distance of rows (filtered, amplifier and
//! 1/f noise), periodic noise (hum), and a random walk (drift, and all that changes more slowly than a branch). The
//! deviation of a mean, of a smoothed value or of an energy follows from all of them, theory.md (10.1).

mod differences;
mod resolution;

use std::f64::consts::TAU;

use hysid_core::elementary::{cos, powf, sin_cos, square};

pub(crate) use differences::{ChannelRun, roughness};
pub use resolution::resolution;

/// Share of the variance above which noise is hum.
const MOSTLY: f64 = 0.7;

/// Amplitude of a sine, divided by the deviation estimated from its median magnitude: `0.6745 √2`.
const SINE: f64 = 0.954;

/// How the noise of a part depends on that of the rows before.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Correlation {
    White,
    /// By this factor from row to row.
    Decaying(f64),
    /// By a sine that turns by this angle from row to row.
    Periodic(f64),
    /// Random walk: the noise of the row before plus an independent step. Its variance is that of one step; only
    /// differences between rows are defined.
    Walking,
}

impl Correlation {
    /// Correlation of two rows at this distance. For a walk: minus half the variance of the difference between the rows,
    /// which replaces the correlation where the weights add up to 0.
    fn at(self, distance: f64) -> f64 {
        match self {
            Self::White => f64::from(distance == 0.0),
            Self::Decaying(factor) => powf(factor, distance),
            Self::Periodic(angle) => cos(angle * distance),
            Self::Walking => -0.5 * distance,
        }
    }

    /// Variance of a weighted sum of successive rows of variance 1; of a walk, from its middle row on.
    fn of_sum(self, weights: &[f64]) -> f64 {
        match self {
            Self::White => weights.iter().map(|w| w * w).sum(),
            Self::Decaying(factor) => {
                let (mut before, mut sum) = (0.0, 0.0);
                for w in weights {
                    sum += w * (w + 2.0 * before);
                    before = factor * (before + w);
                }
                sum.max(0.0)
            }
            Self::Periodic(angle) => {
                let (sine, cosine) = sin_cos(angle);
                // Σ w_k e^{ikθ}, by Horner from the last row on.
                let turn =
                    |(re, im): (f64, f64), w: &f64| (w + re * cosine - im * sine, re * sine + im * cosine);
                let (re, im) = weights.iter().rev().fold((0.0, 0.0), turn);
                re * re + im * im
            }
            Self::Walking => {
                // A step moves all rows that are further from the middle than it.
                let (before, after) = weights.split_at(weights.len() / 2);
                let steps = |outwards: &mut dyn Iterator<Item = &f64>| {
                    outwards.fold((0.0, 0.0), |(moved, sum), w| (moved + w, sum + square(moved + w))).1
                };
                steps(&mut before.iter()) + steps(&mut after.iter().skip(1).rev())
            }
        }
    }
}

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Noise {
    parts: Vec<(Correlation, f64)>,
    /// Deviation of the noise if it were white, as neighbouring rows show it.
    roughness: f64,
}

impl Noise {
    pub fn white(deviation: f64) -> Self {
        let part = (Correlation::White, deviation * deviation);
        Self { parts: if deviation > 0.0 { vec![part] } else { Vec::new() }, roughness: deviation }
    }

    /// The noise of a channel, from its values in runs of rows on which the course is smooth: between two turning
    /// points. No difference is taken across their ends.
    pub fn of<'a>(runs: impl Iterator<Item = ChannelRun<'a>>) -> Self {
        differences::noise(runs)
    }

    /// Standard deviation of a value, without the walk.
    pub fn deviation(&self) -> f64 {
        let of_value = self.parts.iter().filter(|part| part.0 != Correlation::Walking);
        // The sum of nothing would be -0.
        of_value.fold(0.0, |sum, part| sum + part.1).sqrt()
    }

    /// Standard deviation of the walk over a number of rows.
    pub fn wander(&self, rows: f64) -> f64 {
        let steps = self.parts.iter().filter(|part| part.0 == Correlation::Walking);
        (steps.map(|part| part.1).sum::<f64>() * rows).sqrt()
    }

    /// Standard deviation of the white noise that would cause the differences between neighbouring rows.
    pub fn roughness(&self) -> f64 {
        self.roughness
    }

    /// Period in rows and amplitude of the hum, where most of the noise is hum.
    pub fn hum(&self) -> Option<(f64, f64)> {
        let periodic = |part: &(Correlation, f64)| match part {
            (Correlation::Periodic(angle), variance) => Some((TAU / angle, *variance)),
            _ => None,
        };
        let parts: Vec<(f64, f64)> = self.parts.iter().filter_map(periodic).collect();
        let variance: f64 = parts.iter().map(|part| part.1).sum();
        if variance <= MOSTLY * square(self.deviation()) {
            return None;
        }
        let period = parts.iter().map(|(period, part)| period * part).sum::<f64>() / variance;
        // The median magnitude of a sine is 1.48 times that of a normal number of its deviation.
        Some((period, SINE * variance.sqrt()))
    }

    /// True if rows are independent.
    pub fn is_white(&self) -> bool {
        self.parts.iter().all(|part| part.0 == Correlation::White)
    }

    /// Standard deviation of a weighted sum of successive rows.
    pub fn of_sum(&self, weights: &[f64]) -> f64 {
        self.parts
            .iter()
            .map(|(correlation, variance)| variance * correlation.of_sum(weights))
            .sum::<f64>()
            .sqrt()
    }

    /// Standard deviation of the mean of a number of successive rows.
    pub fn of_mean(&self, rows: usize) -> f64 {
        let rows = rows.max(1);
        self.of_sum(&vec![(rows as f64).recip(); rows])
    }

    /// The noise of the means of blocks of rows.
    pub fn in_blocks(&self, rows: usize) -> Self {
        if rows <= 1 {
            return self.clone();
        }
        let mean = vec![(rows as f64).recip(); rows];
        let part = |&(correlation, variance): &(Correlation, f64)| {
            let own = correlation.of_sum(&mean);
            let blocks = match correlation {
                Correlation::White => Correlation::White,
                Correlation::Walking => return (Correlation::Walking, variance * rows as f64),
                Correlation::Periodic(angle) => Correlation::Periodic(angle * rows as f64),
                Correlation::Decaying(factor) => {
                    // What a block shares with the next: the variance of both together says it.
                    let both = correlation.of_sum(&vec![(rows as f64).recip(); 2 * rows]);
                    Correlation::Decaying((0.5 * both / own - 1.0).clamp(0.0, factor))
                }
            };
            (blocks, variance * own)
        };
        Self {
            parts: self.parts.iter().map(part).collect(),
            roughness: self.roughness / (rows as f64).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn no_noise_is_not_minus_nought() {
        let none = Noise { parts: Vec::new(), ..Noise::white(1.0) };
        assert!(none.deviation() == 0.0 && none.deviation().is_sign_positive());
    }

    #[test]
    fn the_deviation_of_a_sum_is_that_of_its_covariances() {
        let weights = [0.3, -1.0, 0.2, 0.7, 0.05];
        for correlation in [Correlation::White, Correlation::Decaying(0.8), Correlation::Periodic(0.7)] {
            let pairs = (0..5).flat_map(|i: i32| (0..5).map(move |j: i32| (i, j)));
            let expected: f64 = pairs
                .map(|(i, j)| {
                    weights[i as usize] * weights[j as usize] * correlation.at(f64::from((i - j).abs()))
                })
                .sum();
            assert_relative_eq!(correlation.of_sum(&weights), expected, epsilon = 1e-12);
        }
    }

    #[test]
    fn the_mean_of_blocks_has_the_noise_of_the_mean_of_their_rows() {
        let noise = Noise {
            parts: vec![(Correlation::White, 1.0), (Correlation::Decaying(0.9), 2.0)],
            roughness: 1.2,
        };
        assert_relative_eq!(noise.in_blocks(5).of_mean(4), noise.of_mean(20), max_relative = 0.05);
        assert_relative_eq!(noise.in_blocks(5).deviation(), noise.of_mean(5), max_relative = 1e-12);
    }

    #[test]
    fn a_walk_counts_from_the_middle_row_on_and_in_differences_from_any() {
        let walk = Noise { parts: vec![(Correlation::Walking, 0.04)], roughness: 0.1 };
        assert_relative_eq!(walk.wander(25.0), 1.0, max_relative = 1e-12);
        assert_relative_eq!(walk.of_sum(&[-1.0, 0.0, 0.0, 0.0, 1.0]), 0.4, max_relative = 1e-12);
        assert_relative_eq!(walk.of_sum(&[0.0, 0.0, 0.0, 0.0, 1.0]), 0.08f64.sqrt(), max_relative = 1e-12);
        assert_eq!(walk.of_sum(&[0.0, 0.0, 1.0, 0.0, 0.0]), 0.0);
        assert_eq!(walk.deviation(), 0.0);
    }

    #[test]
    fn the_mean_of_white_noise_falls_with_the_root_of_its_rows() {
        assert_relative_eq!(Noise::white(0.3).of_mean(9), 0.1, max_relative = 1e-12);
        assert_eq!(Noise::default().of_mean(9), 0.0);
    }
}

//! Residuals: noise, and dependences that are planted beside it.

use hysid::diagnosis::residuals::ResidualTest;
use hysid_core::elementary::{cos, ln, square};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Uniform numbers between 0 and 1.
pub fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(seed);
    move || generator.random::<f64>()
}

/// Noise of deviation 1, unrelated to the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    White,
    /// An autoregression of first order, 0.6 from row to row.
    Correlated,
    /// The same, 0.95 from row to row.
    Slow,
    /// Waves of about 25 rows that keep their phase for some 100 rows.
    Waves,
}

impl Noise {
    pub const ALL: [Self; 4] = [Self::White, Self::Correlated, Self::Slow, Self::Waves];

    pub fn name(self) -> &'static str {
        match self {
            Self::White => "white",
            Self::Correlated => "0.6 from row to row",
            Self::Slow => "0.95 from row to row",
            Self::Waves => "waves of 25 rows",
        }
    }

    pub fn drawn(self, seed: u64, rows: usize) -> Vec<f64> {
        let [a, b] = match self {
            Self::White => [0.0, 0.0],
            Self::Correlated => [0.6, 0.0],
            Self::Slow => [0.95, 0.0],
            Self::Waves => [2.0 * 0.99 * cos(std::f64::consts::TAU / 25.0), -0.99 * 0.99],
        };
        let mut draw = uniform(seed);
        let mut normal = || (-2.0 * ln(draw().max(1e-300))).sqrt() * cos(std::f64::consts::TAU * draw());
        // Begins in the steady state, after a while that is not used.
        const BEFORE: usize = 500;
        let (mut last, mut earlier) = (0.0, 0.0);
        let drawn: Vec<f64> = (0..rows + BEFORE)
            .map(|_| {
                (earlier, last) = (last, a * last + b * earlier + normal());
                last
            })
            .collect();
        let variance = (1.0 - b) / ((1.0 + b) * (square(1.0 - b) - a * a));
        drawn[BEFORE..].iter().map(|e| e / variance.sqrt()).collect()
    }
}

/// Part of the residual that follows from the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dependence {
    /// Proportional to the change of the input since the last row.
    Rate,
    Input,
    /// The input that an element with a fading memory has not followed.
    Memory,
    /// One sign on the way up, the other on the way down.
    Direction,
    /// The error is larger in large half cycles.
    Amplitude,
    /// The error is larger after turning points.
    TurningPoints,
    Drift,
}

impl Dependence {
    pub const ALL: [Self; 7] = [
        Self::Rate,
        Self::Input,
        Self::Memory,
        Self::Direction,
        Self::Amplitude,
        Self::TurningPoints,
        Self::Drift,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Rate => "rate",
            Self::Input => "input",
            Self::Memory => "fading memory of the input",
            Self::Direction => "direction",
            Self::Amplitude => "size by amplitude",
            Self::TurningPoints => "size after turning points",
            Self::Drift => "drift",
        }
    }

    /// The test that must find it.
    pub fn test(self) -> ResidualTest {
        match self {
            Self::Rate => ResidualTest::Rate,
            Self::Input | Self::Memory => ResidualTest::Input,
            Self::Direction => ResidualTest::Direction,
            Self::Amplitude => ResidualTest::Amplitude,
            Self::TurningPoints => ResidualTest::TurningPoints,
            Self::Drift => ResidualTest::Time,
        }
    }

    /// Adds a part of this root mean square, or multiplies by 1 to `1 + size`.
    pub fn plant(self, residual: &mut [f64], size: f64, time: &[f64], x: &[f64]) {
        let rows = x.len();
        let change = |row: usize| if row == 0 { x[1] - x[0] } else { x[row] - x[row - 1] };
        let part: Vec<f64> = match self {
            Self::Rate => (0..rows).map(|row| change(row) / (time[1] - time[0])).collect(),
            Self::Input => x.to_vec(),
            Self::Memory => {
                let mut followed = x[0];
                let lag = |x: &f64| {
                    followed += 0.1 * (x - followed);
                    x - followed
                };
                x.iter().map(lag).collect()
            }
            Self::Direction => (0..rows).map(|row| change(row).signum()).collect(),
            Self::Drift => (0..rows).map(|row| row as f64 / rows as f64 - 0.5).collect(),
            Self::Amplitude | Self::TurningPoints => {
                let factor = factors(x, self == Self::Amplitude);
                residual.iter_mut().zip(factor).for_each(|(e, share)| *e *= 1.0 + size * share);
                return;
            }
        };
        let rms = (part.iter().map(|p| p * p).sum::<f64>() / rows as f64).sqrt();
        residual.iter_mut().zip(part).for_each(|(e, part)| *e += size * part / rms);
    }
}

/// Of each row: half the way of its half cycle, or 1 in the first quarter of it and 0 beyond.
fn factors(x: &[f64], by_amplitude: bool) -> Vec<f64> {
    let (mut ends, mut direction) = (vec![0], 0.0);
    for row in 1..x.len() {
        let change = x[row] - x[row - 1];
        // Two rows beside a peak may be equal.
        if change * direction < 0.0 {
            ends.push(row - 1);
        }
        direction = if change == 0.0 { direction } else { change };
    }
    ends.push(x.len() - 1);
    let mut factors = Vec::with_capacity(x.len());
    for pair in ends.windows(2) {
        let (from, to) = (x[pair[0]], x[pair[1]]);
        let of_row = |row: usize| match by_amplitude {
            true => 0.5 * (to - from).abs(),
            false => f64::from(u8::from((x[row] - from) / (to - from) <= 0.25)),
        };
        factors.extend((pair[0]..pair[1]).map(of_row));
    }
    factors.push(*factors.last().unwrap_or(&0.0));
    factors
}

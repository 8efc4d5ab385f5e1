//! Wanted outputs that no training record resembles: a sum of three sines, a staircase, band-limited noise. Each is one
//! period with values from -1 to 1.

use std::f64::consts::TAU;

use hysid_core::elementary::sin;

/// A wanted output by its name.
pub struct Shape {
    /// Its name.
    pub name: &'static str,
    /// Values of one period, from -1 to 1.
    pub values: Vec<f64>,
}

/// The golden ratio, whose multiples are phases and amplitudes that do not repeat.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// Order, amplitude and phase of the three sines.
const SINES: [(f64, f64, f64); 3] = [(1.0, 1.0, 0.0), (3.0, 0.6, 1.0), (7.0, 0.4, 2.0)];

/// Levels of the staircase. Half of each step is a smooth ramp, half rest.
const LEVELS: [f64; 12] = [0.0, 0.5, 0.2, 0.9, -0.3, 0.1, -0.8, -0.4, -0.6, 0.7, 0.3, 0.0];

/// Largest order of the noise, in periods.
const ORDERS: usize = 10;

/// All shapes, with so many rows a period.
pub fn shapes(rows: usize) -> [Shape; 3] {
    [
        Shape { name: "three sines", values: scaled(each(rows, sines)) },
        Shape { name: "staircase", values: each(rows, staircase) },
        Shape { name: "noise", values: scaled(each(rows, noise)) },
    ]
}

fn each(rows: usize, value: fn(f64) -> f64) -> Vec<f64> {
    (0..rows).map(|row| value(row as f64 / rows as f64)).collect()
}

/// With a largest magnitude of 1.
fn scaled(values: Vec<f64>) -> Vec<f64> {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    values.into_iter().map(|value| value / largest).collect()
}

fn sines(share: f64) -> f64 {
    SINES.iter().map(|(order, amplitude, phase)| amplitude * sin(TAU * order * share + phase)).sum()
}

fn staircase(share: f64) -> f64 {
    let place = share * LEVELS.len() as f64;
    let level = (place as usize).min(LEVELS.len() - 1);
    let from = LEVELS[(level + LEVELS.len() - 1) % LEVELS.len()];
    let ramp = (2.0 * (place - level as f64)).min(1.0);
    from + (LEVELS[level] - from) * ramp * ramp * (3.0 - 2.0 * ramp)
}

fn noise(share: f64) -> f64 {
    let sine = |order: usize| {
        let (amplitude, phase) =
            ((GOLDEN * order as f64).fract(), (GOLDEN * (order + ORDERS) as f64).fract());
        (0.3 + amplitude) * sin(TAU * (order as f64 * share + phase))
    };
    (1..=ORDERS).map(sine).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_periods_between_their_limits() {
        for Shape { name, values } in shapes(600) {
            let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            assert!((0.85..=1.0).contains(&largest), "{name}: {largest}");
            let step = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
            assert!((values[0] - values[599]).abs() <= 1.5 * step, "{name} closes");
        }
    }
}

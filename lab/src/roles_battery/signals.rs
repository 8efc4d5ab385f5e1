//! Values of the columns: an input of growing amplitude, an output with hysteresis, and what stands beside them.

use std::f64::consts::TAU;

use hysid_core::elementary::sin;

use super::Column;

/// Rows of a table.
const ROWS: usize = 800;

/// Rows of a cycle.
const CYCLE: usize = 100;

/// The rows of a table with these columns, as text.
pub fn rows(columns: &[Column]) -> String {
    let input: Vec<f64> = (0..ROWS).map(input).collect();
    let output = stop(&input, 0.3, 0.4);
    let other = stop(&input, 0.6, -0.1);
    let step = |k: usize| if k == 0 { 0.0 } else { input[k] - input[k - 1] };
    let mut sum = 0.0;
    let sums: Vec<f64> = (0..ROWS)
        .map(|k| {
            sum += if k % CYCLE < CYCLE / 2 { 10.0 * step(k).max(0.0) } else { 0.0 };
            sum
        })
        .collect();
    let cell = |k: usize, (place, (name, signal)): (usize, &Column)| -> String {
        let noise = |size: f64| size * noise(k, place);
        let number = match signal {
            't' => 0.1 * k as f64,
            // A temperature that drives is no drift.
            'x' if name.to_lowercase().contains("temperat") => 60.0 + 40.0 * input[k],
            'x' | 'r' => 5.0 * input[k],
            'y' => 20.0 * output[k] + noise(0.02),
            'c' => (k / (CYCLE / 2)) as f64 / 2.0,
            'n' => (1 + k / CYCLE) as f64,
            'i' => (k + 1) as f64,
            's' => (1 + k / (CYCLE / 2) % 4) as f64,
            'k' => 25.0 + noise(0.05),
            'l' => [5.0, 50.0, 150.0, 300.0][k * 4 / ROWS],
            'd' => 25.0 + 3.0 * sin(k as f64 / 300.0) + noise(0.02),
            'f' => 1.0,
            'a' => sums[k],
            'v' => 10.0 * step(k),
            'e' => 0.5 + noise(0.02).abs(),
            'z' => 5.05 * input[k] + noise(0.005),
            'q' => 20.0 * output[k] + 3.0 * input[k],
            'p' => 9.0 * other[k],
            'o' => 3.0 * output[k] + 2.0 * other[k],
            'w' => return "ok".into(),
            'g' => return if k < ROWS / 2 { "a" } else { "b" }.into(),
            'm' => {
                let minutes = 15 * k;
                return format!(
                    "2023-03-{:02} {:02}:{:02}",
                    1 + minutes / 1440,
                    minutes / 60 % 24,
                    minutes % 60
                );
            }
            unknown => panic!("no signal {unknown}"),
        };
        format!("{number:.6}")
    };
    let row =
        |k: usize| columns.iter().enumerate().map(|column| cell(k, column)).collect::<Vec<_>>().join(",");
    (0..ROWS).map(|k| row(k) + "\n").collect()
}

fn input(k: usize) -> f64 {
    sin(TAU * k as f64 / CYCLE as f64) * (0.3 + 0.7 * k as f64 / ROWS as f64)
}

/// A stop operator of this threshold, with a spring beside it.
fn stop(input: &[f64], threshold: f64, spring: f64) -> Vec<f64> {
    let (mut state, mut before) = (0.0_f64, input[0]);
    let next = |&x: &f64| {
        state = (state + x - before).clamp(-threshold, threshold);
        before = x;
        state + spring * x
    };
    input.iter().map(next).collect()
}

/// A sequence between -1 and 1 that repeats nowhere in a table.
fn noise(k: usize, place: usize) -> f64 {
    2.0 * (43_758.545 * sin(12.9898 * (k + 1) as f64 + 78.233 * place as f64)).rem_euclid(1.0) - 1.0
}

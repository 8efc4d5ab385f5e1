//! Inputs of the battery, with their time.

use std::f64::consts::TAU;

use hysid_core::elementary::sin;

use super::residual::uniform;

/// An input.
pub struct Drive {
    pub name: &'static str,
    make: fn(u64) -> Vec<f64>,
}

impl Drive {
    /// Time and input; the seed changes only drives at random.
    pub fn run(&self, seed: u64) -> (Vec<f64>, Vec<f64>) {
        let x = (self.make)(seed);
        ((0..x.len()).map(|row| 0.01 * row as f64).collect(), x)
    }
}

/// All inputs.
pub const DRIVES: [Drive; 5] = [
    Drive { name: "4 cycles of a sine, 300 rows each", make: |_| sines(&[(1.0, 300); 4]) },
    Drive { name: "30 cycles of a sine, 60 rows each", make: |_| sines(&[(1.0, 60); 30]) },
    Drive { name: "triangles of six amplitudes, three each, one speed", make: |_| triangles() },
    Drive { name: "sines of three amplitudes at three speeds", make: |_| speeds() },
    Drive { name: "random reversals", make: random },
];

fn sines(cycles: &[(f64, usize)]) -> Vec<f64> {
    let of_cycle = |&(amplitude, rows): &(f64, usize)| {
        (0..rows).map(move |row| amplitude * sin(TAU * row as f64 / rows as f64))
    };
    cycles.iter().flat_map(of_cycle).collect()
}

fn triangles() -> Vec<f64> {
    let mut x = vec![0.0];
    for amplitude in 1..=6 {
        for _ in 0..3 {
            for end in [amplitude, -amplitude] {
                line(&mut x, f64::from(end) / 6.0, 0.03);
            }
        }
    }
    line(&mut x, 0.0, 0.03);
    x
}

fn speeds() -> Vec<f64> {
    let of_speed = |rows: usize| [0.3, 0.6, 1.0].map(|amplitude| (amplitude, rows));
    let cycles: Vec<(f64, usize)> = [150, 75, 30].into_iter().flat_map(of_speed).collect();
    sines(&[&cycles[..], &cycles[..], &cycles[..]].concat())
}

fn random(seed: u64) -> Vec<f64> {
    let mut x = vec![0.0];
    let mut draws = uniform(seed ^ 0x5eed);
    while x.len() < 2000 {
        let (end, speed) = (2.0 * draws() - 1.0, 0.01 + 0.06 * draws());
        line(&mut x, end, speed);
    }
    x
}

/// Goes to an input by steps of this size or less.
fn line(x: &mut Vec<f64>, to: f64, step: f64) {
    let from = x[x.len() - 1];
    let rows = ((to - from).abs() / step).ceil().max(1.0);
    x.extend((1..=rows as usize).map(|row| from + (to - from) * row as f64 / rows));
}

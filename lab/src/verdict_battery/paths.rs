//! The paths of the input, as engineers measure. All run over -1 ... 1 and begin at rest at 0.
//!
//! A law runs on [`SUBSTEPS`] steps from row to row. Rows are evenly spaced in time and, on most paths, miss the turning
//! points by a fraction of their distance, as a measurement does.

use std::f64::consts::PI;

use hysid_core::elementary::{cos, exp, ln, powi, sin};

use super::chance::Chance;

/// Steps of the simulation from one row to the next.
pub const SUBSTEPS: usize = 8;

/// A path of the input.
pub struct Path {
    pub name: &'static str,
    /// Whether the records have time stamps.
    pub timed: bool,
    /// Rows on the fastest branch over the whole range.
    pub rows_of_branch: usize,
    course: fn() -> Course,
}

impl Path {
    /// Time from row to row, in seconds: the fastest branch over the whole range takes 1 s.
    pub fn row_seconds(&self) -> f64 {
        (self.rows_of_branch as f64).recip()
    }

    /// The input at every step of the simulation.
    pub fn inputs(&self) -> Vec<f64> {
        (self.course)().sampled(self.row_seconds() / SUBSTEPS as f64)
    }
}

/// How the input goes between turning points.
#[derive(Clone, Copy)]
enum Shape {
    Triangle,
    Sine,
}

/// The input over time.
enum Course {
    /// Pieces: where they end and how many seconds they take.
    Pieces(Shape, Vec<(f64, f64)>),
    /// A function of time that lasts so many seconds.
    Function(fn(f64) -> f64, f64),
}

impl Course {
    /// Between turning points, the whole range in a second.
    fn between(shape: Shape, turns: &[f64]) -> Self {
        let mut from = 0.0_f64;
        let mut pieces = Vec::new();
        for &to in turns {
            pieces.push((to, 0.5 * (to - from).abs()));
            from = to;
        }
        Self::Pieces(shape, pieces)
    }

    fn sampled(&self, seconds: f64) -> Vec<f64> {
        match self {
            Self::Function(x, duration) => {
                (0..=(duration / seconds) as usize).map(|k| x(k as f64 * seconds)).collect()
            }
            Self::Pieces(shape, pieces) => sampled(*shape, pieces, seconds),
        }
    }
}

fn sampled(shape: Shape, pieces: &[(f64, f64)], seconds: f64) -> Vec<f64> {
    let mut inputs = vec![0.0];
    let (mut from, mut begin) = (0.0, 0.0);
    for &(to, duration) in pieces {
        let end = begin + duration;
        loop {
            let time = inputs.len() as f64 * seconds;
            if time > end {
                break;
            }
            let share = (time - begin) / duration;
            let share = match shape {
                Shape::Triangle => share,
                Shape::Sine => 0.5 - 0.5 * cos(PI * share),
            };
            inputs.push(from + (to - from) * share);
        }
        (from, begin) = (to, end);
    }
    inputs
}

/// Cycles of these amplitudes.
fn cycles(amplitudes: impl Iterator<Item = f64>) -> Vec<f64> {
    amplitudes.flat_map(|a| [a, -a]).chain([0.0]).collect()
}

fn growing(shape: Shape) -> Course {
    let twice = [0.2, 0.4, 0.6, 0.8, 1.0].into_iter().flat_map(|a| [a, a]);
    Course::between(shape, &cycles(twice))
}

fn repeated() -> Course {
    Course::between(Shape::Sine, &cycles([1.0; 8].into_iter()))
}

/// The same minor loops on both branches, nested three deep, and each repeated once.
const NESTED: [f64; 33] = [
    1.0, -1.0, 0.6, 0.1, 0.6, 0.1, 1.0, -0.6, -0.1, -0.6, -0.1, -1.0, 0.2, -0.15, 0.2, -0.15, 1.0, -0.15,
    0.2, -0.15, 0.2, -1.0, 0.7, -0.6, 0.5, -0.3, 0.3, -0.3, 0.5, -0.6, 1.0, -1.0, 1.0,
];

fn nested(shape: Shape) -> Course {
    Course::between(shape, &NESTED)
}

/// Three minor loops, each run twice on the way up and twice on the way down of the largest one.
const MINOR_LOOPS: [f64; 29] = [
    1.0, -1.0, -0.1, -0.5, -0.1, -0.5, 0.2, -0.4, 0.2, -0.4, 0.6, 0.0, 0.6, 0.0, 1.0, 0.0, 0.6, 0.0, 0.6,
    -0.4, 0.2, -0.4, 0.2, -0.5, -0.1, -0.5, -0.1, -1.0, 1.0,
];

fn minor_loops() -> Course {
    Course::between(Shape::Triangle, &MINOR_LOOPS)
}

fn first_order_reversals() -> Course {
    let turns: Vec<f64> = (1..=10).flat_map(|k| [1.0, 1.0 - 0.2 * f64::from(k)]).chain([1.0]).collect();
    Course::between(Shape::Triangle, &turns)
}

/// Turning points by chance between two passes of the whole range.
fn random_turns(name: &str) -> Vec<f64> {
    let mut chance = Chance::of(1, name);
    let mut turns = vec![1.0, -1.0, 1.0];
    for k in 0..36 {
        let from: f64 = turns[turns.len() - 1];
        // Downwards first; never less than a sixth of the range.
        let (sign, room): (f64, f64) = if k % 2 == 0 { (-1.0, from + 0.95) } else { (1.0, 0.95 - from) };
        turns.push(from + sign * (0.25 + (room - 0.25).max(0.0) * chance.even()));
    }
    turns.extend([1.0, -1.0, 1.0]);
    turns
}

fn reversals_of_one_speed() -> Course {
    Course::between(Shape::Triangle, &random_turns("triangle"))
}

/// Every branch takes the same time, so that the speeds differ.
fn reversals_of_one_duration() -> Course {
    let pieces = random_turns("sine").into_iter().map(|to| (to, 1.0)).collect();
    Course::Pieces(Shape::Sine, pieces)
}

/// A pattern, three times over for every time that a branch over the range takes.
fn at_speeds(shape: Shape, pattern: &[f64], times: usize, seconds: [f64; 3]) -> Course {
    let mut pieces = vec![(1.0, 0.5 * seconds[0])];
    for seconds in seconds {
        for _ in 0..times {
            let mut from = 1.0_f64;
            for &to in pattern {
                pieces.push((to, 0.5 * (to - from).abs() * seconds));
                from = to;
            }
        }
    }
    Course::Pieces(shape, pieces)
}

fn two_tones() -> Course {
    let x = |t: f64| 0.66 * sin(0.5 * PI * t) + 0.345 * sin(0.5 * PI * 3.7 * t);
    Course::Function(x, 33.0)
}

fn decaying() -> Course {
    let amplitudes = (0..12).map(|k| powi(0.8, k));
    Course::between(Shape::Triangle, &cycles(amplitudes))
}

/// From 0.05 to 0.5 cycles per second, as a power.
fn chirp() -> Course {
    const SECONDS: f64 = 52.0;
    let x = |t: f64| {
        let growth = ln(10.0) / SECONDS;
        sin(2.0 * PI * 0.05 * (exp(growth * t) - 1.0) / growth)
    };
    Course::Function(x, SECONDS)
}

fn one_loop() -> Course {
    Course::between(Shape::Sine, &[1.0, -1.0, 1.0])
}

/// All paths.
pub fn all() -> Vec<Path> {
    let path = |name, timed, rows_of_branch, course| Path { name, timed, rows_of_branch, course };
    vec![
        path("growing", true, 103, || growing(Shape::Triangle)),
        path("growing-untimed", false, 100, || growing(Shape::Sine)),
        path("repeated", true, 97, repeated),
        path("nested", true, 151, || nested(Shape::Triangle)),
        path("nested-untimed", false, 120, || nested(Shape::Sine)),
        path("minor-loops", true, 163, minor_loops),
        path("first-order-reversals", true, 101, first_order_reversals),
        path("reversals-sine", true, 61, reversals_of_one_duration),
        path("reversals-triangle", true, 107, reversals_of_one_speed),
        path("three-speeds", true, 41, || {
            at_speeds(Shape::Sine, &[-1.0, 1.0], 3, [10.0, 10.0_f64.sqrt(), 1.0])
        }),
        path("three-speeds-minor", true, 40, || {
            at_speeds(Shape::Triangle, &[-1.0, 0.5, -0.5, 0.5, -1.0, 1.0], 2, [6.0, 2.4, 1.0])
        }),
        path("two-tones", true, 53, two_tones),
        path("decaying", true, 127, decaying),
        path("chirp", true, 47, chirp),
        path("one-loop", true, 163, one_loop),
    ]
}

/// Smallest and largest value.
pub fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_path_covers_the_range_in_400_to_4000_rows() {
        for path in all() {
            let inputs = path.inputs();
            let rows = inputs.len() / SUBSTEPS;
            assert!((400..=4000).contains(&rows), "{}: {rows} rows", path.name);
            let (low, high) =
                inputs.iter().fold((0.0_f64, 0.0_f64), |(low, high), &x| (low.min(x), high.max(x)));
            assert!(
                (-1.01..=-0.96).contains(&low) && (0.96..=1.01).contains(&high),
                "{}: {low} {high}",
                path.name
            );
        }
    }
}

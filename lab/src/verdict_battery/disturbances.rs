//! What a laboratory does to a record. Sizes are shares of the ranges of the undisturbed record.

use hysid_core::elementary::{exp, powi, sin};

use super::chance::Chance;
use super::paths::{Path, SUBSTEPS, range};
use super::run::Run;

/// What is measured: rows with input and output, most with time.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    pub time: Option<Vec<f64>>,
    pub input: Vec<f64>,
    pub output: Vec<f64>,
}

impl Record {
    /// As CSV. Every number reads back as the same number.
    pub fn csv(&self) -> String {
        let mut text = String::from(if self.time.is_some() { "t_s,x,y\n" } else { "x,y\n" });
        for (row, (x, y)) in self.input.iter().zip(&self.output).enumerate() {
            if let Some(time) = &self.time {
                text += &format!("{},", time[row]);
            }
            text += &format!("{x},{y}\n");
        }
        text
    }
}

/// What disturbs a record.
pub struct Disturbance {
    pub name: &'static str,
    kind: Kind,
}

enum Kind {
    None,
    White(f64),
    /// Noise with a memory: correlation from row to row, deviation.
    Correlated(f64, f64),
    Pink(f64),
    Hum(f64),
    Quantised(i32),
    /// Noise of the input and of the output.
    Both(f64),
    /// Rows by which the output is late.
    Late(f64),
    Drift(f64),
    Walk(f64),
    Clipped(f64),
    Jitter(f64),
    Spikes(usize, f64),
    Coarse(usize),
    Wear(f64),
    MidLoop,
}

/// All disturbances.
pub fn all() -> Vec<Disturbance> {
    let one = |name, kind| Disturbance { name, kind };
    vec![
        one("none", Kind::None),
        one("white-0.3", Kind::White(0.003)),
        one("white-1", Kind::White(0.01)),
        one("ar-0.9-1", Kind::Correlated(0.9, 0.01)),
        one("ar-0.98-0.5", Kind::Correlated(0.98, 0.005)),
        one("pink-0.5", Kind::Pink(0.005)),
        one("hum-0.5", Kind::Hum(0.005)),
        one("8-bits", Kind::Quantised(8)),
        one("12-bits", Kind::Quantised(12)),
        one("both-0.3", Kind::Both(0.003)),
        one("late-1.5-rows", Kind::Late(1.5)),
        one("early-1-row", Kind::Late(-1.0)),
        one("drift-4", Kind::Drift(0.04)),
        one("drift-walk-4", Kind::Walk(0.04)),
        one("clipped-90", Kind::Clipped(0.9)),
        one("time-jitter", Kind::Jitter(0.3)),
        one("10-spikes", Kind::Spikes(10, 0.1)),
        one("coarse-12", Kind::Coarse(12)),
        one("wear-5", Kind::Wear(0.05)),
        one("mid-loop", Kind::MidLoop),
    ]
}

impl Disturbance {
    /// False where it does not belong to a path: wear between speeds needs several speeds.
    pub fn applies_to(&self, path: &Path) -> bool {
        !matches!(self.kind, Kind::Wear(_)) || path.name.starts_with("three-speeds")
    }

    /// True if the specimen itself wears: the answer about deterioration is not that of the law.
    pub fn wears(&self) -> bool {
        matches!(self.kind, Kind::Wear(_))
    }

    /// Step of the simulation at which the record begins.
    pub fn first_step(&self, run: &Run) -> usize {
        match self.kind {
            Kind::MidLoop => middle_of_second_branch(&run.inputs),
            _ => 0,
        }
    }

    /// What is measured of a run.
    pub fn record(&self, run: &Run, chance: &mut Chance) -> Record {
        let stride = match self.kind {
            Kind::Coarse(rows) => run.path.rows_of_branch * SUBSTEPS / rows,
            _ => SUBSTEPS,
        };
        let last = run.inputs.len() as isize - 1;
        let late = match self.kind {
            Kind::Late(rows) => (rows * SUBSTEPS as f64).round() as isize,
            _ => 0,
        };
        let steps: Vec<usize> = (self.first_step(run)..run.inputs.len()).step_by(stride).collect();
        let seconds = run.path.row_seconds() / SUBSTEPS as f64;
        let mut time: Vec<f64> = steps.iter().map(|&step| step as f64 * seconds).collect();
        let mut input: Vec<f64> = steps.iter().map(|&step| run.inputs[step]).collect();
        let measured = |&step: &usize| run.outputs[(step as isize - late).clamp(0, last) as usize];
        let mut output: Vec<f64> = steps.iter().map(measured).collect();
        self.disturb(&mut time, &mut input, &mut output, chance);
        Record { time: run.path.timed.then_some(time), input, output }
    }

    fn disturb(&self, time: &mut [f64], input: &mut [f64], output: &mut [f64], chance: &mut Chance) {
        let rows = output.len();
        let (low, high) = range(output);
        let height = high - low;
        match self.kind {
            Kind::None | Kind::Late(_) | Kind::Coarse(_) | Kind::MidLoop => {}
            Kind::White(size) => add(output, size * height, || chance.normal()),
            Kind::Correlated(memory, size) => add(output, size * height, correlated(memory, chance)),
            Kind::Pink(size) => add(output, size * height, pink(chance)),
            Kind::Hum(size) => {
                let (begin, mut row) = (chance.even(), 0.0);
                add(output, size * height, || {
                    row += 1.0;
                    sin(std::f64::consts::TAU * (begin + 0.137_431 * row))
                });
            }
            Kind::Quantised(bits) => {
                quantise(output, bits);
                quantise(input, bits);
            }
            Kind::Both(size) => {
                add(output, size * height, || chance.normal());
                let (left, right) = range(input);
                add(input, size * (right - left), || chance.normal());
            }
            Kind::Drift(size) => {
                for (row, y) in output.iter_mut().enumerate() {
                    *y += size * height * row as f64 / (rows - 1) as f64;
                }
            }
            Kind::Walk(size) => {
                let walk = walk(rows, chance);
                output.iter_mut().zip(walk).for_each(|(y, w)| *y += size * height * w);
            }
            Kind::Clipped(share) => {
                let (middle, half) = (0.5 * (low + high), 0.5 * share * height);
                output.iter_mut().for_each(|y| *y = y.clamp(middle - half, middle + half));
            }
            Kind::Jitter(share) => {
                let row = time[1] - time[0];
                time.iter_mut().for_each(|t| *t += share * row * (2.0 * chance.even() - 1.0));
            }
            Kind::Spikes(count, size) => {
                for _ in 0..count {
                    let row = (chance.even() * rows as f64) as usize;
                    let sign = if chance.even() < 0.5 { -1.0 } else { 1.0 };
                    output[row] += sign * size * height * (1.0 + chance.even());
                }
            }
            Kind::Wear(share) => {
                for (row, y) in output.iter_mut().enumerate() {
                    *y *= 1.0 - share * row as f64 / (rows - 1) as f64;
                }
            }
        }
    }
}

fn add(values: &mut [f64], size: f64, mut noise: impl FnMut() -> f64) {
    values.iter_mut().for_each(|value| *value += size * noise());
}

/// `e_k = a e_{k-1} + √(1 - a²) n_k`, of deviation 1.
fn correlated(memory: f64, chance: &mut Chance) -> impl FnMut() -> f64 {
    let mut now = chance.normal();
    move || {
        now = memory * now + (1.0 - memory * memory).sqrt() * chance.normal();
        now
    }
}

/// Noise whose power falls as one over the frequency, of deviation 1: equal shares of noise with memories of 1, 4, 16,
/// ... rows.
fn pink(chance: &mut Chance) -> impl FnMut() -> f64 {
    let memories: Vec<f64> = (0..6).map(|octave| exp(-powi(0.25, octave))).collect();
    let mut states: Vec<f64> = memories.iter().map(|_| chance.normal()).collect();
    move || {
        for (state, memory) in states.iter_mut().zip(&memories) {
            *state = memory * *state + (1.0 - memory * memory).sqrt() * chance.normal();
        }
        states.iter().sum::<f64>() / (states.len() as f64).sqrt()
    }
}

/// A random walk that spans 1.
fn walk(rows: usize, chance: &mut Chance) -> Vec<f64> {
    let mut place = 0.0;
    let step = |_| {
        place += chance.normal();
        place
    };
    let walk: Vec<f64> = (0..rows).map(step).collect();
    let (low, high) = range(&walk);
    walk.into_iter().map(|place| place / (high - low)).collect()
}

/// Rounded to so many bits of a measuring range 10 % larger than the values.
fn quantise(values: &mut [f64], bits: i32) {
    let (low, high) = range(values);
    let step = 1.1 * (high - low) / powi(2.0, bits);
    values.iter_mut().for_each(|value| *value = step * (*value / step).round());
}

/// A step half way between the first two turning points.
fn middle_of_second_branch(inputs: &[f64]) -> usize {
    let turns = inputs.windows(3).enumerate().filter(|(_, w)| (w[1] - w[0]) * (w[2] - w[1]) < 0.0);
    let turns: Vec<usize> = turns.map(|(step, _)| step + 1).take(2).collect();
    turns.iter().sum::<usize>() / turns.len().max(1)
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::square;

    use super::super::{laws, paths};
    use super::*;

    fn path(name: &str) -> Path {
        paths::all().into_iter().find(|path| path.name == name).expect("the path is there")
    }

    fn run(path: &Path) -> Run<'_> {
        let law = laws::all().into_iter().find(|law| law.name == "pi-stops").expect("the law is there");
        Run::of(&law, path)
    }

    fn measured(name: &str, run: &Run, seed: u64) -> Record {
        let one = all().into_iter().find(|one| one.name == name).expect("the disturbance is there");
        one.record(run, &mut Chance::of(seed, name))
    }

    fn deviation(values: &[f64]) -> f64 {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (values.iter().map(|v| square(v - mean)).sum::<f64>() / values.len() as f64).sqrt()
    }

    fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
        a.iter().zip(b).map(|(a, b)| a - b).collect()
    }

    #[test]
    fn disturbances_have_their_sizes() {
        let path = path("three-speeds");
        let run = run(&path);
        let clean = measured("none", &run, 1);
        let (low, high) = range(&clean.output);
        let height = high - low;
        let noise = |name| {
            let record = measured(name, &run, 1);
            difference(&record.output, &clean.output).iter().map(|e| e / height).collect::<Vec<f64>>()
        };
        // Deviations; where noise has a memory, few of its values are independent.
        for (name, size, tolerance) in [
            ("white-0.3", 0.003, 0.05),
            ("white-1", 0.01, 0.05),
            ("ar-0.9-1", 0.01, 0.15),
            ("ar-0.98-0.5", 0.005, 0.3),
            ("pink-0.5", 0.005, 0.3),
            ("both-0.3", 0.003, 0.05),
            ("hum-0.5", 0.005 / 2.0_f64.sqrt(), 0.01),
            ("8-bits", 1.1 / 256.0 / 12.0_f64.sqrt(), 0.1),
            ("12-bits", 1.1 / 4096.0 / 12.0_f64.sqrt(), 0.1),
        ] {
            let found = deviation(&noise(name));
            assert!((found / size - 1.0).abs() < tolerance, "{name}: {found} for {size}");
        }
        // Spans.
        for (name, size) in [("drift-4", 0.04), ("drift-walk-4", 0.04)] {
            let (low, high) = range(&noise(name));
            assert!((high - low - size).abs() < 1e-9, "{name}: {low} {high}");
        }
        let (low, high) = range(&measured("clipped-90", &run, 1).output);
        assert!(((high - low) / height - 0.9).abs() < 1e-9);
        let spikes = noise("10-spikes").iter().filter(|e| e.abs() > 0.09).count();
        assert!((9..=10).contains(&spikes), "{spikes} spikes");
        let input = difference(&measured("both-0.3", &run, 1).input, &clean.input);
        assert!((deviation(&input) / 0.006 - 1.0).abs() < 0.05);
        let worn = measured("wear-5", &run, 1);
        let last = clean.output.len() - 1;
        assert!((worn.output[last] / clean.output[last] - 0.95).abs() < 1e-9);
    }

    #[test]
    fn delays_are_as_long_as_they_say() {
        let path = path("repeated");
        let run = run(&path);
        let clean = measured("none", &run, 1);
        assert_eq!(clean.output[101], measured("early-1-row", &run, 1).output[100]);
        let late = measured("late-1.5-rows", &run, 1).output;
        let half_way = run.outputs[100 * SUBSTEPS + SUBSTEPS / 2];
        assert_eq!(late[102], half_way);
    }

    #[test]
    fn coarse_records_have_twelve_rows_a_branch_and_others_begin_within_a_loop() {
        let path = path("repeated");
        let run = run(&path);
        let rows = measured("coarse-12", &run, 1).output.len() as f64;
        // 16 branches over the range.
        assert!((rows / 16.0 - 12.0).abs() < 0.3, "{rows} rows");
        let later = measured("mid-loop", &run, 1);
        assert!(later.input[0].abs() < 0.2 && later.input[1] < later.input[0], "{:?}", &later.input[..2]);
        let jitter = measured("time-jitter", &run, 1).time.expect("it has time");
        assert!(jitter.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn the_same_seed_gives_the_same_record() {
        let path = path("decaying");
        let run = run(&path);
        for one in all().iter().filter(|one| one.applies_to(&path)) {
            let record = measured(one.name, &run, 1);
            assert_eq!(record, measured(one.name, &run, 1), "{}", one.name);
            assert_eq!(record.csv().lines().count(), record.output.len() + 1);
        }
        assert_ne!(measured("white-1", &run, 1), measured("white-1", &run, 2));
    }
}

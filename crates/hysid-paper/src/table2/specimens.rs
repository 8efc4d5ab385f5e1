//! Specimens with one property each, and the records that all of them are tried on.

use std::f64::consts::TAU;

use hysid::data::record::{ColumnNames, Dataset, Record};
use hysid::operator::{DeterioratingStop, Operator, Stop};
use hysid_core::elementary::{sin, tanh};

/// A property and the specimen that has just that.
pub struct SpecimenProperty {
    /// The property.
    pub name: &'static str,
    /// The specimen's law.
    pub law: &'static str,
    /// Whether PNN, GPNN, Preisach-NN, XPNN can represent it, according to the paper.
    pub paper: [bool; 4],
    /// The specimen passes several stops through one tanh.
    pub is_mixing: bool,
    output: fn(&InputMotion) -> Vec<f64>,
}

struct InputMotion {
    x: Vec<f64>,
    rate: Vec<f64>,
}

/// All specimens. The paper has one row for loops that are not congruent; here are two.
pub static SPECIMENS: [SpecimenProperty; 6] = [
    SpecimenProperty {
        name: "rate-independent, congruent, Masing, symmetric",
        law: "y = Σ w ε_r[x], r = 0.1, 0.25, 0.5, 0.8, w = 1, 0.7, 0.5, 0.3",
        paper: [true, true, true, true],
        is_mixing: false,
        output: |motion| sum(&motion.x),
    },
    SpecimenProperty {
        name: "not Masing",
        law: "y = Σ w tanh(3 (x - ε_r[x])), the same r and w: a function of each play, hence congruent",
        paper: [false, false, true, true],
        is_mixing: false,
        output: |motion| weighted(&motion.x, |x, stop| tanh(3.0 * (x - stop))),
    },
    SpecimenProperty {
        name: "asymmetric",
        law: "y = Σ w ε_r[x] + 0.8 x²",
        paper: [false, false, true, true],
        is_mixing: false,
        output: |motion| sum(&motion.x).into_iter().zip(&motion.x).map(|(y, x)| y + 0.8 * x * x).collect(),
    },
    SpecimenProperty {
        name: "not congruent, wiping out",
        law: "y = tanh(1.5 Σ w ε_r[x]): several stops through one bent function",
        paper: [false, true, false, true],
        is_mixing: true,
        output: |motion| sum(&motion.x).into_iter().map(|y| tanh(1.5 * y)).collect(),
    },
    SpecimenProperty {
        name: "not congruent, deteriorating",
        law: "y = Σ w DS_r,β[x], β = 40",
        paper: [false, true, false, true],
        is_mixing: false,
        output: |motion| worn(&motion.x),
    },
    SpecimenProperty {
        name: "rate-dependent",
        law: "y = Σ w ε_r[x + 0.05 x']",
        paper: [false, false, false, true],
        is_mixing: false,
        output: |motion| {
            sum(&motion.x.iter().zip(&motion.rate).map(|(x, rate)| x + 0.05 * rate).collect::<Vec<f64>>())
        },
    },
];

/// Thresholds and weights of the stops.
const STOPS: [(f64, f64); 4] = [(0.1, 1.0), (0.25, 0.7), (0.5, 0.5), (0.8, 0.3)];

/// Capacity of those that wear out.
const CAPACITY: f64 = 40.0;

/// A weighted sum of a function of the input and each stop's output.
fn weighted(x: &[f64], function: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let mut total = vec![0.0; x.len()];
    for (r, weight) in STOPS {
        let stop = Stop::new(r).expect("thresholds are above 0").run(x);
        for ((total, &x), stop) in total.iter_mut().zip(x).zip(stop) {
            *total += weight * function(x, stop);
        }
    }
    total
}

fn sum(x: &[f64]) -> Vec<f64> {
    weighted(x, |_, stop| stop)
}

fn worn(x: &[f64]) -> Vec<f64> {
    let mut total = vec![0.0; x.len()];
    for (r, weight) in STOPS {
        let outputs = DeterioratingStop::new(r, CAPACITY).expect("values are above 0").run(x);
        total.iter_mut().zip(outputs).for_each(|(total, stop)| *total += weight * stop);
    }
    total
}

/// The specimen's outputs; its rate is that of central differences, as the networks have it.
pub fn outputs(property: &SpecimenProperty, time: &[f64], x: &[f64]) -> Vec<f64> {
    let last = x.len() - 1;
    let rate = |row: usize| {
        let (before, after) = (row.saturating_sub(1), (row + 1).min(last));
        (x[after] - x[before]) / (time[after] - time[before])
    };
    (property.output)(&InputMotion { x: x.to_vec(), rate: (0..x.len()).map(rate).collect() })
}

const ROWS: usize = 600;

/// Periods of the slower tone in a record.
const PERIODS: f64 = 7.0;

/// A record of two tones that do not repeat, the slower with a period of 1 s at speed 1.
fn record(property: &SpecimenProperty, speed: f64, phase: f64) -> hysid::Result<Record> {
    let phases: Vec<f64> = (0..ROWS).map(|row| PERIODS * row as f64 / ROWS as f64).collect();
    let tones = |p: f64| 0.6 * sin(TAU * p) + 0.4 * sin(TAU * 2.618 * p + phase) - 0.4 * sin(phase);
    // It begins at 0 and grows to its whole size.
    let x: Vec<f64> = phases.iter().map(|&p| (p / 2.0).min(1.0) * tones(p)).collect();
    let time: Vec<f64> = phases.iter().map(|p| p / speed).collect();
    let y = outputs(property, &time, &x);
    Record::new(format!("speed {speed}"), vec![x], y)?.with_time(time)
}

fn dataset(property: &SpecimenProperty, records: [(f64, f64); 3]) -> hysid::Result<Dataset> {
    let records: hysid::Result<Vec<Record>> =
        records.into_iter().map(|(speed, phase)| record(property, speed, phase)).collect();
    Dataset::new(ColumnNames::plain(1), records?)
}

/// The records to train on.
pub fn training(property: &SpecimenProperty) -> hysid::Result<Dataset> {
    dataset(property, [(1.0, 0.0), (2.5, 2.0), (6.0, 4.0)])
}

/// The records that no network is trained on.
pub fn unseen(property: &SpecimenProperty) -> hysid::Result<Dataset> {
    dataset(property, [(1.5, 1.0), (3.5, 3.0), (5.0, 5.0)])
}

const SWING: usize = 50;

const ENDS: (f64, f64) = (-0.1, 0.3);

/// A path that runs the same minor loop twice, after it came from below and after it came from above.
pub fn two_histories() -> hysid::Result<Record> {
    let (low, high) = ENDS;
    let turning = [0.0, -0.9, high, low, high, low, high, 0.9, low, high, low, high, low];
    let mut x = vec![turning[0]];
    for ends in turning.windows(2) {
        x.extend((1..=SWING).map(|row| ends[0] + (ends[1] - ends[0]) * row as f64 / SWING as f64));
    }
    let time = (0..x.len()).map(|row| row as f64 * 0.01).collect();
    let y = vec![f64::NAN; x.len()];
    Record::new("two histories", vec![x], y)?.with_time(time)
}

/// Largest difference of the minor loop's rising branch after the two histories, in percent of its height.
pub fn incongruency(outputs: &[f64]) -> f64 {
    // The branches from low to high in the second run of either loop.
    let branch = |swing: usize| &outputs[swing * SWING..=(swing + 1) * SWING];
    let (first, second) = (branch(5), branch(10));
    let height = (first[SWING] - first[0]).abs();
    let differences = first.iter().zip(second).map(|(a, b)| ((a - first[0]) - (b - second[0])).abs());
    100.0 * differences.fold(0.0, f64::max) / height
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(property: &SpecimenProperty) -> f64 {
        let record = two_histories().unwrap();
        incongruency(&outputs(property, record.time().unwrap(), &record.inputs()[0]))
    }

    /// Mayergoyz: sums of functions of single plays are congruent; what mixes or wears out is not.
    #[test]
    fn specimens_are_congruent_or_not_as_they_say() {
        for property in &SPECIMENS {
            let difference = of(property);
            match property.name.starts_with("not congruent") {
                true => assert!(difference > 3.0, "{}: {difference}", property.name),
                false => assert!(
                    difference < 1e-9 || property.name == "rate-dependent",
                    "{}: {difference}",
                    property.name
                ),
            }
        }
    }

    #[test]
    fn the_records_are_those_of_their_speeds() {
        let data = training(&SPECIMENS[0]).unwrap();
        let (low, high) = data.input_range(0);
        assert!(low < -0.8 && high > 0.8, "{low} to {high}");
        let lengths: Vec<f64> =
            data.records().iter().map(|record| record.time().unwrap()[ROWS - 1]).collect();
        assert!(
            (lengths[0] / lengths[1] - 2.5).abs() < 1e-12 && (lengths[0] / lengths[2] - 6.0).abs() < 1e-12
        );
        // A specimen without rate gives the same at every speed.
        let record = &data.records()[0];
        let faster: Vec<f64> = record.time().unwrap().iter().map(|t| t / 3.0).collect();
        for property in &SPECIMENS {
            let same = outputs(property, record.time().unwrap(), &record.inputs()[0])
                == outputs(property, &faster, &record.inputs()[0]);
            assert_eq!(same, property.name != "rate-dependent", "{}", property.name);
        }
    }
}

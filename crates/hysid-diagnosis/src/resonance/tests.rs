use std::f64::consts::TAU;

use hysid_core::data::record::{ColumnNames, Dataset, Record};
use hysid_core::elementary::{sin, square};
use hysid_core::operator::{Operator, Stop};

use super::*;
use crate::{DataIssue, DataIssueKind, Diagnosis, DiagnosisOptions, Property, Verdict};

/// Steps of the integration in a row.
const STEPS: usize = 20;
const RATE: f64 = 750.0;

/// A sum of sines of 5 to 150 Hz, one each Hertz, of phases without order: a force of 50 N root mean square, in
/// halves of a step of the integration.
struct ForceMultisine(Vec<f64>);

impl ForceMultisine {
    fn new() -> Self {
        let halves = RATE as usize * 2 * STEPS;
        let sine =
            |line: f64, k: usize| sin(TAU * (line * k as f64 / halves as f64 + 0.618_034 * line * line));
        let amplitude = 50.0 * (2.0 / 146.0_f64).sqrt();
        let force = |k| amplitude * (5..=150).map(|line| sine(f64::from(line), k)).sum::<f64>();
        Self((0..halves).map(force).collect())
    }

    fn at(&self, half: usize) -> f64 {
        self.0[half % self.0.len()]
    }
}

/// A mass of 2 kg with a damper in Ns/m under the force, from rest. What else holds it is a force of `(y, r)`, with
/// `r'` from `(y', r)`. Columns of time, force and displacement.
fn oscillator(
    rows: usize,
    damper: f64,
    holds: impl Fn(f64, f64) -> f64,
    evolution: impl Fn(f64, f64) -> f64,
) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let force = ForceMultisine::new();
    let step = 1.0 / (RATE * STEPS as f64);
    let rates = |[y, v, r]: [f64; 3], u: f64| [v, (u - damper * v - holds(y, r)) / 2.0, evolution(v, r)];
    let ahead = |s: [f64; 3], k: [f64; 3], h: f64| [s[0] + h * k[0], s[1] + h * k[1], s[2] + h * k[2]];
    let mut state = [0.0; 3];
    let (mut time, mut input, mut output) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..rows * STEPS {
        if k % STEPS == 0 {
            time.push((k / STEPS) as f64 / RATE);
            input.push(force.at(2 * k));
            output.push(state[0]);
        }
        // Runge and Kutta, fourth order.
        let [u0, u1, u2] = [0, 1, 2].map(|half| force.at(2 * k + half));
        let k0 = rates(state, u0);
        let k1 = rates(ahead(state, k0, 0.5 * step), u1);
        let k2 = rates(ahead(state, k1, 0.5 * step), u1);
        let k3 = rates(ahead(state, k2, step), u2);
        for (part, k) in [(k0, 1.0), (k1, 2.0), (k2, 2.0), (k3, 1.0)] {
            state = ahead(state, part, k * step / 6.0);
        }
    }
    (time, input, output)
}

fn bouc_wen() -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let evolution = |v: f64, r: f64| 5e4 * v - 1e3 * (0.8 * v.abs() * r - 1.1 * v * r.abs());
    oscillator(3000, 10.0, |y, r| 5e4 * y + r, evolution)
}

/// Of 40 Hz and `10/(2·2·2π·40)` of damping.
fn linear() -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let stiffness = 2.0 * square(TAU * 40.0);
    oscillator(1500, 10.0, move |y, _| stiffness * y, |_, _| 0.0)
}

fn named(time: &str, records: Vec<Record>) -> Dataset {
    let names = ColumnNames::of(Some(time), &["F_N"], "y_m");
    Dataset::new(names, records).unwrap()
}

fn record((time, input, output): (Vec<f64>, Vec<f64>, Vec<f64>)) -> Record {
    Record::new("r", vec![input], output).unwrap().with_time(time).unwrap()
}

fn dataset(columns: (Vec<f64>, Vec<f64>, Vec<f64>)) -> Dataset {
    named("t_s", vec![record(columns)])
}

/// A linear oscillator has no static hysteresis, does not wear, and its frequency is no hum of the mains.
#[test]
fn what_a_mass_makes_is_no_verdict_on_memory() {
    let diagnosis = Diagnosis::of(&dataset(linear()), &DiagnosisOptions::default()).unwrap();
    for property in [Property::StaticHysteresis, Property::Deterioration] {
        let finding = diagnosis.finding(property);
        assert_ne!(finding.verdict, Verdict::Yes, "{}", finding.statement);
    }
    assert!(diagnosis.doctor.iter().all(|issue| issue.kind != DataIssueKind::Hum), "{:?}", diagnosis.doctor);
    assert_eq!(
        diagnosis.advice.model.map(hysid_core::options::ModelName::name),
        Some("hysteretic-oscillator")
    );
}

fn complaint(data: &Dataset) -> Option<DataIssue> {
    let doctor = Diagnosis::of(data, &DiagnosisOptions::default()).unwrap().doctor;
    doctor.into_iter().find(|issue| issue.kind == DataIssueKind::Resonance)
}

#[test]
fn a_bouc_wen_oscillator_is_a_resonance() {
    let data = dataset(bouc_wen());
    let found = Resonance::of(&data).unwrap();
    assert!(found.is_found() && found.ratio < 0.4, "{found:?}");
    let told = complaint(&data).unwrap();
    // The stiffness 1e5 N/m at small amplitudes gives 35.6 Hz; the law hardens as it moves away from rest.
    assert!((35.6..45.0).contains(&told.value.unwrap()), "{told:?}");
    assert!(told.unit.as_deref() == Some("Hz") && told.statement.contains(" Hz (damping "), "{told:?}");
    assert_eq!(told.evidence[0].rows, (0, 2999));
    // A column of time without unit.
    let told = complaint(&named("t", data.records().to_vec())).unwrap();
    assert!(told.unit.is_none() && told.statement.contains("cycles per unit of time"), "{told:?}");
}

#[test]
fn a_linear_oscillator_is_found_exactly() {
    let columns = linear();
    let stiffness = 2.0 * square(TAU * 40.0);
    let damping_ratio = 10.0 / (2.0 * 2.0 * TAU * 40.0);
    let check = |data: &Dataset, scale: f64| {
        let found = Resonance::of(data).unwrap();
        let oscillator = found.oscillator;
        // Straight lines between rows make a force of 40 Hz weaker by 1 %.
        assert!((oscillator.natural_frequency / 40.0 - 1.0).abs() < 1e-4, "{oscillator:?}");
        assert!((oscillator.damping_ratio / damping_ratio - 1.0).abs() < 1e-2, "{oscillator:?}");
        assert!((oscillator.gain * stiffness / scale - 1.0).abs() < 2e-2, "{oscillator:?}");
        assert!((oscillator.offset / scale - 0.01).abs() < 1e-6, "{oscillator:?}");
        assert!(found.ratio < 1e-3 && found.is_found(), "{found:?}");
    };
    let moved = |scale: f64, blank: bool| -> Vec<f64> {
        let rows = columns.2.iter().enumerate();
        rows.map(|(k, y)| if blank && k % 3 == 0 { f64::NAN } else { scale * (y + 0.01) }).collect()
    };
    let (time, force, _) = columns.clone();
    check(&dataset((time.clone(), force.clone(), moved(1.0, false))), 1.0);
    check(&dataset((time.clone(), force.clone(), moved(1.0, true))), 1.0);
    check(&dataset((time.clone(), force.clone(), moved(1e90, false))), 1e90);
    // Two records that begin in the middle of the motion.
    let part = |rows: std::ops::Range<usize>| {
        let cut = |column: &[f64]| column[rows.clone()].to_vec();
        record((cut(&time), cut(&force), cut(&moved(1.0, false))))
    };
    check(&named("t_s", vec![part(300..900), part(901..1500)]), 1.0);
}

/// Each earthquake leaves it in another place, so that no linear oscillator fits its displacement.
#[test]
fn a_building_that_yields_is_a_resonance_in_the_changes() {
    let building = hysid_specimens::Specimen::named("shear-building").unwrap();
    for seed in 1..=4 {
        let data = building.train_with_seed(seed);
        let found = Resonance::of(&data).unwrap();
        assert!(found.is_found() && found.oscillator.compared == ComparedSignal::Changes, "{found:?}");
        // The elastic building has its first mode at 2 Hz; a building that yields and degrades is softer.
        assert!((0.7..2.0).contains(&found.oscillator.natural_frequency), "{found:?}");
        assert!(complaint(&data).unwrap().statement.contains("for the changes of the output"));
    }
}

/// A sweep through springs and sliders.
fn sliders() -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let time: Vec<f64> = (0..1200).map(|row| f64::from(row) / 400.0).collect();
    let input: Vec<f64> = time.iter().map(|t| sin(TAU * (0.5 * t + t * t)) * (1.0 - 0.1 * t)).collect();
    let mut output = vec![0.0; input.len()];
    for threshold in [0.15, 0.33, 0.62] {
        let slider = Stop::new(threshold).unwrap().run(&input);
        output.iter_mut().zip(slider).for_each(|(y, slider)| *y += slider);
    }
    (time, input, output)
}

#[test]
fn sliders_delays_and_hum_are_no_resonance() {
    let (time, input, output) = sliders();
    let found = |output: Vec<f64>| Resonance::of(&dataset((time.clone(), input.clone(), output))).unwrap();
    let ratio = found(output.clone()).ratio;
    assert!(ratio > 2.0, "{ratio}");
    // What swings without the input is nothing that a model of the input holds.
    for law in [&output, &input] {
        let hum = law.iter().zip(&time).map(|(y, t)| y + 0.2 * sin(TAU * 50.0 * t)).collect();
        assert!(!found(hum).is_found());
    }
    // A spring behind a dashpot comes late, and does not swing.
    let mut late = 0.0;
    let relaxed = input.iter().map(|x| {
        late += 0.05 * (x - late);
        late
    });
    let relaxed = found(relaxed.collect());
    assert!(!relaxed.is_found(), "{relaxed:?}");
}

#[test]
fn what_tells_nothing_is_not_compared() {
    let (time, input, output) = linear();
    let none = |data: &Dataset| assert!(Resonance::of(data).is_none());
    let rows = |count: usize| (time[..count].to_vec(), input[..count].to_vec(), output[..count].to_vec());
    none(&dataset(rows(199)));
    assert!(Resonance::of(&dataset(rows(200))).is_some());
    none(&dataset((time.clone(), vec![1.0; 1500], output.clone())));
    none(&dataset((time.clone(), input.clone(), vec![1.0; 1500])));
    none(&dataset((time.clone(), input.clone(), vec![f64::NAN; 1500])));
    let mut uneven = time.clone();
    uneven[700] += 0.002 / RATE;
    none(&dataset((uneven, input.clone(), output.clone())));
    none(&Dataset::from_slices(&input, &output).unwrap());
    let names = ColumnNames { time: Some("t_s".into()), ..ColumnNames::plain(2) };
    let two = Record::new("r", vec![input.clone(), output.clone()], output.clone()).unwrap();
    none(&Dataset::new(names, vec![two.with_time(time.clone()).unwrap()]).unwrap());
}

#[test]
fn large_and_small_values_are_compared_without_panic() {
    let (time, input, output) = linear();
    for scale in [1e100, 1e-100, 1e-290] {
        let scaled = |column: &[f64]| column.iter().map(|value| scale * value / 300.0).collect::<Vec<f64>>();
        let times: Vec<f64> = time.iter().map(|t| 0.1 * scale * t).collect();
        if let Some(found) = Resonance::of(&dataset((times, scaled(&input), scaled(&output)))) {
            assert!(found.ratio < 1e-3, "{scale}: {found:?}");
        }
    }
}

#[test]
fn specimens_without_inertia_are_no_resonance() {
    let mut compared = 0;
    for specimen in hysid_specimens::Specimen::of_the_paper() {
        let Some(found) = Resonance::of(&specimen.train()) else { continue };
        assert!(found.ratio > 0.8 && !found.is_found(), "{}: {found:?}", specimen.name);
        compared += 1;
    }
    assert!(compared >= 5, "{compared}");
}

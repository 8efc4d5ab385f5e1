//! Verdicts and complaints where the measurement is that of a real laboratory: coloured noise, hum, delays, drift, loops
//! that do not settle, laws that fade.

use super::subjects::{bouc_wen, m330, prandtl_ishlinskii, protocol};
use super::*;
use hysid::diagnosis::DataIssueKind;
use hysid_core::elementary::{cos, exp, ln, sin};

/// A record of the protocol's law, with what happens to each output.
fn record_of(x: &[f64], y: Vec<f64>, dt: f64) -> Dataset {
    let time = (0..x.len()).map(|row| row as f64 * dt).collect();
    let names = ColumnNames::of(Some("t"), &["x"], "y");
    let record = Record::new("r", vec![x.to_vec()], y).unwrap().with_time(time).unwrap();
    Dataset::new(names, vec![record]).unwrap()
}

fn steel(x: &[f64]) -> Vec<f64> {
    m330(x).records()[0].output().to_vec()
}

fn range(y: &[f64]) -> f64 {
    y.iter().copied().fold(f64::NEG_INFINITY, f64::max) - y.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Noise whose rows are correlated by 0.9, of deviation 1.
fn coloured(rows: usize, seed: u64) -> Vec<f64> {
    let mut generator = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut normal = move || {
        let (u, v): (f64, f64) = (generator.random(), generator.random());
        (-2.0 * ln(1.0 - u)).sqrt() * cos(TAU * v)
    };
    let mut value = normal();
    let next = |_| {
        value = 0.9 * value + 0.19f64.sqrt() * normal();
        value
    };
    (0..rows).map(next).collect()
}

fn diagnose(data: &Dataset) -> Diagnosis {
    Diagnosis::of(data, &DiagnosisOptions::default()).unwrap()
}

/// Properties that the diagnosis contradicts although a Preisach model has them.
fn contradicted(diagnosis: &Diagnosis) -> Vec<Property> {
    let of_memory = [Property::WipingOut, Property::Congruency, Property::LoopClosure, Property::OddSymmetry];
    of_memory.into_iter().filter(|property| diagnosis.verdict(*property) == Verdict::No).collect()
}

#[test]
fn coloured_noise_contradicts_no_memory() {
    let x = protocol();
    for (name, y) in [("Prandtl-Ishlinskii", prandtl_ishlinskii(&x)), ("Preisach", steel(&x))] {
        let height = range(&y);
        for seed in 1..=2 {
            let noisy = y.iter().zip(coloured(x.len(), seed)).map(|(y, e)| y + 0.01 * height * e);
            let diagnosis = diagnose(&record_of(&x, noisy.collect(), 0.01));
            assert_eq!(contradicted(&diagnosis), [], "{name}, seed {seed}");
            let noise = diagnosis.output_noise / height;
            assert!((0.005..0.03).contains(&noise), "{name}, seed {seed}: {noise}");
        }
    }
}

#[test]
fn coloured_noise_leaves_what_is_large_visible() {
    let x = protocol();
    let y = bouc_wen(&x).records()[0].output().to_vec();
    let height = range(&y);
    let seen = (1..=4).filter(|&seed| {
        let noisy = y.iter().zip(coloured(x.len(), seed)).map(|(y, e)| y + 0.003 * height * e);
        diagnose(&record_of(&x, noisy.collect(), 0.01)).verdict(Property::WipingOut) == Verdict::No
    });
    assert!(seen.count() >= 3);
}

#[test]
fn an_output_that_is_late_by_rows_is_named_and_contradicts_nothing() {
    let x = protocol();
    let rows = 1.5;
    let then: Vec<f64> = (0..x.len())
        .map(|row| {
            let place = (row as f64 - rows).max(0.0);
            let below = place as usize;
            x[below] + (place - below as f64) * (x[(below + 1).min(x.len() - 1)] - x[below])
        })
        .collect();
    for (name, y) in [("Prandtl-Ishlinskii", prandtl_ishlinskii(&then)), ("Preisach", steel(&then))] {
        let diagnosis = diagnose(&record_of(&x, y, 0.01));
        assert_eq!(contradicted(&diagnosis), [], "{name}, {rows} rows");
        // A lag that withholds verdicts is told; one that leaves them as they are may be.
        let lag = diagnosis.doctor.iter().any(|issue| issue.kind == DataIssueKind::Lag);
        let memory = [Property::WipingOut, Property::OddSymmetry, Property::LoopClosure];
        let withheld: Vec<Property> =
            memory.into_iter().filter(|p| diagnosis.verdict(*p) == Verdict::NotTestable).collect();
        assert!(lag || withheld.is_empty(), "{name}, {rows} rows: {withheld:?} {:#?}", diagnosis.doctor);
    }
}

#[test]
fn a_drift_is_named_and_contradicts_nothing() {
    let x = protocol();
    for (name, y) in [("Prandtl-Ishlinskii", prandtl_ishlinskii(&x)), ("Preisach", steel(&x))] {
        let (height, rows) = (range(&y), x.len() as f64);
        let drifting = y.iter().enumerate().map(|(row, y)| y + 0.04 * height * row as f64 / rows);
        let diagnosis = diagnose(&record_of(&x, drifting.collect(), 0.01));
        assert_eq!(contradicted(&diagnosis), [], "{name}");
        let drift = diagnosis.doctor.iter().find(|issue| issue.kind == DataIssueKind::Drift);
        assert!(drift.is_some(), "{name}: {:#?}", diagnosis.doctor);
    }
}

#[test]
fn hum_is_named() {
    let x = protocol();
    let y = steel(&x);
    let height = range(&y);
    let humming = y.iter().enumerate().map(|(row, y)| y + 0.005 * height * sin(TAU * row as f64 / 11.3));
    let diagnosis = diagnose(&record_of(&x, humming.collect(), 0.01));
    let hum = diagnosis.doctor.iter().find(|issue| issue.kind == DataIssueKind::Hum).expect("hum");
    assert!((hum.value.unwrap() / (0.005 * height) - 1.0).abs() < 0.3, "{hum:?}");
    assert_eq!(contradicted(&diagnosis), []);
}

/// A spring and a dashpot in series, and one with another spring beside it, have no loop at rest.
#[test]
fn loops_of_a_relaxation_are_not_called_static() {
    let dt = 0.01;
    let wave = |row: usize| sin(TAU * 0.2 * row as f64 * dt) * (0.4 + 0.6 * row as f64 / 4000.0);
    let x: Vec<f64> = (0..4000).map(wave).collect();
    for beside in [0.0, 1.0] {
        let mut force = 0.0;
        let mut y = vec![0.0];
        for pair in x.windows(2) {
            let kept = exp(-dt / 0.5);
            force = kept * force + (pair[1] - pair[0]) * (1.0 - kept) * 0.5 / dt;
            y.push(force + beside * pair[1]);
        }
        let diagnosis = diagnose(&record_of(&x, y, dt));
        assert_ne!(diagnosis.verdict(Property::StaticHysteresis), Verdict::Yes, "spring {beside}");
    }
}

/// `k x + c x'` leads its input: the law depends on the rate, and nothing is late.
#[test]
fn a_lead_is_no_delay() {
    let data = super::subjects::at_three_speeds(|x| x.to_vec(), 1e-3, 0.0);
    let records = data.records().iter().map(|record| {
        let (x, time) = (&record.inputs()[0], record.time().unwrap());
        let rate = |row: usize| {
            let (before, after) = (row.saturating_sub(1), (row + 1).min(x.len() - 1));
            (x[after] - x[before]) / (time[after] - time[before])
        };
        let y = (0..x.len()).map(|row| x[row] + 0.01 * rate(row)).collect();
        record.clone().with_output(y).unwrap()
    });
    let damped = Dataset::new(data.names().clone(), records.collect()).unwrap();
    let diagnosis = diagnose(&damped);
    assert_eq!(diagnosis.verdict(Property::RateDependence), Verdict::Yes);
    assert_eq!(diagnosis.delay, None);
}

/// Repeats with one past say nothing about congruency: the beginning of a record is no turning point.
#[test]
fn one_loop_again_and_again_is_not_congruent() {
    let swing = |row: usize| sin(TAU * row as f64 / 200.0);
    let x: Vec<f64> = (0..2000).map(swing).collect();
    let diagnosis = diagnose(&record_of(&x, steel(&x), 0.01));
    assert_eq!(diagnosis.verdict(Property::Congruency), Verdict::NotTestable);
}

#[test]
fn what_is_clipped_is_named_and_left_out() {
    let x = protocol();
    let y = prandtl_ishlinskii(&x);
    let limit = 0.9 * y.iter().copied().fold(0.0, f64::max);
    let clipped = y.iter().map(|y| y.clamp(-limit, limit)).collect();
    let diagnosis = diagnose(&record_of(&x, clipped, 0.01));
    assert!(diagnosis.doctor.iter().any(|issue| issue.kind == DataIssueKind::OutputClipped));
    assert_eq!(contradicted(&diagnosis), []);
    assert_ne!(diagnosis.verdict(Property::Masing), Verdict::No);
}

//! Verdicts on laws whose properties are known, without noise and with, theory.md section 10.

mod subjects;

use hysid::diagnosis::{Diagnosis, DiagnosisOptions, Property, Verdict};
use hysid::plant::with_noise;
use hysid::record::Dataset;
use rayon::prelude::*;

use subjects::{Subject, laws, specimens, timed};

fn all() -> Vec<Subject> {
    laws().into_iter().chain(timed()).chain(specimens()).collect()
}

/// The data with noise of so many percent of the output's range.
fn noisy(data: &Dataset, percent: f64, seed: u64) -> Dataset {
    if percent == 0.0 {
        return data.clone();
    }
    let output: Vec<f64> =
        data.records().iter().flat_map(|record| record.output()).copied().filter(|y| !y.is_nan()).collect();
    let n = output.len() as f64;
    let mean = output.iter().sum::<f64>() / n;
    let deviation = (output.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n).sqrt();
    let (low, high) = data.output_range();
    with_noise(data, percent * (high - low) / deviation, seed).unwrap()
}

/// How often a verdict was right, wrong, or not given.
#[derive(Debug, Default, Clone, Copy)]
struct Count {
    right: usize,
    wrong: usize,
    none: usize,
}

/// Counts of all properties of a subject over seeds.
fn counts(subject: &Subject, percent: f64, seeds: u64) -> Vec<(Property, Count)> {
    let diagnoses: Vec<Diagnosis> = (1..=seeds)
        .into_par_iter()
        .map(|seed| {
            Diagnosis::of(&noisy(&subject.data, percent, seed), &DiagnosisOptions::default()).unwrap()
        })
        .collect();
    let count = |property: Property| {
        let mut count = Count::default();
        for diagnosis in &diagnoses {
            match (diagnosis.verdict(property), (subject.truth)(property)) {
                (Verdict::NotTestable, _) => count.none += 1,
                (Verdict::Yes, Some(false)) | (Verdict::No, Some(true)) => {
                    count.wrong += 1;
                    if count.wrong < 3 {
                        let f = diagnosis.finding(property);
                        println!(
                            "  wrong {} {percent} {property}: {:?} {:?} {:?} {}",
                            subject.name, f.index, f.threshold, f.noise, f.comparisons
                        );
                    }
                }
                _ => count.right += 1,
            }
        }
        count
    };
    Property::ALL.into_iter().map(|property| (property, count(property))).collect()
}

#[test]
fn no_verdict_is_wrong_without_noise() {
    let wrong: Vec<String> = all()
        .iter()
        .flat_map(|subject| {
            let of = counts(subject, 0.0, 1).into_iter().filter(|(property, count)| {
                count.wrong > 0 || count.none > 0 && subject.testable.contains(property)
            });
            of.map(|(property, count)| format!("{}: {property} {count:?}", subject.name)).collect::<Vec<_>>()
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Prints the table of `docs/diagnosis.md`: `cargo test --release -p hysid --test diagnosis -- --nocapture table`.
#[test]
fn the_table_of_verdicts_under_noise() {
    const SEEDS: u64 = 50;
    let mut ok = true;
    for percent in [0.5, 2.0] {
        println!("\nNoise of {percent} % of the range, {SEEDS} seeds: right / wrong / not testable\n");
        let (mut right, mut wrong, mut none, mut lost) = (0, 0, 0, Vec::new());
        for subject in all() {
            let counts = counts(&subject, percent, SEEDS);
            let cells: Vec<String> = counts
                .iter()
                .map(|(property, count)| match (subject.truth)(*property) {
                    Some(_) => format!("{}/{}/{}", count.right, count.wrong, count.none),
                    None => "-".into(),
                })
                .collect();
            println!("| {} | {} |", subject.name, cells.join(" | "));
            for (property, count) in counts {
                if (subject.truth)(property).is_some() {
                    right += count.right;
                    wrong += count.wrong;
                    none += count.none;
                    if subject.testable.contains(&property) && count.none > 0 || count.wrong > 0 {
                        lost.push(format!("{}: {property} {count:?}", subject.name));
                    }
                }
            }
        }
        println!("\n{right} right, {wrong} wrong, {none} not testable");
        println!("{lost:#?}");
        let allowed = if percent < 1.0 { 0.0 } else { 0.02 };
        ok &= wrong as f64 <= allowed * (right + wrong) as f64;
    }
    assert!(ok);
}

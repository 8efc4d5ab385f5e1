//! Fits of synthetic data that the library's own operators generate, and what every fit promises.

use crate::scaffold::*;
use hysid::fit::network::fit;
use hysid::model::history::{Phase, Run};
use hysid::options::network::Regularisation;
use hysid_core::elementary::{cos, exp, ln, sin, tanh};

/// A path between random turning points, in unequal steps.
fn path(rows: usize, amplitude: f64, seed: u64) -> Vec<f64> {
    let mut generator = Generator::seed_from_u64(seed);
    let (mut x, mut path) = (0.0, Vec::new());
    while path.len() < rows {
        let to = amplitude * (2.0 * generator.random::<f64>() - 1.0);
        let steps = 8 + (generator.random::<u64>() % 8) as usize;
        path.extend((0..steps).map(|k| x + (to - x) * k as f64 / steps as f64));
        x = to;
    }
    path.truncate(rows);
    path
}

fn dataset(records: Vec<Record>) -> Dataset {
    Dataset::new(ColumnNames::plain(records[0].inputs().len()), records).unwrap()
}

/// Three stops and a linear spring.
fn bank(x: &[f64]) -> Vec<f64> {
    let mut y: Vec<f64> = x.iter().map(|x| 40.0 + 0.7 * x).collect();
    for (threshold, weight) in [(0.5, 3.0), (2.0, 1.0), (4.0, -0.5)] {
        let stop = Stop::new(threshold).unwrap().run(x);
        y.iter_mut().zip(stop).for_each(|(y, z)| *y += weight * z);
    }
    y
}

fn bank_data(rows: usize) -> Dataset {
    let x = path(rows, 6.0, 11);
    dataset(vec![Record::new("bank", vec![x.clone()], bank(&x)).unwrap()])
}

fn small(model: Family, stops: usize, hidden: usize) -> FitOptions {
    let sizes = Sizes { stops, hidden, relaxation: 1 };
    FitOptions { model, sizes, starts: 3, epochs: 15, ..FitOptions::default() }
}

fn quietly(data: &Dataset, options: &FitOptions) -> Fitted {
    fit(data, options, &mut |_| ControlFlow::Continue(())).unwrap()
}

fn nrmse(fit: &Fitted, data: &Dataset) -> f64 {
    error_percent(&fit.model, data)
}

/// Parameters and output weights, to the last bit.
fn bits(fit: &Fitted) -> Vec<u64> {
    let network = fit.model.network().unwrap();
    network.parameters().iter().chain(network.output()).map(|value| value.to_bits()).collect()
}

#[test]
fn a_bank_of_stops_is_found() {
    let data = bank_data(600);
    let error = nrmse(&quietly(&data, &FitOptions { epochs: 30, ..small(Family::Pnn, 6, 0) }), &data);
    assert!(error < 1.0, "{error} %");
    // One stop cannot be three: the figure above is no matter of course.
    let one = nrmse(&quietly(&data, &FitOptions { epochs: 30, ..small(Family::Pnn, 1, 0) }), &data);
    assert!(one > 2.0, "{one} %");
}

#[test]
fn a_network_of_the_family_is_found_and_carries_on() {
    let sizes = Sizes { stops: 3, hidden: 2, relaxation: 0 };
    let architecture = Architecture::new(Family::Xpnn, sizes, 1, false, false).unwrap();
    let ln_beta = [60f64, 100.0, 1000.0].map(ln);
    let mut parameters = vec![4.0, 2.0, 1.2];
    parameters.extend(ln_beta);
    parameters.extend([0.8]);
    parameters.extend([0.2, 0.9, 0.5, -0.3, 0.6, -0.4, -0.5, 0.4, 0.8, 0.3]);
    let source = Network::new(architecture, parameters, vec![1.0, 2.0, -1.5]).unwrap();
    let x = path(1200, 1.0, 5);
    let mut y = vec![0.0; x.len()];
    source.simulator().run(&[&x], &[], &mut y);

    let part =
        |rows: usize, y: Vec<f64>| dataset(vec![Record::new("r", vec![x[..rows].to_vec()], y).unwrap()]);
    let train = part(800, y[..800].to_vec());
    let held_out =
        part(1200, y.iter().enumerate().map(|(k, &y)| if k < 800 { f64::NAN } else { y }).collect());
    let options = FitOptions { starts: 6, epochs: 80, ..small(Family::Xpnn, 8, 5) };
    let fitted = quietly(&train, &options);
    let (trained, continued) = (nrmse(&fitted, &train), nrmse(&fitted, &held_out));
    assert!(trained < 1.0 && continued < 3.0, "{trained} %, {continued} %");
    // Stops that never wear out cannot follow.
    let eternal = quietly(&train, &FitOptions { no_deterioration: true, ..options });
    assert!(!eternal.model.network().unwrap().architecture().deterioration);
    assert!(nrmse(&eternal, &held_out) > 3.0, "{} %", nrmse(&eternal, &held_out));
}

/// Two records of one specimen that stiffens with speed, at two speeds.
fn two_speeds() -> Dataset {
    let record = |step: f64| {
        let x: Vec<f64> =
            (0..220).map(|k| sin(0.2 * k as f64) * (0.5 + 0.5 * cos(0.03 * k as f64))).collect();
        let mut stop = Stop::new(0.3).unwrap();
        let y = (0..220)
            .map(|k| {
                let speed = if k == 0 { 0.0 } else { (x[k] - x[k - 1]) / step };
                stop.step(x[k]) + 0.4 * tanh(speed)
            })
            .collect();
        let time = (0..220).map(|k| step * k as f64).collect();
        Record::new(format!("step {step}"), vec![x], y).unwrap().with_time(time).unwrap()
    };
    dataset(vec![record(0.1), record(1.0)])
}

#[test]
fn the_rate_tells_two_speeds_apart() {
    let data = two_speeds();
    let with = FitOptions { rate: Some(RateMethod::Backward), ..small(Family::Xpnn, 4, 3) };
    let error = |options: &FitOptions| nrmse(&quietly(&data, options), &data);
    let (without, with) = (error(&FitOptions { rate: None, ..with.clone() }), error(&with));
    assert!(with < 5.0 && without > 20.0, "{with} %, {without} %");
}

/// Progress report of the observer.
struct TrainingReport {
    phase: Phase,
    start: usize,
    epoch: usize,
    train_nrmse_percent: f64,
    done: f64,
}

impl TrainingReport {
    fn of(progress: &Progress) -> Self {
        let &Progress { phase, start, epoch, train_nrmse_percent, done, .. } = progress;
        Self { phase, start, epoch, train_nrmse_percent, done }
    }
}

#[test]
fn the_observer_sees_the_share_of_the_work_grow() {
    let data = bank_data(150);
    let options = small(Family::PreisachNn, 3, 2);
    let mut seen: Vec<TrainingReport> = Vec::new();
    let fitted = fit(&data, &options, &mut |progress: &Progress| {
        seen.push(TrainingReport::of(progress));
        ControlFlow::Continue(())
    });
    assert!(seen.len() > 20);
    assert!(seen.windows(2).all(|pair| pair[0].done <= pair[1].done));
    assert!(seen.iter().all(|progress| (0.0..=1.0).contains(&progress.done)));
    assert!(seen.last().unwrap().done > 0.7 && seen[0].done < 0.1);
    let starts = seen.iter().filter(|progress| progress.phase == Phase::AllData);
    assert_eq!(starts.map(|progress| progress.start).max(), Some(options.starts - 1));
    // What was told is what the history keeps; of the starts on everything it keeps one.
    for run in &fitted.unwrap().model.provenance().runs {
        let mut told = seen
            .iter()
            .filter(|progress| (progress.phase, progress.start) == (run.phase, run.start))
            .map(|progress| (progress.epoch, progress.train_nrmse_percent));
        for point in &run.history[1..] {
            assert!(told.any(|told| told == (point.epoch, point.train_nrmse_percent)), "{point:?}");
        }
    }
}

/// Stops after so many calls, with one thread, so that the calls come start by start.
fn stopped_after(calls: usize, data: &Dataset, options: &FitOptions) -> (Fitted, usize) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let mut seen = 0;
    let fitted = pool.install(|| {
        fit(data, options, &mut |_| {
            seen += 1;
            if seen == calls { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    });
    (fitted.unwrap(), seen)
}

#[test]
fn a_fit_that_is_stopped_is_usable() {
    let data = bank_data(150);
    let options = FitOptions { starts: 3, epochs: 4, ..small(Family::PreisachNn, 3, 2) };
    for calls in [1, 3, 6, 9, 18] {
        let (fitted, seen) = stopped_after(calls, &data, &options);
        assert_eq!(seen, calls, "the observer was called again after it said stop");
        assert_eq!(fitted.model.provenance().termination, Termination::Stopped);
        assert!(nrmse(&fitted, &data) < 120.0);
        let file = fitted.model.to_json();
        assert_eq!(hysid::model::Model::from_json(&file).unwrap(), fitted.model);
    }
}

#[test]
fn training_never_worsens_and_begins_no_worse_than_the_mean() {
    let data = bank_data(300);
    // Without penalties the error is the objective.
    for family in Family::ALL {
        let options = FitOptions { ridge: Some(0.0), decay: Some(0.0), ..small(family, 3, 2) };
        let fitted = quietly(&data, &options);
        for run in &fitted.model.provenance().runs {
            let errors: Vec<f64> = run.history.iter().map(|point| point.train_nrmse_percent).collect();
            assert!(errors.len() > 2, "{family:?}: no iteration");
            assert!(errors.windows(2).all(|pair| pair[1] <= pair[0]), "{family:?}: {errors:?}");
            // Percent of the deviation of what the run was trained on.
            assert!(errors[0] <= 100.0 + 1e-9, "{family:?}: {errors:?}");
        }
        let refit = fitted.model.provenance().runs.last().unwrap();
        let last = refit.history.last().unwrap().train_nrmse_percent;
        let run = nrmse(&fitted, &data);
        assert!((last - run).abs() < 1e-4 * run, "{family:?}: history {last} %, free run {run} %");
    }
}

#[test]
fn many_rows_are_thinned_with_little_loss() {
    let data = bank_data(3000);
    let options = FitOptions { starts: 2, ..small(Family::Pnn, 5, 0) };
    let whole = quietly(&data, &options);
    let thinned = quietly(&data, &FitOptions { thin: 250, ..options.clone() });
    assert_ne!(bits(&whole), bits(&thinned));
    let (whole, thinned) = (nrmse(&whole, &data), nrmse(&thinned, &data));
    assert!(thinned < 1.5 * whole + 0.5, "{thinned} %, not {whole} %");
    // As many rows as the limit are not thinned at all.
    let limit = quietly(&data, &FitOptions { thin: 3000, ..options.clone() });
    assert_eq!(bits(&limit), bits(&quietly(&data, &options)));
}

#[test]
fn data_are_held_out_unless_they_are_too_few() {
    let options = FitOptions { starts: 7, epochs: 3, ..small(Family::Pnn, 2, 0) };
    let data = bank_data(100);
    let held = quietly(&data, &options);
    let provenance = held.model.provenance();
    // A single record is cut into five folds; from row 0 to the end, every row is held out of one of them.
    assert_eq!(provenance.validation.as_ref().unwrap().samples, 100);
    let (on_folds, on_all): (Vec<&Run>, Vec<&Run>) =
        provenance.runs.iter().partition(|run| run.phase == Phase::Starts);
    assert_eq!(on_folds.len(), 5 * 3);
    assert_eq!((on_all.len(), on_all[0].start), (1, provenance.chosen_start));
    assert!(on_folds.iter().all(|run| run.validation_nrmse_percent.is_some() && run.fold.is_some()));

    // The share that is asked for takes the place of the folds.
    let share = quietly(&data, &FitOptions { validation: Some(0.25), ..options.clone() });
    assert_eq!(share.model.provenance().validation.as_ref().unwrap().samples, 25);

    let few = quietly(&bank_data(12), &options);
    assert_eq!(few.model.provenance().validation, None);
    assert!(few.model.provenance().runs.iter().all(|run| run.validation_nrmse_percent.is_none()));
}

/// The validation is that of [`cross_validate`], also if the largest values are in one record only.
#[test]
fn validation_is_that_of_a_cross_validation() {
    let record = |name: &str, size: f64, offset: f64| {
        let x = path(60, size, 5);
        let y = bank(&x).iter().map(|y| y + offset).collect();
        Record::new(name, vec![x], y).unwrap()
    };
    let data = dataset(vec![record("a", 1.0, 0.0), record("b", 1.4, 0.0), record("c", 7.0, 300.0)]);
    let options = FitOptions { starts: 3, epochs: 6, ridge: Some(1e-6), ..small(Family::Pnn, 3, 0) };
    let validation = quietly(&data, &options).model.provenance().validation.clone().unwrap();
    let expected = cross_validate(&data, &FitSpec::Network(options), 5, &mut |_| ControlFlow::Continue(()));
    let expected = expected.unwrap().unseen;
    assert_eq!(validation.samples, 180);
    assert!((validation.rmse - expected.rmse).abs() < 1e-9 * expected.rmse, "{validation:?} {expected:?}");
}

/// Networks of the paper with a linear readout find their own parameters in data without noise.
#[test]
fn pnn_and_gpnn_find_their_own_parameters() {
    let x: Vec<f64> = (0..900)
        .map(|k| {
            let t = 0.02 * f64::from(k);
            (0.3 + 0.07 * t) * sin(2.0 * t) + 0.2 * sin(5.3 * t)
        })
        .collect();
    // Threshold, capacity, weight.
    let elements = [(0.1, 30.0, 2.0), (0.3, 60.0, 1.5), (0.8, 150.0, -0.7)];
    for family in [Family::Pnn, Family::Gpnn] {
        let deteriorates = family == Family::Gpnn;
        let mut y = vec![0.25; x.len()];
        for (threshold, capacity, weight) in elements {
            let z: Vec<f64> = match deteriorates {
                true => DeterioratingStop::new(threshold, capacity).unwrap().run(&x),
                false => Stop::new(threshold).unwrap().run(&x),
            };
            y.iter_mut().zip(z).for_each(|(y, z)| *y += weight * z);
        }
        let data = dataset(vec![Record::new("r", vec![x.clone()], y).unwrap()]);
        let options = FitOptions { starts: 8, epochs: 150, ..small(family, 3, 0) };
        let fitted = quietly(&data, &options);
        let provenance = fitted.model.provenance();
        assert!(provenance.penalties.unwrap().ridge < 1e-9, "{family:?}: {:?}", provenance.penalties);
        let network = fitted.model.network().unwrap();
        let layout = ParameterLayout::new(*network.architecture());
        let scale = fitted.model.scaling().unwrap().inputs[0];
        let parameters = network.parameters();
        let mut found: Vec<(f64, f64)> = (0..3)
            .map(|stop| {
                let threshold = scale / parameters[layout.stop_weights.clone()][stop].abs();
                let capacity = parameters[layout.ln_beta.clone()].get(stop).map_or(0.0, |ln| exp(*ln));
                (threshold, capacity * threshold)
            })
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        for ((threshold, capacity), expected) in found.into_iter().zip(elements) {
            assert!((threshold / expected.0 - 1.0).abs() < 1e-4, "{family:?}: {threshold} for {expected:?}");
            let capacity = capacity / (if deteriorates { threshold } else { 1.0 });
            let is_found = !deteriorates || (capacity / expected.1 - 1.0).abs() < 1e-3;
            assert!(is_found, "{family:?}: {capacity} for {expected:?}");
        }
        assert!(nrmse(&fitted, &data) < 1e-4, "{family:?}: {} %", nrmse(&fitted, &data));
    }
}

/// Noise asks for penalties, and those that were asked for stay.
#[test]
fn penalties_stay_where_there_is_noise_or_they_were_asked_for() {
    let data = with_noise(&bank_data(200), 3.0, 7).unwrap();
    let options = FitOptions { starts: 2, epochs: 400, ..small(Family::PreisachNn, 4, 4) };
    assert_eq!(quietly(&data, &options).model.provenance().penalties, Some(Regularisation::default()));
    let asked = FitOptions { ridge: Some(1e-3), ..options };
    let penalties = Regularisation { ridge: 1e-3, ..Regularisation::default() };
    assert_eq!(quietly(&bank_data(200), &asked).model.provenance().penalties, Some(penalties));
}

#[test]
fn options_outside_their_meaning_are_refused() {
    let data = bank_data(60);
    let good = FitOptions { starts: 1, epochs: 1, ..small(Family::Xpnn, 2, 2) };
    let refused = |options: &FitOptions| {
        let error = fit(&data, options, &mut |_| ControlFlow::Continue(())).err()?;
        Some(error.to_string())
    };
    assert_eq!(refused(&good), None);
    let sizes = good.sizes;
    let bad = [
        ("stop", FitOptions { sizes: Sizes { stops: 0, ..sizes }, ..good.clone() }),
        ("hidden", FitOptions { sizes: Sizes { hidden: 0, ..sizes }, ..good.clone() }),
        ("stops", FitOptions { sizes: Sizes { stops: 1001, ..sizes }, ..good.clone() }),
        ("starts", FitOptions { starts: 0, ..good.clone() }),
        ("starts", FitOptions { starts: 10_001, ..good.clone() }),
        ("validation", FitOptions { validation: Some(0.0), ..good.clone() }),
        ("validation", FitOptions { validation: Some(1.0), ..good.clone() }),
        ("validation", FitOptions { validation: Some(f64::NAN), ..good.clone() }),
        ("ridge", FitOptions { ridge: Some(-1.0), ..good.clone() }),
        ("decay", FitOptions { decay: Some(f64::NAN), ..good.clone() }),
        ("time", FitOptions { rate: Some(RateMethod::Central), ..good.clone() }),
        ("measured rate", FitOptions { rate: Some(RateMethod::Given), ..good.clone() }),
    ];
    for (word, options) in bad {
        let text = refused(&options).unwrap_or_else(|| panic!("accepted: {options:?}"));
        assert!(text.contains(word), "{text:?} does not speak of {word}");
    }
}

#[test]
fn any_number_of_epochs_is_a_number_or_an_error() {
    let options = FitOptions { starts: 2, epochs: usize::MAX, ..small(Family::Pnn, 1, 0) };
    let mut calls = 0;
    let _ = fit(&bank_data(40), &options, &mut |progress: &Progress| {
        assert!((0.0..=1.0).contains(&progress.done));
        calls += 1;
        if calls == 5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
}

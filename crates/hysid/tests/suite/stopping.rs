//! A stop is heard in the midst of all long work, and harms nothing.

use crate::scaffold::*;
use std::time::{Duration, Instant};

use hysid::Error;
use hysid::fit::network::{fit, resume};
use hysid::fit::progress::Checkpoint;
use hysid_core::elementary::sin;
use serde_json::json;

/// After so long a fit is asked to stop.
const LIMIT: Duration = Duration::from_millis(300);

/// A fit that takes longer does not listen: far more than the half second that is promised, for a busy machine.
const GENEROUS: Duration = Duration::from_secs(5);

/// A play with noise: every row turns, so that no row can be left out.
fn noisy(rows: usize, records: usize) -> Dataset {
    let mut state = 1u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1u64 << 31) as f64 - 0.5
    };
    let record = |index: usize| {
        let x: Vec<f64> = (0..rows).map(|k| sin(0.004 * k as f64) + 0.01 * noise()).collect();
        let mut play: f64 = 0.0;
        let y = x.iter().map(|x| {
            play = play.clamp(x - 0.3, x + 0.3);
            0.5 * x + play
        });
        let (y, time) = (y.collect(), (0..rows).map(|k| 0.01 * k as f64).collect());
        Record::new(format!("r{index}"), vec![x], y).unwrap().with_time(time).unwrap()
    };
    Dataset::new(ColumnNames::plain(1), (0..records).map(record).collect()).unwrap()
}

fn request(options: serde_json::Value) -> FitSpec {
    named(options).unwrap().request(Some(RateMethod::Central), false)
}

fn assert_stops_soon(data: &Dataset, request: &FitSpec) {
    let began = Instant::now();
    let mut observer = |_: &Progress| match began.elapsed() >= LIMIT {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let fitted = identify(data, request, &mut observer);
    let elapsed = began.elapsed();
    let what = request.label();
    assert!(elapsed < GENEROUS, "{what}: {elapsed:?}");
    match fitted {
        Ok(fitted) if elapsed >= LIMIT => {
            let errors = fitted.model.provenance().train.clone();
            assert!(errors.rmse.is_finite(), "{what}");
        }
        Ok(_) | Err(Error::Stopped) => {}
        Err(error) => panic!("{what}: {error}"),
    }
}

#[test]
fn every_model_stops_in_the_midst_of_its_fit() {
    let long = noisy(200_000, 1);
    for model in ModelName::all().chain([ModelName::AUTO]) {
        assert_stops_soon(&long, &request(json!({ "model": model.name() })));
    }
}

#[test]
fn large_models_stop_too() {
    let long = noisy(30_000, 1);
    for options in [
        json!({ "model": "xpnn+", "relaxation": 1000 }),
        json!({ "model": "xpnn", "training": "genetic", "population": 10_000 }),
        json!({ "model": "xpnn", "training": "subgradient", "stops": 60, "hidden": 60 }),
        json!({ "model": "preisach", "operators": 60 }),
        json!({ "model": "random-stops", "operators": 1000, "hidden": 1000 }),
        json!({ "model": "modified-prandtl-ishlinskii", "operators": 300 }),
        json!({ "model": "bouc-wen", "degradation": true, "starts": 1000 }),
    ] {
        assert_stops_soon(&long, &request(options));
    }
}

#[test]
fn many_records_stop_too() {
    let many = noisy(40, 3000);
    for model in ["preisach", "jiles-atherton", "random-stops", "auto"] {
        assert_stops_soon(&many, &request(json!({ "model": model })));
    }
}

/// A search that is stopped in the midst of its first round gives a model.
#[test]
fn a_search_that_is_stopped_early_gives_its_best_point() {
    let data = noisy(3000, 1);
    let mut asked = 0;
    let mut after_some = |_: &Progress| {
        asked += 1;
        if asked > 300 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let fitted = identify(&data, &request(json!({ "model": "jiles-atherton" })), &mut after_some).unwrap();
    assert_eq!(fitted.model.provenance().termination, Termination::Stopped);
    assert!(fitted.model.provenance().train.nrmse_std_percent.unwrap() < 100.0);
}

/// Wherever a fit is broken off, it goes on to the very model that it would have come to.
#[test]
fn a_fit_broken_off_in_the_midst_of_a_round_goes_on_as_if_nothing_had_happened() {
    let data = noisy(6000, 1);
    let sizes = hysid_core::network::Sizes { stops: 12, hidden: 12, relaxation: 2 };
    let options =
        FitOptions { starts: 2, epochs: 3, sizes, rate: Some(RateMethod::Central), ..FitOptions::default() };
    let mut calls = 0;
    let whole = fit(&data, &options, &mut |_| {
        calls += 1;
        ControlFlow::Continue(())
    })
    .unwrap()
    .model;
    let mut in_the_midst = 0;
    for share in [0.1, 0.37, 0.62, 0.9] {
        let last = (share * f64::from(calls)) as i32;
        let (mut call, mut kept): (i32, Option<Checkpoint>) = (0, None);
        let stopped = fit(&data, &options, &mut |progress| {
            call += 1;
            kept = progress.checkpoint().or(kept.take());
            if call < last {
                return ControlFlow::Continue(());
            }
            in_the_midst += i32::from(call == last && progress.checkpoint().is_none());
            ControlFlow::Break(())
        });
        let (Ok(stopped), Some(kept)) = (stopped, kept) else { continue };
        assert_eq!(stopped.model.provenance().termination, Termination::Stopped);
        let resumed = resume(&data, kept, &mut |_| ControlFlow::Continue(())).unwrap().model;
        assert_eq!(resumed, whole, "broken off at {last} of {calls}");
    }
    assert!(in_the_midst > 0, "no fit was broken off in the midst of a round: {calls} calls");
}

/// Without time for a first model there is a clear error, and no panic.
#[test]
fn a_fit_that_may_not_begin_says_so() {
    let data = noisy(20_000, 1);
    for model in ModelName::all() {
        let outcome =
            identify(&data, &request(json!({ "model": model.name() })), &mut |_| ControlFlow::Break(()));
        if let Err(error) = outcome {
            assert_eq!(error, Error::Stopped, "{}", model.name());
        }
    }
    assert!(Error::Stopped.to_string().contains("allow more time"));
}

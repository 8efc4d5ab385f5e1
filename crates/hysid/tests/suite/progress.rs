//! Observers of a fit: the best model so far, and the candidates of `auto`.

use crate::scaffold::*;
use std::collections::BTreeMap;

use hysid::fit::progress::Standing;
use hysid::model::history::Phase;
use serde_json::json;

use crate::noisy_record::noisy;

fn data() -> Dataset {
    Dataset::new(ColumnNames::plain(1), vec![noisy(150, "a"), noisy(110, "b"), noisy(130, "c")]).unwrap()
}

/// A fit with the models that an observer sees on the way.
fn seen(
    data: &Dataset,
    request: &FitSpec,
    wanted: impl Fn(&Progress) -> bool + Sync,
) -> (Fitted, Vec<Model>) {
    let mut models = Vec::new();
    let fitted = identify(data, request, &mut |progress| {
        if wanted(progress) {
            models.extend(progress.model_so_far());
        }
        ControlFlow::Continue(())
    });
    (fitted.unwrap(), models)
}

fn simulated(model: &Model, data: &Dataset) -> Vec<Vec<f64>> {
    data.records().iter().map(|record| model.simulate(record).unwrap()).collect()
}

#[test]
fn the_last_network_so_far_is_the_one_that_is_finished() {
    let data = data();
    for trainer in ["levenberg-marquardt", "genetic", "subgradient", "hybrid"] {
        let request = request(json!({
            "model": "xpnn", "training": trainer, "starts": 1, "epochs": 12, "operators": 3, "hidden": 2
        }));
        let (fitted, models) = seen(&data, &request, |progress| progress.phase == Phase::AllData);
        let last = models.last().expect("there was a model on the way");
        assert_eq!(simulated(last, &data), simulated(&fitted.model, &data), "{trainer}");
        assert_eq!(last.provenance().termination, Termination::Stopped);
        assert_eq!(&Model::from_json(&last.to_json()).unwrap(), last);
    }
}

#[test]
fn several_starts_show_the_best_of_them() {
    let data = data();
    let request = request(json!({"model": "xpnn", "starts": 4, "epochs": 6, "operators": 3, "hidden": 2}));
    let (fitted, models) = seen(&data, &request, |_| true);
    // Also while folds are fitted to, it is the network for all data.
    assert!(models.len() > 4 * 6);
    let ranges = |model: &Model| model.trained_ranges().inputs[0];
    assert!(models.iter().all(|model| ranges(model) == ranges(&fitted.model)));
    assert_eq!(simulated(models.last().unwrap(), &data), simulated(&fitted.model, &data));
}

#[test]
fn whether_models_are_asked_for_does_not_change_the_fit() {
    let data = data();
    for model in ["xpnn", "bouc-wen"] {
        let request = request(json!({"model": model, "starts": 2, "epochs": 5}));
        let (with, models) = seen(&data, &request, |_| true);
        let (without, none) = seen(&data, &request, |_| false);
        assert!(!models.is_empty() && none.is_empty());
        assert_eq!(with.model.to_json(), without.model.to_json());
    }
}

#[test]
fn the_last_law_so_far_is_the_one_that_is_found() {
    let data = data();
    for model in
        ["bouc-wen", "generalized-prandtl-ishlinskii", "jiles-atherton", "duhem-nn", "neuro-madelung"]
    {
        let request = request(json!({"model": model, "starts": 2, "epochs": 6}));
        let (fitted, models) = seen(&data, &request, |_| true);
        let last = models.last().expect("there was a law on the way");
        assert_eq!(simulated(last, &data), simulated(&fitted.model, &data), "{model}");
        assert_eq!(last.provenance().runs[0].history, fitted.model.provenance().runs[0].history);
    }
}

#[test]
fn a_search_that_is_stopped_gives_the_law_that_was_shown() {
    let data = data();
    for model in ["bouc-wen", "duhem-nn", "neuro-madelung", "hysteretic-oscillator"] {
        let (mut rounds, mut shown) = (0, None);
        let fitted =
            identify(&data, &request(json!({"model": model, "starts": 2, "epochs": 12})), &mut |seen| {
                let Some(law) = seen.model_so_far() else { return ControlFlow::Continue(()) };
                (rounds, shown) = (rounds + 1, Some(law));
                if rounds == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
        let found = fitted.unwrap().model;
        assert_eq!((rounds, found.provenance().termination), (3, Termination::Stopped), "{model}");
        assert_eq!(simulated(&shown.unwrap(), &data), simulated(&found, &data), "{model}");
    }
}

#[test]
fn a_law_without_a_search_has_no_model_on_its_way() {
    let (_, models) = seen(&data(), &request(json!({"model": "prandtl-ishlinskii"})), |_| true);
    assert!(models.is_empty());
}

/// Last report on a candidate.
#[derive(Debug, PartialEq)]
struct CandidateReport {
    standing: Standing,
    error_percent: Option<(f64, f64)>,
    folds: (usize, usize),
}

/// A fit with what was told of each candidate, until `most` tellings.
fn told(data: &Dataset, request: &FitSpec, most: usize) -> (Model, BTreeMap<String, CandidateReport>) {
    let mut all = BTreeMap::new();
    let mut count = 0;
    let fitted = identify(data, request, &mut |progress: &Progress| {
        assert!(count < most, "it was told after it had said stop");
        let Some(tried) = &progress.tried else { return ControlFlow::Continue(()) };
        assert!(progress.is_part && progress.model_so_far().is_none() && progress.checkpoint().is_none());
        assert!(tried.folds <= tried.of);
        if tried.standing != Standing::Dropped {
            let model = tried.model.expect("a candidate that is tried has a model");
            assert!(simulated(model, data).iter().flatten().all(|y| y.is_finite()));
        }
        let trained = tried.model.and_then(|model| model.provenance().trained_error().nrmse_std_percent);
        assert_eq!(trained, (!progress.train_nrmse_percent.is_nan()).then_some(progress.train_nrmse_percent));
        let (error_percent, folds) = (tried.error_percent, (tried.folds, tried.of));
        all.insert(tried.name.clone(), CandidateReport { standing: tried.standing, error_percent, folds });
        count += 1;
        if count == most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    (fitted.unwrap().model, all)
}

#[test]
fn the_candidates_that_are_told_are_those_of_the_selection() {
    let data = data();
    let FitSpec::Auto(options) = small(ModelName::AUTO, None) else { panic!("auto was asked for") };
    let (model, told) = told(&data, &FitSpec::Auto(options), usize::MAX);
    let selection = model.provenance().selection.as_ref().unwrap();
    for candidate in &selection.candidates {
        let of = selection.folds.len();
        let expected = CandidateReport {
            standing: Standing::Complete,
            error_percent: Some(candidate.error_percent),
            folds: (of, of),
        };
        assert_eq!(told[&candidate.name], expected, "{}", candidate.name);
    }
    assert!(!selection.dropped.is_empty());
    for name in &selection.dropped {
        assert_eq!(told[name].standing, Standing::Dropped, "{name}");
    }
    let complete = told.values().filter(|told| told.standing == Standing::Complete).count();
    assert_eq!(complete, selection.candidates.len());
    assert!(told.values().all(|told| told.standing != Standing::Trying));
}

#[test]
fn a_named_model_with_members_is_told_as_its_only_candidate() {
    let data = data();
    let request = request(json!({"model": "xpnn", "members": 3, "starts": 2, "epochs": 4}));
    let (model, told) = told(&data, &request, usize::MAX);
    let [candidate] = model.provenance().selection.as_ref().unwrap().candidates.as_slice() else {
        panic!("one candidate was asked for")
    };
    assert_eq!(told.len(), 1);
    assert_eq!(told[&candidate.name].error_percent, Some(candidate.error_percent));
}

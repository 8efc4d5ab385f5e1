//! The automatic model: what it promises of itself, its ensembles, bands and validation.

use crate::scaffold::*;
use std::sync::OnceLock;

use hysid::fit::intervals::ParameterIntervals;
use hysid::fit::progress::Observer;
use hysid::model::{Ensemble, Group, Node, NodeKind, Predictor, Weights};
use hysid::validation::folds;
use hysid_core::elementary::exp;

use crate::noisy_record::{noisy, waved};

fn names() -> ColumnNames {
    ColumnNames::of(Some("t_s"), &["x_mm"], "f_kN")
}

/// Records of a law: a stop and a line, with noise.
fn of_a_law() -> Dataset {
    Dataset::new(names(), vec![noisy(150, "a"), noisy(110, "b"), noisy(130, "c")]).unwrap()
}

fn data() -> Dataset {
    Dataset::new(names(), vec![waved(150, "a"), waved(110, "b"), waved(130, "c")]).unwrap()
}

fn shared() -> &'static Model {
    static MODEL: OnceLock<Model> = OnceLock::new();
    MODEL.get_or_init(|| fitted(&data(), options(None)))
}

fn options(rate: Option<RateMethod>) -> AutoOptions {
    match small(ModelName::AUTO, rate) {
        FitSpec::Auto(options) => options,
        _ => unreachable!("auto was asked for"),
    }
}

fn fitted(data: &Dataset, options: AutoOptions) -> Model {
    model_of(data, &FitSpec::Auto(options))
}

#[test]
fn an_ensemble_comes_back_from_its_file_and_steps_as_it_simulates() {
    let data = data();
    let model = fitted(&data, options(Some(RateMethod::Central)));
    let ensemble = model.ensemble().expect("several members");
    assert!((2..=6).contains(&ensemble.members().len()));
    assert_eq!(model.name(), ModelName::AUTO);
    let again = Model::from_json(&model.to_json()).unwrap();
    assert_eq!(again, model);

    for record in data.records() {
        let simulated = model.simulate(record).unwrap();
        assert_eq!(again.simulate(record).unwrap(), simulated);
        let rates = RateMethod::Central.rate(record).unwrap();
        let mut stepper = model.stepper();
        for _ in 0..2 {
            for (row, expected) in simulated.iter().enumerate() {
                let rate = Some(rates[row]);
                let y = stepper.step(&[record.inputs()[0][row]], record.time().unwrap()[row], rate).unwrap();
                assert_eq!(y, *expected, "{} row {row}", record.name());
            }
            stepper.reset();
        }
    }
    let told: usize =
        model.provenance().selection.as_ref().unwrap().candidates.iter().map(|one| one.members).sum();
    assert_eq!(told, ensemble.members().len());
    let parameters: usize = ensemble.members().iter().map(Model::parameters).sum();
    assert_eq!(model.parameters(), parameters);
    let errors = model.evaluate(&data).unwrap();
    assert_eq!(errors, model.provenance().train);
    assert!(errors.nrmse_std_percent.unwrap() < 15.0, "{errors:?}");
}

#[test]
fn the_answer_is_the_nested_median_of_the_members() {
    let data = data();
    let model = shared();
    let ensemble = model.ensemble().unwrap();
    let record = &data.records()[0];
    let outputs: Vec<Vec<f64>> =
        ensemble.members().iter().map(|member| member.simulate(record).unwrap()).collect();
    let simulated = model.simulate(record).unwrap();
    for row in (0..record.len()).step_by(7) {
        let expected = answer(ensemble.group(), &|member| outputs[member][row]);
        assert!((simulated[row] - expected).abs() < 1e-12 * (1.0 + expected.abs()), "row {row}");
    }
}

/// The weighted median by its definition, theory.md (11.3): the weighted distribution function inverted by bisection.
fn answer(group: &Group, of_member: &dyn Fn(usize) -> f64) -> f64 {
    let mut votes: Vec<(f64, f64)> = group
        .nodes
        .iter()
        .map(|node| match &node.kind {
            NodeKind::Member(member) => (of_member(*member), node.weights.inside),
            NodeKind::Group(group) => (answer(group, of_member), node.weights.inside),
        })
        .filter(|(_, weight)| *weight > 0.0)
        .collect();
    votes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = votes.iter().map(|vote| vote.1).sum();
    let places: Vec<f64> = (0..votes.len())
        .map(|i| (votes[..i].iter().map(|vote| vote.1).sum::<f64>() + 0.5 * votes[i].1) / all)
        .collect();
    let share_below = |y: f64| match votes.iter().rposition(|vote| vote.0 <= y) {
        None => 0.0,
        Some(last) if last + 1 == votes.len() => 1.0,
        Some(i) => {
            let (low, high) = (votes[i].0, votes[i + 1].0);
            places[i] + (y - low) / (high - low) * (places[i + 1] - places[i])
        }
    };
    let (mut low, mut high) = (votes[0].0, votes[votes.len() - 1].0);
    if places[0] >= 0.5 {
        return low;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if share_below(middle) < 0.5 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[test]
fn one_member_is_a_single_model_with_band_and_selection() {
    let data = data();
    let model = fitted(&data, AutoOptions { members: 1, ..options(None) });
    assert!(model.ensemble().is_none());
    assert_ne!(model.name(), ModelName::Classical(ClassicalModel::RandomStops));
    let provenance = model.provenance();
    let selection = provenance.selection.as_ref().expect("there was a choice");
    assert_eq!(selection.folds.len(), 3);
    assert!(provenance.validation.is_some() && model.band().is_some());
    assert_eq!(provenance.train, model.evaluate(&data).unwrap());
    // What it was taught beside the data is none of the data.
    assert_eq!(model.trained_ranges().inputs[0], data.input_range(0));
    assert_eq!((provenance.samples, provenance.records), (390, 3));
    assert_eq!(Model::from_json(&model.to_json()).unwrap(), model);
}

#[test]
fn a_law_of_few_numbers_takes_the_place_of_an_ensemble() {
    let data = of_a_law();
    let model = fitted(&data, options(None));
    assert!(matches!(model.name(), ModelName::Classical(_)), "{:?}", model.name());
    assert!(model.parameters() <= 40);
    let provenance = model.provenance();
    let selection = provenance.selection.as_ref().expect("there was a choice");
    let single = selection.single.as_ref().expect("one model was chosen");
    assert!(single.is_law && !single.distilled);
    assert_eq!(provenance.validation.as_ref().unwrap().nrmse_std_percent, selection.held_out_percent);
    assert!(
        selection.candidates.len() > 1 && selection.summary()[0].contains("a law, in place of an ensemble")
    );
    // The noise has a root mean square of 0.07.
    let trained = provenance.trained_error().rmse;
    assert!((0.05..0.09).contains(&trained), "{trained}");
    assert!(model.band().is_some());
    assert_eq!(Model::from_json(&model.to_json()).unwrap(), model);
}

#[test]
fn decisions_are_obeyed() {
    let data = data();
    let rate = Some(RateMethod::Central);
    let members = |options: AutoOptions| fitted(&data, options).ensemble().unwrap().members().to_vec();
    let networks = |members: &[Model]| -> Vec<hysid_core::network::Architecture> {
        members.iter().filter_map(|member| member.network().map(|network| *network.architecture())).collect()
    };
    let without = members(AutoOptions {
        deterioration: Some(false),
        always_rate: true,
        compression: Some(false),
        ..options(rate)
    });
    assert!(networks(&without).iter().all(|a| !a.deterioration));
    assert!(without.iter().all(|member| member.rate() == rate));
    assert!(without.iter().all(|member| member.input_transform().compression.is_none()));
    let with = members(AutoOptions { deterioration: Some(true), ..options(rate) });
    assert!(!with.is_empty() && networks(&with).iter().all(|a| a.deterioration));
    let wears = |member: &Model| match member.predictor() {
        Predictor::Network { network, .. } => network.architecture().deterioration,
        Predictor::Law(Classical::BoucWen(law)) => law.degradation.is_some(),
        Predictor::Law(Classical::PeakOriented(law)) => law.degradation.is_some(),
        _ => false,
    };
    assert!(with.iter().all(wears));
    let unrated = shared().ensemble().unwrap().members();
    assert!(unrated.iter().all(|member| member.rate().is_none() && !member.needs_time()));
    // Networks that are tried have these sizes, whether they become members or not.
    let sized = FitSpec::Auto(AutoOptions { stops: Some(4), hidden: Some(3), ..options(None) });
    let mut sizes = Vec::new();
    let mut observer = |progress: &Progress| {
        let tried = progress.tried.as_ref().and_then(|tried| tried.model);
        let is_network = |model: &&Model| matches!(model.name(), ModelName::Network(_));
        let network = tried.filter(is_network).and_then(Model::network);
        sizes.extend(network.map(|network| (network.architecture().stops, network.architecture().hidden)));
        ControlFlow::Continue(())
    };
    identify(&data, &sized, &mut observer).unwrap();
    assert!(!sizes.is_empty() && sizes.iter().all(|&size| size == (4, 3)), "{sizes:?}");
}

#[test]
fn decisions_that_leave_nothing_are_refused() {
    let refused =
        |options: AutoOptions| identify(&data(), &FitSpec::Auto(options), &mut on).unwrap_err().to_string();
    let nothing = AutoOptions { compression: Some(true), history: Some(true), ..options(None) };
    assert!(refused(nothing).contains("leave no candidate"));
    assert!(refused(AutoOptions { members: 0, ..options(None) }).contains("choose a whole number from 1 to"));
}

#[test]
fn a_named_model_becomes_an_ensemble_of_its_starts() {
    let data = data();
    let of = |model: ModelName| small(model, None);
    for (model, expected) in [
        (ModelName::Network(Family::Xpnn), 3),
        (ModelName::Classical(ClassicalModel::RandomStops), 3),
        // Nothing about it is random: it is the model.
        (ModelName::Classical(ClassicalModel::Preisach), 1),
    ] {
        let options = AutoOptions { only: Some(Box::new(of(model))), members: 3, starts: 3, ..options(None) };
        let fitted = fitted(&data, options);
        let Some(ensemble) = fitted.ensemble() else {
            assert_eq!((fitted.name(), expected), (model, 1));
            assert!(fitted.provenance().selection.as_ref().unwrap().single.as_ref().unwrap().is_law);
            continue;
        };
        assert_eq!(ensemble.members().len(), expected, "{model:?}");
        assert!(ensemble.members().iter().all(|member| member.name() == model));
        assert_ne!(ensemble.members()[0].predictor(), ensemble.members()[1].predictor());
    }
}

#[test]
fn however_early_it_is_stopped_there_is_a_model() {
    let data = data();
    for patience in [0, 60] {
        let mut heard = 0;
        let mut observer = |progress: &Progress| {
            assert!((0.0..=1.0).contains(&progress.done));
            heard += 1;
            if heard > patience { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let observer: &mut Observer = &mut observer;
        let model = identify(&data, &FitSpec::Auto(options(None)), observer).unwrap().model;
        assert_eq!(model.provenance().termination, Termination::Stopped, "after {patience}");
        assert!(model.simulate(&data.records()[0]).unwrap().iter().all(|y| y.is_finite()));
        assert_eq!(Model::from_json(&model.to_json()).unwrap(), model);
    }
}

#[test]
fn the_band_lies_about_the_output_and_widens_with_its_probability() {
    let data = data();
    let model = shared();
    let record = record(400, "new");
    let excitation = record.excitation();
    let mut last = 0.0;
    for probability in [0.5, 0.8, 0.9, 0.99] {
        let prediction = model.predict(&excitation, probability).unwrap();
        assert_eq!(prediction.output, model.simulate(&record).unwrap());
        let rows = prediction.low.iter().zip(&prediction.high).zip(record.output());
        let covered = rows.filter(|((low, high), y)| (**low..=**high).contains(y)).count();
        let share = covered as f64 / record.len() as f64;
        assert!(share >= last, "{probability}");
        last = share;
        assert!(prediction.output.iter().zip(&prediction.low).all(|(y, low)| low <= y));
    }
    // Three epochs do not predict a longer record as their folds, but the band is no thin line.
    assert!(last > 0.5, "{last}");
    for wrong in [0.0, 0.3, 1.0, f64::NAN] {
        assert!(model.predict(&excitation, wrong).unwrap_err().to_string().contains("from 0.5 to 0.99"));
    }
    let alone = model_of(&data, &small(ModelName::Network(Family::Xpnn), None));
    assert!(alone.predict(&excitation, 0.9).unwrap_err().to_string().contains("no prediction band"));
}

#[test]
fn data_too_few_to_hold_any_out_still_give_a_model() {
    let few = Dataset::new(names(), vec![record(30, "short")]).unwrap();
    assert!(folds(&few, 5).is_empty());
    let model = fitted(&few, options(None));
    assert!(model.band().is_none() && model.provenance().selection.is_none());
    assert!(model.provenance().train.nrmse_std_percent.unwrap() < 100.0);
}

/// A law among the members was fitted to the data as the law alone is: the residual of its intervals is that of its training.
#[test]
fn laws_among_the_members_have_intervals() {
    let data = data();
    let members = shared().ensemble().expect("several members").members();
    let mut found = 0;
    for member in members {
        let Some(intervals) = ParameterIntervals::of(member, &data).unwrap() else { continue };
        found += 1;
        let trained = member.provenance().trained_error().rmse;
        approx::assert_relative_eq!(intervals.residual_rms, trained, max_relative = 0.02);
    }
    let laws = members.iter().filter(|member| member.law().is_some()).count();
    assert!(found > 0 || laws == 0, "{laws} laws without intervals");
}

#[test]
fn an_ensemble_that_makes_no_sense_is_refused() {
    let data = data();
    let member = model_of(&data, &small(ModelName::Network(Family::Pnn), None));
    let node = |member| Node { weights: Weights::equal(), kind: NodeKind::Member(member) };
    let group = |nodes| Group { name: "g".into(), nodes };
    let new = |members: &[&Model], nodes, range| {
        Ensemble::new(members.iter().map(|one| (*one).clone()).collect(), group(nodes), range)
    };
    let range = (-1.0, 1.0);
    assert!(new(&[&member], vec![node(0)], range).is_ok());
    let refused = |result: hysid::Result<Ensemble>| result.unwrap_err().to_string();
    assert!(refused(new(&[&member], vec![], range)).contains("at least one"));
    assert!(refused(new(&[&member], vec![node(1)], range)).contains("no member 1"));
    assert!(refused(new(&[&member], vec![node(0)], (1.0, 1.0))).contains("no range"));
    let none = Node { weights: Weights { inside: 0.0, outside: 0.0 }, ..node(0) };
    assert!(refused(new(&[&member], vec![none], range)).contains("not all 0"));
    let named_often = refused(new(&[&member], vec![node(0); 2_001], range));
    assert!(named_often.contains("has 2001 members, at most 2000 are possible"), "{named_often}");
    let whole = shared();
    assert!(refused(new(&[whole], vec![node(0)], range)).contains("member of another"));
}

#[test]
fn rows_of_a_wrong_beginning_are_not_trained_on() {
    // The memory of each record starts elsewhere than in the virgin state, and is itself after a while.
    let strange = |rows: usize, name: &str| {
        let sound = record(rows, name);
        let wrong = |(row, y): (usize, &f64)| y + 3.0 * exp(-(row as f64) / 4.0);
        let output = sound.output().iter().enumerate().map(wrong).collect();
        Record::new(name, vec![sound.inputs()[0].to_vec()], output).unwrap()
    };
    let untimed = ColumnNames { time: None, ..names() };
    let data = Dataset::new(untimed.clone(), vec![strange(150, "a"), strange(140, "b")]).unwrap();
    let unseen = Dataset::new(untimed, vec![record(300, "sound")]).unwrap();
    let error = |warm_up| {
        let options = AutoOptions { warm_up: Some(warm_up), ..options(None) };
        fitted(&data, options).evaluate(&unseen).unwrap().nrmse_std_percent.unwrap()
    };
    let (from_the_beginning, after) = (error(0), error(20));
    assert!(after < 0.8 * from_the_beginning, "{after} after a warm-up, {from_the_beginning} without");
}

/// Closed loops of relays whose thresholds are those of a soft magnet, one record for each amplitude.
fn loops_of_relays(amplitudes: &[f64]) -> Dataset {
    let thresholds: Vec<f64> = (0..200).map(|place| -0.995 + 0.01 * f64::from(place)).collect();
    let bell = |distance: f64| exp(-distance * distance / 0.05);
    let record = |&amplitude: &f64| {
        let pairs = thresholds.iter().flat_map(|&up| thresholds.iter().map(move |&down| (up, down)));
        let mut relays: Vec<(f64, f64, f64, f64)> = pairs
            .filter(|(up, down)| up >= down)
            .map(|(up, down)| {
                (up, down, bell(up - 0.15) * bell(down + 0.15), if up + down > 0.0 { -1.0 } else { 1.0 })
            })
            .collect();
        let x: Vec<f64> = through(&[0.0, amplitude, -amplitude, amplitude], 50);
        let output = |&x: &f64| -> f64 {
            let states = relays.iter_mut().map(|(up, down, weight, state)| {
                *state = if x >= *up {
                    1.0
                } else if x <= *down {
                    -1.0
                } else {
                    *state
                };
                *weight * *state
            });
            states.sum()
        };
        let y = x.iter().map(output).collect();
        Record::new(format!("loop to {amplitude}"), vec![x], y).unwrap()
    };
    Dataset::new(ColumnNames::plain(1), amplitudes.iter().map(record).collect()).unwrap()
}

#[test]
fn a_preisach_model_takes_the_place_of_an_ensemble_on_few_loops_of_a_magnet() {
    let data = loops_of_relays(&[0.4, 1.0]);
    let model = fitted(&data, AutoOptions { operators: None, ..options(None) });
    assert_eq!(model.name(), ModelName::Classical(ClassicalModel::Preisach));
    assert!(model.provenance().selection.as_ref().unwrap().single.as_ref().unwrap().is_law);
    let unseen = error_percent(&model, &loops_of_relays(&[0.7]));
    assert!(unseen < 5.0, "{unseen}");
}

/// Closed loops of electrical steel of high loss, far below saturation: each asks for what the other does not show.
#[test]
fn where_the_folds_tell_nothing_the_default_fits_the_data() {
    let record = |largest: f64| {
        let mut sheet = hysid::specimens::Ferromagnet::m800_65a();
        let x = through(&[0.0, largest, -largest, largest], 100);
        let y = x.iter().map(|h| sheet.step(*h)).collect();
        Record::new(format!("to {largest} A/m"), vec![x], y).unwrap()
    };
    let data = Dataset::new(ColumnNames::plain(1), vec![record(73.0), record(148.0)]).unwrap();
    let model = hysid::Fit::new().option("effort", "quick").run(&data).unwrap();
    let alone = model_of(&data, &request(serde_json::json!({ "model": "preisach" })));
    let error = |model: &Model| model.provenance().trained_error().nrmse_std_percent.unwrap();
    assert!(error(&model) < 1.4 * error(&alone), "{} {}", error(&model), error(&alone));
}

//! Initial states: lead-ins drive the memory as rows before the record do, unknown ones are found, and data that
//! begin in the virgin state are not touched.

use crate::model_file::with_fitting_checksum;
use crate::scaffold::*;
use hysid::data::initial_state::lead_in_of_period;
use hysid::data::known_beginning::KnownBeginning;
use hysid::law::preisach::{Preisach, PreisachWeights};
use hysid::law::series::run;
use hysid_core::elementary::{exp, ln, sin, square};

fn untimed(records: Vec<Record>) -> Dataset {
    Dataset::new(ColumnNames { time: None, ..ColumnNames::plain(1) }, records).unwrap()
}

fn without_time(record: &Record) -> Record {
    Record::new(record.name(), vec![record.inputs()[0].to_vec()], record.output().to_vec()).unwrap()
}

fn path(rows: usize, size: f64, pace: f64) -> Vec<f64> {
    let x = |k: f64| size * sin(pace * k) * (0.35 + 0.3 * sin(0.37 * pace * k));
    (0..rows).map(|k| x(k as f64)).collect()
}

/// The record with its lead-in as rows without an output, the last at the first input; and with the lead-in given.
fn both_ways(record: &Record, lead_in: &[f64]) -> (Record, Record) {
    let x = &record.inputs()[0];
    let x: Vec<f64> = lead_in.iter().chain(&x[..1]).chain(x).copied().collect();
    let mut y = vec![f64::NAN; lead_in.len() + 1];
    y.extend(record.output());
    let as_rows = Record::new(record.name(), vec![x], y).unwrap();
    (as_rows, without_time(record).with_lead_in(lead_in.to_vec()).unwrap())
}

/// A magnet: relays whose thresholds lie about a coercive input of 0.35.
fn magnet() -> Preisach {
    const INTERVALS: usize = 24;
    let line = |k: usize| 2.0 * k as f64 / INTERVALS as f64 - 1.0;
    let middle = |k: usize| line(k) + 1.0 / INTERVALS as f64;
    let bell = |distance: f64, width: f64| exp(-square(distance / width));
    let weight = |i: usize, j: usize| {
        let (alpha, beta) = (middle(i), middle(j));
        bell(0.5 * (alpha - beta) - 0.35, 0.2) * bell(0.5 * (alpha + beta), 0.25)
    };
    let cells: Vec<f64> = (0..INTERVALS).flat_map(|i| (0..=i).map(move |j| weight(i, j))).collect();
    let sum: f64 = cells.iter().sum();
    Preisach::new(PreisachWeights {
        constant: 0.0,
        slope: 0.05,
        lines: (0..=INTERVALS).map(line).collect(),
        reversible: vec![0.0; INTERVALS],
        cells: cells.iter().map(|weight| weight / sum).collect(),
    })
    .unwrap()
}

/// Record of the magnet along a path, after a lead-in that is not recorded.
fn measured(name: &str, lead_in: &[f64], x: Vec<f64>) -> Record {
    let driven: Vec<f64> = lead_in.iter().chain(&x).copied().collect();
    let y = run(&magnet(), &samples_of(&driven)).split_off(lead_in.len());
    Record::new(name, vec![x], y).unwrap()
}

/// Records that begin at remanence. The inputs reach 1 in one of them, which tells the range.
fn remanent() -> (Dataset, Dataset) {
    let (up, down) = (&[1.0][..], &[-1.0][..]);
    let whole = |pace: f64| {
        let mut x = path(240, 1.0, pace);
        x.extend((0..160).map(|k| sin(0.08 * f64::from(k))));
        x
    };
    let train = vec![
        measured("a", up, path(300, 0.9, 0.11)),
        measured("b", down, path(280, 0.8, 0.13)),
        measured("c", up, whole(0.12)),
        measured("d", up, path(260, 1.0, 0.1)),
        measured("e", down, whole(0.09)),
        measured("f", up, path(300, 0.7, 0.14)),
    ];
    let test = vec![measured("t", up, path(300, 0.85, 0.125)), measured("u", up, path(300, 0.75, 0.105))];
    (untimed(train), untimed(test))
}

/// Every model without time is the same with the lead-in as rows and as a lead-in, and simulates the same.
#[test]
fn a_lead_in_drives_the_memory_as_rows_before_the_record_do() {
    let records = [record(150, "a"), record(120, "b")];
    let range = untimed(records.iter().map(without_time).collect()).input_range(0);
    for (name, lead_in) in [("up", vec![range.1]), ("turned", vec![range.0, 0.4 * range.1])] {
        let (as_rows, told): (Vec<Record>, Vec<Record>) =
            records.iter().map(|record| both_ways(record, &lead_in)).unzip();
        let (as_rows, told) = (untimed(as_rows), untimed(told));
        for model in ModelName::all() {
            let request = small(model, None);
            if model.check_data(&told, None).is_err() {
                continue;
            }
            let what = format!("{} {name}", model.name());
            let (of_rows, of_told) = (model_of(&as_rows, &request), model_of(&told, &request));
            assert_eq!((of_rows.lead_in(), of_told.lead_in()), (&[][..], &lead_in[..]), "{what}");
            assert_eq!(of_told.network(), of_rows.network(), "{what}");
            assert_eq!(of_told.law(), of_rows.law(), "{what}");
            assert_eq!(of_told.provenance().train, of_rows.provenance().train, "{what}");
            assert_eq!(of_told.evaluate(&told).unwrap(), of_told.provenance().train, "{what}");
            for (as_rows, told) in as_rows.records().iter().zip(told.records()) {
                let behind = of_rows.simulate(as_rows).unwrap().split_off(lead_in.len() + 1);
                assert_eq!(bits(&of_told.simulate(told).unwrap()), bits(&behind), "{what}");
            }
        }
    }
}

/// Rows of a record, in blocks that go round in a circle.
fn in_blocks(model: &Model, record: &Record, lengths: &[usize]) -> Vec<f64> {
    crate::simulation::in_blocks(&mut model.simulation(), record, lengths).output
}

#[test]
fn whole_blocks_and_steps_begin_alike_and_a_record_can_begin_otherwise() {
    let data = Dataset::new(ColumnNames::plain(1), vec![record(150, "a"), record(110, "b")]).unwrap();
    let unseen = record(90, "unseen");
    let rate = Some(RateMethod::Backward);
    let rates = RateMethod::Backward.rate(&unseen).unwrap();
    let mut requests: Vec<FitSpec> = ModelName::all()
        .filter(|model| model.check_data(&data, rate).is_ok())
        .map(|model| small(model, rate.filter(|_| model.uses_rate())))
        .collect();
    requests.push(small(ModelName::AUTO, rate));
    let mut shaped = NamedOptions::of(Default::default()).unwrap();
    (shaped.model, shaped.epochs, shaped.starts) = (Some("xpnn+".parse().unwrap()), Some(3), Some(1));
    (shaped.history, shaped.compression, shaped.rate_compression) = (Some(true), Some(0.2), Some(0.3));
    requests.push(shaped.request(rate, false));
    for request in requests {
        let virgin = model_of(&data, &request);
        let request = request.with_initial_state(Some(InitialState::SaturatedDown));
        let model = model_of(&data, &request);
        let what = format!("{} {:?}", model.name().name(), model.input_transform());
        assert_eq!(model.lead_in(), [data.input_range(0).0], "{what}");
        let whole = model.simulate(&unseen).unwrap();
        for lengths in [&[1][..], &[3, 7], &[64, 1, 13], &[1000]] {
            assert_eq!(bits(&in_blocks(&model, &unseen, lengths)), bits(&whole), "{what} {lengths:?}");
        }
        // Told, whatever the model begins with.
        let told = unseen.clone().with_lead_in(model.lead_in().to_vec()).unwrap();
        let also = model.clone().with_initial_state(InitialState::SaturatedUp).unwrap();
        assert_eq!(bits(&also.simulate(&told).unwrap()), bits(&whole), "{what}");
        assert_eq!(bits(&in_blocks(&also, &told, &[5])), bits(&whole), "{what}");
        let mut stepper = model.stepper();
        let step = |stepper: &mut hysid::model::Stepper<'_>| -> Vec<f64> {
            let rows = unseen.inputs()[0].iter().zip(unseen.time().unwrap()).zip(&rates);
            rows.map(|((&x, &t), &rate)| stepper.step(&[x], t, Some(rate)).unwrap()).collect()
        };
        for _ in 0..2 {
            assert_eq!(bits(&step(&mut stepper)), bits(&whole), "{what}");
            stepper.reset();
        }
        stepper.reset_to(InitialState::SaturatedUp).unwrap();
        let up = model.clone().with_initial_state(InitialState::SaturatedUp).unwrap();
        assert_eq!(bits(&step(&mut stepper)), bits(&up.simulate(&unseen).unwrap()), "{what}");
        stepper.reset_to(InitialState::Virgin).unwrap();
        let begun = unseen.clone().with_lead_in(Vec::new()).unwrap();
        assert_eq!(bits(&step(&mut stepper)), bits(&model.simulate(&begun).unwrap()), "{what}");
        stepper.reset();
        assert_eq!(bits(&step(&mut stepper)), bits(&whole), "{what}");

        let again = Model::from_json(&model.to_json()).unwrap();
        assert_eq!(again, model, "{what}");
        assert_eq!(bits(&again.simulate(&unseen).unwrap()), bits(&whole), "{what}");
        let text = virgin.to_json();
        assert!(!text.contains("lead_in") && !text.contains("initial_state"), "{what}");
    }
}

#[test]
fn relaxation_is_complete_before_the_first_row() {
    let sizes = Sizes { stops: 1, hidden: 1, relaxation: 1 };
    let mut architecture = Architecture::new(Family::XpnnPlus, sizes, 1, false, true).unwrap();
    (architecture.deterioration, architecture.hidden, architecture.linear) = (false, 0, false);
    // A stop whose weight is 1, a relaxation time of e, and an output of the relaxation neuron alone.
    let network = Network::new(architecture, vec![1.0, 1.0], vec![0.0, 0.0, 1.0]).unwrap();
    let mut simulator = network.simulator();
    let mut y = [f64::NAN; 3];
    simulator.run(&[&[0.9, -0.7, 0.2]], &[f64::INFINITY; 3], &mut y);
    assert_eq!(y, [0.0; 3]);
    // Then the record: at rest first, and from there on as the equation says.
    simulator.run(&[&[0.2, 0.2, 0.5]], &[0.0, 1.0, 0.0], &mut y);
    assert_eq!(y[..2], [0.0; 2]);
    assert!((y[2] - 0.3).abs() < 1e-15);
}

/// The derivatives stay finite over the infinite steps of a lead-in, and are those of the objective.
#[test]
fn gradients_are_right_behind_a_lead_in() {
    let data = Dataset::new(ColumnNames::plain(1), vec![record(120, "a"), record(140, "b")]).unwrap();
    let lead_in = InitialState::Demagnetised.lead_in(data.input_range(0), 0.0).unwrap();
    let data = data.with_lead_ins(|record, _| if record == 0 { lead_in.clone() } else { vec![0.8] }).unwrap();
    let sizes = Sizes { stops: 3, hidden: 2, relaxation: 2 };
    let rate = Some(RateMethod::Central);
    let options = FitOptions { model: Family::XpnnPlus, sizes, rate, ..FitOptions::default() };
    let (scaling, architecture) = (Scaling::of(&data, rate).unwrap(), options.architecture(&data).unwrap());
    let objective = Objective::new(&data, &scaling, architecture, &options).unwrap();
    let mut generator = Generator::seed_from_u64(7);
    let mut point: Vec<f64> =
        (0..objective.layout().len()).map(|_| generator.random::<f64>() - 0.5).collect();
    objective.layout().ln_beta.clone().for_each(|index| point[index] += 6.0);
    objective.layout().stop_weights.clone().for_each(|index| point[index] *= 8.0);
    let value = objective.value(&point);
    let gradient = objective.gradient(&point, &value);
    let largest = gradient.iter().fold(0.0, |most: f64, g| most.max(g.abs()));
    let (mut compared, step) = (0, 1e-6);
    for index in objective.layout().ln_tau.clone().chain(objective.layout().hidden.clone()) {
        let at = |by: f64| {
            let mut moved = point.clone();
            moved[index] += by;
            objective.value(&moved).objective
        };
        let slope = (at(step) - at(-step)) / (2.0 * step);
        assert!((slope - gradient[index]).abs() < 1e-5 * largest, "{index}: {slope} and {}", gradient[index]);
        compared += 1;
    }
    assert!(compared > 4 && largest > 1e-4);
}

#[test]
fn states_of_a_magnet_at_remanence_are_found() {
    let (train, test) = remanent();
    for model in ["preisach", "random-stops"] {
        let virgin = model_of(&train, &request(serde_json::json!({ "model": model })));
        let found =
            model_of(&train, &request(serde_json::json!({ "model": model, "initial_state": "unknown" })));
        let (low, high) = train.input_range(0);
        assert_eq!(found.lead_in(), [high], "{model}");
        for (name, end) in [("a", high), ("b", low), ("c", high), ("d", high), ("e", low), ("f", high)] {
            let of_record = found.provenance().lead_ins.iter().find(|one| one.record == name).unwrap();
            assert_eq!(of_record.lead_in, [end], "{model} {name}");
        }
        let as_trained = found.as_trained(&train).unwrap();
        assert_eq!(found.evaluate(&as_trained).unwrap(), found.provenance().train, "{model}");
        let error = |model: &Model| model.evaluate(&test).unwrap().rmse;
        assert!(error(&found) < 0.5 * error(&virgin), "{model}: {} of {}", error(&found), error(&virgin));
        assert_eq!(Model::from_json(&found.to_json()).unwrap(), found);
    }
}

/// Held-out records begin as most of the records that are left, not as their own outputs tell.
#[test]
fn a_validation_does_not_look_at_what_is_held_out() {
    let (up, down) = (&[1.0][..], &[-1.0][..]);
    let saturating = |pace: f64, size: f64| {
        let mut x = path(100, size, pace);
        x.extend((0..200).map(|k| sin(0.07 * f64::from(k))));
        x
    };
    let data = untimed(vec![
        measured("a", up, saturating(0.11, 0.8)),
        measured("b", up, saturating(0.13, 0.5)),
        measured("c", down, path(200, 0.8, 0.12)),
    ]);
    let request = request(serde_json::json!({ "model": "preisach", "initial_state": "unknown" }));
    let validation = cross_validate(&data, &request, 3, &mut |_| ControlFlow::Continue(())).unwrap();
    let (kept, held) = data.partition(|record| record < 2);
    let model = model_of(&kept, &request);
    assert_eq!(model.lead_in(), [kept.input_range(0).1]);
    let wrong = model.evaluate(&held).unwrap();
    assert_eq!(validation.folds[2].unseen, wrong);
    let begun = model.with_initial_state(InitialState::SaturatedDown).unwrap();
    assert!(begun.evaluate(&held).unwrap().rmse < 0.5 * wrong.rmse);
}

/// A single record is forecast from the state that its beginning tells.
#[test]
fn a_forecast_begins_with_the_state_of_its_record() {
    let mut x = path(150, 0.9, 0.12);
    x.extend((0..60).map(|k| sin(0.105 * f64::from(k))));
    x.extend(path(250, 0.9, 0.1));
    let data = untimed(vec![measured("r", &[1.0], x)]);
    let error = |state: &str| {
        let request = request(serde_json::json!({ "model": "preisach", "initial_state": state }));
        let validation = cross_validate(&data, &request, 5, &mut |_| ControlFlow::Continue(())).unwrap();
        let forecasts =
            validation.folds.iter().filter(|fold| fold.held_out.ends_with("from what came before"));
        forecasts.map(|fold| ln(fold.unseen.nrmse_std_percent.unwrap())).sum::<f64>()
    };
    let (found, told, virgin) = (error("unknown"), error("saturated-up"), error("virgin"));
    assert!(found < told + 0.1 && found < virgin - 0.5, "{found} found, {told} told, {virgin} virgin");
}

fn few_candidates() -> FitSpec {
    let FitSpec::Auto(options) = small(ModelName::AUTO, None) else { panic!("auto was asked for") };
    FitSpec::Auto(AutoOptions {
        compression: Some(false),
        history: Some(false),
        deterioration: Some(false),
        operators: None,
        ..options
    })
}

#[test]
fn auto_finds_states_where_they_matter_and_says_so() {
    let (train, test) = remanent();
    let auto = few_candidates();
    let model = model_of(&train, &auto);
    let selection = model.provenance().selection.as_ref().unwrap();
    let found = selection.found_states.expect("states that were found");
    assert!(found.found_percent < 0.8 * found.virgin_percent);
    assert_eq!(selection.warm_up, None);
    assert_eq!(model.lead_in(), [train.input_range(0).1]);
    let members = model.ensemble().into_iter().flat_map(|ensemble| ensemble.members());
    assert!(members.into_iter().all(|member| member.lead_in().is_empty()));
    assert!(model.notes().iter().any(|note| note.contains("initial state")), "{:?}", model.notes());
    let virgin = model_of(&train, &auto.with_initial_state(Some(InitialState::Virgin)));
    let error = |model: &Model| model.evaluate(&test).unwrap().rmse;
    assert!(error(&model) < 0.5 * error(&virgin), "{} of {}", error(&model), error(&virgin));
    assert_eq!(Model::from_json(&model.to_json()).unwrap(), model);
}

/// A steady loop of the magnet from 0 upwards: what came before is not recorded.
fn steady(amplitude: f64) -> Record {
    const ROWS: usize = 160;
    let x = |row: usize| amplitude * sin(std::f64::consts::TAU * row as f64 / ROWS as f64);
    let period: Vec<f64> = (0..ROWS).map(x).collect();
    measured(&format!("to {amplitude}"), &period, period.clone())
}

#[test]
fn steady_loops_begin_after_a_period_of_themselves() {
    let data = untimed([0.3, 0.5, 0.7, 1.0].map(steady).into());
    let unseen = untimed(vec![steady(0.6)]);
    let auto = few_candidates();
    let model = model_of(&data, &auto);
    assert!(model.is_periodic() && model.lead_in().is_empty());
    assert!(
        model.notes().iter().any(|note| note.contains("after one period of itself")),
        "{:?}",
        model.notes()
    );
    let virgin = model_of(&data, &auto.with_initial_state(Some(InitialState::Virgin)));
    let error = |model: &Model| model.evaluate(&unseen).unwrap().rmse;
    // A recurrent network learns a part of what the period before would tell.
    assert!(error(&model) < 0.8 * error(&virgin), "{} of {}", error(&model), error(&virgin));

    let named = request(serde_json::json!({ "model": "preisach", "initial_state": "periodic" }));
    let record = &unseen.records()[0];
    for model in [model, model_of(&data, &named)] {
        assert_eq!(Model::from_json(&model.to_json()).unwrap(), model);
        assert_eq!(model.evaluate(&data).unwrap(), model.provenance().train);
        assert_eq!(model.as_trained(&data).unwrap().records()[1].lead_in().unwrap(), [0.5, -0.5]);
        let whole = model.simulate(record).unwrap();
        assert_eq!(bits(&in_blocks(&model, record, &[7, 50])), bits(&whole));
        let told = record.clone().with_lead_in(lead_in_of_period(&record.inputs()[0])).unwrap();
        let virgin = model.clone().with_initial_state(InitialState::Virgin).unwrap();
        assert_eq!(bits(&virgin.simulate(&told).unwrap()), bits(&whole));
        // Sample by sample the period ahead is not known.
        let mut stepper = model.stepper();
        let error = stepper.reset_to(InitialState::Periodic).unwrap_err().to_string();
        assert!(error.starts_with("initial_state periodic: choose one of virgin, saturated-up"), "{error}");
        let stepped: Vec<f64> =
            record.inputs()[0].iter().map(|&x| stepper.step(&[x], 0.0, None).unwrap()).collect();
        assert_eq!(bits(&stepped), bits(&virgin.simulate(record).unwrap()));
        assert!(model.stepping_note().unwrap().contains("virgin") && virgin.stepping_note().is_none());
    }
}

#[test]
fn data_that_begin_virgin_keep_their_model() {
    let data = untimed(["a", "b", "c"].map(|name| without_time(&record(150, name))).into());
    let auto = few_candidates();
    let model = model_of(&data, &auto);
    assert!(model.lead_in().is_empty());
    assert_eq!(model.provenance().selection.as_ref().unwrap().found_states, None);
    // With the state decided, the same but for the option itself.
    let decided = model_of(&data, &auto.with_initial_state(Some(InitialState::Virgin)));
    let (plain, decided) = (model.to_json(), decided.to_json());
    let option = "      \"initial_state\": \"virgin\",\n";
    let content = |text: &str| text[..text.rfind("\"checksum\"").unwrap()].to_string();
    let (plain, decided) = (content(&plain), content(&decided));
    assert!(decided.contains(option) && decided.replace(option, "") == plain, "two models");
}

#[test]
fn bad_values_are_one_clear_error() {
    let data = untimed(vec![without_time(&record(150, "a"))]);
    let model = model_of(&data, &small(ModelName::Classical(ClassicalModel::Preisach), None));
    let error = model.clone().with_initial_state(InitialState::Unknown).unwrap_err().to_string();
    assert!(error.starts_with("initial_state unknown: choose one of virgin, saturated-up,"), "{error}");
    assert!(model.stepper().reset_to(InitialState::Unknown).is_err());
    let record = without_time(&record(20, "r"));
    for value in [f64::NAN, f64::INFINITY, 1e101] {
        let error = record.clone().with_lead_in(vec![0.0, value]).unwrap_err().to_string();
        assert!(error.starts_with("record \"r\", input: the lead-in has the value"), "{error}");
    }
    record.clone().with_lead_in(vec![0.5; 1_000]).unwrap();
    let error = record.clone().with_lead_in(vec![0.5; 1_001]).unwrap_err().to_string();
    assert_eq!(error, "record \"r\", input: the lead-in has 1001 turning points: at most 1000 are possible");
    let error = named(serde_json::json!({ "initial_state": "saturated" })).unwrap_err().to_string();
    assert!(error.contains("initial_state \"saturated\": choose one of virgin, saturated-up"), "{error}");
    let up = model.with_initial_state(InitialState::SaturatedUp).unwrap().to_json();
    let broken = up.replacen("\"lead_in\": [", "\"lead_in\": [1e200, ", 1);
    assert_ne!(broken, up);
    assert!(Model::from_json(&broken).is_err());
    let long = up.replacen("\"lead_in\": [", &format!("\"lead_in\": [{}", "0.5, ".repeat(1_001)), 1);
    let error = Model::from_json(&with_fitting_checksum(&long)).unwrap_err().to_string();
    assert!(error.contains("turning points, at most 1000 are possible"), "{error}");
}

/// A record that begins after a past that nobody recorded: the outputs of its first rows tell the model enough.
#[test]
fn a_known_beginning_tells_the_past_of_a_record() {
    let train = untimed(vec![
        measured("train", &[], path(500, 1.0, 0.11)),
        measured("more", &[], path(400, 0.9, 0.07)),
    ]);
    let options = ClassicalOptions { operators: Some(24), ..ClassicalOptions::of(ClassicalModel::Preisach) };
    let fitted = identify(&train, &FitSpec::Classical(options), &mut |_| ControlFlow::Continue(()));
    let model = fitted.unwrap().model;
    let pasts: [&[f64]; 3] = [&[0.9], &[-0.9, 0.5], &[0.8, -0.6, 0.3]];
    for past in pasts {
        let cut = untimed(vec![measured("cut", past, path(300, 0.5, 0.13))]);
        let error = |known| {
            let model = model.clone().with_known_beginning(KnownBeginning::Rows(known));
            model.evaluate(&cut).unwrap().rmse
        };
        let (virgin, known) = (error(0), error(60));
        assert!(known < 0.3 * virgin, "{past:?}: {known} with a known beginning, {virgin} without");
    }
}

/// Records that are cut out of a longer past: a fit that finds their pasts with the model is far better than one that takes
/// them for virgin.
#[test]
fn pasts_are_found_together_with_the_model() {
    let past = |k: f64| vec![0.9 * sin(7.1 * k), 0.9 * sin(4.3 * k + 1.0), 0.6 * sin(2.9 * k)];
    let cut = |k: f64| measured(&format!("cut {k}"), &past(k), path(200, 0.8 + 0.05 * k, 0.06 + 0.01 * k));
    let all: Vec<Record> = (0..14).map(|k| cut(f64::from(k))).collect();
    let (train, unseen) = (untimed(all[2..].to_vec()), untimed(all[..2].to_vec()));
    let options = ClassicalOptions { operators: Some(24), ..ClassicalOptions::of(ClassicalModel::Preisach) };
    let error = |state| {
        let request = FitSpec::Classical(options.clone()).with_initial_state(state);
        let model = identify(&train, &request, &mut |_| ControlFlow::Continue(())).unwrap().model;
        model.with_known_beginning(KnownBeginning::Rows(80)).evaluate(&unseen).unwrap().rmse
    };
    let (virgin, free) = (error(None), error(Some(InitialState::Free)));
    assert!(free < 0.5 * virgin, "{free} with found pasts, {virgin} without");
}

/// A stop in a later round ends with the model so far.
#[test]
fn a_stop_while_pasts_are_found_keeps_the_model_so_far() {
    let cut = |k: i32| measured(&format!("cut {k}"), &[0.9, -0.3 * f64::from(k)], path(150, 0.9, 0.11));
    let train = untimed((0..3).map(cut).collect());
    let options = ClassicalOptions { starts: Some(2), ..ClassicalOptions::of(ClassicalModel::BoucWen) };
    let request = FitSpec::Classical(options).with_initial_state(Some(InitialState::Free));
    let (mut last, mut goes_back) = (0.0, false);
    let fitted = identify(&train, &request, &mut |progress| {
        goes_back |= progress.done < last;
        last = progress.done;
        // The first of at most four fits is done.
        if progress.done > 0.25 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let model = fitted.unwrap().model;
    assert_eq!(model.provenance().termination, Termination::Stopped);
    assert!(!goes_back && last > 0.25 && model.provenance().train.rmse.is_finite());
}

/// A model that is wrong takes its own error for a state: what it finds must not be worse than no past.
#[test]
fn a_wrong_model_is_not_led_astray_by_a_known_beginning() {
    let train = untimed(vec![measured("train", &[], path(500, 1.0, 0.11))]);
    for model in [ClassicalModel::PrandtlIshlinskii, ClassicalModel::BoucWen] {
        let options = ClassicalOptions { starts: Some(4), ..ClassicalOptions::of(model) };
        let fitted = identify(&train, &FitSpec::Classical(options), &mut |_| ControlFlow::Continue(()));
        let model = fitted.unwrap().model;
        let cut = |k: i32| measured(&format!("cut {k}"), &[], path(300, 0.5, 0.03 * f64::from(k)));
        let cuts: Vec<Record> = (1..9).map(cut).collect();
        let blank = cuts.iter().map(|cut| cut.clone().scored_where(|row| row >= 100)).collect();
        let virgin = model.evaluate(&untimed(blank)).unwrap().rmse;
        let beginning = KnownBeginning::Rows(100);
        let known = model.clone().with_known_beginning(beginning).evaluate(&untimed(cuts)).unwrap().rmse;
        assert!(known < 1.03 * virgin, "{}: {known} known, {virgin} virgin", model.name().name());
    }
}

/// Known rows are not scored, and a division into blocks changes nothing.
#[test]
fn a_known_beginning_is_not_scored_and_may_be_taken_in_blocks() {
    let train = untimed(vec![measured("train", &[], path(400, 1.0, 0.11))]);
    let options = ClassicalOptions { operators: Some(12), ..ClassicalOptions::of(ClassicalModel::Preisach) };
    let fitted = identify(&train, &FitSpec::Classical(options), &mut |_| ControlFlow::Continue(()));
    let model = fitted.unwrap().model;
    let whole = measured("cut", &[0.9], path(200, 0.5, 0.13));
    let cut = whole.clone().with_known_beginning(50);
    assert_eq!((cut.scored(), cut.known()), (150, &whole.output()[..50]));
    assert_eq!(cut.fingerprint(), whole.fingerprint());
    // Another number of known rows begins from the whole record again.
    let again = cut.clone().with_known_beginning(20);
    assert_eq!((again.scored(), again.known()), (180, &whole.output()[..20]));
    assert!(cut.clone().with_known_beginning(0) == whole);

    let at_once = model.simulate(&cut).unwrap();
    let mut simulation = model.simulation();
    simulation.begin("cut");
    let mut in_blocks = Vec::new();
    for (first, last) in [(0, 60), (60, 61), (61, 150), (150, 200)] {
        let x = &whole.inputs()[0][first..last];
        let block = hysid::data::record::Excitation::new("cut", vec![x]).unwrap();
        let known = if first == 0 { cut.known() } else { &[] };
        in_blocks.extend(simulation.take(&block.with_known_beginning(known).unwrap()).unwrap().output);
    }
    in_blocks.extend(simulation.finish().unwrap().output);
    assert_eq!(in_blocks, at_once);
    let blank = untimed(vec![whole.clone().scored_where(|row| row >= 50)]);
    let error = |rows| {
        let model = model.clone().with_known_beginning(KnownBeginning::Rows(rows));
        model.evaluate(&blank).map_err(|error| error.to_string())
    };
    assert!(error(50).unwrap_err().contains("is blank in the first 50 rows"));
    assert!(error(51).is_ok());
    let too_many = hysid::data::record::Excitation::new("cut", vec![&[0.0, 1.0]]).unwrap();
    assert!(too_many.with_known_beginning(&[0.0; 3]).is_err());
}

#[test]
fn a_state_is_found_once_and_used_everywhere() {
    let train = untimed(vec![measured("train", &[], path(400, 1.0, 0.11))]);
    let options = ClassicalOptions { operators: Some(12), ..ClassicalOptions::of(ClassicalModel::Preisach) };
    let single = model_of(&train, &FitSpec::Classical(options));
    let network = small(ModelName::Network(Family::Xpnn), None);
    let options =
        AutoOptions { only: Some(Box::new(network)), members: 2, starts: 2, ..AutoOptions::default() };
    let ensemble = model_of(&train, &FitSpec::Auto(options));
    let cut = measured("cut", &[0.9, -0.4], path(200, 0.5, 0.13));
    for model in [&single, &ensemble] {
        runs_from_its_state(model, &cut, 60);
    }
    let known = cut.clone().with_known_beginning(60);
    let state = |model: &Model| model.find_state(&known.excitation()).unwrap();
    let of_both = state(&ensemble).to_string();
    assert!(of_both.contains("member 1: ") && of_both.contains("; member 2: "), "{of_both}");
    assert!(state(&single).to_string().starts_with("after "), "{}", state(&single));
    // The band is that of the run with the known beginning.
    let of_ensemble = state(&ensemble);
    assert_eq!(
        ensemble.predict(&cut.excitation().with_state(&of_ensemble), 0.9).unwrap(),
        ensemble.predict(&known.excitation(), 0.9).unwrap()
    );

    let refused = single.response(&cut.excitation().with_state(&of_ensemble)).unwrap_err().to_string();
    assert!(refused.contains("was found by another model"), "{refused}");
    assert!(single.stepper().reset_to_record(&of_ensemble).is_err());
    assert!(ensemble.simulation().take(&cut.excitation().with_state(&state(&single))).is_err());
    // A copy of the model, and one with another initial state, are the same model.
    let copy = Model::from_json(&single.to_json()).unwrap().with_initial_state(InitialState::SaturatedUp);
    assert!(copy.unwrap().response(&cut.excitation().with_state(&state(&single))).is_ok());
    let error = single.find_state(&cut.excitation()).unwrap_err().to_string();
    assert!(error.contains("is blank in the first 0 rows"), "{error}");
    let blank = cut.excitation().with_known_beginning(&[f64::NAN; 5]).unwrap();
    assert!(single.find_state(&blank).unwrap_err().to_string().contains("is blank in the first 5 rows"));
}

#[test]
fn a_time_is_so_many_rows() {
    let record = measured("r", &[], path(40, 1.0, 0.1));
    let timed = record.clone().with_time((0..40).map(|k| 5.0 + 0.5 * f64::from(k)).collect()).unwrap();
    for (beginning, rows) in [
        (KnownBeginning::default(), 0),
        (KnownBeginning::Rows(7), 7),
        (KnownBeginning::Rows(100), 40),
        (KnownBeginning::Time(2.0), 5),
        (KnownBeginning::Time(1.9), 4),
        (KnownBeginning::Share(0.1), 4),
    ] {
        assert_eq!(beginning.rows(&timed), rows, "{beginning:?}");
    }
    assert_eq!(KnownBeginning::Time(2.0).rows(&record), 0);
}

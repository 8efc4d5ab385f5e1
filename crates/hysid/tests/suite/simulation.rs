//! Free runs in blocks: however a record is cut, the outputs are those of the whole to the last bit.

use crate::scaffold::*;
use hysid::model::{Prediction, Simulation};
use hysid_core::elementary::cos;

use crate::noisy_record::waved;

const METHODS: [RateMethod; 4] =
    [RateMethod::Given, RateMethod::Central, RateMethod::Backward, RateMethod::SavitzkyGolay];

/// With a second input and a given rate.
fn rich(rows: usize, name: &str) -> Record {
    let plain = record(rows, name);
    let x = plain.inputs()[0].to_vec();
    let load = (0..rows).map(|k| cos(0.05 * k as f64)).collect();
    let rate = (0..rows).map(|k| cos(0.19 * k as f64)).collect();
    let rich = Record::new(name, vec![x, load], plain.output().to_vec()).unwrap();
    rich.with_time(plain.time().unwrap().to_vec()).unwrap().with_given_rate(rate).unwrap()
}

fn with_rate(rows: usize, name: &str) -> Record {
    let rate = (0..rows).map(|k| cos(0.19 * k as f64)).collect();
    record(rows, name).with_given_rate(rate).unwrap()
}

fn fitted(records: Vec<Record>, request: &FitSpec) -> Model {
    let inputs = records[0].inputs().len();
    let names =
        ColumnNames { rate: records[0].given_rate().map(|_| "v".into()), ..ColumnNames::plain(inputs) };
    let data = Dataset::new(names, records).unwrap();
    model_of(&data, request)
}

/// Rows of a record as an excitation of their own.
fn rows<'r>(record: &'r Record, range: std::ops::Range<usize>) -> Excitation<'r> {
    let inputs = record.inputs().iter().map(|input| &input[range.clone()]).collect();
    let mut rows = Excitation::new(record.name(), inputs).unwrap();
    if let Some(time) = record.time() {
        rows = rows.with_time(&time[range.clone()]).unwrap();
    }
    if let Some(lead_in) = record.lead_in().filter(|_| range.start == 0) {
        rows = rows.with_lead_in(lead_in).unwrap();
    }
    match record.given_rate() {
        Some(rate) => rows.with_given_rate(&rate[range]).unwrap(),
        None => rows,
    }
}

/// A simulation cut into blocks whose lengths go round in a circle.
pub fn in_blocks(simulation: &mut Simulation<'_>, record: &Record, lengths: &[usize]) -> Prediction {
    let mut all = Prediction { output: Vec::new(), low: Vec::new(), high: Vec::new() };
    let mut add = |some: Prediction| {
        all.output.extend(some.output);
        all.low.extend(some.low);
        all.high.extend(some.high);
    };
    simulation.begin(record.name());
    let (mut first, mut lengths) = (0, lengths.iter().cycle());
    while first < record.len() {
        let end = record.len().min(first + lengths.next().unwrap());
        add(simulation.take(&rows(record, first..end)).unwrap());
        first = end;
    }
    add(simulation.finish().unwrap());
    all
}

/// Whole, cut in many ways, and several records one after another.
fn check(model: &Model, records: &[Record], what: &str) {
    // Longer than a chunk of the library too.
    for lengths in [&[1][..], &[3, 1, 7], &[1023, 1, 1025]] {
        let mut simulation = model.simulation();
        for record in records {
            let whole = model.simulate(record).unwrap();
            let cut = in_blocks(&mut simulation, record, lengths);
            assert!(bits(&cut.output) == bits(&whole), "{what}, {}, {lengths:?}", record.name());
            assert!(cut.low.is_empty() && cut.high.is_empty());
        }
        let data = Dataset::new(ColumnNames::plain(records[0].inputs().len()), records.to_vec()).unwrap();
        assert_eq!(simulation.range_warnings(), model.range_warnings(&data).unwrap(), "{what}");
    }
}

#[test]
fn every_model_with_every_rate_is_the_same_in_blocks() {
    for method in METHODS {
        let train = vec![with_rate(200, "a"), with_rate(160, "b")];
        // Beyond the trained range, one row long, and longer than any block.
        let unseen = [with_rate(2600, "long"), with_rate(1, "one"), with_rate(7, "short")];
        for model in ModelName::all() {
            let request = small(model, Some(method));
            if model
                .check_data(&Dataset::new(ColumnNames::plain(1), train.clone()).unwrap(), Some(method))
                .is_err()
            {
                continue;
            }
            check(&fitted(train.clone(), &request), &unseen, &format!("{} {method:?}", model.name()));
        }
    }
}

#[test]
fn further_inputs_and_what_a_model_makes_of_its_input_are_the_same_in_blocks() {
    for method in METHODS {
        let mut chosen = NamedOptions::of(serde_json::from_str(OPTIONS).unwrap()).unwrap();
        chosen.model = Some(ModelName::Network(Family::XpnnPlus));
        let request = chosen.request(Some(method), true);
        let model = fitted(vec![rich(200, "a"), rich(150, "b")], &request);
        assert!(model.input_transform().compression.is_some() && model.input_transform().history.is_some());
        check(&model, &[rich(2100, "long"), rich(3, "short")], &format!("{method:?}"));
    }
}

const OPTIONS: &str = r#"{"stops": 3, "hidden": 2, "relaxation": 1, "starts": 1, "epochs": 3, "compression": 0.2,
    "rate_compression": 0.3, "history": true}"#;

#[test]
fn an_ensemble_and_its_band_are_the_same_in_blocks() {
    for method in [None, Some(RateMethod::Central), Some(RateMethod::SavitzkyGolay)] {
        let train = vec![waved(150, "a"), waved(110, "b"), waved(130, "c")];
        let model = fitted(train, &small(ModelName::AUTO, method));
        assert!(model.ensemble().unwrap().members().len() > 1);
        let unseen = [record(1500, "long"), record(2, "short")];
        check(&model, &unseen, "ensemble");
        for lengths in [&[1][..], &[64, 1, 700]] {
            let mut simulation = model.simulation_with_band(0.9).unwrap();
            for record in &unseen {
                let whole = model.predict(&record.excitation(), 0.9).unwrap();
                assert_eq!(in_blocks(&mut simulation, record, lengths), whole, "{method:?} {lengths:?}");
                assert_eq!(bits(&whole.output), bits(&model.simulate(record).unwrap()));
            }
        }
    }
    let single =
        fitted(vec![record(150, "a")], &small(ModelName::Classical(ClassicalModel::PrandtlIshlinskii), None));
    assert!(
        single.simulation_with_band(0.9).is_err()
            && single.predict(&record(9, "r").excitation(), 0.9).is_err()
    );
}

#[test]
fn errors_in_blocks_are_those_of_the_whole_to_the_last_bit() {
    let (model, record) = (
        fitted(vec![record(150, "a")], &small(ModelName::Classical(ClassicalModel::Masing), None)),
        record(3000, "long"),
    );
    let simulated = model.simulate(&record).unwrap();
    let (mut whole, mut parts) = (ErrorSums::default(), ErrorSums::default());
    whole.add(record.output(), &simulated);
    for (measured, simulated) in record.output().chunks(77).zip(simulated.chunks(77)) {
        parts.add_rows(measured, simulated);
    }
    parts.end_record();
    assert_eq!(parts.errors("y"), whole.errors("y"));
    // A record without a scored row is none.
    parts.add_rows(&[f64::NAN], &[0.0]);
    parts.end_record();
    assert_eq!(parts.errors("y"), whole.errors("y"));
}

/// As a record, a stepper takes magnitudes up to 1e100 and refuses larger ones; outputs are finite.
#[test]
fn a_step_is_finite_for_any_input_and_rate_that_it_takes() {
    let rate = Some(RateMethod::Backward);
    for model in ModelName::all() {
        let rate = rate.filter(|_| model.uses_rate());
        let model = fitted(vec![record(150, "r")], &small(model, rate));
        let mut stepper = model.stepper();
        let too_large =
            |error: hysid::Error| error.to_string().ends_with("too large: at most 1e100 in magnitude");
        assert!(stepper.step(&[1e200], 0.0, None).is_err_and(too_large), "{}", model.name().name());
        for (k, x) in [0.1, 1e100, -1e100, 0.0, 9e99, 5e-324, 0.3].into_iter().enumerate() {
            let given = [Some(0.5), Some(1e100), Some(-1e99)][k % 3];
            let y = stepper.step(&[x], k as f64, given).unwrap();
            assert!(y.is_finite(), "{}: {y} at {x}, rate {given:?}", model.name().name());
        }
    }
}

/// A member that refuses a sample does so before another has taken it.
#[test]
fn a_sample_that_is_refused_changes_nothing() {
    let options = serde_json::json!({ "model": "xpnn+", "members": 3, "stops": 3, "hidden": 2, "epochs": 2, "history": true });
    let request = named(options).unwrap().request(Some(RateMethod::Backward), false);
    let model = fitted(vec![record(150, "r")], &request);
    let mut stepper = model.stepper();
    stepper.step(&[0.1], 0.0, None).unwrap();
    let mut untouched = stepper.clone();
    // The backward rate is infinite.
    assert!(stepper.step(&[1e300], 5e-324, None).is_err());
    assert!(stepper.step(&[f64::NAN], 1.0, None).is_err());
    for k in 1..4 {
        let next =
            |stepper: &mut hysid::model::Stepper<'_>| stepper.step(&[0.2], f64::from(k), None).unwrap();
        assert_eq!(next(&mut stepper).to_bits(), next(&mut untouched).to_bits());
    }
}

#[test]
fn defects_name_their_row_in_the_record() {
    let model =
        fitted(vec![record(150, "a")], &small(ModelName::Network(Family::Xpnn), Some(RateMethod::Central)));
    let defect = |result: hysid::Result<Prediction>| match result {
        Err(Error::Data(defect)) => defect,
        other => panic!("{other:?}"),
    };
    let mut simulation = model.simulation();
    simulation.begin("r");
    let x = [0.1, 0.2, 0.3];
    let block = |time: &'static [f64]| Excitation::new("r", vec![&x]).unwrap().with_time(time).unwrap();
    simulation.take(&block(&[0.0, 1.0, 2.0])).unwrap();
    let found = defect(simulation.take(&block(&[2.0, 3.0, 4.0])));
    assert_eq!(
        (found.row, found.problem),
        (Some(3), DataProblem::TimeNotIncreasing { before: 2.0, now: 2.0 })
    );
    // The rate of row 3 follows from row 4, which comes with the block after.
    simulation.begin("r");
    simulation.take(&block(&[0.0, 1.0, 2.0])).unwrap();
    let tiny: &'static [f64] = &[3.0, 3.0 + 1e-15, 4.0];
    let x: [f64; 3] = [1e99, -1e99, 0.0];
    let wild = Excitation::new("r", vec![&x]).unwrap().with_time(tiny).unwrap();
    let found = defect(simulation.take(&wild));
    assert_eq!((found.row, found.record.as_str()), (Some(3), "r"));
    assert!(matches!(found.problem, DataProblem::RateTooLarge(_)));
    // Without what the model needs.
    simulation.begin("r");
    let found = defect(simulation.take(&Excitation::new("r", vec![&x]).unwrap()));
    assert_eq!(found.problem, DataProblem::NoTimeForModel);
    simulation.begin("r");
    let found = defect(
        simulation.take(&Excitation::new("r", vec![&x, &x]).unwrap().with_time(&[0.0, 1.0, 2.0]).unwrap()),
    );
    assert_eq!(found.problem, DataProblem::Inputs { expected: 1, found: 2 });
}

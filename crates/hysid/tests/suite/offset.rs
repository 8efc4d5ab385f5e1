//! Where the input is measured from does not matter: the same data at 198 to 202 mm in place of -2 to 2 give
//! the same model.

use hysid_core::elementary::sin;

use crate::scaffold::*;

fn shifted(by: f64) -> Dataset {
    let records = [record(180, "a"), record(140, "b")].map(|record| {
        let x = record.inputs()[0].iter().map(|x| x + by).collect();
        let shifted = Record::new(record.name(), vec![x], record.output().to_vec()).unwrap();
        shifted.with_time(record.time().unwrap().to_vec()).unwrap()
    });
    let names = ColumnNames { inputs: vec!["x_mm".into()], ..ColumnNames::plain(1) };
    Dataset::new(names, records.into()).unwrap()
}

fn fitted(data: &Dataset, model: ModelName) -> Model {
    let rate = model.uses_rate().then_some(RateMethod::Central);
    model_of(data, &small(model, rate))
}

#[test]
fn errors_are_the_same_wherever_the_input_is() {
    let (low, high) = shifted(0.0).input_range(0);
    let half = 0.5 * (high - low);
    let all = ModelName::all().chain([ModelName::AUTO]);
    for model in all.filter(|model| *model != ModelName::Classical(ClassicalModel::JilesAtherton)) {
        let there = shifted(0.0);
        let expected = error_percent(&fitted(&there, model), &there);
        // The automatic model takes the others' time together.
        let offsets: &[f64] = if model == ModelName::AUTO { &[1e3] } else { &[-30.0, 1e6] };
        for offset in offsets {
            let data = shifted(offset * half);
            let model = fitted(&data, model);
            let found = error_percent(&model, &data);
            let name = model.name().name();
            assert!(
                (found - expected).abs() < 0.03 * expected + 1e-3,
                "{name}: {found} % at {offset}, {expected} % at 0"
            );
            assert_eq!(Model::from_json(&model.to_json()).unwrap(), model, "{name}");
        }
    }
}

/// Step by step it is the same model too, and the ranges it tells are those of the data.
#[test]
fn a_shifted_model_steps_as_it_simulates() {
    let data = shifted(5000.0);
    let model = fitted(&data, "xpnn".parse().unwrap());
    let record = &data.records()[0];
    let simulated = model.simulate(record).unwrap();
    let rates = RateMethod::Central.rate(record).unwrap();
    let mut stepper = model.stepper();
    for (row, y) in simulated.iter().enumerate() {
        let x = [record.inputs()[0][row]];
        assert_eq!(stepper.step(&x, record.time().unwrap()[row], Some(rates[row])).unwrap(), *y);
    }
    assert_eq!(model.trained_ranges().inputs[0], data.input_range(0));
    assert_eq!(model.input_transform().origins, [record.inputs()[0][0]]);
}

/// Jiles and Atherton's law is about a field of 0: it is not shifted.
#[test]
fn the_origin_of_a_field_stays() {
    let data = shifted(0.1);
    let model = fitted(&data, ModelName::Classical(ClassicalModel::JilesAtherton));
    assert!(model.input_transform().is_none());
}

/// A further input far from 0 is measured from its middle.
#[test]
fn further_inputs_are_shifted_too() {
    let with_temperature = |by: f64| {
        let record = record(200, "a");
        let temperature = (0..200).map(|row| by + 5.0 * sin(0.05 * f64::from(row))).collect();
        let record =
            Record::new("a", vec![record.inputs()[0].to_vec(), temperature], record.output().to_vec());
        Dataset::new(ColumnNames { time: None, ..ColumnNames::plain(2) }, vec![record.unwrap()]).unwrap()
    };
    let errors = [0.0, 300.0, 1e6].map(|by| {
        let data = with_temperature(by);
        let request = small("xpnn+".parse().unwrap(), None);
        let model = model_of(&data, &request);
        error_percent(&model, &data)
    });
    for error in errors {
        assert!((error / errors[0] - 1.0).abs() < 0.01, "{errors:?}");
    }
}

//! Imports and helpers that most tests of the suite use.

pub use std::ops::ControlFlow;

pub use hysid::data::initial_state::InitialState;
pub use hysid::data::metrics::ErrorSums;
pub use hysid::data::rate::RateMethod;
pub use hysid::data::record::{ColumnNames, Dataset, Excitation, Record};
pub use hysid::error::{DataProblem, Error};
pub use hysid::fit::law::Identify;
pub use hysid::fit::network::objective::Objective;
pub use hysid::fit::progress::SearchProgress;
pub use hysid::fit::progress::{Fitted, Progress};
pub use hysid::fit::{cross_validate, identify};
pub use hysid::law::series::{Series, samples_of};
pub use hysid::law::{Classical, Law, Sample};
pub use hysid::model::Model;
pub use hysid::operator::{DeterioratingStop, Operator, Relay, Stop};
pub use hysid::options::chosen::NamedOptions;
pub use hysid::options::classical::{ClassicalModel, ClassicalOptions};
pub use hysid::options::fit_spec::AutoOptions;
pub use hysid::options::network::FitOptions;
pub use hysid::options::{FitSpec, ModelName};
pub use hysid::specimens::with_noise;
pub use hysid_core::network::scaling::Scaling;
pub use hysid_core::network::{Architecture, Family, Network, NetworkDrive, ParameterLayout, Sizes};
pub use hysid_core::stop_check::StopCheck;
pub use hysid_core::termination::Termination;
pub use rand::{RngExt, SeedableRng};
pub use rand_xoshiro::Xoshiro256PlusPlus as Generator;

pub use crate::small_models::{record, small};

/// An observer of a search that lets it go on.
pub fn go_on(_: SearchProgress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// An observer of a fit that lets it go on.
pub fn on(_: &Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

pub fn of(model: ClassicalModel) -> ClassicalOptions {
    ClassicalOptions::of(model)
}

pub fn named(options: serde_json::Value) -> hysid::Result<NamedOptions> {
    NamedOptions::of(serde_json::from_value(options).unwrap())
}

/// A fit without rate by the names of its options.
pub fn request(options: serde_json::Value) -> FitSpec {
    named(options).unwrap().request(None, false)
}

pub fn model_of(data: &Dataset, request: &FitSpec) -> Model {
    identify(data, request, &mut on).unwrap().model
}

pub fn error_percent(model: &Model, data: &Dataset) -> f64 {
    model.evaluate(data).unwrap().nrmse_std_percent.unwrap()
}

/// Data of one record with time stamps.
pub fn timed(time: Vec<f64>, x: Vec<f64>, y: Vec<f64>) -> Dataset {
    Dataset::from_columns(Some(("t", &time)), &[("x", &x)], ("y", &y)).unwrap()
}

pub fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

pub fn between(generator: &mut Generator, low: f64, high: f64) -> f64 {
    low + (high - low) * generator.random::<f64>()
}

/// A path through turning points, each swing in `steps` equal steps.
pub fn through(turning: &[f64], steps: usize) -> Vec<f64> {
    let mut path = vec![turning[0]];
    for ends in turning.windows(2) {
        path.extend((1..=steps).map(|k| ends[0] + (ends[1] - ends[0]) * k as f64 / steps as f64));
    }
    path
}

pub fn outputs<L: Law>(law: &L, x: &[f64]) -> Vec<f64> {
    hysid::law::series::run(law, &samples_of(x))
}

pub fn last<L: Law>(law: &L, x: &[f64]) -> f64 {
    outputs(law, x)[x.len() - 1]
}

/// Error of a free run of a law in percent of the output's standard deviation.
pub fn error_of<L: Law>(law: &L, data: &Dataset, rate: Option<RateMethod>) -> f64 {
    let mut sums = ErrorSums::default();
    for series in Series::all(data, rate).unwrap() {
        sums.add(&series.output, &hysid::law::series::run(law, &series.samples));
    }
    sums.errors("y").unwrap().nrmse_std_percent.unwrap()
}

/// Runs of a model from the state that it finds in the first rows of a record: whole, in blocks and sample by sample, they
/// are those with the known beginning.
pub fn runs_from_its_state(model: &Model, record: &Record, rows: usize) {
    let known = record.clone().with_known_beginning(rows);
    let expected = model.simulate(&known).unwrap();
    let state = model.find_state(&known.excitation()).unwrap();
    assert_eq!(model.response(&record.excitation().with_state(&state)).unwrap(), expected, "{state}");
    let mut simulation = model.simulation();
    let mut in_blocks = simulation.take(&record.excitation().with_state(&state)).unwrap().output;
    in_blocks.extend(simulation.finish().unwrap().output);
    assert_eq!(in_blocks, expected, "{state}");
    let mut stepper = model.stepper();
    stepper.step(&inputs_at(record, 3), 0.0, None).unwrap();
    stepper.reset_to_record(&state).unwrap();
    for (row, y) in expected.iter().enumerate() {
        let (inputs, time) = (inputs_at(record, row), record.time().map_or(f64::NAN, |time| time[row]));
        // A trial changes nothing.
        assert_eq!(stepper.trial(&inputs, time, None).unwrap(), *y, "row {row}, {state}");
        assert_eq!(stepper.step(&inputs, time, None).unwrap(), *y, "row {row}, {state}");
    }
    stepper.reset();
    let virgin = model.stepper().step(&inputs_at(record, 0), 0.0, None).unwrap();
    assert_eq!(stepper.step(&inputs_at(record, 0), 0.0, None).unwrap(), virgin);
}

fn inputs_at(record: &Record, row: usize) -> Vec<f64> {
    record.inputs().iter().map(|input| input[row]).collect()
}

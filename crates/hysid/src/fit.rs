//! Identification of any model by its name: a network, a classical model, or `auto`.

pub mod auto;
pub(crate) mod initial_state;
pub mod intervals;
pub mod law;
mod memory_need;
pub mod network;
mod one_model;
pub mod progress;
mod random_start;
pub(crate) mod sums;
mod validate;

use crate::data::FEWEST_ROWS;
use crate::data::record::Dataset;
use crate::error::{Channel, DataProblem, Result};
use crate::fit::progress::{Fitted, Observer};
use crate::options::FitSpec;

pub use memory_need::MemoryNeed;
pub use validate::cross_validate;

/// Identifies a model. The observer is as in [`network::fit`]; it is called after every round of the search
/// of a classical model, or at intervals if there is no search, and then without a checkpoint.
///
/// # Errors
/// Data from which no model can be identified, invalid options, or a stop before there was a model.
pub fn identify(data: &Dataset, request: &FitSpec, observer: &mut Observer<'_>) -> Result<Fitted> {
    check_warm_up(data, request)?;
    if data.scored() > 0 {
        request.judged_beginning(data.names())?.check_rest(data)?;
    }
    let is_auto = matches!(request, FitSpec::Auto(_));
    law::check_weights(data, if is_auto { "auto" } else { request.model().name() })?;
    match request {
        FitSpec::Auto(options) => auto::fit(data, options, observer),
        FitSpec::Network(_) | FitSpec::Classical(_) => one_model::identify(data, request, observer),
    }
}

/// The peak memory of an identification with this number of threads.
///
/// # Errors
/// Options that are no valid network for these data.
pub fn memory_need(data: &Dataset, request: &FitSpec, threads: usize) -> Result<MemoryNeed> {
    match request {
        FitSpec::Network(options) => network::memory_need(data, options, threads),
        FitSpec::Classical(options) => Ok(law::memory_need(data, options, threads)),
        FitSpec::Auto(options) => {
            let mut largest = MemoryNeed::of(0.0, "nothing", "");
            for candidate in auto::requests(data, options) {
                // Candidates that cannot be fitted to these data are passed over, as in the fit.
                let Ok(need) = memory_need(data, &candidate, 1) else { continue };
                if need.bytes > largest.bytes {
                    largest = need;
                }
            }
            // Each thread fits a candidate of its own, on folds that are copies of the data.
            let of_candidates = threads as f64 * largest.bytes;
            Ok(MemoryNeed { bytes: of_candidates, ..largest }.and(10.0 * memory_need::numbers(data)))
        }
    }
}

/// Checks that a warm-up leaves enough to train on.
fn check_warm_up(data: &Dataset, request: &FitSpec) -> Result<()> {
    let warm_up = match request {
        FitSpec::Network(options) => options.shaping.warm_up,
        FitSpec::Auto(options) => options.warm_up.unwrap_or(0),
        FitSpec::Classical(options) => options.shaping.warm_up,
    };
    if warm_up == 0 || data.scored() < FEWEST_ROWS {
        return Ok(());
    }
    let after = data.records().iter().flat_map(|record| record.output().iter().skip(warm_up));
    let found = after.filter(|y| !y.is_nan()).count();
    let problem = DataProblem::LongWarmUp { warm_up, found, needed: FEWEST_ROWS };
    match found < FEWEST_ROWS {
        true => Err(data.records()[0].defect(None, Some(Channel::Output), problem)),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;
    use crate::data::record::{ColumnNames, Record};
    use crate::options::ModelName;
    use crate::options::chosen::NamedOptions;

    fn data(rows: usize, inputs: usize) -> Dataset {
        let input = |c: usize| (0..rows).map(|k| sin((k + c) as f64 * 0.1)).collect();
        let time = (0..rows).map(|k| k as f64).collect();
        let inputs: Vec<Vec<f64>> = (0..inputs).map(input).collect();
        let output = inputs[0].clone();
        let names = ColumnNames::plain(inputs.len());
        let record = Record::new("r", inputs, output).unwrap().with_time(time).unwrap();
        Dataset::new(names, vec![record]).unwrap()
    }

    fn need(data: &Dataset, options: serde_json::Value) -> MemoryNeed {
        let serde_json::Value::Object(options) = options else { panic!("a map") };
        let request = NamedOptions::of(options).unwrap().request(None, false);
        memory_need(data, &request, 2).unwrap()
    }

    #[test]
    fn the_largest_network_is_refused_with_numbers_and_advice() {
        let rows = data(200_000, 1);
        let sizes = serde_json::json!({ "model": "xpnn+", "stops": 300, "hidden": 300, "training": "levenberg-marquardt" });
        let need = need(&rows, sizes);
        assert!(need.bytes > 60e9, "{need:?}");
        let error = need.check(16e9).unwrap_err().to_string();
        for words in ["GB", "16.0 GB are available", "searched parameters", "fewer hidden"] {
            assert!(error.contains(words), "{error}");
        }
        assert!(need.check(1e13).is_ok());
    }

    #[test]
    fn few_rows_of_many_inputs_need_little() {
        let wide = data(50, 99);
        let need = need(&wide, serde_json::json!({ "model": "xpnn+" }));
        assert!(need.bytes < 300e6, "{need:?}");
    }

    #[test]
    fn every_model_has_an_estimate() {
        let rows = data(1000, 1);
        for model in ModelName::all().chain([ModelName::AUTO]) {
            let need = need(&rows, serde_json::json!({ "model": model.name() }));
            assert!(need.bytes > 1e4 && need.bytes < 1e9, "{}: {need:?}", model.name());
        }
        let fine = need(&rows, serde_json::json!({ "model": "preisach", "operators": 200 }));
        assert!(fine.bytes > 5e9 && fine.taken_by.contains("cells"), "{fine:?}");
    }
}

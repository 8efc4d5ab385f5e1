//! The example of the first page: a soft magnet, and a model that is judged by data that it was not fitted to.

use std::ops::ControlFlow;

use hysid::data::record::Dataset;
use hysid::fit::identify;
use hysid::options::chosen::NamedOptions;
use hysid::specimens::{Specimen, with_noise};
use hysid_document::{Result, unit};
use hysid_records::{RateOption, csv_text, data_of_text};
use serde_json::{Map, Value, json};

use crate::judgement::{Run, columns};

const SPECIMEN: &str = "ferromagnet";
const SEED: u64 = 1;
const NOISE_PERCENT: f64 = 1.0;

/// The unseen data of the example, and the free run of its model over them.
pub struct Example {
    pub columns: Vec<(&'static str, Vec<f64>)>,
    /// The specimen, the options of the fit, labels and errors.
    pub facts: Value,
}

impl Example {
    /// Fits the model, which takes about a second.
    pub fn new() -> Result<Self> {
        let specimen = Specimen::named(SPECIMEN).expect("it is in the catalogue");
        // The very data that the project gets with this specimen.
        let as_stored =
            |data: Dataset, seed| data_of_text(csv_text(&with_noise(&data, NOISE_PERCENT, seed)?).as_bytes());
        let train = as_stored(specimen.train_with_seed(SEED), SEED)?;
        let unseen = as_stored(specimen.test_with_seed(SEED), !SEED)?;
        let options = Map::from_iter([("model".into(), json!("preisach")), ("members".into(), json!(2))]);
        let spec = RateOption::default().request(&NamedOptions::of(options.clone())?, &train)?;
        let model = identify(&train, &spec, &mut |_| ControlFlow::Continue(()))?.model;
        let run = Run::of(&model, unseen)?;
        let record = &run.data.records()[0];
        let row = (1..=record.len()).map(|row| row as f64).collect();
        let mut all =
            vec![("row", row), ("input", record.inputs()[0].to_vec()), ("output", record.output().to_vec())];
        all.extend(columns(&run.predicted));
        let names = run.data.names();
        let facts = json!({
            "specimen": {"name": SPECIMEN, "seed": SEED, "noise_percent": NOISE_PERCENT, "is_example": true},
            "options": options,
            "model": model.name().name(),
            "inputs": [unit::label(&names.inputs[0])],
            "output": unit::label(&names.output),
            "rows_in_training": train.rows(),
            "rows": record.len(),
            "error_percent": run.errors.nrmse_std_percent,
            "validation_percent": model.provenance().validation.as_ref().and_then(|errors| errors.nrmse_std_percent),
        });
        Ok(Self { columns: all, facts })
    }
}

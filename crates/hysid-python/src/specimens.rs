//! The synthetic specimens.

use std::sync::Arc;

use hysid::specimens::{Specimen, with_noise};
use pyo3::prelude::*;

use crate::data::Dataset;
use crate::failure::refused;

/// Name, example of the paper, summary, what is published, what is designed, training and test data.
type Description = (
    &'static str,
    Option<&'static str>,
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    &'static str,
);

/// All specimens.
#[pyfunction]
pub fn specimens() -> Vec<Description> {
    let described = |specimen: &&Specimen| {
        let Specimen { name, example, summary, published, designed, training, testing, .. } = specimen;
        (*name, *example, *summary, *published, *designed, *training, *testing)
    };
    Specimen::all().iter().map(described).collect()
}

/// The data of a specimen, as `hysid generate` writes them: noise in percent of the output's deviation.
#[pyfunction]
pub fn specimen(name: &str, test: bool, noise: f64, seed: u64) -> PyResult<Dataset> {
    let Some(specimen) = Specimen::named(name) else {
        let names: Vec<&str> = Specimen::all().iter().map(|specimen| specimen.name).collect();
        return Err(refused(format!("specimen `{name}` is unknown: choose one of {}", names.join(", "))));
    };
    let (data, seed) =
        if test { (specimen.test_with_seed(seed), !seed) } else { (specimen.train_with_seed(seed), seed) };
    Ok(Dataset { set: Arc::new(with_noise(&data, noise, seed).map_err(refused)?) })
}

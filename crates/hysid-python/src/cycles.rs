//! Tables of cycles.

use std::sync::Arc;

use hysid::diagnosis::cycles::{CycleOptions, CycleTable, prepared};
use hysid::diagnosis::model::ModelCycles;
use hysid::diagnosis::reversal_curves::{ReversalCurveOptions, ReversalCurves};
use hysid::model::Model;
use pyo3::prelude::*;
use serde::Serialize;

use crate::data::Dataset;
use crate::failure::refused;
use crate::interruption::interruptible;

/// Cycles and reversal curves, as Python reads them.
#[derive(Serialize)]
struct CyclesContent<'a> {
    table: &'a CycleTable,
    reversal_curves: Option<&'a ReversalCurves>,
    /// How the data were changed before.
    changes: &'a [String],
}

/// Names of the figures of a cycle, in the order of the columns.
#[pyfunction]
pub fn figure_names() -> Vec<&'static str> {
    hysid::diagnosis::cycles::FIGURES.iter().map(|figure| figure.name).collect()
}

/// Names of the figures of an amplitude level, in the order of the columns.
#[pyfunction]
pub fn level_figure_names() -> Vec<&'static str> {
    hysid::diagnosis::cycles::LEVEL_FIGURES.iter().map(|figure| figure.name).collect()
}

/// The cycles and first-order reversal curves of data, as JSON.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "they are those of the function in Python")]
#[pyo3(signature = (data, smallest_reversal, smoothing, division, field, smoothing_factor, smoothing_growth, density, height))]
pub fn cycles(
    py: Python<'_>,
    data: &Dataset,
    smallest_reversal: Option<f64>,
    smoothing: bool,
    division: Option<&str>,
    field: Option<&str>,
    smoothing_factor: Option<usize>,
    smoothing_growth: f64,
    density: Option<f64>,
    height: Option<f64>,
) -> PyResult<String> {
    let options = CycleOptions { smallest_reversal, smoothing, density, height, ..options(division, field)? };
    let of_curves = ReversalCurveOptions { branches: options.branches(), smoothing_factor, smoothing_growth };
    let set = Arc::clone(&data.set);
    let find = move || {
        let (set, changes) = prepared(&set, options.field);
        let mut table = CycleTable::of(&set, &options)?;
        table.notes.splice(..0, changes.clone());
        Ok((table, ReversalCurves::of(&set, &of_curves)?, changes))
    };
    let (table, curves, changes) = interruptible(py, find)?;
    told(&table, curves.as_ref(), &changes)
}

/// The cycles and first-order reversal curves that a model is driven through, as JSON.
pub fn of_model(
    py: Python<'_>,
    model: &Arc<Model>,
    division: Option<&str>,
    field: Option<&str>,
    smoothing_factor: Option<usize>,
    (density, height): (Option<f64>, Option<f64>),
) -> PyResult<String> {
    let (model, options) = (Arc::clone(model), CycleOptions { density, height, ..options(division, field)? });
    let driven = interruptible(py, move || ModelCycles::of(&model, &options, smoothing_factor))?;
    told(&driven.table, driven.reversal_curves.as_ref(), &[])
}

fn options(division: Option<&str>, field: Option<&str>) -> PyResult<CycleOptions> {
    Ok(CycleOptions {
        division: division.map(str::parse).transpose().map_err(|error: hysid::Error| refused(error))?,
        field: field.map(str::parse).transpose().map_err(|error: hysid::Error| refused(error))?,
        ..CycleOptions::default()
    })
}

fn told(
    table: &CycleTable,
    reversal_curves: Option<&ReversalCurves>,
    changes: &[String],
) -> PyResult<String> {
    serde_json::to_string(&CyclesContent { table, reversal_curves, changes }).map_err(refused)
}

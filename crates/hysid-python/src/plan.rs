//! Plans of experiments.

use std::sync::Arc;

use hysid::plan::{LimitOptions, Plan, PlanOptions, Protocol, ProtocolOptions, Wave};
use pyo3::prelude::*;

use crate::data::Dataset;
use crate::failure::refused;
use crate::interruption::interruptible;

/// A plan from data, or a protocol of a kind, as JSON.
#[pyfunction]
#[pyo3(signature = (data, kind, range, length, step, max_rate, wave, seed))]
#[allow(clippy::too_many_arguments, reason = "one for each keyword of Python")]
pub fn plan(
    py: Python<'_>,
    data: Option<&Dataset>,
    kind: Option<&str>,
    range: Option<(f64, f64)>,
    length: Option<usize>,
    step: Option<f64>,
    max_rate: Option<f64>,
    wave: Option<&str>,
    seed: u64,
) -> PyResult<String> {
    let limits = LimitOptions { range, step, max_rate, length };
    let wave: Option<Wave> =
        wave.map(str::parse).transpose().map_err(|error: hysid::Error| refused(error))?;
    let set = data.map(|data| Arc::clone(&data.set));
    let kind = kind.unwrap_or_default().to_owned();
    let made = interruptible(py, move || match set {
        Some(set) => Plan::of(&set, &PlanOptions { limits, wave, seed }),
        None => Protocol::named(&kind)?.plan(&ProtocolOptions { limits, wave }),
    })?;
    serde_json::to_string(&made).map_err(refused)
}

//! Plans of experiments.

use std::path::PathBuf;
use std::sync::Arc;

use hysid::plan::{LimitOptions, PlanOptions, Protocol, ProtocolOptions, Wave};
use hysid_app::plan::{Planned, page};
use hysid_app::{origin, page_text};
use hysid_files::{Destination, Kind};
use pyo3::prelude::*;

use crate::data::Dataset;
use crate::failure::{not_written, refused};
use crate::interruption::interruptible;

/// A drive with its segments and their reasons.
#[pyclass(frozen, module = "hysid._hysid")]
pub struct Plan {
    plan: hysid::plan::Plan,
    title: String,
    /// Code that uses the results of the drive.
    next: &'static str,
}

#[pymethods]
impl Plan {
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.plan).map_err(refused)
    }

    /// Writes the page of the plan.
    fn report(&self, path: PathBuf, title: Option<String>, force: bool) -> PyResult<()> {
        let title = title.unwrap_or_else(|| self.title.clone());
        let planned = Planned { plan: &self.plan, title, understood: Vec::new(), next: self.next.into() };
        let mut page = page(&planned);
        page.parts.push(origin::section("hysid.Plan.report", &[]));
        let destination = Destination::new(path, Kind::Page, force);
        destination.write(page_text(&page).as_bytes()).map(drop).map_err(not_written)
    }
}

/// A plan from data, or a protocol of a kind.
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
) -> PyResult<Plan> {
    let limits = LimitOptions { range, step, max_rate, length };
    let wave: Option<Wave> =
        wave.map(str::parse).transpose().map_err(|error: hysid::Error| refused(error))?;
    let set = data.map(|data| Arc::clone(&data.set));
    let kind = kind.unwrap_or_default().to_owned();
    interruptible(py, move || match set {
        Some(set) => Ok(Plan {
            plan: hysid::plan::Plan::of(&set, &PlanOptions { limits, wave, seed })?,
            title: "What to measure next".into(),
            next: "hysid.fit([x, new_x], [y, new_y])",
        }),
        None => {
            let protocol = Protocol::named(&kind)?;
            Ok(Plan {
                plan: protocol.plan(&ProtocolOptions { limits, wave })?,
                title: format!("First test: {}", protocol.name()),
                next: "hysid.fit(new_x, new_y)",
            })
        }
    })
}

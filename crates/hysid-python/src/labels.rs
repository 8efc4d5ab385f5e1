//! Names of columns and figures as axes and tables show them, and the table of errors.

use hysid::data::metrics::Errors;
use hysid::data::record::ColumnNames;
use hysid::diagnosis::cycles::{FIGURES, Quantities};
use hysid_app::errors_table::errors_table;
use hysid_document::unit::{label, split};
use pyo3::prelude::*;

use crate::failure::refused;

/// The quantity and the unit in the name of a column, as a page shows them.
#[pyfunction]
pub fn name_and_unit(column: &str) -> (String, Option<String>) {
    split(column)
}

/// The name of a column as an axis shows it: `force (kN)`.
#[pyfunction]
pub fn axis_label(column: &str) -> String {
    label(column)
}

/// A figure of a cycle as an axis shows it, with its unit where those of the columns give it: `energy (J)`.
#[pyfunction]
#[pyo3(signature = (figure, input, output, time))]
pub fn figure_label(figure: &str, input: String, output: String, time: Option<String>) -> PyResult<String> {
    let Some(found) = FIGURES.iter().find(|one| one.name == figure) else {
        let names: Vec<&str> = FIGURES.iter().map(|figure| figure.name).collect();
        return Err(refused(format!("there is no figure {figure:?}: choose one of {}", names.join(", "))));
    };
    let names = ColumnNames { time, inputs: vec![input], rate: None, output };
    Ok(label(&Quantities::of(&names).as_figure(found.label, found.quantity)))
}

/// Errors, as JSON, in the table that `hysid evaluate` prints.
#[pyfunction]
pub fn errors_text(errors: &str) -> PyResult<String> {
    let errors: Errors = serde_json::from_str(errors).map_err(refused)?;
    Ok(errors_table(&[("free run", &errors)]))
}

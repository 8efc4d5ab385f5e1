//! Operators and classical laws as functions on arrays.

use hysid::data::record::Excitation;
use hysid::law::Classical;
use hysid::law::series::samples;
use hysid::operator::{DeterioratingStop, Operator, Play, Relaxation, Relay, Stop};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::data::{Column, NewColumn, values};
use crate::failure::refused;
use crate::interruption::interruptible;

/// Runs an operator over a signal from its virgin state.
fn run<'py>(py: Python<'py>, x: &Column<'_>, mut operator: impl Operator) -> PyResult<NewColumn<'py>> {
    finite(x)?;
    Ok(PyArray1::from_vec(py, operator.run(x.as_slice()?)))
}

/// Refuses what an operator cannot take into its memory.
fn finite(x: &Column<'_>) -> PyResult<()> {
    match x.as_slice()?.iter().position(|x| !x.is_finite()) {
        Some(row) => Err(refused(format!("row {}, input: not a finite number", row + 1))),
        None => Ok(()),
    }
}

/// The relay, theory.md (1.1).
#[pyfunction]
pub fn relay<'py>(py: Python<'py>, x: Column<'_>, r: f64, s: f64) -> PyResult<NewColumn<'py>> {
    run(py, &x, Relay::new(r, s).map_err(refused)?)
}

/// The play, theory.md (1.2).
#[pyfunction]
pub fn play<'py>(py: Python<'py>, x: Column<'_>, r: f64) -> PyResult<NewColumn<'py>> {
    run(py, &x, Play::new(r).map_err(refused)?)
}

/// The stop, theory.md (1.3).
#[pyfunction]
pub fn stop<'py>(py: Python<'py>, x: Column<'_>, r: f64) -> PyResult<NewColumn<'py>> {
    run(py, &x, Stop::new(r).map_err(refused)?)
}

/// The deteriorating stop, theory.md (1.6).
#[pyfunction]
pub fn deteriorating_stop<'py>(
    py: Python<'py>,
    x: Column<'_>,
    r: f64,
    beta: f64,
) -> PyResult<NewColumn<'py>> {
    run(py, &x, DeterioratingStop::new(r, beta).map_err(refused)?)
}

/// The relaxation element, theory.md (1.10).
#[pyfunction]
pub fn relaxation<'py>(
    py: Python<'py>,
    x: Column<'_>,
    time: Column<'_>,
    tau: f64,
) -> PyResult<NewColumn<'py>> {
    finite(&x)?;
    let mut element = Relaxation::new(tau).map_err(refused)?;
    let stress = element.run(time.as_slice()?, x.as_slice()?).map_err(refused)?;
    Ok(PyArray1::from_vec(py, stress))
}

/// Runs a classical law, given as in a model file, from its virgin state.
#[pyfunction]
pub fn law<'py>(
    py: Python<'py>,
    description: &str,
    x: Column<'_>,
    time: Option<Column<'_>>,
    rate: Option<&str>,
) -> PyResult<NewColumn<'py>> {
    let law: Classical = serde_json::from_str(description).map_err(refused)?;
    let law = law.validated().map_err(refused)?;
    let rate = rate.map(str::parse).transpose().map_err(refused)?;
    let (x, time) = (values(&x)?, time.as_ref().map(values).transpose()?);
    let outputs = interruptible(py, move || {
        let mut excitation = Excitation::new("data", vec![&x])?;
        if let Some(time) = &time {
            excitation = excitation.with_time(time)?;
        }
        Ok(law.run(&samples(&excitation, rate)?))
    })?;
    Ok(PyArray1::from_vec(py, outputs))
}

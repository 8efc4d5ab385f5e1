//! The minimiser of functions that need not be smooth.

use hysid::optimise::space_dilatation::{self, DilatationOptions, Limits};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::data::{Column, NewColumn};
use crate::failure::refused;

/// Where the minimum is, the function there, iterations, evaluations, and why it ended.
type Found<'py> = (NewColumn<'py>, f64, usize, usize, String);

/// Minimises a function of an array that gives its value and a sub-gradient.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn minimise<'py>(
    py: Python<'py>,
    function: &Bound<'py, PyAny>,
    x: Column<'_>,
    options: &str,
    iterations: usize,
    target: f64,
    stall: usize,
) -> PyResult<Found<'py>> {
    let options: DilatationOptions = serde_json::from_str(options).map_err(refused)?;
    let mut failure = None;
    let mut value = |x: &[f64], subgradient: &mut [f64]| match evaluate(py, function, x, subgradient) {
        Ok(value) if failure.is_none() => value,
        Ok(_) => f64::NAN,
        Err(error) => {
            failure.get_or_insert(error);
            f64::NAN
        }
    };
    let limits = Limits { iterations, target, stall };
    let found = space_dilatation::minimise(&mut value, x.as_slice()?.to_vec(), options, limits);
    if let Some(error) = failure {
        return Err(error);
    }
    let (minimum, termination) = found.map_err(refused)?;
    let x = PyArray1::from_vec(py, minimum.x);
    Ok((x, minimum.value, minimum.iterations, minimum.evaluations, termination.to_string()))
}

fn evaluate(
    py: Python<'_>,
    function: &Bound<'_, PyAny>,
    x: &[f64],
    subgradient: &mut [f64],
) -> PyResult<f64> {
    py.check_signals()?;
    let answer = function.call1((PyArray1::from_slice(py, x),))?;
    let (value, slope): (f64, PyReadonlyArray1<'_, f64>) = answer.extract()?;
    let slope = slope.as_array();
    if slope.len() != subgradient.len() {
        let (found, expected) = (slope.len(), subgradient.len());
        return Err(PyValueError::new_err(format!(
            "a sub-gradient of {found} values for {expected} variables"
        )));
    }
    subgradient.iter_mut().zip(slope).for_each(|(to, from)| *to = *from);
    Ok(value)
}

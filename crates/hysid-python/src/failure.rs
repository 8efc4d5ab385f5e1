//! Errors of the library as Python's.

use std::fmt::Display;

use pyo3::PyErr;
use pyo3::exceptions::PyValueError;

/// What the caller handed in cannot be used: a `ValueError` with the library's text.
pub fn refused<E: Display>(error: E) -> PyErr {
    PyValueError::new_err(error.to_string())
}

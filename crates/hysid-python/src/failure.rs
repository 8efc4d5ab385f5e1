//! Errors of the library as Python's.

use std::fmt::Display;

use hysid_document::{Face, Problem};
use hysid_files::Failure;
use pyo3::PyErr;
use pyo3::exceptions::{PyFileExistsError, PyOSError, PyValueError};

/// Error for an invalid argument of the caller: a `ValueError` with the library's text.
pub fn refused<E: Display>(error: E) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A problem of a use case, with the arguments that help.
pub fn explained(problem: &Problem) -> PyErr {
    refused(Face::Python.told(&problem.words()))
}

/// A file could not be written: a `FileExistsError` for one that is not Hysid's own, otherwise the `OSError` of the
/// reason, such as `FileNotFoundError`.
pub fn not_written(failure: Failure) -> PyErr {
    match &failure {
        Failure::NotOurs { .. } | Failure::Changed(_) => {
            PyFileExistsError::new_err(format!("{failure}: name another file, or replace it with force=True"))
        }
        Failure::Refused { error, .. } => std::io::Error::new(error.kind(), failure.to_string()).into(),
        Failure::InUse(_) | Failure::NotPlain(_) | Failure::HoldsInput { .. } => {
            PyOSError::new_err(failure.to_string())
        }
    }
}

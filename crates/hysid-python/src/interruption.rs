//! Long computations that Ctrl-C interrupts.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::failure::refused;

/// How often signals are looked for.
pub const PAUSE: Duration = Duration::from_millis(50);

/// Elementary operations of about ten milliseconds.
const SHORT: f64 = 1e7;

/// Runs work on a thread of its own, which holds all that it needs, and returns its result. Ctrl-C raises
/// `KeyboardInterrupt` at once; the thread then runs to its end without being heard.
pub fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> hysid::Result<T> + Send + 'static,
) -> PyResult<T> {
    let (answer, mut answers) = channel();
    std::thread::spawn(move || {
        // Nobody listens after Ctrl-C.
        let _ = answer.send(work());
    });
    loop {
        let answers = &mut answers;
        match py.detach(move || answers.recv_timeout(PAUSE)) {
            Ok(done) => return done.map_err(refused),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => return Err(no_result()),
        }
    }
}

/// As [`interruptible`], but on the caller's thread where so few elementary operations take less time than a thread's start.
pub fn interruptible_if_long<T: Send + 'static>(
    py: Python<'_>,
    operations: f64,
    work: impl FnOnce() -> hysid::Result<T> + Send + 'static,
) -> PyResult<T> {
    match operations < SHORT {
        true => py.detach(work).map_err(refused),
        false => interruptible(py, work),
    }
}

/// A thread that ended in a panic.
pub fn no_result() -> PyErr {
    PyRuntimeError::new_err("this ended without a result: it is an error in Hysid, please report it")
}

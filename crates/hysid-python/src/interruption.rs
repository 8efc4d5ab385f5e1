//! Long computations that Ctrl-C interrupts.

use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::failure::refused;

/// How often a waiting thread looks for signals.
const PAUSE: Duration = Duration::from_millis(50);

/// Elementary operations of about ten milliseconds.
const SHORT: f64 = 1e7;

/// Runs work on a thread of its own, which holds all that it needs, and returns its result. Ctrl-C raises
/// `KeyboardInterrupt` at once; the thread then runs to its end without being heard.
pub fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> hysid::Result<T> + Send + 'static,
) -> PyResult<T> {
    let (answer, answers) = channel();
    std::thread::spawn(move || {
        // Nobody listens after Ctrl-C.
        let _ = answer.send(work());
    });
    waited_for(py, answers, || py.check_signals())?.map_err(refused)
}

/// Waits for what a thread sends, without the interpreter's lock, and calls `look` at intervals: its error ends the wait.
pub fn waited_for<T: Send>(
    py: Python<'_>,
    mut answers: Receiver<T>,
    mut look: impl FnMut() -> PyResult<()>,
) -> PyResult<T> {
    loop {
        let answers = &mut answers;
        match py.detach(move || answers.recv_timeout(PAUSE)) {
            Ok(done) => return Ok(done),
            Err(RecvTimeoutError::Timeout) => look()?,
            Err(RecvTimeoutError::Disconnected) => {
                let words = "this ended without a result: it is an error in Hysid, please report it";
                return Err(PyRuntimeError::new_err(words));
            }
        }
    }
}

/// As [`interruptible`], but on the caller's thread for few elementary operations, which need no interruption: a thread
/// takes 0.1 ms to start.
pub fn interruptible_if_long<T: Send + 'static>(
    py: Python<'_>,
    operations: f64,
    work: impl FnOnce() -> hysid::Result<T> + Send + 'static,
) -> PyResult<T> {
    if operations < SHORT { py.detach(work).map_err(refused) } else { interruptible(py, work) }
}

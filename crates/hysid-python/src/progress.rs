//! The line of progress: its words, its width and the remaining time.

use hysid_core::significant::Significant;
use hysid_document::progress::{Line, Remaining, in_words, share_done};
use pyo3::prelude::*;

/// The line of one computation.
#[pyclass(module = "hysid._hysid")]
#[derive(Default)]
pub struct ProgressLine {
    remaining: Remaining,
}

#[pymethods]
impl ProgressLine {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// The line after so many seconds, in this number of columns: with a bar, or in words alone. `most` is the time that a
    /// limit leaves, `error` the training error in percent of std.
    #[allow(clippy::too_many_arguments)]
    fn text(
        &mut self,
        elapsed: f64,
        done: f64,
        most: Option<f64>,
        part: String,
        error: Option<f64>,
        columns: usize,
        bar: bool,
    ) -> String {
        let done = share_done(done, elapsed, most.map(|most| elapsed + most));
        let left = self.remaining.after(elapsed, done, most).map(in_words);
        let error = error.map(|error| format!("{:.3}", Significant(error)));
        let line = Line { done, fold: None, part, error, left };
        if bar { line.in_columns(columns) } else { line.without_bar(columns) }
    }
}

//! Where records begin: a column names the record of each row.

use std::collections::HashSet;

use hysid_core::words::Words;
use hysid_document::visible::clipped;
use hysid_tables::{Problem, Result};

#[derive(Debug, Default)]
pub struct RecordNames {
    begun: HashSet<String>,
    present: Option<String>,
}

impl RecordNames {
    /// Takes the name in the next row; true if another record begins. `problem` adds its place in the file.
    ///
    /// # Errors
    /// No name, or that of a record that ended before.
    pub fn begins(&mut self, cell: &str, problem: impl Fn(Words) -> Problem) -> Result<bool> {
        let name = cell.trim();
        if self.present.as_deref() == Some(name) {
            return Ok(false);
        }
        if name.is_empty() {
            let words = Words::from("the cell is empty");
            return Err(problem(words.advised("every row needs the name of its record")));
        }
        if !self.begun.insert(name.to_string()) {
            let words = format!("record \"{}\" continues after another record", clipped(name));
            return Err(problem(
                Words::from(words).advised("keep its rows together, or give each run a name of its own"),
            ));
        }
        self.present = Some(name.to_string());
        Ok(true)
    }

    /// The present record; `None` before the first.
    pub fn present(&self) -> Option<&str> {
        self.present.as_deref()
    }
}

//! Where records begin: a column names the record of each row.

use std::collections::HashSet;

use anyhow::{Result, bail};

use hysid_document::visible::clipped;

#[derive(Debug, Default)]
pub struct RecordNames {
    begun: HashSet<String>,
    present: Option<String>,
}

impl RecordNames {
    /// Takes the name in the next row; true if another record begins. `place` is its place in the file.
    ///
    /// # Errors
    /// No name, or that of a record that ended before.
    pub fn begins(&mut self, cell: &str, place: impl Fn() -> String) -> Result<bool> {
        let name = cell.trim();
        if self.present.as_deref() == Some(name) {
            return Ok(false);
        }
        if name.is_empty() {
            bail!("{}: the cell is empty (every row needs the name of its record)", place());
        }
        if !self.begun.insert(name.to_string()) {
            let name = clipped(name);
            bail!("{}: record \"{name}\" continues after another record (keep its rows together)", place());
        }
        self.present = Some(name.to_string());
        Ok(true)
    }

    /// The present record; `None` before the first.
    pub fn present(&self) -> Option<&str> {
        self.present.as_deref()
    }
}

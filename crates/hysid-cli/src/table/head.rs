//! The header of a table: the names of its columns.

use std::collections::HashMap;

use anyhow::{Result, bail, ensure};

use super::rows::Row;
use crate::cell;
use crate::terminal::clipped;

/// A file and the header of its table.
#[derive(Debug)]
pub struct Head {
    /// The file, as the user named it.
    pub file: String,
    /// What separates the cells: a comma, a semicolon or a tab.
    pub delimiter: u8,
    /// Names of the columns, without surrounding blanks.
    pub header: Vec<String>,
    /// Line of the header, counted from 1.
    line: u64,
    places: HashMap<String, usize>,
}

impl Head {
    /// Of a file whose header was not read yet.
    pub fn nameless(file: String) -> Self {
        Self { file, delimiter: b',', header: Vec::new(), line: 1, places: HashMap::new() }
    }

    /// Of the first row of a table.
    ///
    /// # Errors
    /// A row of numbers, a column without a name, two of the same name.
    pub fn new(file: &str, delimiter: u8, row: &Row<'_>, is_commented: bool) -> Result<Self> {
        let line = row.line;
        if cell::all_numbers(row.cells()) {
            let hint = if is_commented { ", or remove the # before it" } else { "" };
            bail!(
                "{file}, line {line}: is all numbers where the names of the columns are expected (add a header line{hint})"
            );
        }
        let header: Vec<String> = row.cells().map(|name| name.trim().to_string()).collect();
        let mut places = HashMap::with_capacity(header.len());
        for (index, name) in header.iter().enumerate() {
            ensure!(!name.is_empty(), "{file}, line {line}: column {} has no name", index + 1);
            ensure!(
                places.insert(name.clone(), index).is_none(),
                "{file}, line {line}: there are two columns named \"{}\" (rename one)",
                clipped(name)
            );
        }
        Ok(Self { file: file.into(), delimiter, header, line, places })
    }

    /// Refuses a single column where more are needed: it is likely to be several, separated by something else.
    ///
    /// # Errors
    /// The table has one column.
    pub fn require_columns(&self) -> Result<()> {
        if let [name] = self.header.as_slice() {
            bail!(
                "{}, line {}: there is only one column, \"{}\" (separate columns by comma, semicolon or tab)",
                self.file,
                self.line,
                clipped(name)
            );
        }
        Ok(())
    }

    /// Place of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.places.get(name).copied()
    }
}

/// Refuses a row with more or fewer cells than the header.
pub fn check_width(head: &Head, row: &Row<'_>) -> Result<()> {
    let (file, line, found, expected) = (&head.file, row.line, row.len(), head.header.len());
    if found == expected {
        return Ok(());
    }
    let hint = match head.delimiter {
        _ if row.cells().any(|cell| cell.contains(['\n', '\r'])) => " (is a quotation mark not closed?)",
        b',' if found > expected => " (decimal commas? separate the columns by semicolons)",
        _ => "",
    };
    let cells = if found == 1 { "1 cell" } else { &format!("{found} cells") };
    bail!("{file}, line {line}: has {cells} where the header has {expected}{hint}")
}

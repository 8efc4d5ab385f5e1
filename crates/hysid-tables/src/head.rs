//! File, layout and column names of a table, found before its rows are read.

use std::collections::HashMap;

use hysid_core::data::unit;
use hysid_core::words::{Hint, Words};
use hysid_document::visible::clipped;

use crate::layout::{Layout, bare};
use crate::number::{DecimalSign, NumberFormat};
use crate::problem::CellProblem;
use crate::reading::{Delimiter, Reading};
use hysid_document::{Problem, Result};

/// A file and the layout of its table.
#[derive(Debug)]
pub struct Head {
    /// The file, as the user named it.
    pub file: String,
    /// How the file is stored, in words, such as `text, UTF-8`.
    pub stored: String,
    /// Names of the columns, without surrounding blanks.
    pub header: Vec<String>,
    /// Layout of the table.
    pub layout: Layout,
    /// The user's options of reading it.
    pub reading: Reading,
    places: HashMap<String, usize>,
}

impl Head {
    pub fn new(file: String, stored: String, layout: Layout, reading: Reading) -> Self {
        let header = layout.names.clone();
        let places = header.iter().enumerate().map(|(place, name)| (name.clone(), place)).collect();
        Self { file, stored, header, layout, reading, places }
    }

    pub fn delimiter(&self) -> Delimiter {
        self.layout.delimiter
    }

    pub fn numbers(&self) -> &NumberFormat {
        &self.layout.numbers
    }

    /// How the table was read, in words: how it is stored, what separates its cells, where its names stand.
    pub fn described(&self) -> String {
        let layout = &self.layout;
        let mut words = vec![self.stored.clone()];
        if self.stored.starts_with("text") {
            words.push(format!("columns separated by {}", layout.delimiter.plural()));
        }
        match layout.numbers.decimal {
            Some(DecimalSign::Point) => words.push("decimal point".into()),
            Some(DecimalSign::Comma) => words.push("decimal comma".into()),
            None => {}
        }
        if layout.preamble > 0 {
            words.push(counted(layout.preamble as u64, "line", "before the table"));
        }
        match layout.header_lines.as_slice() {
            [] if layout.names.first().is_some_and(|name| name == "c1") => {
                words.push("no names of columns".into());
            }
            // Names of the instrument or of joined files.
            [] => {}
            [line] => words.push(format!("names in line {line}")),
            [first, .., last] => words.push(format!("names in lines {first} to {last}")),
        }
        if let Some(line) = layout.units_line {
            words.push(format!("units in line {line}"));
        }
        let [first, others @ ..] = words.as_slice() else { return String::new() };
        if others.is_empty() { first.clone() } else { format!("{first}; {}", others.join(", ")) }
    }

    /// The problem of a table without rows.
    pub fn no_rows(&self) -> Problem {
        let words = if !self.reading.rows.is_all() {
            Words::from("has no row that ") + Hint::Option("rows") + " selects"
        } else if self.stored.starts_with("spreadsheet") {
            let sheet = self.stored.rsplit(", ").next().unwrap_or_default();
            let other = Words::from("choose another one with ") + Hint::Option("sheet");
            Words::from(format!("has no rows of numbers in {sheet}")).advised(other)
        } else {
            "has a header but no rows".into()
        };
        Problem::in_file(&self.file, words)
    }

    /// Refuses a single column where more are needed: it is likely to be several, separated by something else.
    pub fn require_columns(&self) -> Result<()> {
        if let [name] = self.header.as_slice() {
            let line = *self.layout.header_lines.first().unwrap_or(&self.layout.line);
            let advice = match self.stored.starts_with("text") {
                true => {
                    Words::from("what separates the columns? name it with ")
                        + Hint::Option("delimiter")
                        + "; input and output in two files? hysid look FILE FILE --join -o both.csv joins them"
                }
                false => Words::from("choose what has more columns with ") + Hint::Option("sheet"),
            };
            let words = Words::from(format!("there is only one column, \"{}\"", clipped(name)));
            return Err(Problem::at(&self.file, line, words.advised(advice)));
        }
        Ok(())
    }

    /// Place of a column: that of this name, or the only one of this name and a unit in brackets.
    pub fn column(&self, name: &str) -> Option<usize> {
        let exact = self.places.get(name).copied();
        exact.or_else(|| {
            let is_it = |full: &&String| {
                full.starts_with(name)
                    && full.ends_with([']', ')'])
                    && matches!(unit::split(full), (quantity, Some(_)) if quantity == name)
            };
            let mut found = self.header.iter().filter(is_it);
            let only = found.next().filter(|_| found.next().is_none())?;
            self.places.get(only).copied()
        })
    }

    pub fn full_name(&self, name: &str) -> Option<&str> {
        self.column(name).map(|place| self.header[place].as_str())
    }

    /// A cell without the unit that all numbers of its column have.
    pub fn bare<'c>(&self, place: usize, cell: &'c str) -> Result<&'c str, CellProblem> {
        let Some(unit) = self.layout.cell_units.get(place).and_then(Option::as_deref) else {
            return Ok(cell);
        };
        match bare(cell) {
            (digits, Some(found)) if found == unit => Ok(digits),
            (_, Some(found)) => {
                let words =
                    format!("\"{}\" is in {}, other cells are in {unit}", clipped(cell), clipped(found));
                Err(CellProblem::Other(words.into()))
            }
            (text, None) => Ok(text),
        }
    }

    /// True for a column of dates or clocks.
    pub fn has_stamps(&self, place: usize) -> bool {
        self.layout.stamps.get(place) == Some(&true)
    }
}

/// A count of something, in words.
pub fn counted(count: u64, one: &str, where_it_is: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {one}{plural} {where_it_is}")
}

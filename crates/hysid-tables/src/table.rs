//! A table as a whole: all its cells, each row with its line.

use std::ops::Deref;
use std::path::Path;

use crate::head::Head;
use crate::layout::Layout;
use crate::left_out::LeftOut;
use crate::reading::Reading;
use crate::rows::Rows;
use hysid_document::Result;

/// A table as it stands in its file.
#[derive(Debug)]
pub struct Table {
    origin: TableOrigin,
    /// The cells of all rows one after the other, verbatim.
    text: String,
    /// Where each cell ends in `text`.
    ends: Vec<usize>,
}

/// Where the rows of a table stand: what is left of it when its cells have been read.
#[derive(Debug)]
pub struct TableOrigin {
    head: Head,
    /// Line of each row in the file, counted from 1.
    pub lines: Vec<u64>,
    /// Lines that are no rows.
    pub left_out: LeftOut,
}

impl Deref for Table {
    type Target = TableOrigin;

    fn deref(&self) -> &TableOrigin {
        &self.origin
    }
}

impl Deref for TableOrigin {
    type Target = Head;

    fn deref(&self) -> &Head {
        &self.head
    }
}

impl Table {
    pub fn read(path: &Path, reading: &Reading) -> Result<Self> {
        Self::of(Rows::open(path, reading)?)
    }

    /// The table that a file with this content holds.
    pub fn from_bytes(path: &Path, bytes: Vec<u8>, reading: &Reading) -> Result<Self> {
        Self::of(Rows::from_bytes(path, bytes, reading)?)
    }

    fn of(mut rows: Rows) -> Result<Self> {
        let (mut lines, mut all, mut all_ends) = (Vec::new(), String::new(), Vec::new());
        while let Some(row) = rows.next_row()? {
            let (text, ends) = row.parts();
            lines.push(row.line);
            all_ends.extend(ends.iter().map(|end| all.len() + end));
            all.push_str(text);
        }
        let origin = TableOrigin { left_out: rows.left_out, head: rows.head, lines };
        let table = Self { origin, text: all, ends: all_ends };
        if table.lines.is_empty() { Err(table.no_rows()) } else { Ok(table) }
    }

    /// The table without its cells, which need several times the memory of their numbers.
    pub fn into_origin(self) -> TableOrigin {
        self.origin
    }

    /// The same rows with other cells.
    pub(crate) fn with_cells(&self, file: String, layout: Layout, text: String, ends: Vec<usize>) -> Self {
        let head = Head::new(file, self.stored.clone(), layout, self.reading.clone());
        let origin = TableOrigin { head, lines: self.lines.clone(), left_out: self.left_out.clone() };
        Self { origin, text, ends }
    }

    pub fn rows(&self) -> usize {
        self.lines.len()
    }

    pub fn cell(&self, row: usize, column: usize) -> &str {
        let index = row * self.header.len() + column;
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.text[start..self.ends[index]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<u64> {
        Table::from_bytes(Path::new("f"), text.into(), &Reading::default()).unwrap().into_origin().lines
    }

    /// The last byte of one cell and the first of the next make a letter together, and nothing alone.
    #[test]
    fn a_letter_cut_in_two_by_a_delimiter_is_no_text() {
        for text in [b"x,y\n1\xc9,\xb72\n".as_slice(), b"x\xc9,\xb7y\n1,2\n"] {
            let error = Table::from_bytes(
                Path::new("f"),
                text.to_vec(),
                &Reading { encoding: "utf-8".parse().ok(), ..Reading::default() },
            )
            .unwrap_err()
            .to_string();
            assert!(error.contains("f, line"), "{error}");
        }
    }

    #[test]
    fn rows_know_their_lines() {
        assert_eq!(lines("a,b\n1,2\n3,4\n"), [2, 3]);
        assert_eq!(lines("a,b\r\n1,2\r\n\r\n3,4"), [2, 4]);
        assert_eq!(lines("a,b\r1,2\r3,4\r"), [2, 3]);
        assert_eq!(lines("# a remark\n\n#\na,b\n\n1,2\n   \n3,4\n"), [6, 8]);
        assert_eq!(lines("a,\"b\nc\"\n1,2\n"), [3]);
    }
}

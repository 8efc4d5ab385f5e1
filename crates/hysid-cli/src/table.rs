//! Tables in text files: CSV with a header, its delimiter found out, each row with its line.

use std::path::Path;

use anyhow::{Result, anyhow, bail, ensure};
use csv::StringRecord;

use crate::{cell, files};

/// A table as it stands in its file.
#[derive(Debug)]
pub struct Table {
    /// The file, as the user named it.
    pub file: String,
    /// What separates the cells: a comma, a semicolon or a tab.
    pub delimiter: u8,
    /// Names of the columns, without surrounding blanks.
    pub header: Vec<String>,
    /// Line of each row in the file, counted from 1.
    pub lines: Vec<u64>,
    /// The cells of all rows one after the other, verbatim.
    text: String,
    /// Where each cell ends in `text`.
    ends: Vec<usize>,
}

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// A file that cannot be read, is no text, or is no table with a header and at least one row.
    pub fn read(path: &Path) -> Result<Self> {
        Self::from_bytes(path, &files::read(path)?)
    }

    /// The table that a file with this content holds.
    ///
    /// # Errors
    /// As of [`Table::read`].
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self> {
        let file = path.display().to_string();
        check_kind(bytes).map_err(|what| anyhow!("{file}: {what}"))?;
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text,
            Err(error) => {
                let line = 1 + line_ends(&bytes[..error.valid_up_to()]);
                bail!("{file}, line {line}: is not UTF-8 text (save the file as UTF-8)");
            }
        };
        Self::parse(&file, text)
    }

    fn parse(file: &str, text: &str) -> Result<Self> {
        let (start, commented) = start_of_header(text);
        ensure!(start < text.len(), "{file}: is empty (expected a header line and rows of numbers)");
        let skipped = line_ends(&text.as_bytes()[..start]);
        let text = &text[start..];
        let delimiter = delimiter(text);
        let mut lines = LineCounter { text: text.as_bytes(), byte: 0, line: 1 + skipped };
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(delimiter)
            .from_reader(text.as_bytes());
        let mut cells = StringRecord::new();
        let mut next = |cells: &mut StringRecord| -> Result<Option<u64>> {
            if !reader.read_record(cells).map_err(|error| anyhow!("{file}: {error}"))? {
                return Ok(None);
            }
            Ok(Some(lines.line_at(cells.position().map_or(0, |position| position.byte() as usize))))
        };
        let first = next(&mut cells)?.unwrap_or(1);
        let header = header_of(file, &cells, first, commented)?;
        let mut table = Self {
            file: file.to_string(),
            delimiter,
            header,
            lines: Vec::new(),
            text: String::with_capacity(text.len()),
            ends: Vec::new(),
        };
        while let Some(line) = next(&mut cells)? {
            if cells.len() > 1 || !cells[0].trim().is_empty() {
                table.push(line, &cells)?;
            }
        }
        ensure!(!table.is_empty(), "{file}: has a header but no rows");
        Ok(table)
    }

    fn push(&mut self, line: u64, cells: &StringRecord) -> Result<()> {
        check_width(&self.file, line, cells, self.header.len(), self.delimiter)?;
        self.lines.push(line);
        for cell in cells {
            self.text.push_str(cell);
            self.ends.push(self.text.len());
        }
        Ok(())
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.lines.len()
    }

    fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// A cell, verbatim.
    pub fn cell(&self, row: usize, column: usize) -> &str {
        let index = row * self.header.len() + column;
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.text[start..self.ends[index]]
    }

    /// The cells of a row.
    pub fn cells(&self, row: usize) -> impl Iterator<Item = &str> {
        (0..self.header.len()).map(move |column| self.cell(row, column))
    }

    /// Place of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|column| column == name)
    }
}

/// True for the content of a file that begins like a JSON object, as model files do.
pub fn is_json(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"{")
}

/// Refuses what is clearly no text table.
fn check_kind(bytes: &[u8]) -> Result<(), &'static str> {
    if bytes.starts_with(b"\x1f\x8b") {
        Err("is compressed with gzip (gunzip it first)")
    } else if bytes.starts_with(b"PK\x03\x04") {
        Err("is a spreadsheet or zip archive (export the table as CSV)")
    } else if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        Err("is UTF-16 text (save the file as UTF-8)")
    } else if is_json(bytes) {
        Err("is JSON, not CSV (a model file in the place of data?)")
    } else if bytes.contains(&0) {
        Err("is a binary file, not CSV")
    } else {
        Ok(())
    }
}

/// Where the header begins, after blank and comment lines; and whether the line before is a comment.
fn start_of_header(text: &str) -> (usize, bool) {
    let (mut start, mut commented) = (0, false);
    for line in text.split_inclusive(['\n', '\r']) {
        let content = line.trim();
        if !content.is_empty() && !content.starts_with('#') {
            return (start, commented);
        }
        commented = content.starts_with('#') || commented && content.is_empty();
        start += line.len();
    }
    (start, commented)
}

/// The delimiter that divides the first lines alike; failing that, the commonest in the header.
fn delimiter(text: &str) -> u8 {
    let first: Vec<&str> = text.split(['\n', '\r']).filter(|line| !line.trim().is_empty()).take(4).collect();
    let count = |line: &str, delimiter: char| {
        let mut quoted = false;
        line.chars()
            .filter(|&c| {
                quoted ^= c == '"';
                c == delimiter && !quoted
            })
            .count()
    };
    let in_header = |delimiter: char| count(first[0], delimiter);
    let alike = |&delimiter: &char| {
        in_header(delimiter) > 0 && first.iter().all(|line| count(line, delimiter) == in_header(delimiter))
    };
    let candidates = ['\t', ';', ','];
    let commonest = || candidates.into_iter().max_by_key(|&delimiter| in_header(delimiter));
    candidates.into_iter().find(alike).or_else(commonest).map_or(b',', |delimiter| delimiter as u8)
}

/// Names of the columns.
fn header_of(file: &str, cells: &StringRecord, line: u64, commented: bool) -> Result<Vec<String>> {
    if cell::all_numbers(cells.iter()) {
        let hint = if commented { ", or remove the # before it" } else { "" };
        bail!(
            "{file}, line {line}: is all numbers where the names of the columns are expected (add a header line{hint})"
        );
    }
    let names: Vec<String> = cells.iter().map(|name| name.trim().to_string()).collect();
    if let [name] = names.as_slice() {
        bail!(
            "{file}, line {line}: there is only one column, \"{}\" (separate columns by comma, semicolon or tab)",
            name.chars().take(40).collect::<String>()
        );
    }
    for (index, name) in names.iter().enumerate() {
        ensure!(!name.is_empty(), "{file}, line {line}: column {} has no name", index + 1);
        ensure!(
            !names[..index].contains(name),
            "{file}, line {line}: there are two columns named \"{name}\" (rename one)"
        );
    }
    Ok(names)
}

fn check_width(file: &str, line: u64, cells: &StringRecord, expected: usize, delimiter: u8) -> Result<()> {
    let found = cells.len();
    let hint = match delimiter {
        _ if cells.iter().any(|cell| cell.contains(['\n', '\r'])) => " (is a quotation mark not closed?)",
        b',' if found > expected => " (decimal commas? separate the columns by semicolons)",
        _ => "",
    };
    let cells = if found == 1 { "1 cell" } else { &format!("{found} cells") };
    ensure!(found == expected, "{file}, line {line}: has {cells} where the header has {expected}{hint}");
    Ok(())
}

/// Line ends (LF, CR LF or CR) in a text.
fn line_ends(text: &[u8]) -> u64 {
    let end = |(i, &byte): (usize, &u8)| byte == b'\n' || byte == b'\r' && text.get(i + 1) != Some(&b'\n');
    text.iter().enumerate().filter(|&place| end(place)).count() as u64
}

/// Counts lines while walking forward through a text.
struct LineCounter<'a> {
    text: &'a [u8],
    byte: usize,
    line: u64,
}

impl LineCounter<'_> {
    /// Line of the first content at or after a byte.
    fn line_at(&mut self, byte: usize) -> u64 {
        let rest = &self.text[byte..];
        let content = byte + rest.iter().take_while(|byte| matches!(byte, b'\n' | b'\r')).count();
        self.line += line_ends(&self.text[self.byte..content]);
        self.byte = content;
        self.line
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<u64> {
        Table::parse("f", text).unwrap().lines
    }

    #[test]
    fn rows_know_their_lines() {
        assert_eq!(lines("a,b\n1,2\n3,4\n"), [2, 3]);
        assert_eq!(lines("a,b\r\n1,2\r\n\r\n3,4"), [2, 4]);
        assert_eq!(lines("a,b\r1,2\r3,4\r"), [2, 3]);
        assert_eq!(lines("# a remark\n\n#\na,b\n\n1,2\n   \n3,4\n"), [6, 8]);
        assert_eq!(lines("a,\"b\nc\"\n1,2\n"), [3]);
    }

    #[test]
    fn delimiters_are_found() {
        let of = |text| Table::parse("f", text).unwrap().delimiter;
        assert_eq!(of("t;x;y\n0;1,5;2,5\n"), b';');
        assert_eq!(of("Force, kN;Travel, mm\n1,5;2,5\n"), b';');
        assert_eq!(of("t\tx, mm\n0\t1,5\n"), b'\t');
        assert_eq!(of("t,\"x;1\"\n0,1\n"), b',');
    }
}

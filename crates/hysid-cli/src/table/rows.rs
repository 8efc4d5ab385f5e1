//! The rows of a table one after another: memory does not grow with the file.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

use anyhow::{Result, anyhow, bail, ensure};
use csv_core::ReadRecordResult;

use super::beginning::{BINARY, Beginning, not_text};
use super::head::{Head, check_width};
use super::line_counter::LineCounter;
use crate::files;

/// Bytes that are read at a time.
const BLOCK: usize = 1 << 18;

/// A row longer than this is no row, but a quotation mark that is not closed.
const LONGEST_ROW: usize = 1 << 29;

/// Reads the rows of a table.
pub struct Rows<R> {
    /// File, delimiter and names of the columns.
    pub head: Head,
    reader: R,
    parser: csv_core::Reader,
    /// Bytes that were read; those of the present row are `start..start + parsed`, and `end` is where they end.
    buffer: Vec<u8>,
    start: usize,
    parsed: usize,
    end: usize,
    is_all_read: bool,
    /// The place before the present row.
    lines: LineCounter,
    /// The cells of the present row without quotation marks, one after the other, and where they end.
    text: Vec<u8>,
    ends: Vec<usize>,
    cells: usize,
}

/// A row of a table.
#[derive(Debug, Clone, Copy)]
pub struct Row<'r> {
    /// Its line in the file, counted from 1.
    pub line: u64,
    text: &'r str,
    ends: &'r [usize],
}

impl<'r> Row<'r> {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// A cell, verbatim.
    pub fn cell(&self, column: usize) -> &'r str {
        let start = if column == 0 { 0 } else { self.ends[column - 1] };
        &self.text[start..self.ends[column]]
    }

    /// All cells.
    pub fn cells(self) -> impl Iterator<Item = &'r str> {
        (0..self.len()).map(move |column| self.cell(column))
    }

    /// All cells one after the other, and where each ends.
    pub fn parts(&self) -> (&'r str, &'r [usize]) {
        (self.text, self.ends)
    }

    fn is_blank(&self) -> bool {
        self.len() == 1 && self.text.trim().is_empty()
    }
}

impl Rows<File> {
    /// Opens a file and reads its header.
    ///
    /// # Errors
    /// A file that cannot be read, is no text, or is no table with a header.
    pub fn open(path: &Path) -> Result<Self> {
        Self::new(path, files::open(path)?)
    }
}

impl<R: Read> Rows<R> {
    /// Reads the header of what a file of this name contains.
    ///
    /// # Errors
    /// As of [`Rows::open`].
    pub fn new(path: &Path, reader: R) -> Result<Self> {
        let mut rows = Self {
            head: Head::nameless(path.display().to_string()),
            reader,
            parser: csv_core::Reader::new(),
            buffer: Vec::new(),
            start: 0,
            parsed: 0,
            end: 0,
            is_all_read: false,
            lines: LineCounter::new(),
            text: Vec::new(),
            ends: Vec::new(),
            cells: 0,
        };
        let beginning = loop {
            rows.fill()?;
            let bytes = &rows.buffer[..rows.end];
            if let Some(beginning) = Beginning::of(&rows.head.file, bytes, rows.is_all_read)? {
                break beginning;
            }
        };
        rows.parsed = beginning.start;
        rows.parser = csv_core::ReaderBuilder::new().delimiter(beginning.delimiter).build();
        rows.parse()?;
        rows.head = Head::new(&rows.head.file, beginning.delimiter, &rows.row()?, beginning.is_commented)?;
        Ok(rows)
    }

    /// The next row that is not blank; `None` at the end.
    ///
    /// # Errors
    /// A row with more or fewer cells than the header, bytes that are no text, a file that cannot be read.
    pub fn next_row(&mut self) -> Result<Option<Row<'_>>> {
        loop {
            if !self.parse()? {
                return Ok(None);
            }
            if self.cells > 1 || !self.row()?.is_blank() {
                break;
            }
        }
        let row = self.row()?;
        check_width(&self.head, &row)?;
        Ok(Some(row))
    }

    /// Parses the row behind the present one; false at the end.
    fn parse(&mut self) -> Result<bool> {
        self.lines.pass(&self.buffer[self.start..self.start + self.parsed]);
        self.start += self.parsed;
        (self.parsed, self.cells) = (0, 0);
        let mut bytes = 0;
        loop {
            // An empty input would tell the parser that there is no more.
            if self.start + self.parsed == self.end && !self.is_all_read {
                self.fill_with_text()?;
                continue;
            }
            let input = &self.buffer[self.start + self.parsed..self.end];
            let (text, ends) = (&mut self.text[bytes..], &mut self.ends[self.cells..]);
            let (result, read, written, ended) = self.parser.read_record(input, text, ends);
            self.parsed += read;
            bytes += written;
            self.cells += ended;
            match result {
                ReadRecordResult::InputEmpty => self.fill_with_text()?,
                ReadRecordResult::OutputFull => grow(&mut self.text),
                ReadRecordResult::OutputEndsFull => grow(&mut self.ends),
                ReadRecordResult::Record => return Ok(true),
                ReadRecordResult::End => return Ok(false),
            }
        }
    }

    /// The present row.
    fn row(&self) -> Result<Row<'_>> {
        let ends = &self.ends[..self.cells];
        let raw = &self.buffer[self.start..self.start + self.parsed];
        match std::str::from_utf8(&self.text[..ends.last().copied().unwrap_or(0)]) {
            // The end of one cell and the beginning of the next may make a letter that neither has.
            Ok(text) if ends.iter().all(|&end| text.is_char_boundary(end)) => {
                Ok(Row { line: self.lines.line_of(raw), text, ends })
            }
            _ => {
                let valid = std::str::from_utf8(raw).map_or_else(|error| error.valid_up_to(), str::len);
                let mut lines = self.lines;
                lines.pass(&raw[..valid]);
                bail!("{}", not_text(&self.head.file, lines.line()))
            }
        }
    }

    /// As [`Rows::fill`], of a file that is known to begin as a table.
    fn fill_with_text(&mut self) -> Result<()> {
        let read = self.fill()?;
        ensure!(!self.buffer[self.end - read..self.end].contains(&0), "{}: {BINARY}", self.head.file);
        Ok(())
    }

    /// Reads on, behind what is not parsed yet; gives the number of bytes.
    fn fill(&mut self) -> Result<usize> {
        if self.start > 0 {
            self.buffer.copy_within(self.start..self.end, 0);
            (self.start, self.end) = (0, self.end - self.start);
        }
        if self.buffer.len() < self.end + BLOCK {
            let (file, line) = (&self.head.file, self.lines.line_of(&self.buffer[..self.end]));
            ensure!(
                self.end < LONGEST_ROW,
                "{file}, line {line}: the row is longer than {LONGEST_ROW} bytes (is a quotation mark not closed?)"
            );
            self.buffer.resize((2 * self.end).max(BLOCK), 0);
        }
        let read = loop {
            match self.reader.read(&mut self.buffer[self.end..]) {
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                read => break read,
            }
        };
        let read =
            read.map_err(|error| anyhow!("{}: cannot be read: {}", self.head.file, files::reason(&error)))?;
        self.is_all_read = read == 0;
        self.end += read;
        Ok(read)
    }
}

fn grow<T: Default + Clone>(room: &mut Vec<T>) {
    room.resize((2 * room.len()).max(256), T::default());
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives a text in pieces of so many bytes.
    struct Dripping<'a>(&'a [u8], usize);

    impl Read for Dripping<'_> {
        fn read(&mut self, room: &mut [u8]) -> std::io::Result<usize> {
            let (now, later) = self.0.split_at(self.1.min(self.0.len()).min(room.len()));
            room[..now.len()].copy_from_slice(now);
            self.0 = later;
            Ok(now.len())
        }
    }

    fn read(text: &[u8], piece: usize) -> Result<Vec<(u64, Vec<String>)>> {
        let mut rows = Rows::new(Path::new("f"), Dripping(text, piece))?;
        let mut all = vec![(0, rows.head.header.clone())];
        while let Some(row) = rows.next_row()? {
            all.push((row.line, row.cells().map(String::from).collect()));
        }
        Ok(all)
    }

    #[test]
    fn rows_are_the_same_however_the_file_comes() {
        let text =
            "\u{feff}# a remark\r\n\r\nt;\"x; µ\"\n0;1,5\r\n\r\n1;\"a\r\n\"\"b\"\"\"\r2;\n   \n\"3\";µ";
        let whole = read(text.as_bytes(), usize::MAX).unwrap();
        let lines: Vec<u64> = whole.iter().map(|(line, _)| *line).collect();
        assert_eq!(lines, [0, 4, 6, 8, 10]);
        assert_eq!(whole[0].1, ["t", "x; µ"]);
        assert_eq!(whole[2].1, ["1", "a\r\n\"b\""]);
        for piece in 1..20 {
            assert_eq!(read(text.as_bytes(), piece).unwrap(), whole, "{piece}");
        }
    }

    #[test]
    fn errors_are_the_same_however_the_file_comes() {
        let cases: [(&[u8], &str); 4] = [
            (
                b"t,x\n0,1\n\n1,2,3\n",
                "f, line 4: has 3 cells where the header has 2 (decimal commas? separate the columns by semicolons)",
            ),
            (b"t,x\n0,1\n1,2\n3,4\n5,\"\n\xb5\"\n", "f, line 6: is not UTF-8 text (save the file as UTF-8)"),
            (b"t,x\n0,1\n1,2\n3,4\n5,\0\n", "f: is a binary file, not CSV"),
            (b"t,x\n0,1\n1,2\n3,4\n5,\"6\n7,8\n", "f, line 5: has 2 cells where the header has 3"),
        ];
        for (text, expected) in &cases[..3] {
            for piece in [1, 2, 3, 5, 7, 1000] {
                assert_eq!(read(text, piece).unwrap_err().to_string(), *expected, "{piece}");
            }
        }
        // A quotation mark that is not closed swallows the rest.
        let rest = read(cases[3].0, 3).unwrap();
        assert_eq!(rest.last().unwrap().1, ["5", "6\n7,8\n"]);
    }
}

//! The rows of a table one after another: memory does not grow with the file.

use std::io::{self, Cursor, ErrorKind, Read};
use std::path::Path;

use csv_core::ReadRecordResult;
use hysid_core::words::{Hint, Words};

use crate::blanks::TabsForBlanks;
use crate::container::{BINARY, DecodedText, LONGEST_TEXT, TextContent, TextSheet};
use hysid_files::unreadable;

use crate::head::Head;
use crate::layout::{Layout, cells_and_names, has_number, is_comment, is_row, split, width_problem};
use crate::left_out::LeftOut;
use crate::line_counter::LineCounter;
use crate::number::{is_missing, parsed};
use crate::reading::{Delimiter, Reading};
use crate::several::{Found, GatheredTables, gather};
use crate::stamp;
use hysid_document::{Problem, Result};

/// Bytes that are read at a time.
const BLOCK: usize = 1 << 18;

/// A row longer than this is no row, but a quotation mark that is not closed.
const LONGEST_ROW: usize = 1 << 29;

/// Lines from which a layout can be found.
const FEWEST_LINES: usize = 6;

const MOST_COLUMNS: usize = 20_000;

/// Bytes at the end of a file that are looked through for rows, if they begin like none.
const LONGEST_END: usize = 1 << 16;

/// Rows before blank lines, for each line behind them that may be no row.
const LEAST_ROWS_A_LINE: u64 = 10;

/// Steps of the first column over blank lines between rows.
const MOST_STEPS: f64 = 10.0;

pub struct Rows {
    /// File, layout and names of the columns.
    pub head: Head,
    reader: Box<dyn Read>,
    parser: csv_core::Reader,
    /// Bytes that were read; those of the present row are `start..start + parsed`, and `end` is where they end.
    buffer: Vec<u8>,
    start: usize,
    parsed: usize,
    end: usize,
    is_all_read: bool,
    /// The place before the present row.
    lines: LineCounter,
    /// Line in the file of each line that is read, if these differ.
    origin: Vec<u64>,
    /// The cells of the present row without quotation marks, one after the other, and where they end.
    text: Vec<u8>,
    ends: Vec<usize>,
    cells: usize,
    /// Rows behind the header so far, those that are not used among them.
    read: u64,
    /// Blank lines stood between rows.
    has_gaps: bool,
    /// First cells of the last two rows.
    before: [Vec<u8>; 2],
    /// Lines that are no rows: comments, and text behind the table.
    pub left_out: LeftOut,
}

#[derive(Debug, Clone, Copy)]
pub struct Row<'r> {
    /// Its line in the file, counted from 1.
    pub line: u64,
    text: &'r str,
    ends: &'r [usize],
}

impl<'r> Row<'r> {
    /// Number of cells.
    pub fn width(&self) -> usize {
        self.ends.len()
    }

    pub fn cell(&self, column: usize) -> &'r str {
        let start = if column == 0 { 0 } else { self.ends[column - 1] };
        &self.text[start..self.ends[column]]
    }

    pub fn cells(self) -> impl Iterator<Item = &'r str> {
        (0..self.width()).map(move |column| self.cell(column))
    }

    /// All cells one after the other, and where each ends.
    pub fn parts(&self) -> (&'r str, &'r [usize]) {
        (self.text, self.ends)
    }

    fn is_blank(&self) -> bool {
        self.width() == 1 && self.text.trim().is_empty()
    }
}

impl Rows {
    /// Opens a file and finds the layout of its table.
    pub fn open(path: &Path, reading: &Reading) -> Result<Self> {
        Self::of(DecodedText::open(path, reading)?, reading)
    }

    /// Finds the layout of the table that a file with this content has.
    pub fn from_bytes(path: &Path, bytes: Vec<u8>, reading: &Reading) -> Result<Self> {
        let reader = Box::new(Cursor::new(bytes));
        Self::of(DecodedText::new(path.display().to_string(), reader, true, reading)?, reading)
    }

    fn of(text: DecodedText, reading: &Reading) -> Result<Self> {
        let DecodedText { file, content, stored, is_short } = text;
        let mut reader = match content {
            TextContent::Stream(reader) => reader,
            TextContent::Sheets(mut sheets) => {
                return match gather(&file, &sheets, reading)? {
                    Found::Gathered(tables) => Self::of_gathered(file, &stored, *tables, reading),
                    Found::Alone(place) => {
                        let sheet = sheets.swap_remove(place);
                        let stored = format!("{stored}, {}", sheet.described);
                        Self::of_one(
                            file,
                            stored,
                            sheet.text.into_bytes(),
                            true,
                            Box::new(io::empty()),
                            reading,
                        )
                    }
                };
            }
        };
        let (mut first, mut is_all) = beginning(&file, &mut reader)?;
        if is_short && !is_all {
            let more = LONGEST_TEXT.saturating_sub(first.len());
            let read = reader.by_ref().take(more as u64).read_to_end(&mut first);
            is_all = read.map_err(|error| unreadable(&file, &error))? < more;
        }
        if is_all && !first.contains(&0) {
            match String::from_utf8(first) {
                Ok(text) => {
                    let sheet = TextSheet { name: String::new(), described: String::new(), text };
                    let sheets = [sheet];
                    if let Found::Gathered(tables) = gather(&file, &sheets, reading)? {
                        return Self::of_gathered(file, &stored, *tables, reading);
                    }
                    let [sheet] = sheets;
                    first = sheet.text.into_bytes();
                }
                Err(error) => first = error.into_bytes(),
            }
        }
        Self::of_one(file, stored, first, is_all, reader, reading)
    }

    fn of_gathered(file: String, stored: &str, tables: GatheredTables, reading: &Reading) -> Result<Self> {
        check_width(&file, &tables.layout)?;
        let GatheredTables { layout, text, lines, described, left_out, is_doubtful } = tables;
        let stored = format!("{stored}, {described}");
        let head = Head::new(file, stored, layout, reading.clone());
        let left_out = LeftOut { tables: left_out, is_doubtful, ..LeftOut::default() };
        let rows = Self::new(head, Box::new(Cursor::new(text)), b'\t', LineCounter::new());
        Ok(Self { origin: lines, left_out, ..rows })
    }

    /// The only table of a text, of which the first bytes were read.
    fn of_one(
        file: String,
        stored: String,
        first: Vec<u8>,
        is_all: bool,
        reader: Box<dyn Read>,
        reading: &Reading,
    ) -> Result<Self> {
        let valid = match std::str::from_utf8(&first) {
            Ok(text) => text,
            Err(error) => std::str::from_utf8(&first[..error.valid_up_to()]).unwrap_or_default(),
        };
        let is_cut = first.len() - valid.len() < 4 && !is_all;
        let layout = Layout::find(&file, valid, is_all || !is_cut && valid.len() < first.len(), reading)?;
        check_width(&file, &layout)?;
        let mut lines = LineCounter::new();
        lines.pass(&first[..layout.start]);
        let mut rest = Cursor::new(first);
        rest.set_position(layout.start as u64);
        let rest = rest.chain(reader);
        let (reader, delimiter): (Box<dyn Read>, u8) = match layout.delimiter {
            Delimiter::Character(delimiter) => (Box::new(rest), delimiter),
            Delimiter::Blanks => (Box::new(TabsForBlanks::new(rest)), b'\t'),
        };
        Ok(Self::new(Head::new(file, stored, layout, reading.clone()), reader, delimiter, lines))
    }

    /// From the first row on.
    fn new(head: Head, reader: Box<dyn Read>, delimiter: u8, lines: LineCounter) -> Self {
        Self {
            head,
            reader,
            parser: csv_core::ReaderBuilder::new().delimiter(delimiter).build(),
            buffer: Vec::new(),
            start: 0,
            parsed: 0,
            end: 0,
            is_all_read: false,
            lines,
            origin: Vec::new(),
            text: Vec::new(),
            ends: Vec::new(),
            cells: 0,
            read: 0,
            has_gaps: false,
            before: Default::default(),
            left_out: LeftOut::default(),
        }
    }

    /// The line in the file of one that is read.
    fn line(&self, read: u64) -> u64 {
        let place = usize::try_from(read).ok().and_then(|line| line.checked_sub(1));
        place.and_then(|place| self.origin.get(place)).copied().unwrap_or(read)
    }

    /// The next row that is used; `None` at the end.
    ///
    /// # Errors
    /// A row with more or fewer cells than the table has columns, bytes that are no text, a file that cannot be read.
    pub fn next_row(&mut self) -> Result<Option<Row<'_>>> {
        Ok(self.next_row_of()?.map(|(_, row)| row))
    }

    /// As [`Rows::next_row`], with what is known of the table.
    pub fn next_row_of(&mut self) -> Result<Option<(&Head, Row<'_>)>> {
        let rows = self.head.reading.rows;
        loop {
            if rows.ends_before(self.read + 1) || !self.parse_row()? {
                return Ok(None);
            }
            self.read += 1;
            if rows.has(self.read) {
                self.complete_stamp()?;
                return Ok(Some((&self.head, self.row()?)));
            }
        }
    }

    /// Writes the clock of the present row behind its date, and the seconds that a clock alone lacks.
    fn complete_stamp(&mut self) -> Result<()> {
        let Some((clock, date)) = self.head.layout.clock else { return Ok(()) };
        let mut cells: Vec<String> = self.row()?.cells().map(|cell| cell.trim().to_string()).collect();
        stamp::complete(&mut cells, clock, date);
        self.text.clear();
        for (end, cell) in self.ends.iter_mut().zip(&cells) {
            self.text.extend_from_slice(cell.as_bytes());
            *end = self.text.len();
        }
        self.text.resize(self.text.len().max(256), 0);
        Ok(())
    }

    /// Parses the next row that has as many cells as the table has columns; false at the end of the table.
    fn parse_row(&mut self) -> Result<bool> {
        loop {
            if !self.parse()? {
                return Ok(false);
            }
            if self.is_empty_row() {
                self.left_out.empty += 1;
                self.left_out.first_empty.get_or_insert(self.row()?.line);
                continue;
            }
            let width = self.head.header.len();
            if self.cells == width && width > 1 && !self.is_line_of_text()? {
                return Ok(!self.is_summary()?);
            }
            if self.cells == width + 1 && self.row()?.cell(width).trim().is_empty() {
                self.cells = width;
            }
            if width > 1 && self.cells > width && self.ends_with_remark(width)? {
                self.left_out.remarks += 1;
                self.left_out.first_remark.get_or_insert(self.row()?.line);
                self.cells = width;
            }
            if self.cells + 1 == width && self.head.layout.ends_with_remarks() {
                let end = self.ends[self.cells - 1];
                self.ends.resize(self.ends.len().max(width), 0);
                (self.ends[self.cells], self.cells) = (end, width);
            }
            let row = self.row()?;
            if row.is_blank() {
                continue;
            }
            let is_text = self.is_line_of_text()?;
            if self.cells == width && !is_text {
                return Ok(true);
            }
            if is_text && is_comment(row.cell(0)) {
                self.left_out.comments += 1;
                continue;
            }
            let (line, cells) = (row.line, row.cells().collect::<Vec<_>>());
            let (other, has_numbers) = (self.other_delimiter(), is_row(&cells));
            let problem = match &other {
                Some(changed) => changed.clone(),
                None if has_numbers => width_problem(self.cells, width, &cells, self.head.delimiter()),
                None => {
                    cells_and_names(self.cells, width).advised("if the line is a remark, begin it with #")
                }
            };
            if (other.is_some() || !has_numbers)
                && let Some(lines) = self.lines_without_rows()?
            {
                (self.left_out.end, self.left_out.end_doubt) = (Some((line, lines)), other);
                return Ok(false);
            }
            if is_text && self.read > 0 {
                self.left_out.text += 1;
                self.left_out.first_text.get_or_insert(line);
                continue;
            }
            return Err(Problem::at(&self.head.file, line, problem));
        }
    }

    /// True for a row of several cells that are all empty.
    fn is_empty_row(&self) -> bool {
        let end = self.ends[..self.cells].last().copied().unwrap_or(0);
        self.cells > 1 && self.text[..end].iter().all(u8::is_ascii_whitespace)
    }

    /// True if the present row and what follows it are no rows: the few last ones, behind the first blank lines, whose first
    /// cells do not go on as those before.
    fn is_summary(&mut self) -> Result<bool> {
        let raw = &self.buffer[self.start..self.start + self.parsed];
        let is_apart = self.read > 0 && self.lines.line_of(raw) > self.lines.line();
        let is_first = is_apart && !self.has_gaps;
        self.has_gaps |= is_apart;
        if is_first && !self.goes_on() {
            let line = self.row()?.line;
            if let Some(lines) = self.rest()?.map(|rest| filled(rest).count() as u64)
                && lines * LEAST_ROWS_A_LINE <= self.read
            {
                let words = Words::from("they follow blank lines")
                    .advised("if they are rows of the table, remove the blank lines");
                (self.left_out.end, self.left_out.end_doubt) = (Some((line, lines)), Some(words));
                return Ok(true);
            }
        }
        self.before.swap(0, 1);
        self.before[1].clear();
        self.before[1].extend_from_slice(&self.text[..self.ends[0]]);
        Ok(false)
    }

    /// True if the first cell grows as those of the last two rows.
    fn goes_on(&self) -> bool {
        let number = |cell: &[u8]| {
            let text = std::str::from_utf8(cell).ok()?;
            let number = parsed(text, self.head.numbers().decimal).ok();
            number.map(|(number, _)| number)
        };
        match [&self.before[0], &self.before[1], &self.text[..self.ends[0]]].map(number) {
            [Some(a), Some(b), Some(c)] => b > a && c > b && c - b <= MOST_STEPS * (b - a),
            _ => false,
        }
    }

    /// True for a comment or words in the place of a row. Of a line without a mark, no cell is a number, and one with as
    /// many cells as a row has begins with several words: `OVLD,OVLD` is a row.
    fn is_line_of_text(&self) -> Result<bool> {
        let first = self.text.iter().find(|byte| !byte.is_ascii_whitespace());
        if first.is_none_or(|byte| byte.is_ascii_digit() || b"+-.".contains(byte)) {
            return Ok(false);
        }
        let row = self.row()?;
        let first = row.cell(0).trim();
        let cells = || row.cells().collect::<Vec<_>>();
        let is_words = || {
            first.starts_with(char::is_alphabetic)
                && (row.width() != self.head.header.len() || first.contains(' '))
                && !is_missing(first)
        };
        Ok(if is_comment(first) { !is_row(&cells()) } else { is_words() && !has_number(&cells()) })
    }

    /// That the present line is a row with another delimiter than that of the table.
    fn other_delimiter(&self) -> Option<Words> {
        let line = std::str::from_utf8(&self.buffer[self.start..self.start + self.parsed]).ok()?;
        let is_row = |&other: &Delimiter| is_row_of(line.trim(), other, self.head.header.len());
        let other = Delimiter::ALL.into_iter().find(is_row)?.plural();
        let own = self.head.delimiter().plural();
        let words = format!("the columns are separated by {other} from here on, and by {own} before");
        Some(Words::from(words).advised("save the whole file with one delimiter"))
    }

    /// True for a row of the table with words behind it, in a column that has no name and no cell in the rows before.
    fn ends_with_remark(&self, width: usize) -> Result<bool> {
        let cells: Vec<&str> = self.row()?.cells().collect();
        let remark = cells[width].trim_start();
        let is_words = remark.starts_with(char::is_alphabetic) || is_comment(remark);
        Ok(is_words && !is_row(&cells[width..=width]) && is_row(&cells[..width]))
    }

    /// How many lines stand from the present row to the end of the file, if none of them is a row.
    fn lines_without_rows(&mut self) -> Result<Option<u64>> {
        let delimiter = match self.head.delimiter() {
            // Blanks are tabs by now.
            Delimiter::Blanks => Delimiter::Character(b'\t'),
            delimiter => delimiter,
        };
        let width = self.head.header.len();
        let Some(rest) = self.rest()? else { return Ok(None) };
        Ok((!filled(rest).any(|line| is_row_of(line, delimiter, width))).then(|| filled(rest).count() as u64))
    }

    /// The text from the present row to the end of the file, if it is short.
    fn rest(&mut self) -> Result<Option<&str>> {
        while !self.is_all_read {
            if self.end - self.start > LONGEST_END {
                return Ok(None);
            }
            let (parsed, present) = (self.parsed, self.end - self.start);
            self.fill()?;
            // What is parsed stays: only the buffer moved.
            debug_assert!(self.parsed == parsed && self.end - self.start >= present);
        }
        Ok(std::str::from_utf8(&self.buffer[self.start..self.end]).ok())
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

    fn row(&self) -> Result<Row<'_>> {
        let ends = &self.ends[..self.cells];
        let raw = &self.buffer[self.start..self.start + self.parsed];
        match std::str::from_utf8(&self.text[..ends.last().copied().unwrap_or(0)]) {
            // The end of one cell and the beginning of the next may make a letter that neither has.
            Ok(text) if ends.iter().all(|&end| text.is_char_boundary(end)) => {
                Ok(Row { line: self.line(self.lines.line_of(raw)), text, ends })
            }
            _ => {
                let valid = std::str::from_utf8(raw).map_or_else(|error| error.valid_up_to(), str::len);
                let mut lines = self.lines;
                lines.pass(&raw[..valid]);
                let advice = Words::from("name the encoding with ") + Hint::Option("encoding");
                let words = Words::from(format!("is not {} text", encoding_rs::UTF_8.name()))
                    .advised(advice + ", such as windows-1252, or save the file as UTF-8");
                Err(Problem::at(&self.head.file, lines.line(), words))
            }
        }
    }

    /// As [`Rows::fill`], of a file that is known to begin as a table.
    fn fill_with_text(&mut self) -> Result<()> {
        let read = self.fill()?;
        match self.buffer[self.end - read..self.end].contains(&0) {
            true => Err(Problem::in_file(&self.head.file, BINARY)),
            false => Ok(()),
        }
    }

    /// Reads on, behind what is not parsed yet; gives the number of bytes.
    fn fill(&mut self) -> Result<usize> {
        if self.start > 0 {
            self.buffer.copy_within(self.start..self.end, 0);
            (self.start, self.end) = (0, self.end - self.start);
        }
        if self.buffer.len() < self.end + BLOCK {
            let (file, line) = (&self.head.file, self.lines.line_of(&self.buffer[..self.end]));
            if self.end >= LONGEST_ROW {
                let words = Words::from(format!("the row is longer than {LONGEST_ROW} bytes"));
                return Err(Problem::at(file, line, words.advised("is a quotation mark not closed?")));
            }
            self.buffer.resize((2 * self.end).max(BLOCK), 0);
        }
        let read = loop {
            match self.reader.read(&mut self.buffer[self.end..]) {
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                read => break read,
            }
        };
        let read = read.map_err(|error| unreadable(&self.head.file, &error))?;
        self.is_all_read = read == 0;
        self.end += read;
        Ok(read)
    }
}

/// The beginning of a text, with enough lines to find the layout of its table; true if that is all.
fn beginning(file: &str, reader: &mut dyn Read) -> Result<(Vec<u8>, bool)> {
    let mut first = Vec::new();
    let mut wanted = BLOCK;
    loop {
        let more = (wanted - first.len()) as u64;
        let read = reader.take(more).read_to_end(&mut first);
        read.map_err(|error| unreadable(file, &error))?;
        let mut lines = first.split(|&byte| byte == b'\n' || byte == b'\r');
        let is_comment = |line: &[u8]| std::str::from_utf8(line).is_ok_and(is_comment);
        let has_enough = lines.by_ref().filter(|line| !is_comment(line)).nth(FEWEST_LINES).is_some();
        if first.len() < wanted || has_enough || wanted >= LONGEST_ROW {
            let is_all = first.len() < wanted;
            return Ok((first, is_all));
        }
        wanted *= 2;
    }
}

/// The lines with letters.
fn filled(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter(|line| !line.trim().is_empty())
}

/// True for a line of numbers in so many columns.
fn is_row_of(line: &str, delimiter: Delimiter, width: usize) -> bool {
    let cells = split(line, delimiter);
    cells.len() == width && is_row(&cells.iter().map(|cell| &*cell.text).collect::<Vec<_>>())
}

fn check_width(file: &str, layout: &Layout) -> Result<()> {
    let width = layout.names.len();
    let words = || format!("has {width} columns: at most {MOST_COLUMNS} are read");
    if width > MOST_COLUMNS { Err(Problem::in_file(file, words())) } else { Ok(()) }
}

fn grow<T: Default + Clone>(room: &mut Vec<T>) {
    room.resize((2 * room.len()).max(256), T::default());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_without_end_and_equal_names_cost_little() {
        let lines = "#\n".repeat(300_000);
        let text = format!("{lines}# t;x\nt,x\n1,2\n3,4\n5,6\n");
        assert_eq!(read(text.as_bytes(), 1 << 20).unwrap()[1].0, 300_003);
        let row = |cell: &str, columns: usize| vec![cell; columns].join(",") + "\n";
        let wide = |columns: usize| [row("a", columns), row("1", columns), row("2", columns)].concat();
        // Each name was compared with all before it.
        let names = &read(wide(20_000).as_bytes(), 1 << 20).unwrap()[0].1;
        assert_eq!((names[1].as_str(), names[19_999].as_str()), ("a (2)", "a (20000)"));
        let error = read(wide(20_001).as_bytes(), 1 << 20).unwrap_err().to_string();
        assert!(error.ends_with("has 20001 columns: at most 20000 are read"), "{error}");
    }

    #[test]
    fn a_table_behind_long_comments_is_read() {
        let comments = format!("# {}\n", "x".repeat(98)).repeat(6_000);
        let text = format!("{comments}t,x\n1,2\n3,4\n5,6\n");
        let rows = read(text.as_bytes(), 4_096).unwrap();
        assert_eq!(rows.len(), 4, "{rows:?}");
        assert_eq!(rows[1], (6_002, vec!["1".to_string(), "2".into()]));
    }

    /// Gives a text in pieces of so many bytes.
    struct Dripping(Vec<u8>, usize);

    impl Read for Dripping {
        fn read(&mut self, room: &mut [u8]) -> std::io::Result<usize> {
            let some = self.1.min(self.0.len()).min(room.len());
            let later = self.0.split_off(some);
            room[..some].copy_from_slice(&self.0);
            self.0 = later;
            Ok(some)
        }
    }

    fn rows(text: &[u8], piece: usize, reading: &Reading) -> Result<Rows> {
        Rows::of(
            DecodedText::new("f".into(), Box::new(Dripping(text.to_vec(), piece)), false, reading)?,
            reading,
        )
    }

    fn read(text: &[u8], piece: usize) -> Result<Vec<(u64, Vec<String>)>> {
        read_as(text, piece, &Reading::default())
    }

    fn read_as(text: &[u8], piece: usize, reading: &Reading) -> Result<Vec<(u64, Vec<String>)>> {
        let mut rows = rows(text, piece, reading)?;
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
            (b"t,x\n0,1\n1,2\n3,4\n5,\"\n\xb5\"\n", "f, line 6: is not UTF-8 text"),
            (b"t,x\n0,1\n1,2\n3,4\n5,\0\n", "f: is a binary file, not a table of numbers"),
            (b"t,x\n0,1\n1,2\n3,4\n5,\"6\n7,8\n", "f, line 5: has 2 cells where the header has 3"),
        ];
        for (text, expected) in &cases[..3] {
            for piece in [1, 2, 3, 5, 7, 1000] {
                let reading = Reading { encoding: "utf-8".parse().ok(), ..Reading::default() };
                let error = read_as(text, piece, &reading).unwrap_err().to_string();
                assert!(error.starts_with(expected), "{piece}: {error}");
            }
        }
        // A quotation mark that is not closed swallows the rest.
        let rest = read(cases[3].0, 3).unwrap();
        assert_eq!(rest.last().unwrap().1, ["5", "6\n7,8\n"]);
    }

    /// A remark in a column without a name, first behind the lines that the layout is found from.
    #[test]
    fn a_late_remark_without_a_column_is_left_out_and_numbers_are_not() {
        for (end, late) in
            [("", ",crack, 2 mm north"), ("", ",# crack"), (",", "crack"), (",", "crack, north")]
        {
            let mut lines = vec![format!("t_s,x_mm,F_kN{end}")];
            lines.extend(
                (1..=600).map(|row| format!("{row},0.1,2.3{end}{}", if row == 500 { late } else { "" })),
            );
            let mut rows = rows(lines.join("\n").as_bytes(), 1 << 20, &Reading::default()).unwrap();
            let mut count = 0;
            while let Some(row) = rows.next_row().unwrap() {
                (count, _) = (count + 1, assert_eq!(row.width(), 3, "{end} {late}"));
            }
            assert_eq!(count, 600);
            assert_eq!(rows.left_out.described().unwrap(), "1 remark behind the rows (from line 501)");
            lines[500] = "500,0.1,2.3,4.5".into();
            let error = read(lines.join("\n").as_bytes(), 1 << 20).unwrap_err().to_string();
            assert!(error.starts_with("f, line 501: has 4 cells"), "{error}");
        }
    }

    /// The header was said to have a name less where the first remark came after the lines that the layout is found from.
    #[test]
    fn remarks_may_begin_in_any_row() {
        for (delimiter, has_end) in [(",", false), (",", true), (";", false), (";", true)] {
            for first in [1, 2, 3, 7, 299, 300, 301, 500, 900, 1000] {
                let mut lines = vec![["n", "x_mm", "F_kN", "Remark"].join(delimiter)];
                for row in 1..=1000 {
                    let remark = if row == first || row == first + 50 { "crack" } else { "" };
                    let last = if has_end || !remark.is_empty() { delimiter } else { "" };
                    lines.push([row.to_string().as_str(), "0.1", "2.3"].join(delimiter) + last + remark);
                }
                let all = read(lines.join("\n").as_bytes(), 1 << 20).unwrap();
                let case = format!("{delimiter} {has_end} {first}");
                assert_eq!((all.len(), all[0].1[3].as_str()), (1001, "Remark"), "{case}");
                for (row, (line, cells)) in all.iter().enumerate().skip(1) {
                    let remark = if row == first || row == first + 50 { "crack" } else { "" };
                    let number = row.to_string();
                    let expected = [number.as_str(), "0.1", "2.3", remark];
                    assert!(*line == 1 + row as u64 && *cells == expected, "{case}: {line} {cells:?}");
                }
            }
        }
    }

    #[test]
    fn comments_and_text_behind_the_table_are_left_out_and_counted() {
        let text = b"t x\n0 1\n# a pause\n1 2\n\nEnd of test\nOperator: N.N.\n";
        let mut rows = rows(text, 1000, &Reading::default()).unwrap();
        let mut lines = Vec::new();
        while let Some(row) = rows.next_row().unwrap() {
            lines.push(row.line);
        }
        assert_eq!(lines, [2, 4]);
        assert_eq!(rows.left_out, LeftOut { comments: 1, end: Some((6, 2)), ..LeftOut::default() });
        for text in
            ["Pump off", "pump off, low", "\"pump off, on\"", "# a, b, c", "// pump, 5 V, low, on", "%"]
        {
            let text = format!("t,x,y\n0,1,2\n1,2,3\n{text}\n2,3,4\n{text}\n3,4,5\n");
            let mut rows = self::rows(text.as_bytes(), 1000, &Reading::default()).unwrap();
            while rows.next_row().unwrap().is_some() {}
            let left_out = rows.left_out.described().unwrap();
            let kinds = ["2 text lines among the rows (from line 4)", "2 comment lines among the rows"];
            assert!(rows.read == 4 && kinds.contains(&left_out.as_str()), "{text}: {left_out}");
        }
        // Cells of a row that are no numbers stay, and so does a row with too few cells.
        let overload = read(b"t,x\n0,1\n1,2\nOVLD,OVLD\n2,3\n", 1000).unwrap();
        assert_eq!(overload[3].1, ["OVLD", "OVLD"]);
        let error = read(b"t,x,y\n0,1,2\n1,2,3\nn/a\n2,3,4\n", 1000).unwrap_err().to_string();
        assert_eq!(
            error,
            "f, line 4: has 1 cell where the header has 3 (if the line is a remark, begin it with #)"
        );
    }

    #[test]
    fn a_clock_beside_a_date_is_its_time_and_one_of_hours_and_minutes_passes_midnight() {
        let cells = |text: &str, place: usize| -> Vec<String> {
            read(text.as_bytes(), 1000)
                .unwrap()
                .iter()
                .skip(1)
                .map(|(_, cells)| cells[place].clone())
                .collect()
        };
        let text = "Datum;Uhrzeit;rF\n26.02.2024;06:00;1\n26.02.2024;18:30;2\n27.02.2024;00:00;3\n";
        assert_eq!(cells(text, 0), ["26.02.2024 06:00", "26.02.2024 18:30", "27.02.2024 00:00"]);
        assert_eq!(cells("Clock,x\n06:00,1\n07:00 PM,2\n", 0), ["06:00:00", "07:00:00 PM"]);
        assert_eq!(cells("t,x\n12:00,1\n23:00,2\n00:30,3\n", 0), ["12:00:00", "23:00:00", "00:30:00"]);
        // Minutes and seconds, perhaps.
        assert_eq!(cells("t,x\n12:00,1\n12:30,2\n13:00,3\n", 0), ["12:00", "12:30", "13:00"]);
    }

    #[test]
    fn empty_rows_and_a_summary_behind_blank_lines_are_left_out() {
        let rows_of =
            |first: u32| (first..first + 40).map(|row| format!("{row},{}\n", row % 7)).collect::<String>();
        let data = format!("t,x\n{}", rows_of(0));
        for (end, read, left_out) in [
            (
                ",\n , \nEnd of data,\n",
                40,
                "2 empty rows among the rows (from line 42), 1 line after the table (from line 44)",
            ),
            (",,,\n", 40, "1 empty row among the rows (from line 42)"),
            ("\n\n99.9,12.3\n98,4.5\n", 40, "2 lines after the table (from line 44)"),
            ("\r\n\r\n99.9,12.3", 40, "1 line after the table (from line 44)"),
            ("\n40,5\n41,6\n", 42, ""),
            (&format!("\n{}", rows_of(0)), 80, ""),
            (&format!("\n{}\n0,1\n", rows_of(0)), 81, ""),
        ] {
            let mut rows = rows(format!("{data}{end}").as_bytes(), 1000, &Reading::default()).unwrap();
            while rows.next_row().unwrap().is_some() {}
            assert_eq!(
                (rows.read, rows.left_out.described().unwrap_or_default().as_str()),
                (read, left_out),
                "{end}"
            );
            let warns = end.contains("99.9");
            assert_eq!(rows.left_out.warning("f").is_some(), warns, "{end}");
        }
    }

    #[test]
    fn rows_with_another_delimiter_are_a_warning_at_the_end_and_else_an_error() {
        let text = "t,x,y\n-2,1,2\n-1,2,3\n0,1.5,2\n1,2.5,3\n2;3.5;4\n3;4.5;5\n";
        let mut rows = rows(text.as_bytes(), 1000, &Reading::default()).unwrap();
        while rows.next_row().unwrap().is_some() {}
        let warning = Problem::in_file("f", rows.left_out.warning("f").unwrap()).to_string();
        let words = "the columns are separated by semicolons from here on, and by commas before \
            (save the whole file with one delimiter)";
        assert_eq!(rows.left_out.end, Some((6, 2)));
        assert_eq!(warning, format!("f: f: 2 lines are left out (from line 6): {words}"));
        let error = read(format!("{text}4,5.5,6\n").as_bytes(), 1000).unwrap_err().to_string();
        assert_eq!(error, format!("f, line 6: {words}"));
    }
}

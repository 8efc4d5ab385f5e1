//! The archive of a spreadsheet, checked before a library reads it: the unpacked size of its parts, and the memory that
//! their numbers need.

use std::io::{Cursor, Write as _};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::super::budget::{Budget, DAMAGED, too_much};

const MOST_PARTS: usize = 10_000;

/// Deepest nesting of elements.
const DEEPEST: usize = 200;

/// Sizes of a sheet of Excel.
const MOST_ROWS: u64 = 1 << 20;
const MOST_COLUMNS: u64 = 1 << 14;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpreadsheetKind {
    /// Excel's, `.xlsx`.
    Excel,
    /// LibreOffice's, `.ods`.
    OpenDocument,
}

/// The same archive, without compression and what is not needed, and its kind.
///
/// # Errors
/// No archive of a spreadsheet; parts that unpack to more than the budget, or declare more than they hold.
pub fn checked(bytes: &[u8]) -> Result<(Vec<u8>, SpreadsheetKind), String> {
    let budget = Budget::of(bytes.len());
    let parts = budget.parts(bytes, MOST_PARTS, |name| {
        let lower = name.to_ascii_lowercase();
        if lower.ends_with(".bin") && lower.contains("workbook") {
            return Err("it is a binary workbook (.xlsb): save it as .xlsx".into());
        }
        Ok([".xml", ".rels", "mimetype"].iter().any(|ending| lower.ends_with(ending)))
    })?;
    let has = |name: &str| parts.iter().any(|(part, _)| part.eq_ignore_ascii_case(name));
    let kind =
        match (has("content.xml"), parts.iter().any(|(part, _)| part.to_lowercase().contains("workbook"))) {
            (_, true) => SpreadsheetKind::Excel,
            (true, false) => SpreadsheetKind::OpenDocument,
            _ => return Err("it is of an unknown kind".into()),
        };
    let mut strings = None;
    if kind == SpreadsheetKind::Excel {
        for (_, content) in parts.iter().filter(|(_, content)| mentions(content, "sst")) {
            if strings.replace(lengths_of_strings(content, budget)?).is_some() {
                return Err("it has two lists of texts".into());
            }
        }
    }
    let strings = strings.unwrap_or_default();
    let mut asked = SheetTotals { budget, cells: 0, bytes: 0 };
    for (name, content) in &parts {
        if name.to_lowercase().ends_with("mimetype") {
            continue;
        }
        match kind {
            SpreadsheetKind::Excel => asked.of_sheet(content, &strings)?,
            SpreadsheetKind::OpenDocument => asked.of_tables(content)?,
        }
    }
    Ok((packed(&parts)?, kind))
}

/// True if an element of this name may be in the text.
fn mentions(content: &[u8], name: &str) -> bool {
    content.windows(name.len()).any(|window| window == name.as_bytes())
}

fn packed(parts: &[(String, Vec<u8>)]) -> Result<Vec<u8>, String> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, content) in parts {
        archive.start_file(name.as_str(), options).map_err(|_| DAMAGED)?;
        archive.write_all(content).map_err(|_| DAMAGED)?;
    }
    Ok(archive.finish().map_err(|_| DAMAGED)?.into_inner())
}

/// Calls for each element that begins, with its name and attributes, for each text, and for each element that ends.
fn each(content: &[u8], mut call: impl FnMut(&XmlPiece<'_>) -> Result<(), String>) -> Result<(), String> {
    let text = std::str::from_utf8(content).map_err(|_| DAMAGED)?;
    let mut reader = Reader::from_str(text.trim_start_matches('\u{feff}'));
    reader.config_mut().expand_empty_elements = true;
    let mut depth = 0_usize;
    loop {
        match reader.read_event().map_err(|_| DAMAGED)? {
            Event::Start(element) => {
                depth += 1;
                if depth > DEEPEST {
                    return Err("its elements are nested too deeply".into());
                }
                call(&XmlPiece::Begin(&element))?;
            }
            Event::End(element) => {
                depth = depth.checked_sub(1).ok_or(DAMAGED)?;
                call(&XmlPiece::End(element.local_name().as_ref()))?;
            }
            Event::Text(text) => call(&XmlPiece::Text(&text))?,
            Event::Eof if depth == 0 => return Ok(()),
            Event::Eof => return Err(DAMAGED.into()),
            _ => {}
        }
    }
}

/// A piece of a text of XML.
enum XmlPiece<'p> {
    Begin(&'p BytesStart<'p>),
    Text(&'p str),
    End(&'p str),
}

impl XmlPiece<'_> {
    fn begins(&self, name: &str) -> bool {
        matches!(self, Self::Begin(element) if element.local_name().as_ref() == name)
    }

    fn ends(&self, name: &str) -> bool {
        matches!(self, Self::End(end) if *end == name)
    }

    /// An attribute, by its name without a prefix.
    fn attribute(&self, name: &str) -> Option<String> {
        let Self::Begin(element) = self else { return None };
        let mut attributes = element.attributes().flatten();
        let found = attributes.find(|attribute| attribute.key.local_name().as_ref() == name)?;
        Some(found.value.to_string())
    }

    /// A number in an attribute; 1 without it.
    fn count(&self, name: &str) -> Result<u64, String> {
        self.attribute(name).map_or(Ok(1), |text| text.trim().parse().map_err(|_| DAMAGED.into()))
    }
}

/// Lengths of the texts that cells share.
fn lengths_of_strings(content: &[u8], budget: Budget) -> Result<Vec<u64>, String> {
    let mut lengths: Vec<u64> = Vec::new();
    let mut claimed = 0;
    each(content, |piece| {
        if piece.begins("sst") {
            claimed = piece.attribute("uniqueCount").map_or(0, |count| count.parse().unwrap_or(u64::MAX));
        } else if piece.begins("si") {
            lengths.push(0);
        } else if let (XmlPiece::Text(text), Some(last)) = (piece, lengths.last_mut()) {
            *last += text.len() as u64;
        }
        Ok(())
    })?;
    // Some programs count wrongly, which does no harm.
    if claimed > budget.cells() && claimed > lengths.len() as u64 {
        return Err(format!("it claims more texts than the {} that it has", lengths.len()));
    }
    Ok(lengths)
}

/// Cells and bytes of the sheets so far, within the budget.
struct SheetTotals {
    budget: Budget,
    cells: u64,
    bytes: u64,
}

impl SheetTotals {
    fn add_cells(&mut self, cells: u64) -> Result<(), String> {
        self.cells = self.cells.saturating_add(cells);
        if self.cells > self.budget.cells() {
            return Err(format!(
                "its sheets span more than {} cells, which it cannot hold",
                self.budget.cells()
            ));
        }
        Ok(())
    }

    fn add_bytes(&mut self, bytes: u64) -> Result<(), String> {
        self.bytes = self.bytes.saturating_add(bytes);
        if self.bytes > self.budget.bytes() { Err(too_much()) } else { Ok(()) }
    }

    /// A sheet of Excel, if the part is one.
    fn of_sheet(&mut self, content: &[u8], strings: &[u64]) -> Result<(), String> {
        let mut within = CellArea::default();
        let (mut row, mut column, mut is_shared, mut is_value) = (0, 0, false, false);
        each(content, |piece| {
            if piece.begins("row") {
                row = piece
                    .attribute("r")
                    .map_or(Ok(row + 1), |row| row.parse().map_err(|_| DAMAGED.to_string()))?;
                column = 0;
            } else if piece.begins("c") {
                (row, column) = match piece.attribute("r") {
                    Some(place) => place_of(&place)?,
                    None => (row, column + 1),
                };
                within.add(row, column)?;
                is_shared = piece.attribute("t").is_some_and(|kind| kind == "s");
            } else if piece.begins("v") {
                is_value = true;
            } else if piece.ends("v") {
                is_value = false;
            } else if let (XmlPiece::Text(text), true) = (piece, is_shared && is_value) {
                let length = text.trim().parse().ok().and_then(|place: usize| strings.get(place));
                self.add_bytes(length.copied().unwrap_or(0))?;
            }
            Ok(())
        })?;
        self.add_cells(within.area())
    }

    /// Sheets of an OpenDocument.
    fn of_tables(&mut self, content: &[u8]) -> Result<(), String> {
        let (mut row, mut cell) = (RowOfTable::default(), CellOfTable::default());
        let (mut widest, mut rows, mut empty_rows) = (0, 0_u64, 0_u64);
        each(content, |piece| {
            if piece.begins("table") {
                (widest, rows, empty_rows) = (0, 0, 0);
            } else if piece.begins("table-row") {
                row = RowOfTable { repeated: piece.count("number-rows-repeated")?, ..RowOfTable::default() };
            } else if piece.begins("table-cell") || piece.begins("covered-table-cell") {
                cell = CellOfTable {
                    repeated: piece.count("number-columns-repeated")?,
                    ..CellOfTable::default()
                };
                let kept = ["value", "string-value", "date-value", "time-value", "boolean-value", "formula"];
                for text in kept.into_iter().filter_map(|name| piece.attribute(name)) {
                    cell.is_filled = true;
                    cell.bytes += text.len() as u64;
                }
            } else if piece.begins("s") {
                cell.bytes = cell.bytes.saturating_add(piece.count("c")?);
                self.add_bytes(cell.bytes)?;
            } else if let XmlPiece::Text(text) = piece {
                cell.is_filled |= !text.trim().is_empty();
                cell.bytes += text.len() as u64;
            } else if piece.ends("table-cell") || piece.ends("covered-table-cell") {
                let repeated = cell.repeated.min(MOST_COLUMNS);
                match cell.is_filled {
                    true => {
                        row.width = row.width.saturating_add(row.empty).saturating_add(repeated);
                        row.empty = 0;
                        row.bytes = row.bytes.saturating_add(cell.bytes.saturating_mul(repeated));
                    }
                    false => row.empty = row.empty.saturating_add(repeated),
                }
            } else if piece.ends("table-row") {
                if row.width == 0 {
                    empty_rows = empty_rows.saturating_add(row.repeated);
                    return Ok(());
                }
                widest = row.width.max(widest);
                rows = rows.saturating_add(std::mem::take(&mut empty_rows)).saturating_add(row.repeated);
                if rows.saturating_mul(widest) > self.budget.cells() {
                    self.add_cells(rows.saturating_mul(widest))?;
                }
                self.add_bytes(row.bytes.saturating_mul(row.repeated))?;
            } else if piece.ends("table") {
                self.add_cells(rows.saturating_mul(widest))?;
            }
            Ok(())
        })
    }
}

#[derive(Default)]
struct RowOfTable {
    repeated: u64,
    width: u64,
    /// Empty cells behind the last filled one.
    empty: u64,
    bytes: u64,
}

#[derive(Default)]
struct CellOfTable {
    repeated: u64,
    is_filled: bool,
    bytes: u64,
}

/// The rectangle that holds all cells.
#[derive(Default)]
pub struct CellArea {
    bounds: Option<[u64; 4]>,
}

impl CellArea {
    /// Adds a cell, whose row and column count from 1.
    pub fn add(&mut self, row: u64, column: u64) -> Result<(), String> {
        if row == 0 || column == 0 || row > MOST_ROWS || column > MOST_COLUMNS {
            return Err(format!("it has a cell in row {row}, column {column}, which no sheet has"));
        }
        let [top, bottom, left, right] = self.bounds.unwrap_or([row, row, column, column]);
        self.bounds = Some([top.min(row), bottom.max(row), left.min(column), right.max(column)]);
        Ok(())
    }

    /// Cells of the rectangle.
    pub fn area(&self) -> u64 {
        self.bounds.map_or(0, |[top, bottom, left, right]| (bottom - top + 1) * (right - left + 1))
    }
}

/// Row and column of a name such as `BC12`, counted from 1.
fn place_of(name: &str) -> Result<(u64, u64), String> {
    let digits = name.find(|letter: char| letter.is_ascii_digit()).unwrap_or(name.len());
    let (letters, digits) = name.split_at(digits);
    if letters.is_empty() || letters.len() > 3 || digits.len() > 7 {
        return Err(format!("it has a cell {name:.20}, which no sheet has"));
    }
    let letter = |sum: u64, letter: u8| 26 * sum + u64::from(letter.to_ascii_uppercase().wrapping_sub(b'@'));
    let column = letters.bytes().fold(0, letter);
    Ok((digits.parse().map_err(|_| DAMAGED)?, column))
}

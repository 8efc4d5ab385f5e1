//! The sheets of a spreadsheet as text: a line for each row, cells separated by tabs.

mod archive;
mod compound;
#[cfg(test)]
mod tests;

use std::io::Cursor;

use calamine::{Data, ExcelDateTime, Ods, OdsError, Range, Reader, Xls, XlsError, Xlsx, XlsxError};

use super::budget::{Budget, DAMAGED};
use super::{TextSheet, push_words};
use crate::number::shortest;
use hysid_document::visible::{clipped, listed};

/// How compound files begin, such as `.xls`.
pub const COMPOUND: &[u8] = b"\xd0\xcf\x11\xe0";

/// The name, in UTF-16, of the part of a compound file that holds an encrypted `.xlsx` file.
const ENCRYPTED_PART: &[u8] = b"E\0n\0c\0r\0y\0p\0t\0e\0d\0P\0a\0c\0k\0a\0g\0e\0";

const ENCRYPTED: &str = "it is encrypted: save it without a password";

/// The sheets that are not empty, or the one that is chosen. Line `n` of a text is row `n` of the sheet.
pub fn sheets(bytes: Vec<u8>, chosen: Option<String>) -> Result<Vec<TextSheet>, String> {
    let budget = Budget::of(bytes.len());
    budget.run(move || {
        if bytes.starts_with(COMPOUND) {
            compound::check(&bytes)?;
            if bytes.windows(ENCRYPTED_PART.len()).any(|part| part == ENCRYPTED_PART) {
                return Err(ENCRYPTED.into());
            }
            return of_book::<Xls<_>, _>(bytes, chosen.as_deref(), |error| {
                matches!(error, XlsError::Password)
            });
        }
        let (bytes, kind) = archive::checked(&bytes)?;
        match kind {
            archive::SpreadsheetKind::Excel => {
                of_book::<Xlsx<_>, _>(bytes, chosen.as_deref(), |error| matches!(error, XlsxError::Password))
            }
            archive::SpreadsheetKind::OpenDocument => {
                of_book::<Ods<_>, _>(bytes, chosen.as_deref(), |error| matches!(error, OdsError::Password))
            }
        }
    })
}

/// As [`sheets`], of a file whose declared sizes do not exceed its content.
fn of_book<R, E>(
    bytes: Vec<u8>,
    chosen: Option<&str>,
    is_encrypted: fn(&E) -> bool,
) -> Result<Vec<TextSheet>, String>
where
    R: Reader<Cursor<Vec<u8>>, Error = E>,
    E: std::fmt::Debug + std::fmt::Display + From<std::io::Error>,
{
    let in_words = |error: E| if is_encrypted(&error) { ENCRYPTED } else { DAMAGED };
    let mut book = R::new(Cursor::new(bytes)).map_err(in_words)?;
    let names = book.sheet_names();
    let names = match chosen {
        Some(chosen) => {
            let by_number = chosen.parse::<usize>().ok().and_then(|number| names.get(number.checked_sub(1)?));
            let name = names.iter().find(|name| *name == chosen).or(by_number);
            vec![name.ok_or_else(|| {
                format!("there is no sheet \"{}\" (sheets: {})", clipped(chosen), listed(&names))
            })?]
        }
        None => names.iter().collect(),
    };
    let mut sheets = Vec::new();
    for name in names {
        let range =
            book.worksheet_range(name).map_err(|error| format!("sheet {}: {error}", clipped(name)))?;
        if !range.is_empty() || chosen.is_some() {
            let described = format!("sheet {}", clipped(name));
            sheets.push(TextSheet { name: name.clone(), described, text: lines(&range) });
        }
    }
    if sheets.is_empty() { Err("all its sheets are empty".into()) } else { Ok(sheets) }
}

fn lines(range: &Range<Data>) -> String {
    let (row, _) = range.start().unwrap_or_default();
    let mut text = "\n".repeat(row as usize);
    for cells in range.rows() {
        for (place, cell) in cells.iter().enumerate() {
            if place > 0 {
                text.push('\t');
            }
            push(&mut text, cell);
        }
        text.push('\n');
    }
    text
}

fn push(text: &mut String, cell: &Data) {
    match cell {
        Data::Empty => {}
        Data::Int(number) => text.push_str(&number.to_string()),
        Data::Float(number) => text.push_str(&shortest(*number)),
        Data::Bool(truth) => text.push(if *truth { '1' } else { '0' }),
        Data::DateTime(date) => text.push_str(&stamp(date)),
        Data::Error(_) => text.push_str("#N/A"),
        Data::String(words) | Data::DateTimeIso(words) | Data::DurationIso(words) => push_words(text, words),
    }
}

/// A date with a clock, or a clock alone for a time of day or a duration.
fn stamp(date: &ExcelDateTime) -> String {
    let days = date.as_f64();
    let seconds = (days - days.floor()) * 86_400.0;
    // Spreadsheets store days with fifteen digits: microseconds are beyond them.
    let whole = (seconds * 1e5).round() / 1e5;
    let clock = |hours: f64| {
        let minutes = (whole / 60.0).floor();
        let within_hour = minutes - 60.0 * (minutes / 60.0).floor();
        format!("{:.0}:{within_hour:02.0}:{:08.5}", hours + (minutes / 60.0).floor(), whole - 60.0 * minutes)
    };
    if date.is_duration() || days < 1.0 {
        return clock(24.0 * days.floor());
    }
    let (year, month, day, ..) = date.to_ymd_hms_milli();
    format!("{year:04}-{month:02}-{day:02} {}", clock(0.0))
}

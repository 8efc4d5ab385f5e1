//! The cells of a line, and what each of them is.

use std::borrow::Cow;

use hysid_core::data::unit;

use crate::number::{self, NumberProblem};
use crate::reading::Delimiter;
use crate::stamp::Stamp;

/// Text of a cell, without its quotation marks.
#[derive(Debug, Clone, PartialEq)]
pub struct LineCell<'t> {
    /// Without quotation marks.
    pub text: Cow<'t, str>,
    /// It stands in quotation marks.
    pub is_quoted: bool,
}

/// Kind of a cell's content.
#[derive(Debug, Clone, PartialEq)]
pub enum CellKind {
    /// Empty, or a word for a missing value.
    Missing,
    /// A number, perhaps with a unit behind it.
    Number(Option<String>),
    /// A date with a clock, or a clock.
    Stamp,
    /// Anything else.
    Text,
}

impl LineCell<'_> {
    /// Classifies the content.
    pub fn kind(&self) -> CellKind {
        let text = self.text.trim();
        if number::is_missing(text) {
            return CellKind::Missing;
        }
        let (digits, unit) = bare(text);
        match number::parsed(digits, None) {
            Ok(_) | Err(NumberProblem::TooLarge) => CellKind::Number(unit.map(String::from)),
            Err(_) if Stamp::of(text).is_some() => CellKind::Stamp,
            Err(_) => CellKind::Text,
        }
    }
}

/// A number without the known unit behind it, and that unit.
pub fn bare(text: &str) -> (&str, Option<&str>) {
    let text = text.trim();
    let digits = text.trim_end_matches(|c: char| !(c.is_ascii_digit() || c == '.' || c == ','));
    let unit = text[digits.len()..].trim();
    match unit.is_empty() || digits.is_empty() {
        false if unit::is_unit(unit) => (digits, Some(unit)),
        _ => (text, None),
    }
}

pub fn split(line: &str, delimiter: Delimiter) -> Vec<LineCell<'_>> {
    let mut cells = Vec::new();
    let is_end = |letter: char| match delimiter {
        Delimiter::Character(character) => letter == char::from(character),
        Delimiter::Blanks => letter == ' ' || letter == '\t',
    };
    let is_blanks = delimiter == Delimiter::Blanks;
    let mut rest = if is_blanks { line.trim_matches([' ', '\t']) } else { line };
    loop {
        let (cell, length) = match rest.strip_prefix('"').and_then(|inner| quoted(inner, is_end)) {
            Some((text, length)) => (LineCell { text, is_quoted: true }, length + 1),
            None => {
                let length = rest.find(is_end).unwrap_or(rest.len());
                (LineCell { text: rest[..length].into(), is_quoted: false }, length)
            }
        };
        cells.push(cell);
        if length >= rest.len() {
            return cells;
        }
        rest = &rest[length + 1..];
        if is_blanks {
            rest = rest.trim_start_matches([' ', '\t']);
        }
    }
}

/// The text up to the closing quotation mark, behind which the cell ends, and the length of both.
fn quoted(inner: &str, is_end: impl Fn(char) -> bool) -> Option<(Cow<'_, str>, usize)> {
    let mut from = 0;
    loop {
        let close = from + inner[from..].find('"')?;
        let behind = &inner[close + 1..];
        match behind.chars().next() {
            Some('"') => from = close + 2,
            Some(letter) if !is_end(letter) => return None,
            _ => {
                let text = &inner[..close];
                let text = if text.contains('"') { text.replace("\"\"", "\"").into() } else { text.into() };
                return Some((text, close + 1));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(line: &str, delimiter: Delimiter) -> Vec<String> {
        split(line, delimiter).into_iter().map(|cell| cell.text.into_owned()).collect()
    }

    #[test]
    fn lines_are_cut_at_delimiters_outside_quotation_marks() {
        assert_eq!(texts("a,\"b,\"\"c\"\"\",,d", Delimiter::COMMA), ["a", "b,\"c\"", "", "d"]);
        assert_eq!(texts("5\",6", Delimiter::COMMA), ["5\"", "6"]);
        assert_eq!(texts("a,", Delimiter::COMMA), ["a", ""]);
        assert_eq!(texts("  0.5 \t \"x y\"  2 ", Delimiter::Blanks), ["0.5", "x y", "2"]);
    }

    #[test]
    fn cells_are_numbers_stamps_or_text() {
        let kind = |text: &str| LineCell { text: text.into(), is_quoted: false }.kind();
        assert_eq!(kind("-1,5"), CellKind::Number(None));
        assert_eq!(kind(" 12.5 kN "), CellKind::Number(Some("kN".into())));
        assert_eq!(kind("3°"), CellKind::Number(Some("°".into())));
        assert_eq!(kind("20 °C"), CellKind::Number(Some("°C".into())));
        assert_eq!(kind("#N/A"), CellKind::Missing);
        assert_eq!(kind("12:00:00"), CellKind::Stamp);
        assert_eq!(kind("2024-03-01"), CellKind::Stamp);
        for text in ["force", "1.2.3", "5 apples", "mm"] {
            assert_eq!(kind(text), CellKind::Text, "{text}");
        }
    }
}

//! Tables of typed cells.

use crate::number::number;
use hysid_core::from;

/// Significant digits of a number for which none are named.
const DIGITS: u8 = 3;

/// A table. The first cell of each row is the row's heading. In a row with fewer cells than columns, the last
/// cell spans all remaining columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    /// Heading without a full stop; may be empty.
    pub heading: String,
    pub columns: Vec<String>,
    pub rows: Vec<Vec<Cell>>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A finite number and its number of significant digits.
    Number(f64, u8),
    /// A number with a percent sign, and its number of significant digits.
    Percent(f64, u8),
    Text(String),
    Missing,
}

impl Table {
    /// A table with these columns and without rows.
    pub fn new<C: Into<String>>(columns: impl IntoIterator<Item = C>) -> Self {
        Self { columns: columns.into_iter().map(Into::into).collect(), ..Self::default() }
    }

    /// The table with a heading, written without a full stop.
    pub fn headed(self, heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), ..self }
    }

    pub fn with_rows(self, rows: impl IntoIterator<Item = Vec<Cell>>) -> Self {
        Self { rows: rows.into_iter().collect(), ..self }
    }

    pub fn push(&mut self, row: impl IntoIterator<Item = Cell>) {
        self.rows.push(row.into_iter().collect());
    }

    /// True if a column has words and not numbers with units: more than two letters for each digit in each cell that is
    /// not empty, and one such cell.
    pub fn is_of_words(&self, column: usize) -> bool {
        let cells = || self.rows.iter().filter_map(|row| row.get(column));
        let count = |text: &str, of: fn(char) -> bool| text.chars().filter(|&letter| of(letter)).count();
        let is_word = |cell: &Cell| match cell {
            Cell::Text(text) => {
                let digits = count(text, |letter| letter.is_ascii_digit());
                text.is_empty() || count(text, char::is_alphabetic) > 2 * digits
            }
            _ => false,
        };
        let is_filled = |cell: &Cell| matches!(cell, Cell::Text(text) if !text.is_empty());
        cells().all(is_word) && cells().any(is_filled)
    }
}

impl Cell {
    /// A number with `digits` significant digits; [`Cell::Missing`] for `None` and for a number that is not
    /// finite.
    pub fn number(value: impl Into<Option<f64>>, digits: u8) -> Self {
        match value.into() {
            Some(value) if value.is_finite() => Cell::Number(value, digits),
            _ => Cell::Missing,
        }
    }

    /// The text of the cell on a page.
    pub fn shown(&self) -> String {
        match self {
            Cell::Number(value, digits) => number(*value, (*digits).into()),
            Cell::Percent(value, digits) => format!("{} %", number(*value, (*digits).into())),
            Cell::Text(text) => text.clone(),
            Cell::Missing => "–".into(),
        }
    }

    /// The text of the cell on a terminal, in ASCII.
    pub fn ascii(&self) -> String {
        match self {
            Cell::Text(text) => text.clone(),
            Cell::Missing => "-".into(),
            number => number.shown().replace('−', "-"),
        }
    }
}

from! {
    f64 => Cell: value => Cell::number(value, DIGITS);
    Option<f64> => Cell: value => Cell::number(value, DIGITS);
    usize => Cell: count => Cell::Text(count.to_string());
    &str => Cell: text => Cell::Text(text.into());
    String => Cell: text => Cell::Text(text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_of_words_has_no_number() {
        let mut table = Table::new(["row", "words", "rows", "mixed", "blank"]);
        table.push([
            "1".into(),
            "19 of 36 pairs of turning points".into(),
            "3.8 um".into(),
            "none".into(),
            "".into(),
        ]);
        table.push(["2".into(), "".into(), "805-900".into(), Cell::Missing, "".into()]);
        let words: Vec<bool> = (0..5).map(|column| table.is_of_words(column)).collect();
        assert_eq!(words, [false, true, false, false, false]);
    }
}

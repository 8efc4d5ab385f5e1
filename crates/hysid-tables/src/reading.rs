//! Options of reading a file that override detection.

use std::str::FromStr;

use crate::number::DecimalSign;

/// How a table is to be read. The default is to find everything out from the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    pub delimiter: Option<Delimiter>,
    pub decimal: Option<DecimalSign>,
    /// Lines before the table.
    pub skip: usize,
    /// The table has no names of columns; they are `c1`, `c2` and so on.
    pub no_header: bool,
    /// The line behind the names has units.
    pub units_row: bool,
    /// Cells that stand for a missing value.
    pub missing: Vec<String>,
    pub encoding: Option<TextEncoding>,
    /// Sheet of a spreadsheet or table of a text, by its name or its number from 1, or variable of a file that has them.
    pub sheet: Option<String>,
    pub rows: RowSelection,
}

/// Rows of a table that are used, counted from 1 behind the header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RowSelection {
    pub first: u64,
    pub last: Option<u64>,
    /// Distance of the rows that are used: one of every `every`.
    pub every: u64,
}

impl Default for RowSelection {
    fn default() -> Self {
        Self { first: 1, last: None, every: 1 }
    }
}

impl RowSelection {
    pub fn has(&self, row: u64) -> bool {
        row >= self.first
            && self.last.is_none_or(|last| row <= last)
            && (row - self.first).is_multiple_of(self.every)
    }

    /// True if no row from this one on is used.
    pub fn ends_before(&self, row: u64) -> bool {
        self.last.is_some_and(|last| row > last)
    }

    pub fn is_all(&self) -> bool {
        *self == Self::default()
    }
}

impl FromStr for RowSelection {
    type Err = String;

    /// `FROM:TO`, `FROM:` or `:TO`.
    fn from_str(text: &str) -> Result<Self, String> {
        let advice =
            || "write FROM:TO, such as 1:2000, 500: or :2000 (rows after the header, from 1)".to_string();
        let (first, last) = text.split_once(':').ok_or_else(advice)?;
        let number = |text: &str| match text.trim() {
            "" => Ok(None),
            text => text.parse::<u64>().ok().filter(|&row| row > 0).map(Some).ok_or_else(advice),
        };
        let (first, last) = (number(first)?.unwrap_or(1), number(last)?);
        if last.is_some_and(|last| last < first) {
            return Err("the first row comes after the last".into());
        }
        Ok(Self { first, last, every: 1 })
    }
}

/// Separator of the cells of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Delimiter {
    /// An ASCII character other than a blank.
    Character(u8),
    /// One or more blanks or tabs.
    Blanks,
}

impl Delimiter {
    pub const COMMA: Self = Self::Character(b',');

    /// Those that are found in a file, where several are possible the first of them.
    pub const ALL: [Self; 5] =
        [Self::Character(b'\t'), Self::Character(b';'), Self::COMMA, Self::Character(b'|'), Self::Blanks];

    pub fn name(self) -> String {
        match self {
            Self::Character(b',') => "comma".into(),
            Self::Character(b';') => "semicolon".into(),
            Self::Character(b'\t') => "tab".into(),
            Self::Character(b'|') => "bar".into(),
            Self::Character(other) => format!("\"{}\"", char::from(other)),
            Self::Blanks => "blanks".into(),
        }
    }

    /// Its name for many.
    pub fn plural(self) -> String {
        match self {
            Self::Blanks => "blanks".into(),
            other => format!("{}s", other.name()),
        }
    }

    /// The character that separates the cells of a copy of the table with numbers of this sign.
    pub fn in_a_copy(self, decimal: Option<DecimalSign>) -> u8 {
        match self {
            Self::Character(character) => character,
            Self::Blanks if decimal == Some(DecimalSign::Comma) => b';',
            Self::Blanks => b',',
        }
    }
}

impl FromStr for Delimiter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "comma" => Ok(Self::COMMA),
            "semicolon" => Ok(Self::Character(b';')),
            "tab" | "\\t" => Ok(Self::Character(b'\t')),
            "bar" => Ok(Self::Character(b'|')),
            "blanks" | "blank" | "space" | " " => Ok(Self::Blanks),
            _ => match text.as_bytes() {
                [b'"' | b'\r' | b'\n' | b'.' | b'+' | b'-' | b'0'..=b'9'] => {
                    Err("it cannot separate cells".into())
                }
                &[character] if character.is_ascii() => Ok(Self::Character(character)),
                _ => Err("choose comma, semicolon, tab, bar, blanks or a single character".into()),
            },
        }
    }
}

impl FromStr for DecimalSign {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "point" | "." => Ok(Self::Point),
            "comma" | "," => Ok(Self::Comma),
            _ => Err("choose point or comma".into()),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextEncoding(pub(crate) &'static encoding_rs::Encoding);

impl TextEncoding {
    pub fn name(self) -> &'static str {
        self.0.name()
    }
}

impl FromStr for TextEncoding {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let label = match text.to_ascii_lowercase().replace('_', "-").as_str() {
            // Windows' names, which the standard of the web does not have.
            "cp1250" => "windows-1250".to_string(),
            "cp932" => "shift_jis".into(),
            "cp936" => "gbk".into(),
            "cp949" => "euc-kr".into(),
            "cp950" => "big5".into(),
            "utf8" => "utf-8".into(),
            _ => text.to_string(),
        };
        encoding_rs::Encoding::for_label(label.as_bytes()).map(Self).ok_or_else(|| {
            "choose one such as utf-8, utf-16le, windows-1252, windows-1251, shift_jis or gbk".into()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_selected_from_one() {
        let rows = RowSelection { every: 3, ..":8".parse().unwrap() };
        let chosen: Vec<u64> = (1..20).filter(|&row| rows.has(row)).collect();
        assert_eq!(chosen, [1, 4, 7]);
        assert!(rows.ends_before(9) && !rows.ends_before(8));
        let from: RowSelection = "5:".parse().unwrap();
        assert!(!from.has(4) && from.has(5) && from.has(1_000_000));
        for text in ["", "5", "0:3", "7:3", "a:b", "-1:3"] {
            assert!(text.parse::<RowSelection>().is_err(), "{text}");
        }
    }

    #[test]
    fn delimiters_and_encodings_have_names() {
        assert_eq!("tab".parse(), Ok(Delimiter::Character(b'\t')));
        assert_eq!("blanks".parse(), Ok(Delimiter::Blanks));
        assert_eq!(":".parse(), Ok(Delimiter::Character(b':')));
        for text in ["", "5", "\"", ";;", "ä"] {
            assert!(text.parse::<Delimiter>().is_err(), "{text}");
        }
        assert_eq!("cp1252".parse::<TextEncoding>().unwrap().name(), "windows-1252");
        assert_eq!("latin1".parse::<TextEncoding>().unwrap().name(), "windows-1252");
        assert!("klingon".parse::<TextEncoding>().is_err());
    }
}

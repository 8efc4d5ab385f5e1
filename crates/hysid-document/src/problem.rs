//! Problems of tables, columns and requests: where, what, and which option helps.

use std::fmt;

use hysid_core::words::{Hint, Words};

use crate::Face;
use crate::visible::clipped;

pub type Result<T, E = Problem> = std::result::Result<T, E>;

/// Problem of a table, of its columns or of a request. It displays in the notation of the terminal; other interfaces render
/// its [words](Problem::words).
#[derive(Debug, Clone, thiserror::Error)]
pub enum Problem {
    /// A request that is invalid whatever the data; the program then exits with status 2.
    #[error("{}", Face::Terminal.told(.0))]
    Request(Words),
    /// A request that has to wait for another one.
    #[error("{}", Face::Terminal.told(.0))]
    Busy(Words),
    /// A table that cannot be used.
    #[error("{place}: {}", Face::Terminal.told(.words))]
    Table { place: TablePlace, words: Words },
    #[error(transparent)]
    Library(#[from] hysid_core::Error),
    #[error("{}", Face::Terminal.told(.0))]
    Other(Words),
}

/// Place of a problem.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TablePlace {
    pub file: String,
    /// Line of the file, counted from 1.
    pub line: Option<u64>,
    pub column: Option<String>,
}

impl fmt::Display for TablePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        self.line.iter().try_for_each(|line| write!(f, ", line {line}"))?;
        self.column.iter().try_for_each(|column| write!(f, ", column \"{}\"", clipped(column)))
    }
}

impl Problem {
    pub fn request(words: impl Into<Words>) -> Self {
        Self::Request(words.into())
    }

    /// An invalid value of an option.
    pub fn option(name: &'static str, needed: impl fmt::Display) -> Self {
        Self::Request(Words::from(Hint::Option(name)) + format!(": {needed}"))
    }

    pub fn in_file(file: &str, words: impl Into<Words>) -> Self {
        let place = TablePlace { file: file.into(), line: None, column: None };
        Self::Table { place, words: words.into() }
    }

    pub fn at(file: &str, line: u64, words: impl Into<Words>) -> Self {
        let place = TablePlace { file: file.into(), line: Some(line), column: None };
        Self::Table { place, words: words.into() }
    }

    pub fn in_cell(file: &str, line: u64, column: &str, words: impl Into<Words>) -> Self {
        let place = TablePlace { file: file.into(), line: Some(line), column: Some(column.into()) };
        Self::Table { place, words: words.into() }
    }

    /// Prefixes the problem with the step that failed.
    pub fn within(self, what: impl fmt::Display) -> Self {
        Self::Other(Words::from(format!("{what}: ")) + self.words())
    }

    /// The problem with its place and hints.
    pub fn words(&self) -> Words {
        match self {
            Self::Request(words) | Self::Busy(words) | Self::Other(words) => words.clone(),
            Self::Table { place, words } => Words::from(format!("{place}: ")) + words.clone(),
            Self::Library(error) => error.to_string().into(),
        }
    }

    /// File to inspect, for a problem of a line without advice.
    pub fn file_to_look_at(&self) -> Option<&str> {
        match self {
            Self::Table { place, words } if place.line.is_some() && !words.helps() => Some(&place.file),
            _ => None,
        }
    }
}

impl From<serde_json::Error> for Problem {
    fn from(error: serde_json::Error) -> Self {
        error.to_string().into()
    }
}

impl From<String> for Problem {
    fn from(text: String) -> Self {
        Self::Other(text.into())
    }
}

impl From<&str> for Problem {
    fn from(text: &str) -> Self {
        Self::Other(text.into())
    }
}

/// A problem in words, as `format!` takes them.
#[macro_export]
macro_rules! problem {
    ($($words:tt)*) => { $crate::Problem::from(format!($($words)*)) };
}

//! Problems of cells.

use hysid_core::words::Words;

/// Problem of a cell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CellProblem {
    /// A text where a number is needed, which may stand for a missing value.
    NoNumber(String),
    Other(Words),
}

impl From<CellProblem> for Words {
    fn from(problem: CellProblem) -> Self {
        match problem {
            CellProblem::NoNumber(text) => text.into(),
            CellProblem::Other(words) => words,
        }
    }
}

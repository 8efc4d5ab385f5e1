//! How alike two records are.

use std::fmt;

/// Similarity of a record to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Likeness {
    /// The same numbers.
    Equal,
    /// The same numbers except for rounding or little noise.
    NearlyEqual,
    /// Equal or nearly equal to some rows of the other.
    Part,
    /// The other is equal or nearly equal to some of its rows.
    Contains,
}

impl fmt::Display for Likeness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Equal => "equal to",
            Self::NearlyEqual => "nearly equal to",
            Self::Part => "a part of",
            Self::Contains => "longer than, and contains,",
        })
    }
}

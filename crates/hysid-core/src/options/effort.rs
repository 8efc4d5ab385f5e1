//! The effort of a search.

use serde::{Deserialize, Serialize};

use crate::named;

/// How long the candidates of `auto` are searched.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effort {
    /// The first three candidates of each kind, one start of each, a third of the epochs.
    Quick,
    /// Two starts of each candidate.
    #[default]
    Normal,
    /// Sixteen starts of each candidate, five times the epochs, five times the starts of each search.
    Thorough,
}

named!(Effort, "effort": Quick = "quick", Normal = "normal", Thorough = "thorough");

impl Effort {
    /// Candidates of each kind at most, apart from laws that are searched.
    pub fn candidates_of_a_kind(self) -> usize {
        match self {
            Self::Quick => 3,
            Self::Normal | Self::Thorough => usize::MAX,
        }
    }

    /// Starts of a randomly initialized candidate.
    pub fn starts(self) -> usize {
        match self {
            Self::Quick => 1,
            Self::Normal => 2,
            Self::Thorough => 16,
        }
    }

    /// A number of epochs, or of starts of one search, from that of the normal effort.
    pub fn scaled(self, normal: usize) -> usize {
        match self {
            Self::Quick => normal.div_ceil(3),
            Self::Normal => normal,
            Self::Thorough => 5 * normal,
        }
    }
}

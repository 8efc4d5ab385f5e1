//! State of a model before the first row of a record, found from outputs at its beginning.

use std::fmt;

use crate::data::initial_state::in_words;
use crate::data::record::fingerprint::Fingerprint;
use crate::significant::Significant;

/// State of a model before the first row of a record, as [`Model::find_state`](crate::model::Model::find_state) finds it.
///
/// It has the state of each member of an ensemble: internal states of a law, displacements and velocities of a model with
/// inertia, or a past of the first input. For `duhem-nn` it also has the error at the last known row, which decays.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordState {
    pub(crate) members: Vec<MemberState>,
    pub(crate) residual: Option<FadingResidual>,
    /// Trained range of the first input, in its unit.
    pub(crate) range: (f64, f64),
    /// Fingerprint of the model.
    pub(crate) model: Fingerprint,
}

impl RecordState {
    /// Turning points of the first input before the first row that were found for a single model, in its unit; `None` for free
    /// states, and for an ensemble.
    pub fn past(&self) -> Option<&[f64]> {
        match self.members.as_slice() {
            [MemberState::Past(past)] => Some(past),
            _ => None,
        }
    }
}

/// State of a single model before the first row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum MemberState {
    /// Turning points of the first input before the first row, in its unit.
    Past(Vec<f64>),
    /// Internal states of a law, or displacements and then velocities of modes.
    Free(Vec<f64>),
}

/// Residual at the end of a known beginning, which fades in the rows after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FadingResidual {
    /// Rows of the known beginning that are still to come.
    pub rows: usize,
    /// Residual at the last row with a known output, in the unit of the output.
    pub residual: f64,
    /// Factor by which it decreases from row to row.
    pub remaining: f64,
}

impl FadingResidual {
    /// Corrects the output of the next row.
    pub fn corrected(&mut self, output: f64) -> f64 {
        if self.rows > 0 {
            self.rows -= 1;
            return output;
        }
        self.residual *= self.remaining;
        output + self.residual
    }
}

impl fmt::Display for RecordState {
    /// The state of each member in words, such as `after 3, then 1.2`.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, member) in self.members.iter().enumerate() {
            if self.members.len() > 1 {
                write!(to, "{}member {}: ", if place > 0 { "; " } else { "" }, place + 1)?;
            }
            match member {
                MemberState::Past(past) => write!(to, "{}", in_words(past, self.range))?,
                MemberState::Free(states) => {
                    let shown = states.iter().map(|state| format!("{:.3}", Significant(*state)));
                    write!(to, "states {}", shown.collect::<Vec<_>>().join(", "))?;
                }
            }
        }
        match self.residual {
            Some(FadingResidual { rows, residual, .. }) => {
                write!(to, "; residual {:.3} at row {rows}", Significant(residual))
            }
            None => Ok(()),
        }
    }
}

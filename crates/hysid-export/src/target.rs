//! The targets, one a file: each writes programs in its language.

pub mod c;
mod printer;

use crate::description::Argument;
use crate::export::Subject;

/// Names of the arguments of a step.
pub(crate) fn argument_names(subject: &Subject<'_>) -> Vec<String> {
    let name = |argument: &Argument| match argument {
        Argument::Input(0) => "x".to_string(),
        Argument::Input(input) => format!("x{}", input + 1),
        Argument::TimeStep => "time_step".to_string(),
        Argument::Rate => "rate".to_string(),
    };
    subject.description().arguments.iter().map(name).collect()
}

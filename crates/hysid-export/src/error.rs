//! Errors of an export.

use thiserror::Error;

/// Why a model was not exported.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the message of each has its fields")]
pub enum Error {
    /// A name that is no identifier of the target's language.
    #[error(
        "the name {0:?} is no identifier: at most 50 letters, digits and underscores, and it begins with a letter"
    )]
    Name(String),
    /// A name that has another meaning in the target's language.
    #[error("{name:?} has another meaning in exports to {target}: choose another name")]
    Reserved { name: String, target: &'static str },
    /// More inputs than the target takes.
    #[error("{target} has one input, and the model has {inputs}")]
    Inputs { target: &'static str, inputs: usize },
    /// A model with inertia for a target whose elements have none.
    #[error(
        "{target} is a force that follows from a displacement, and the model has inertia: a resonance of its own"
    )]
    Inertia { target: &'static str },
    /// A band of a model that has none.
    #[error("the model has no prediction band: only ensembles and single models that replace one have")]
    NoBand,
    /// A band that cannot be.
    #[error("{0}")]
    Band(String),
    /// The C compiler failed.
    #[error("the C compiler failed: {0}")]
    Compiler(String),
    /// An archive was not written.
    #[error("the archive cannot be written: {0}")]
    Archive(String),
    /// Single precision for a target that computes in double precision.
    #[error("{0} computes in double precision: leave the precision at f64")]
    Precision(&'static str),
    /// An inverse for a target that has none.
    #[error("exports to {0} have no inverse: those to c and fmu have one")]
    NoInverse(&'static str),
    /// Limits of the input of an inverse.
    #[error("{0}")]
    Limits(String),
    /// Largest change of the input of an inverse.
    #[error("{0}")]
    Slew(String),
    /// An inverse of a model whose rate is an argument.
    #[error(
        "the inverse gives the input and so its rate, which cannot be an argument: use backward differences"
    )]
    InverseRate,
}

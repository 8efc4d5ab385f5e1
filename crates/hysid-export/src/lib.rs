//! Hysteresis models as source code that runs where they are needed.
//!
//! ```text
//! Model ─► description ─► program ─► target ─► files
//!                            └─► tangent
//! ```
//!
//! A [`description::Description`] is one step of a model as a [`program::Program`]; a target writes it in its language.

pub mod description;
pub mod error;
pub mod program;
pub mod target;

pub use error::Error;

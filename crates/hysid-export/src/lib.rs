//! Hysteresis models as source code that runs where they are needed.
//!
//! ```text
//! Model ─► description ─► program ─► target ─► files
//!                            └─► tangent
//! ```
//!
//! [`export`] gives the files of an export. A [`description::Description`] is one step of a model as a
//! [`program::Program`]; a target writes it in its language.

pub mod description;
pub mod error;
mod export;
mod manifest;
pub mod program;
mod readme;
mod target;
pub mod vectors;

pub use error::Error;
pub use export::{Export, File, Options, export};
pub use manifest::{MANIFEST, files_of};
pub use program::Precision;
pub use target::{FmiVersion, Target};

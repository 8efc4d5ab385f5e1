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
mod inverse;
mod manifest;
mod options;
pub mod program;
mod readme;
mod reserved;
mod subject;
mod target;
mod text;
pub mod vectors;

pub use error::Error;
pub use export::{Export, export};
pub use manifest::{MANIFEST, checksum, files_of};
pub use options::{FmiVersion, InverseOptions, Options};
pub use program::Precision;
pub use subject::ExportFile;
pub use target::Target;
#[doc(hidden)]
pub use target::c::elementary::all_elementary_functions;

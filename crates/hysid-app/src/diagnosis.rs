//! Results of `hysid diagnose`: text for a terminal, one JSON object, and a page with pictures.

mod cards;
mod counsel;
#[cfg(feature = "tables")]
mod data;
mod findings;
mod invertibility;
mod loops;
mod model;
mod overview;

#[cfg(feature = "tables")]
pub use data::DataDiagnosis;
use hysid_document::plain::{WIDTH, wrapped};
pub use model::DiagnosedModel;

/// The text in lines that fit a terminal.
fn paragraph(text: &str) -> String {
    wrapped(text, WIDTH).join("\n") + "\n"
}

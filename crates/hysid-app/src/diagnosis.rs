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
mod text;

#[cfg(feature = "tables")]
pub use data::DataDiagnosis;
use hysid_document::plain::{WIDTH, wrapped};
pub use model::DiagnosedModel;
pub use text::text as data_text;

/// The text in lines that fit a terminal.
fn paragraph(text: &str) -> String {
    wrapped(text, WIDTH).join("\n") + "\n"
}

//! Names of quantities with their units, as text shows them.

pub use hysid::diagnosis::cycles::Quantities;
use hysid_document::unit;

/// The name as text shows it: `energy, J`.
pub fn text_label(name: &str) -> String {
    match unit::split(name) {
        (name, Some(unit)) => format!("{name}, {unit}"),
        (name, None) => name,
    }
}

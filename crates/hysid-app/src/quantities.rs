//! Names of quantities with their units, as text shows them.

use hysid::data::unit;
pub use hysid::diagnosis::cycles::Quantities;

/// The name as text shows it: `energy, J`.
pub fn text_label(name: &str) -> String {
    match unit::split(name) {
        (name, Some(unit)) => format!("{name}, {unit}"),
        (name, None) => name.to_string(),
    }
}

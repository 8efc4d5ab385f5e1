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

/// The number at the beginning of a text, the longest that is one, and the unit after it: `2e3 kg`, `2.4m`.
pub fn number_and_unit(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let is_of_number = |c: char| c.is_ascii_digit() || "+-.eE".contains(c);
    let places = (1..=text.len()).rev().filter(|&end| text.is_char_boundary(end));
    let number =
        |end: usize| text[..end].chars().all(is_of_number).then(|| text[..end].parse::<f64>().ok())?;
    places.into_iter().find_map(|end| Some((number(end)?, text[end..].trim())))
}

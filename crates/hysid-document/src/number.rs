//! Numbers and counts as text.

use hysid_core::significant::Significant;

/// A number with this number of significant digits and a minus sign `−`.
pub fn number(value: f64, digits: usize) -> String {
    format!("{:.*}", digits, Significant(value)).replace('-', "−")
}

/// A range in words.
pub fn span((low, high): (f64, f64)) -> String {
    format!("{} to {}", number(low, 4), number(high, 4))
}

/// `3 records`, `1 record`.
pub fn count(n: usize, singular: &str) -> String {
    if n == 1 { format!("1 {singular}") } else { format!("{n} {singular}s") }
}

/// The text with a large first letter.
pub fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

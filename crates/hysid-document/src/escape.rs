//! The one place that escapes text for HTML and SVG.

/// Text escaped for HTML and SVG, in attributes too.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            control if is_not_xml(control) => escaped.push('\u{FFFD}'),
            other => escaped.push(other),
        }
    }
    escaped
}

/// Control characters, and the two that are none, have no place in XML.
pub fn is_not_xml(letter: char) -> bool {
    matches!(letter, '\u{fffe}' | '\u{ffff}') || (letter.is_control() && !"\n\t".contains(letter))
}

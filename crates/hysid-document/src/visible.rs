//! Text of files and arguments made safe for a terminal: no control characters, and a bounded length.

use std::borrow::Cow;

use hysid_core::error::escaped;

/// Largest number of characters of a name or a cell.
const MOST_LETTERS: usize = 60;

/// True for characters that a terminal does not display as such: control characters, and those that change
/// the direction of text or have no width.
pub fn is_hidden(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{ad}' | '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}')
        || matches!(letter, '\u{2060}'..='\u{206f}' | '\u{feff}')
}

/// The text with visible symbols instead of control characters, such as `\n` and `\x1b`: always one line.
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, is_hidden)
}

/// A name or a cell with visible symbols, truncated if it is long.
pub fn clipped(text: &str) -> Cow<'_, str> {
    let Some((end, _)) = text.char_indices().nth(MOST_LETTERS) else { return visible(text) };
    let letters = text[end..].chars().count() + MOST_LETTERS;
    format!("{}… ({letters} characters)", visible(&text[..end])).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_seen_and_not_obeyed() {
        assert_eq!(visible("force (kN), µm"), "force (kN), µm");
        assert_eq!(visible("a\nb\r\t\x1b[2J\x7f\u{9b}31m"), r"a\nb\r\t\x1b[2J\x7f\u{9b}31m");
        assert_eq!(visible("abc\u{202e}def\u{200b}"), r"abc\u{202e}def\u{200b}");
    }

    #[test]
    fn long_names_are_cut_and_say_how_long_they_were() {
        let text = "µ".repeat(61);
        assert_eq!(clipped(&text[..120]), text[..120]);
        assert_eq!(clipped(&text), format!("{}… (61 characters)", "µ".repeat(60)));
    }
}

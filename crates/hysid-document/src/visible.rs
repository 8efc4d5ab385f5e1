//! Text of files and arguments made safe for a terminal: no control characters, and a bounded length.

use std::borrow::Cow;

use hysid_core::error::escaped;
pub use hysid_core::error::is_hidden;

/// Largest number of characters of a name or a cell.
const MOST_LETTERS: usize = 60;

/// Names that are shown of many.
const MOST_NAMES: usize = 6;

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

/// Some names, and how many more there are.
pub fn listed<N: AsRef<str>>(names: &[N]) -> String {
    listed_as(names, clipped)
}

/// As [`listed`], with paths, which are of use only as a whole.
pub fn listed_paths<N: AsRef<str>>(paths: &[N]) -> String {
    listed_as(paths, visible)
}

fn listed_as<N: AsRef<str>>(names: &[N], as_shown: impl Fn(&str) -> Cow<'_, str>) -> String {
    let some: Vec<Cow<str>> = names.iter().take(MOST_NAMES).map(|name| as_shown(name.as_ref())).collect();
    match names.len().saturating_sub(MOST_NAMES) {
        0 => some.join(", "),
        more => format!("{} and {more} more", some.join(", ")),
    }
}

/// Letters of a line that are shown, at its beginning and at its end.
const LONGEST_LINE: (usize, usize) = (1500, 400);

/// A line with names and words: visible, and without its middle where it is very long.
pub fn line(text: &str) -> Cow<'_, str> {
    let (first, last) = LONGEST_LINE;
    let letters = text.chars().count();
    if letters <= first + last {
        return visible(text);
    }
    let place = |letter: usize| text.char_indices().nth(letter).map_or(text.len(), |(place, _)| place);
    let (head, tail) = (&text[..place(first)], &text[place(letters - last)..]);
    format!("{} … ({letters} characters) … {}", visible(head), visible(tail)).into()
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

    #[test]
    fn many_names_are_counted() {
        assert_eq!(listed(&["a", "b\n"]), r"a, b\n");
        let many: Vec<String> = (0..100).map(|k| k.to_string()).collect();
        assert_eq!(listed(&many), "0, 1, 2, 3, 4, 5 and 94 more");
    }
}

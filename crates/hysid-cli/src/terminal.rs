//! Text of files and arguments as a terminal shows it: nothing in it moves the cursor, and nothing is endless.

use std::borrow::Cow;

use anyhow::Result;
use hysid_document::visible::is_hidden;
pub use hysid_document::visible::{clipped, visible};
use serde::Serialize;

/// Letters of a line that are shown, at its beginning and at its end.
const LONGEST_LINE: (usize, usize) = (1500, 400);

/// Names that are shown of many.
const MOST_NAMES: usize = 6;

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

/// JSON that a terminal can show: characters that serde leaves as they are, such as those that turn the direction of
/// the text, are escaped too.
pub fn json(value: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value)?;
    let mut shown = String::with_capacity(text.len() + 1);
    for letter in text.chars() {
        match letter {
            // Outside of strings JSON has no other white space, and inside it is escaped already.
            '\n' => shown.push('\n'),
            // All of them are in the plane where four digits are enough.
            hidden if is_hidden(hidden) => shown.push_str(&format!("\\u{:04x}", hidden as u32)),
            plain => shown.push(plain),
        }
    }
    Ok(shown + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_text_is_cut_and_says_how_long_it_was() {
        let long = format!("begin{}\nend", "x".repeat(5000));
        let cut = line(&long);
        assert!(cut.starts_with("begin") && cut.ends_with(r"x\nend") && cut.chars().count() < 2000, "{cut}");
        assert!(cut.contains("(5009 characters)"), "{cut}");
    }

    #[test]
    fn many_names_are_counted() {
        assert_eq!(listed(&["a", "b\n"]), r"a, b\n");
        let many: Vec<String> = (0..100).map(|k| k.to_string()).collect();
        assert_eq!(listed(&many), "0, 1, 2, 3, 4, 5 and 94 more");
    }

    #[test]
    fn json_reads_back_as_the_same_and_hides_nothing() {
        let value = vec!["a\n\u{9b}2J\u{7f}\u{202e}\"é".to_string()];
        let text = json(&value).unwrap();
        assert!(!text.chars().any(|letter| letter != '\n' && is_hidden(letter)), "{text:?}");
        assert_eq!(serde_json::from_str::<Vec<String>>(&text).unwrap(), value);
    }
}

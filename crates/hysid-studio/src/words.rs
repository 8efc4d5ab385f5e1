//! Words of errors: never empty, and of bounded length, whatever a file contains.

use std::borrow::Cow;

const MOST_LETTERS: usize = 1000;

pub fn said(error: &anyhow::Error) -> String {
    shortened(&format!("{error:#}")).into_owned()
}

/// The text, or its beginning and end if it is long.
pub fn shortened(text: &str) -> Cow<'_, str> {
    let letters = text.chars().count();
    if letters <= MOST_LETTERS {
        return text.into();
    }
    let half = MOST_LETTERS / 2;
    let beginning: String = text.chars().take(half).collect();
    let end: String = text.chars().skip(letters - half).collect();
    format!("{beginning} \u{2026} {end}").into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_words_keep_their_beginning_and_their_end() {
        assert_eq!(shortened("short"), "short");
        let long = format!("begin {} end", "\u{b5}".repeat(100_000));
        let words = shortened(&long);
        assert!(words.starts_with("begin ") && words.ends_with(" end"));
        assert!(words.len() < 2200, "{}", words.len());
    }
}

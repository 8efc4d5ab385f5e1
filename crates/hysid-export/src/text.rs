//! Text from outside, such as names of columns and of files, as it may stand in the comments and pages of every target.
//!
//! It is made harmless once, where the facts of an export are collected: nothing of it ends a line or a comment, continues
//! a line, forms a trigraph or changes the direction of text.

use std::borrow::Cow;
use std::fmt::Write as _;

use hysid_core::data::record::ColumnNames;
use hysid_core::error::is_hidden;

const MOST_LETTERS: usize = 300;

/// Pairs of letters that begin or end comments, or begin trigraphs of C.
const PAIRS: [[char; 2]; 3] = [['*', '/'], ['/', '*'], ['?', '?']];

/// The text in one line without a meaning in any language: hidden characters as `[U+000A]`, the backslash as `＼`, and a
/// blank inside `*/`, `/*` and `??`.
pub(crate) fn harmless(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    let mut before = ' ';
    for (count, letter) in text.chars().enumerate() {
        if count == MOST_LETTERS {
            let _ = write!(shown, "… ({} characters)", text.chars().count());
            break;
        }
        if PAIRS.contains(&[before, letter]) {
            shown.push(' ');
        }
        match letter {
            '\\' => shown.push('＼'),
            hidden if is_hidden(hidden) => drop(write!(shown, "[U+{:04X}]", hidden as u32)),
            plain => shown.push(plain),
        }
        before = letter;
    }
    shown
}

/// Harmless names of columns. An empty one gets a name.
pub(crate) fn harmless_names(names: &ColumnNames) -> ColumnNames {
    let named = |text: &str, otherwise: String| {
        let text = harmless(text);
        if text.trim().is_empty() { otherwise } else { text }
    };
    ColumnNames {
        time: names.time.as_deref().map(|time| named(time, "time".into())),
        inputs: names
            .inputs
            .iter()
            .enumerate()
            .map(|(index, name)| named(name, format!("input {}", index + 1)))
            .collect(),
        rate: names.rate.as_deref().map(|rate| named(rate, "rate".into())),
        output: named(&names.output, "output".into()),
    }
}

/// Harmless text in Markdown, where it is shown as it is.
pub(crate) fn in_markdown(text: &str) -> Cow<'_, str> {
    const MARKS: &str = "`*_[]<>|&~$!#";
    if !text.contains(|letter| MARKS.contains(letter)) {
        return text.into();
    }
    let mut shown = String::new();
    for letter in text.chars() {
        if MARKS.contains(letter) {
            shown.push('\\');
        }
        shown.push(letter);
    }
    shown.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_ends_a_line_or_a_comment_or_begins_one() {
        for (text, expected) in [
            ("force (kN), µm", "force (kN), µm"),
            ("a*\\\n/int f;/*", "a*＼[U+000A]/int f;/ *"),
            ("a*/b**//*/c", "a* /b** // * /c"),
            ("??/", "? ?/"),
            ("???", "? ? ?"),
            (
                "a\r\nb\u{85}c\u{2028}d\u{2029}\u{b}\u{c}",
                "a[U+000D][U+000A]b[U+0085]c[U+2028]d[U+2029][U+000B][U+000C]",
            ),
            ("\u{202e}x\u{2066}\u{fffe}\u{ffff}\u{1}", "[U+202E]x[U+2066][U+FFFE][U+FFFF][U+0001]"),
        ] {
            assert_eq!(harmless(text), expected);
            assert_eq!(harmless(expected), expected, "once is enough");
        }
        assert_eq!(harmless(&"x".repeat(100_000)).len(), MOST_LETTERS + "… (100000 characters)".len());
    }

    #[test]
    fn names_without_a_letter_get_one_and_markdown_shows_letters() {
        let names = ColumnNames::of(None, &["", " "], "");
        let named = harmless_names(&names);
        assert_eq!((named.inputs, named.output), (vec!["input 1".into(), "input 2".into()], "output".into()));
        assert_eq!(in_markdown("<script>|a`b"), "\\<script\\>\\|a\\`b");
    }
}

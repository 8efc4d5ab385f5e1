//! Text of files and arguments as a terminal shows it: nothing in it moves the cursor, and nothing is endless.

use std::borrow::Cow;

pub use hysid_document::json;
pub use hysid_document::visible::{clipped, listed, visible};

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

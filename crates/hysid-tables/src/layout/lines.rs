//! The lines of a text, those in quotation marks joined.

use super::MOST_LINES;

/// Lines that one pair of quotation marks may span.
const LONGEST_QUOTE: usize = 8;

#[derive(Debug, Clone, Copy)]
pub struct TextLine<'t> {
    /// Without its end.
    pub text: &'t str,
    /// Where it begins, in bytes.
    pub start: usize,
    /// Where the next one begins.
    pub end: usize,
    /// Its number in the file, counted from 1.
    pub number: u64,
    /// It begins like a comment.
    pub is_comment: bool,
}

impl<'t> TextLine<'t> {
    /// True for a line without letters.
    pub fn is_blank(&self) -> bool {
        self.text.trim().is_empty()
    }

    /// A comment without its mark, any other line as it is.
    pub fn content(&self) -> &'t str {
        let text = self.text.trim_start();
        match COMMENTS.iter().find(|mark| self.is_comment && text.starts_with(**mark)) {
            Some(_) => text.trim_start_matches(['#', '%', '/', '!']).trim_start(),
            None => self.text,
        }
    }
}

/// Comments that are kept: names and units stand in the first or the last of them.
const MOST_COMMENTS: usize = 10_000;

/// Beginnings of comments.
const COMMENTS: [&str; 4] = ["#", "%", "//", "!"];

/// True for a line that begins like a comment. `%,%,mm` are units.
pub fn is_comment(line: &str) -> bool {
    let text = line.trim_start();
    !["%,", "%;"].iter().any(|units| text.starts_with(units))
        && COMMENTS.iter().any(|mark| text.starts_with(mark))
}

/// The first line of a text without its end, and where the next one begins.
pub fn first_line(text: &str) -> (&str, usize) {
    let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
    let length = text.as_bytes().iter().position(is_end).unwrap_or(text.len());
    let end = if text[length..].starts_with("\r\n") { 2 } else { usize::from(length < text.len()) };
    (&text[..length], length + end)
}

/// The first lines of a text behind those that are skipped. A last line that may go on is left out unless the text is
/// all there is.
pub fn lines(text: &str, is_all: bool, skip: usize) -> Vec<TextLine<'_>> {
    let mut physical = Vec::new();
    // Comments may be of any length, and the table comes behind them.
    let (mut start, mut number, mut others, mut comments) = (0, 1, 0, 0);
    while start < text.len() && others < skip.saturating_add(MOST_LINES + LONGEST_QUOTE) {
        let rest = &text[start..];
        let (line, behind) = first_line(rest);
        if line.len() == rest.len() && !is_all {
            break;
        }
        let (length, next) = (line.len(), start + behind);
        let is_other = !is_comment(line);
        others += usize::from(is_other);
        comments += usize::from(!is_other);
        // What is behind the first comments is not looked at, so that they need no memory.
        if is_other || comments <= skip.saturating_add(MOST_COMMENTS) {
            physical.push((start, start + length, next, number));
        }
        start = next;
        number += 1;
    }
    let mut physical = physical.into_iter().skip(skip).peekable();
    let mut lines = Vec::new();
    while let Some((start, mut end, mut next, number)) = physical.next() {
        if opens_quote(&text[start..end]) {
            let mut ahead = physical.clone().take(LONGEST_QUOTE);
            if let Some(closing) = ahead.position(|(_, end, ..)| is_balanced(&text[start..end])) {
                (end, next) = physical.nth(closing).map_or((end, next), |(_, end, next, _)| (end, next));
            }
        }
        let content = &text[start..end];
        lines.push(TextLine { text: content, start, end: next, number, is_comment: is_comment(content) });
    }
    lines
}

fn is_balanced(text: &str) -> bool {
    text.bytes().filter(|&byte| byte == b'"').count().is_multiple_of(2)
}

/// True for a line with a quotation mark at the beginning of a cell that is not closed.
fn opens_quote(line: &str) -> bool {
    let begins = |place: usize| {
        line[..place].trim_end_matches(' ').chars().next_back().is_none_or(|before| "\t;,|".contains(before))
    };
    !is_balanced(line) && line.rfind('"').is_some_and(begins)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_have_numbers_and_places_whatever_ends_them() {
        let text = "a\r\nb\rc\n\nd";
        let found: Vec<(u64, &str)> =
            lines(text, true, 0).iter().map(|line| (line.number, line.text)).collect();
        assert_eq!(found, [(1, "a"), (2, "b"), (3, "c"), (4, ""), (5, "d")]);
        assert_eq!(lines(text, false, 0).len(), 4);
        assert_eq!(lines(text, true, 2)[0].start, 5);
    }

    #[test]
    fn quotation_marks_join_lines_only_around_a_cell() {
        let count = |text: &str| lines(text, true, 0).len();
        assert_eq!(count("a,\"b\nc\"\n1,2\n"), 2);
        assert_eq!(count("x (\")\n1\n2\n"), 3);
        assert_eq!(count("a,\"b\n1,2\n3,4\n"), 3);
    }
}

//! The beginning of a file: whether it is a table at all, where its header is, and what separates the cells.

use anyhow::{Result, anyhow, bail, ensure};

use super::line_counter::LineCounter;

/// What may separate the cells.
pub const DELIMITERS: [char; 3] = ['\t', ';', ','];

/// Lines from which the delimiter is found.
const LINES: usize = 4;

/// What the first lines of a file tell.
#[derive(Debug, PartialEq, Eq)]
pub struct Beginning {
    /// Where the header begins.
    pub start: usize,
    /// The line before it is a comment.
    pub is_commented: bool,
    /// What separates the cells.
    pub delimiter: u8,
}

impl Beginning {
    /// Looks at the first bytes of a file; `None` if more of them are needed. `is_all` if there are no more.
    ///
    /// # Errors
    /// A file that is no text, or empty.
    pub fn of(file: &str, bytes: &[u8], is_all: bool) -> Result<Option<Self>> {
        check_kind(bytes).map_err(|what| anyhow!("{file}: {what}"))?;
        let mark = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        let (text, is_text) = match std::str::from_utf8(&bytes[mark..]) {
            Ok(text) => (text, true),
            Err(error) => {
                let valid = std::str::from_utf8(&bytes[mark..mark + error.valid_up_to()])?;
                // A character may be cut at the end of what is read so far.
                (valid, error.error_len().is_none() && !is_all)
            }
        };
        let (start, is_commented) = start_of_header(text);
        let content = &text[start..];
        if complete_lines(content) >= LINES || is_all && is_text {
            ensure!(!content.is_empty(), "{file}: is empty (expected a header line and rows of numbers)");
            let delimiter = delimiter(content);
            return Ok(Some(Self { start: mark + start, is_commented, delimiter }));
        }
        if is_text {
            return Ok(None);
        }
        let mut lines = LineCounter::new();
        lines.pass(text.as_bytes());
        bail!("{}", not_text(file, lines.line()));
    }
}

/// What is said of bytes that are no text.
pub fn not_text(file: &str, line: u64) -> String {
    format!("{file}, line {line}: is not UTF-8 text (save the file as UTF-8)")
}

/// True for the content of a file that begins like a JSON object, as model files do.
pub fn is_json(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"{")
}

/// Refuses what is clearly no text table.
fn check_kind(bytes: &[u8]) -> Result<(), &'static str> {
    if bytes.starts_with(b"\x1f\x8b") {
        Err("is compressed with gzip (gunzip it first)")
    } else if bytes.starts_with(b"PK\x03\x04") {
        Err("is a spreadsheet or zip archive (export the table as CSV)")
    } else if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        Err("is UTF-16 text (save the file as UTF-8)")
    } else if is_json(bytes) {
        Err("is JSON, not CSV (a model file in the place of data?)")
    } else if bytes.contains(&0) {
        Err(BINARY)
    } else {
        Ok(())
    }
}

/// What is said of a file with a byte that no text has.
pub const BINARY: &str = "is a binary file, not CSV";

fn is_line_end(letter: char) -> bool {
    letter == '\n' || letter == '\r'
}

/// Lines that are not blank and that end.
fn complete_lines(text: &str) -> usize {
    let complete = text.split_inclusive(is_line_end).filter(|line| line.ends_with(is_line_end));
    complete.filter(|line| !line.trim().is_empty()).take(LINES).count()
}

/// Where the header begins, after blank and comment lines; and whether the line before is a comment.
fn start_of_header(text: &str) -> (usize, bool) {
    let (mut start, mut commented) = (0, false);
    for line in text.split_inclusive(is_line_end) {
        let content = line.trim();
        if !content.is_empty() && !content.starts_with('#') {
            return (start, commented);
        }
        commented = content.starts_with('#') || commented && content.is_empty();
        start += line.len();
    }
    (start, commented)
}

/// The delimiter that divides the first lines alike; failing that, the commonest in the header.
fn delimiter(text: &str) -> u8 {
    let first: Vec<&str> =
        text.split(is_line_end).filter(|line| !line.trim().is_empty()).take(LINES).collect();
    let count = |line: &str, delimiter: char| {
        let mut quoted = false;
        line.chars()
            .filter(|&c| {
                quoted ^= c == '"';
                c == delimiter && !quoted
            })
            .count()
    };
    let in_header = |delimiter: char| count(first[0], delimiter);
    let alike = |&delimiter: &char| {
        in_header(delimiter) > 0 && first.iter().all(|line| count(line, delimiter) == in_header(delimiter))
    };
    let commonest = || DELIMITERS.into_iter().max_by_key(|&delimiter| in_header(delimiter));
    DELIMITERS.into_iter().find(alike).or_else(commonest).map_or(b',', |delimiter| delimiter as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delimiters_are_found() {
        let of = |text: &str| Beginning::of("f", text.as_bytes(), true).unwrap().unwrap().delimiter;
        assert_eq!(of("t;x;y\n0;1,5;2,5\n"), b';');
        assert_eq!(of("Force, kN;Travel, mm\n1,5;2,5\n"), b';');
        assert_eq!(of("t\tx, mm\n0\t1,5\n"), b'\t');
        assert_eq!(of("t,\"x;1\"\n0,1\n"), b',');
    }

    #[test]
    fn a_beginning_is_not_judged_before_enough_of_it_is_there() {
        let text = "# a remark\n\nt;µ\n0;1,5\n1;2\n2;3\n3;4\n".as_bytes();
        let whole = Beginning::of("f", text, true).unwrap();
        assert_eq!(whole, Some(Beginning { start: 12, is_commented: true, delimiter: b';' }));
        for end in 0..text.len() {
            // Also where the cut goes through a letter.
            let found = Beginning::of("f", &text[..end], false).unwrap();
            assert!(found.is_none() || found == whole, "{end}: {found:?}");
        }
        let error = Beginning::of("f", b"a;b\n\xb5", false).unwrap_err().to_string();
        assert_eq!(error, "f, line 2: is not UTF-8 text (save the file as UTF-8)");
    }
}

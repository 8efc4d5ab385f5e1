//! Kinds of files that Hysid writes, and how it recognizes its own.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Name and version of the program, as its pages and drawings carry them.
pub const GENERATOR: &str = concat!("Hysid ", env!("CARGO_PKG_VERSION"));

/// Begins every page. The version follows.
pub const PAGE_MARK: &str = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
                             <meta name=\"generator\" content=\"Hysid ";

/// The line of a page with its checksum, by which a page that somebody edited is known.
const PAGE_SUM: &str = "<meta name=\"checksum\" content=\"";

/// How drawings begin, as SVG, PDF and PNG, and the mark that each carries soon after.
const DRAWINGS: [(&[u8], &str); 3] = [
    (b"<svg class=\"plot\" role=\"img\" aria-label=\"", " data-generator=\"Hysid "),
    (b"%PDF-", "/Creator (Hysid "),
    (b"\x89PNG", "Software\0Hysid "),
];

/// Names of columns in titles and labels may be long.
const LONGEST_BEGINNING: u64 = 1 << 16;

/// A kind of file, by which Hysid recognizes its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Kind {
    /// A model file. One that is replaced is kept as `NAME.bak`.
    Model,
    Checkpoint,
    Page,
    /// A drawing, as SVG, PDF or PNG. One that is replaced is kept as `NAME.bak`, since it may have been edited.
    Drawing,
    /// A table, or another text, that begins with this line. One that is replaced is kept as `NAME.bak`: a table of the
    /// user's may have the same header.
    Beginning(Vec<u8>),
    Project,
    /// A text that begins with the first of these and contains the second soon after.
    Marked(&'static str, String),
    /// A file with exactly this content.
    Content(Vec<u8>),
}

impl Kind {
    pub(crate) fn words(&self) -> &'static str {
        match self {
            Self::Model => "model of Hysid",
            Self::Checkpoint => "checkpoint of Hysid",
            Self::Page => "page of Hysid",
            Self::Drawing => "drawing of Hysid",
            Self::Project => "project of Hysid",
            Self::Beginning(_) | Self::Marked(..) => "result of this command",
            Self::Content(_) => "copy of what this command writes",
        }
    }

    pub(crate) fn is_kept(&self) -> bool {
        // Pages carry a checksum; checkpoints and projects are the program's own state.
        !matches!(self, Self::Page | Self::Checkpoint | Self::Project | Self::Content(_))
    }

    /// True for a file that Hysid may replace: one of its own, or one without content.
    pub(crate) fn recognises(&self, path: &Path) -> io::Result<bool> {
        let mut file = File::open(path)?;
        let length = file.metadata()?.len();
        if length == 0 {
            return Ok(true);
        }
        if let Self::Content(content) = self {
            return Ok(length == content.len() as u64 && has_content(&mut file, content)?);
        }
        let mut beginning = Vec::new();
        file.take(LONGEST_BEGINNING).read_to_end(&mut beginning)?;
        Ok(self.is_begun_by(&beginning))
    }

    fn is_begun_by(&self, text: &[u8]) -> bool {
        match self {
            Self::Model => has_format(text, "hysid-model"),
            Self::Project => has_format(text, "hysid-project"),
            Self::Checkpoint => text.starts_with(b"hysid checkpoint "),
            Self::Page => text.starts_with(PAGE_MARK.as_bytes()),
            Self::Drawing => {
                DRAWINGS.iter().any(|(beginning, mark)| text.starts_with(beginning) && contains(text, mark))
            }
            Self::Beginning(beginning) => text.starts_with(beginning),
            Self::Marked(beginning, mark) => text.starts_with(beginning.as_bytes()) && contains(text, mark),
            Self::Content(content) => text == content,
        }
    }
}

/// A page with a line behind its mark that has the checksum of the rest.
pub fn with_page_sum(page: &str) -> String {
    let place = line_behind_mark(page).unwrap_or(0);
    let sum = crc32fast::hash(page.as_bytes());
    format!("{}{PAGE_SUM}{sum:08x}\">\n{}", &page[..place], &page[place..])
}

/// The place behind the line with the mark of a page.
fn line_behind_mark(page: &str) -> Option<usize> {
    let rest = page.strip_prefix(PAGE_MARK)?;
    Some(PAGE_MARK.len() + rest.find('\n')? + 1)
}

/// True for a page that nobody changed since Hysid wrote it.
pub fn is_page_as_written(page: &[u8]) -> bool {
    let Ok(page) = std::str::from_utf8(page) else { return false };
    let Some((before, rest)) = line_behind_mark(page).map(|place| page.split_at(place)) else { return false };
    let Some((sum, after)) = rest.strip_prefix(PAGE_SUM).and_then(|rest| rest.split_once("\">\n")) else {
        return false;
    };
    sum == format!("{:08x}", crc32fast::hash([before, after].concat().as_bytes()))
}

/// A JSON object whose first field names the format, however it is laid out.
fn has_format(text: &[u8], format: &str) -> bool {
    let format = format!("\"{format}\"");
    let tokens = [&b"{"[..], b"\"format\"", b":", format.as_bytes()];
    let mut rest = text;
    tokens.into_iter().all(|token| {
        rest = rest.trim_ascii_start();
        rest.strip_prefix(token).map(|after| rest = after).is_some()
    })
}

fn contains(text: &[u8], mark: &str) -> bool {
    text.windows(mark.len()).any(|window| window == mark.as_bytes())
}

/// Compares without holding both in memory.
fn has_content(file: &mut impl Read, content: &[u8]) -> io::Result<bool> {
    let mut block = vec![0; 1 << 16];
    let mut rest = content;
    loop {
        let read = file.read(&mut block)?;
        match rest.split_at_checked(read) {
            Some((expected, after)) if expected == &block[..read] => rest = after,
            _ => return Ok(false),
        }
        if read == 0 {
            return Ok(rest.is_empty());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_known_by_their_first_field_however_they_are_laid_out() {
        for text in ["{\n  \"format\": \"hysid-model\",", " {\"format\":\"hysid-model\"}"] {
            assert!(Kind::Model.is_begun_by(text.as_bytes()), "{text}");
        }
        for text in
            ["{}", "{\"a\": \"hysid-model\"}", "{\"format\": \"other\"}", "\"format\": \"hysid-model\""]
        {
            assert!(!Kind::Model.is_begun_by(text.as_bytes()), "{text}");
        }
    }

    #[test]
    fn a_page_that_quotes_the_mark_is_not_ours() {
        let ours = format!("{PAGE_MARK}0.1.0\">");
        assert!(Kind::Page.is_begun_by(ours.as_bytes()));
        assert!(!Kind::Page.is_begun_by(format!("<html><pre>{ours}").as_bytes()));
    }

    #[test]
    fn an_edited_page_is_known() {
        let page = with_page_sum(&format!("{PAGE_MARK}0.1.0\">\n<title>t</title>\n</head>\n<p>text</p>\n"));
        assert!(Kind::Page.is_begun_by(page.as_bytes()) && is_page_as_written(page.as_bytes()), "{page}");
        assert!(page.contains("0.1.0\">\n<meta name=\"checksum\" content=\""), "{page}");
        assert!(!is_page_as_written(page.replace("text", "my text").as_bytes()));
        assert!(!is_page_as_written(
            page.replace("<meta name=\"checksum\"", "<meta name=\"sum\"").as_bytes()
        ));
    }

    #[test]
    fn content_is_compared_to_the_last_byte() {
        let content = vec![7; 200_000];
        let same = |other: &[u8]| has_content(&mut &other[..], &content).unwrap();
        assert!(same(&content));
        assert!(!same(&content[1..]));
        let mut changed = content.clone();
        changed[199_999] = 8;
        assert!(!same(&changed));
    }
}

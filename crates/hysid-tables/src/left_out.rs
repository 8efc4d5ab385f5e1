//! Lines of a file that are no rows of its table, in words.

use hysid_core::words::{Hint, Words};
use hysid_document::visible::{clipped, listed};

use crate::head::counted;

/// Lines that are no rows.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// Comments among the rows.
    pub comments: u64,
    /// Remarks behind rows, where no column has a name for them, and the line of the first.
    pub remarks: u64,
    pub first_remark: Option<u64>,
    /// Lines of text among the rows, and the first of them.
    pub text: u64,
    pub first_text: Option<u64>,
    /// Rows of empty cells, and the first of them.
    pub empty: u64,
    pub first_empty: Option<u64>,
    /// First line behind the table, and how many there are.
    pub end: Option<(u64, u64)>,
    /// Why those lines may be rows: they have another delimiter, or stand behind blank lines.
    pub end_doubt: Option<Words>,
    /// Other tables of the file.
    pub tables: Vec<String>,
    /// One of them may be meant.
    pub is_doubtful: bool,
}

impl LeftOut {
    /// Number and kind of the lines left out, in words; `None` if there were none.
    pub fn described(&self) -> Option<String> {
        let comments = (self.comments > 0).then(|| counted(self.comments, "comment line", "among the rows"));
        let from = |line: Option<u64>, count, one, place| {
            line.map(|line| format!("{} (from line {line})", counted(count, one, place)))
        };
        let remarks = from(self.first_remark, self.remarks, "remark", "behind the rows");
        let text = from(self.first_text, self.text, "text line", "among the rows");
        let empty = from(self.first_empty, self.empty, "empty row", "among the rows");
        let (line, lines) = self.end.unzip();
        let end = from(line, lines.unwrap_or(0), "line", "after the table");
        let tables = (!self.tables.is_empty()).then(|| listed(&self.tables));
        let all: Vec<String> =
            comments.into_iter().chain(remarks).chain(text).chain(empty).chain(end).chain(tables).collect();
        (!all.is_empty()).then(|| all.join(", "))
    }

    /// A warning if data that may be meant are left out.
    pub fn warning(&self, file: &str) -> Option<Words> {
        let file = clipped(file);
        if let (Some(doubt), Some((line, lines))) = (&self.end_doubt, self.end) {
            let are = if lines == 1 { "1 line is".into() } else { format!("{lines} lines are") };
            return Some(Words::from(format!("{file}: {are} left out (from line {line}): ")) + doubt.clone());
        }
        let others = listed(&self.tables);
        let words = format!("{file}: other tables of the file are left out: {others}");
        let advice = || Words::from("choose one with ") + Hint::Option("sheet");
        self.is_doubtful.then(|| Words::from(words).advised(advice()))
    }
}

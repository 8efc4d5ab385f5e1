//! Separators of thousands that look like decimal signs: 1.234 beside 987.

use super::{CellReader, DecimalSign};
use hysid_core::words::{Hint, Words};
use hysid_document::visible::clipped;

/// Numbers of each form that make a column one of thousands.
const FEWEST: usize = 3;

/// Looks through the cells of a column. Where every number with a point (or comma) has one to three digits before it and
/// exactly three behind it, and all others are whole and below 1000, of which some reach 100, the point separates
/// thousands: decimals would have ended in a zero somewhere, or the whole numbers in `.000`.
#[derive(Debug, Clone, Default)]
pub struct ThousandsWatch {
    /// A cell was written otherwise.
    is_over: bool,
    whole: usize,
    reaches_hundreds: bool,
    separated: usize,
    /// The first cell with a separator, and its line.
    first: Option<(String, u64)>,
}

impl ThousandsWatch {
    pub fn take(&mut self, cell: &str, line: u64) {
        if self.is_over {
            return;
        }
        let digits = cell.trim().trim_start_matches(['+', '-']);
        if digits.is_empty() {
            return;
        }
        match digits.split_once(['.', ',']) {
            None if is_whole(digits) && digits.len() <= 3 => {
                self.whole += 1;
                self.reaches_hundreds |= digits.len() == 3 && !digits.starts_with('0');
            }
            Some((before, behind))
                if is_whole(before)
                    && before.len() <= 3
                    && !before.starts_with('0')
                    && is_whole(behind)
                    && behind.len() == 3 =>
            {
                self.separated += 1;
                self.first.get_or_insert_with(|| (cell.trim().to_string(), line));
            }
            _ => self.is_over = true,
        }
    }

    /// Separator of thousands in the column; `None` if there is none, or if the sign may be a decimal one.
    pub fn separator(&self) -> Option<DecimalSign> {
        let (cell, _) = self.first.as_ref().filter(|_| !self.is_over)?;
        let sign = if cell.contains('.') { DecimalSign::Point } else { DecimalSign::Comma };
        (self.whole >= FEWEST && self.reaches_hundreds && self.separated >= FEWEST).then_some(sign)
    }

    /// Problem of the column, with the first line that shows it; `None` if there is none: if its thousands are not
    /// separated by what `cells` took for the decimal sign, or the user chose that sign.
    pub fn problem(&self, cells: &CellReader) -> Option<(u64, Words)> {
        let (cell, line) = self.first.as_ref()?;
        let separator = self.separator()?;
        (cells.sign() == Some(separator) && !cells.sign_is_chosen()).then(|| {
            let cell = clipped(cell);
            let problem = format!(
                "\"{cell}\" seems to have a thousands separator: all numbers of this column are whole and \
                 below 1000, or have exactly three digits after it"
            );
            let sign = |name: &str| Hint::Value("decimal", name.into());
            let choice = Words::from("choose with ") + sign("point") + " or " + sign("comma");
            (*line, Words::from(problem).advised(choice))
        })
    }
}

fn is_whole(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::super::NumberFormat;
    use super::*;
    use hysid_document::Face;

    fn problem(cells: &[&str]) -> Option<(u64, Words)> {
        let mut watch = ThousandsWatch::default();
        cells.iter().zip(2..).for_each(|(cell, line)| watch.take(cell, line));
        let mut reader = CellReader::new(&NumberFormat::default());
        cells.iter().zip(2..).for_each(|(cell, line)| drop(reader.number(cell, line)));
        watch.problem(&reader)
    }

    #[test]
    fn thousands_are_told_from_decimals() {
        let (line, words) = problem(&["850", "-920", "", "990", "1.012", "1.234", "-1.100"]).unwrap();
        assert_eq!(line, 6);
        let words = Face::Terminal.told(&words);
        assert!(words.starts_with("\"1.012\" seems to have a thousands separator"), "{words}");
        assert!(problem(&["850", "920", "990", "1,012", "12,234", "1,100"]).is_some());
        for decimals in [
            // With its zeros, without its zeros, small numbers, too few to tell.
            ["850.000", "920.000", "990.000", "1.012", "1.234", "1.1"],
            ["850", "920", "990", "1.012", "1.23", "1.104"],
            ["0", "1", "2", "1.125", "2.375", "1.875"],
            ["850", "920", "990", "0.012", "1.234", "1.104"],
            ["850", "920", "990", "1.012", "1.234", ""],
        ] {
            assert_eq!(problem(&decimals), None, "{decimals:?}");
        }
    }
}

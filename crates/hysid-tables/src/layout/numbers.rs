//! How the numbers of a table are written: the decimal sign, and what separates thousands.

use super::cells::{CellKind, bare, split};
use super::lines::TextLine;
use super::run::LineRun;
use crate::number::{self, DecimalSign, NumberFormat, ThousandsWatch};
use crate::reading::Reading;

/// Number format that the user chose.
pub fn chosen(reading: &Reading) -> NumberFormat {
    NumberFormat {
        decimal: reading.decimal,
        is_chosen: reading.decimal.is_some(),
        decimal_line: None,
        missing: reading.missing.clone(),
    }
}

pub fn format(lines: &[TextLine<'_>], run: &LineRun, reading: &Reading) -> NumberFormat {
    let mut format = chosen(reading);
    if format.is_chosen {
        return format;
    }
    let mut evidence = DecimalEvidence::default();
    let mut watches = vec![ThousandsWatch::default(); run.width];
    for line in &lines[run.lines.clone()] {
        for (cell, watch) in split(line.text, run.delimiter).iter().zip(&mut watches) {
            if let CellKind::Number(_) = cell.kind() {
                let (digits, _) = bare(&cell.text);
                watch.take(digits, line.number);
                evidence.take(digits, line.number);
            }
        }
    }
    let separator = watches.iter().find_map(ThousandsWatch::separator);
    (format.decimal, format.decimal_line) = match (evidence.point, evidence.comma, separator) {
        (Some(line), None, _) => (Some(DecimalSign::Point), Some(line)),
        (None, Some(line), _) => (Some(DecimalSign::Comma), Some(line)),
        // One of them is wrong; that is said where it is read.
        (Some(point), Some(comma), _) if point <= comma => (Some(DecimalSign::Point), Some(point)),
        (Some(_), Some(comma), _) => (Some(DecimalSign::Comma), Some(comma)),
        (None, None, Some(DecimalSign::Point)) => (Some(DecimalSign::Comma), None),
        (None, None, Some(DecimalSign::Comma)) => (Some(DecimalSign::Point), None),
        (None, None, None) => evidence.unclear.map_or((None, None), |(sign, line)| (Some(sign), Some(line))),
    };
    format
}

/// Lines of the first numbers that show a decimal sign.
#[derive(Default)]
struct DecimalEvidence {
    point: Option<u64>,
    comma: Option<u64>,
    /// The sign of a number that may be one with thousands.
    unclear: Option<(DecimalSign, u64)>,
}

impl DecimalEvidence {
    fn take(&mut self, digits: &str, line: u64) {
        let Ok((_, Some(sign))) = number::parsed(digits, None) else { return };
        let may_be_thousands = number::parsed(digits, Some(sign.opposite())).is_ok();
        match sign {
            _ if may_be_thousands => {
                self.unclear.get_or_insert((sign, line));
            }
            DecimalSign::Point => {
                self.point.get_or_insert(line);
            }
            DecimalSign::Comma => {
                self.comma.get_or_insert(line);
            }
        }
    }
}

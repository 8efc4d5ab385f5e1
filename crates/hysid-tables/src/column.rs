//! The numbers of a column, row by row.

use hysid_core::words::Words;
use hysid_document::visible::clipped;

use crate::head::Head;
use crate::number::{CellReader, ThousandsWatch, is_missing};
use crate::problem::CellProblem;
use crate::stamp::{Stamp, StampReader};

/// Reads the cells of a column: numbers, numbers with their unit, dates or clocks.
#[derive(Debug, Clone)]
pub struct ColumnReader {
    place: usize,
    /// Of a column of dates or clocks.
    stamps: Option<StampReader>,
    thousands: ThousandsWatch,
}

impl ColumnReader {
    pub fn new(head: &Head, place: usize) -> Self {
        let stamps = head.has_stamps(place).then(StampReader::default);
        Self { place, stamps, thousands: ThousandsWatch::default() }
    }

    /// True for a column of dates or clocks.
    pub fn has_stamps(&self) -> bool {
        self.stamps.is_some()
    }

    pub fn place(&self) -> usize {
        self.place
    }

    /// The number in a cell, NaN for a missing value; dates and clocks are seconds since the first one. `cells` reads all
    /// columns of the file.
    pub fn number(
        &mut self,
        head: &Head,
        cells: &mut CellReader,
        cell: &str,
        line: u64,
    ) -> Result<f64, CellProblem> {
        if let Some(stamps) = &mut self.stamps {
            return match Stamp::of(cell) {
                Some(stamp) => Ok(stamps.seconds(stamp)),
                None if is_missing(cell) => Ok(f64::NAN),
                None => {
                    let words = format!("\"{}\" is no date and no clock with seconds", clipped(cell));
                    Err(CellProblem::Other(words.into()))
                }
            };
        }
        let digits = head.bare(self.place, cell)?;
        self.thousands.take(digits, line);
        cells.number(digits, line)
    }

    /// Problem of the column as a whole, with the first line that shows it.
    pub fn problem(&self, cells: &CellReader) -> Option<(u64, Words)> {
        self.thousands.problem(cells)
    }
}

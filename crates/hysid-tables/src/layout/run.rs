//! The rows of numbers of a text, for one delimiter.

use std::ops::Range;

use super::cells::{CellKind, LineCell, split};
use super::lines::TextLine;
use crate::reading::Delimiter;

/// Least share of the filled cells, in percent, that are numbers in a line of a table.
const LEAST_NUMBERS: usize = 40;

/// Least share of the filled cells, in percent, that decide the kind of a column.
const MOST_CELLS: usize = 80;

/// Lines of numbers one after another with equally many cells; blank lines and comments may stand between.
#[derive(Debug, Clone, PartialEq)]
pub struct LineRun {
    /// Separator of the cells.
    pub delimiter: Delimiter,
    /// Cells of a row.
    pub width: usize,
    /// From the first to the last of its lines.
    pub lines: Range<usize>,
    pub columns: Vec<ColumnCells>,
    /// The first column counts the rows.
    pub counts: bool,
    /// The last cell of every row is empty.
    ends_empty: bool,
}

/// Counts of the kinds of cells in a column.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ColumnCells {
    /// Cells that are numbers, time stamps, and text.
    numbers: usize,
    stamps: usize,
    text: usize,
    /// The first unit behind a number, and how many numbers have it.
    unit: Option<(String, usize)>,
    /// All cells are in quotation marks.
    pub is_quoted: bool,
}

impl ColumnCells {
    fn filled(&self) -> usize {
        self.numbers + self.stamps + self.text
    }

    /// True for a column of numbers or of time stamps.
    pub fn is_numeric(&self) -> bool {
        100 * (self.numbers + self.stamps) >= MOST_CELLS * self.filled()
    }

    /// The unit behind the numbers.
    pub fn unit(&self) -> Option<&str> {
        let (unit, count) = self.unit.as_ref()?;
        (100 * count >= MOST_CELLS * self.filled()).then_some(unit)
    }
}

impl LineRun {
    /// All runs, from the first line to the last.
    pub fn all(lines: &[TextLine<'_>], delimiter: Delimiter) -> Vec<Self> {
        let rows: Vec<Vec<LineCell<'_>>> = lines.iter().map(|line| split(line.text, delimiter)).collect();
        let kinds: Vec<Vec<CellKind>> =
            rows.iter().map(|cells| cells.iter().map(LineCell::kind).collect()).collect();
        let is_row = |place: usize| !lines[place].is_blank() && is_data(&kinds[place]);
        let mut runs = Vec::new();
        let mut place = 0;
        while place < lines.len() {
            let next = (place + 1..lines.len()).find(|&next| !lines[next].is_blank());
            let is_names = next.is_some_and(|next| are_labels(&kinds[place], &kinds[next]));
            if !is_row(place) || is_names {
                place += 1;
                continue;
            }
            let mut widths = Widths::of(&kinds[place]);
            let (start, mut end) = (place, place + 1);
            for (next, line) in lines.iter().enumerate().skip(place + 1) {
                if is_row(next) && widths.take(&kinds[next]) {
                    end = next + 1;
                } else if !line.is_blank() && !line.is_comment {
                    break;
                }
            }
            let width = widths.width();
            let members = (start..end).filter(|&place| is_row(place));
            let columns = columns(members.clone().map(|place| (&kinds[place], &rows[place])), width);
            let counts = counts(members.map(|place| &rows[place]));
            let ends_empty = widths.ends_empty();
            let run = Self { delimiter, width, lines: start..end, columns, counts, ends_empty };
            if delimiter != Delimiter::Blanks || run.is_of_blanks(lines) {
                runs.push(run);
            }
            place = end;
        }
        runs
    }

    /// Without the last column, if all its cells are empty.
    pub fn trimmed(&self) -> Option<Self> {
        if !self.ends_empty || self.width < 2 {
            return None;
        }
        let mut run = self.clone();
        run.width -= 1;
        run.columns.pop();
        Some(run)
    }

    /// With the rows directly above in which too many cells are no numbers: their faults are reported where they
    /// are read.
    pub fn with_rows_above(mut self, lines: &[TextLine<'_>]) -> Self {
        for place in (1..self.lines.start).rev() {
            let line = &lines[place];
            if line.is_blank() || line.is_comment {
                continue;
            }
            let cells = split(line.text, self.delimiter);
            let has_number = |(cell, column): (&LineCell<'_>, &ColumnCells)| {
                column.is_numeric() && matches!(cell.kind(), CellKind::Number(None) | CellKind::Stamp)
            };
            let mut both = cells.iter().zip(&self.columns);
            let is_row = match cells.len().checked_sub(self.width) {
                Some(0) => both.any(has_number),
                // A row with a remark.
                Some(1) => self.width > 1 && self.is_pure() && both.all(has_number),
                _ => false,
            };
            if !is_row {
                break;
            }
            self.lines.start = place;
        }
        self
    }

    /// True for several columns of nothing but numbers.
    pub fn is_pure(&self) -> bool {
        self.width > 1 && self.columns.iter().all(|column| column.text == 0)
    }

    /// Rows, as far as the first column has them.
    pub fn rows(&self) -> usize {
        self.columns.iter().map(ColumnCells::filled).max().unwrap_or(0)
    }

    /// The more numbers, and the less text among them, the better.
    pub fn score(&self) -> f64 {
        let numbers: usize = self.columns.iter().map(|column| column.numbers + column.stamps).sum();
        let filled: usize = self.columns.iter().map(ColumnCells::filled).sum();
        let share = numbers as f64 / filled.max(1) as f64;
        numbers as f64 * share * share
    }

    /// Units behind the numbers of each column.
    pub fn units(&self) -> Vec<Option<String>> {
        self.columns.iter().map(|column| column.unit().map(String::from)).collect()
    }

    /// Columns of time stamps.
    pub fn stamps(&self) -> Vec<bool> {
        self.columns.iter().map(|column| 100 * column.stamps >= MOST_CELLS * column.filled().max(1)).collect()
    }

    /// Blanks separate only where no tab does: a date and a clock are one cell of such a table.
    fn is_of_blanks(&self, lines: &[TextLine<'_>]) -> bool {
        let lines = &lines[self.lines.clone()];
        let with_tabs = lines.iter().filter(|line| line.text.trim().contains('\t')).count();
        2 * with_tabs < lines.len() || lines.iter().any(|line| !line.is_blank() && !line.text.contains('\t'))
    }
}

/// True for cells of which enough are numbers.
pub fn is_row(cells: &[&str]) -> bool {
    is_data(&kinds(cells))
}

pub fn has_number(cells: &[&str]) -> bool {
    kinds(cells).iter().any(is_number)
}

fn kinds(cells: &[&str]) -> Vec<CellKind> {
    cells.iter().map(|&cell| LineCell { text: cell.into(), is_quoted: false }.kind()).collect()
}

fn is_number(kind: &CellKind) -> bool {
    matches!(kind, CellKind::Number(_) | CellKind::Stamp)
}

/// True for a line of names such as `5 K`, `50 K` over a row of numbers without units: one of them is a text.
fn are_labels(line: &[CellKind], row: &[CellKind]) -> bool {
    let is_label = |(above, below): (&CellKind, &CellKind)| {
        *below == CellKind::Number(None) && !matches!(above, CellKind::Number(None) | CellKind::Stamp)
    };
    line.len() == row.len() && line.contains(&CellKind::Text) && line.iter().zip(row).all(is_label)
}

fn is_data(kinds: &[CellKind]) -> bool {
    let numbers = kinds.iter().filter(|kind| is_number(kind)).count();
    let text = kinds.iter().filter(|kind| **kind == CellKind::Text).count();
    numbers > 0 && 100 * numbers >= LEAST_NUMBERS * (numbers + text)
}

/// Cells of the lines of a run: as they are, and without an empty last one, as of a delimiter at the end of lines.
struct Widths {
    whole: Option<usize>,
    trimmed: Option<usize>,
}

impl Widths {
    fn of(kinds: &[CellKind]) -> Self {
        Self { whole: Some(kinds.len()), trimmed: Some(trimmed(kinds)) }
    }

    /// Takes another line; false if it does not fit.
    fn take(&mut self, kinds: &[CellKind]) -> bool {
        let whole = self.whole.filter(|&width| width == kinds.len());
        let trimmed = self.trimmed.filter(|&width| width == trimmed(kinds));
        let fits = whole.or(trimmed).is_some();
        if fits {
            (self.whole, self.trimmed) = (whole, trimmed);
        }
        fits
    }

    fn width(&self) -> usize {
        self.whole.or(self.trimmed).unwrap_or(1)
    }

    fn ends_empty(&self) -> bool {
        self.whole.zip(self.trimmed).is_some_and(|(whole, trimmed)| trimmed < whole)
    }
}

fn trimmed(kinds: &[CellKind]) -> usize {
    kinds.len() - usize::from(kinds.len() > 1 && kinds.last() == Some(&CellKind::Missing))
}

fn columns<'r>(
    rows: impl Iterator<Item = (&'r Vec<CellKind>, &'r Vec<LineCell<'r>>)>,
    width: usize,
) -> Vec<ColumnCells> {
    let mut columns = vec![ColumnCells { is_quoted: true, ..ColumnCells::default() }; width];
    for (kinds, cells) in rows {
        for ((column, kind), cell) in columns.iter_mut().zip(kinds).zip(cells) {
            column.is_quoted &= cell.is_quoted || *kind == CellKind::Missing;
            match kind {
                CellKind::Missing => {}
                CellKind::Text => column.text += 1,
                CellKind::Stamp => column.stamps += 1,
                CellKind::Number(unit) => {
                    column.numbers += 1;
                    if let Some(unit) = unit {
                        let (first, count) = column.unit.get_or_insert_with(|| (unit.clone(), 0));
                        *count += usize::from(first == unit);
                    }
                }
            }
        }
    }
    columns
}

/// True if the first cells are whole numbers, each one more than that before.
fn counts<'r>(rows: impl Iterator<Item = &'r Vec<LineCell<'r>>>) -> bool {
    let first: Option<Vec<i64>> = rows.map(|cells| cells.first()?.text.trim().parse().ok()).collect();
    first.is_some_and(|first| {
        first.len() > 1 && first.windows(2).all(|pair| pair[0].checked_add(1) == Some(pair[1]))
    })
}

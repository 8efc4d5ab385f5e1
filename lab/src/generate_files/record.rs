//! The record that every file has: a spring and a play under a displacement of growing amplitude.

use hysid_core::elementary::sin;

/// Rows.
pub const ROWS: usize = 48;

/// Half width of the play in mm.
const PLAY: f64 = 0.8;

/// A row: time in tenths of a second, displacement in thousandths of a mm, force in thousandths of a kN. Whole numbers,
/// so that each file has the very same values.
#[derive(Clone, Copy)]
pub struct Row {
    pub t: i64,
    pub x: i64,
    pub y: i64,
}

/// The record.
pub fn rows() -> Vec<Row> {
    let mut play = 0.0_f64;
    let row = |k: usize| {
        let phase = std::f64::consts::TAU * k as f64 / 16.0;
        let x = (1000.0 * (1.0 + 0.05 * k as f64) * sin(phase)).round() / 1000.0;
        play = play.max(x - PLAY).min(x + PLAY);
        Row {
            t: k as i64,
            x: (1000.0 * x).round() as i64,
            y: (1000.0 * (0.5 * x + 2.0 * play)).round() as i64,
        }
    };
    (0..ROWS).map(row).collect()
}

/// How the numbers of a file are written.
#[derive(Clone, Copy)]
pub struct Style {
    pub decimal: char,
}

pub const POINT: Style = Style { decimal: '.' };
pub const COMMA: Style = Style { decimal: ',' };

impl Style {
    /// A number in units of `10^-digits`.
    pub fn number(self, value: i64, digits: u32) -> String {
        let unit = 10_i64.pow(digits);
        let sign = if value < 0 { "-" } else { "" };
        let (whole, part) = (value.abs() / unit, value.abs() % unit);
        format!("{sign}{whole}{}{part:0width$}", self.decimal, width = digits as usize)
    }

    pub fn time(self, row: Row) -> String {
        self.number(row.t, 1)
    }

    pub fn x(self, row: Row) -> String {
        self.number(row.x, 3)
    }

    pub fn y(self, row: Row) -> String {
        self.number(row.y, 3)
    }

    /// The three cells of a row.
    pub fn cells(self, row: Row) -> Vec<String> {
        vec![self.time(row), self.x(row), self.y(row)]
    }
}

/// Lines of the record, with what stands between the cells.
pub fn lines(style: Style, delimiter: &str) -> String {
    table(delimiter, |_, row| style.cells(row))
}

/// Lines of cells.
pub fn table(delimiter: &str, cells: impl Fn(usize, Row) -> Vec<String>) -> String {
    let lines = rows().into_iter().enumerate().map(|(k, row)| cells(k, row).join(delimiter) + "\n");
    lines.collect()
}

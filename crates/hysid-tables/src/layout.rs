//! Layout of a table in a text: where it begins, what separates its cells, what its columns are called, and how its
//! numbers are written. The table begins where columns of numbers begin; what stands above them with as many cells are
//! their names and units, and everything before is a preamble.

mod cells;
mod header;
mod lines;
mod numbers;
mod run;

use hysid_core::words::Words;

use crate::number::NumberFormat;
use crate::reading::{Delimiter, Reading};
use crate::stamp;
use header::Header;
use hysid_document::{Problem, Result};
use lines::TextLine;
use run::LineRun;

pub use cells::{CellKind, LineCell, bare, split};
pub use header::{ColumnGroups, distinct, is_name};
pub use lines::{first_line, is_comment};
pub use run::{has_number, is_row};

/// Lines that a layout is found from.
const MOST_LINES: usize = 300;

/// True for the name of a column that distinguishes records. A `segment` may be a part of one record.
pub fn is_record(name: &str) -> bool {
    name.eq_ignore_ascii_case("record")
}

/// Words of a time of day.
const CLOCKS: [&str; 6] = ["clock", "time of day", "uhrzeit", "heure", "hora", "时刻"];

/// Rows with names that are a table, and no part of a preamble.
const FEWEST_ROWS: usize = 3;

/// Layout of a table in a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    pub delimiter: Delimiter,
    pub numbers: NumberFormat,
    /// Names of the columns, with the units that stand in a line of their own or in the cells.
    pub names: Vec<String>,
    /// Lines with the names; none for a table without names.
    pub header_lines: Vec<u64>,
    pub units_line: Option<u64>,
    /// Lines before the header.
    pub preamble: usize,
    /// The unit that stands behind the numbers of each column.
    pub cell_units: Vec<Option<String>>,
    /// Columns of dates or clocks.
    pub stamps: Vec<bool>,
    /// A column of clocks, and that of the dates that they belong to. Alone, they are hours and minutes.
    pub clock: Option<(usize, Option<usize>)>,
    /// Where the first row begins, in bytes.
    pub start: usize,
    /// The line of the first row.
    pub line: u64,
    /// Columns that are several tables side by side.
    pub groups: Option<ColumnGroups>,
}

/// Largest number of bytes of a column's name, which models and reports repeat.
const LONGEST_NAME: usize = 10_000;

/// The error of a file without a table.
const IS_EMPTY: &str = "is empty (expected a header line and rows of numbers)";

impl Layout {
    /// The layout of a text of which the beginning is known; `is_all` if that is all.
    pub fn find(file: &str, text: &str, is_all: bool, reading: &Reading) -> Result<Self> {
        let lines = lines::lines(text, is_all, reading.skip);
        if lines.iter().all(TextLine::is_blank) {
            let more = || format!("begins with more than {} blank lines (remove them)", lines.len());
            return Err(Problem::in_file(file, if is_all { IS_EMPTY.into() } else { more() }));
        }
        let delimiters = reading.delimiter.as_ref().map_or(&Delimiter::ALL[..], std::slice::from_ref);
        let runs: Vec<Vec<LineRun>> =
            delimiters.iter().map(|&delimiter| LineRun::all(&lines, delimiter)).collect();
        let all = runs.iter().flat_map(|runs| runs.iter().map(move |run| (run, runs)));
        let best = all.reduce(|best, other| if other.0.score() > best.0.score() { other } else { best });
        let Some((best, runs)) = best else {
            return Self::without_rows(file, &lines, reading);
        };
        let (run, header) = table(runs, best, |run| settled(file, &lines, run, reading))?;
        let first = &lines[run.lines.start];
        let mut layout = Self {
            delimiter: if run.width == 1 {
                reading.delimiter.unwrap_or(Delimiter::COMMA)
            } else {
                run.delimiter
            },
            numbers: numbers::format(&lines, &run, reading),
            preamble: (header.lines.first().copied().unwrap_or(first.number) - 1) as usize,
            cell_units: run.units(),
            stamps: run.stamps(),
            clock: None,
            names: header.names,
            header_lines: header.lines,
            units_line: header.units_line,
            start: first.start,
            line: first.number,
            groups: header.groups,
        };
        if let Some(remarks) = header.remarks {
            layout.names.push(remarks);
            layout.cell_units.push(None);
            layout.stamps.push(false);
        }
        layout.find_clock(&lines[run.lines.clone()]);
        layout.name_units();
        layout.name_micromag(&lines);
        if let Some(name) = layout.names.iter().find(|name| name.len() > LONGEST_NAME) {
            let line = layout.header_lines.last().unwrap_or(&layout.line);
            let letters = name.chars().count();
            let words =
                format!("the name of a column has {letters} characters, and {LONGEST_NAME} are allowed");
            return Err(Problem::at(file, *line, Words::from(words).helpful()));
        }
        Ok(layout)
    }

    /// Of a text without a row of numbers: its first line is the header, and what follows is reported where it is read.
    fn without_rows(file: &str, lines: &[TextLine<'_>], reading: &Reading) -> Result<Self> {
        let Some(place) = lines.iter().position(|line| !line.is_blank() && !line.is_comment) else {
            return Err(Problem::in_file(file, IS_EMPTY));
        };
        let line = &lines[place];
        let most = |&delimiter: &Delimiter| cells::split(line.text, delimiter).len();
        let delimiter = reading.delimiter.unwrap_or_else(|| {
            let characters = Delimiter::ALL.iter().filter(|delimiter| **delimiter != Delimiter::Blanks);
            let best = characters.rev().max_by_key(|delimiter| most(delimiter));
            best.copied().filter(|delimiter| most(delimiter) > 1).unwrap_or(Delimiter::COMMA)
        });
        let names: Vec<String> =
            cells::split(line.text, delimiter).iter().map(|cell| cell.text.trim().to_string()).collect();
        let width = names.len();
        Ok(Self {
            delimiter,
            numbers: numbers::chosen(reading),
            names: header::distinct(names),
            header_lines: vec![line.number],
            units_line: None,
            preamble: 0,
            cell_units: vec![None; width],
            stamps: vec![false; width],
            clock: None,
            start: line.end,
            line: line.number + 1,
            groups: None,
        })
    }

    /// Finds a column of clocks beside one of dates, or of hours and minutes alone: those are named so, or pass midnight.
    fn find_clock(&mut self, lines: &[TextLine<'_>]) {
        let filled = lines.iter().filter(|line| !line.is_blank() && !line.is_comment);
        let rows: Vec<Vec<LineCell<'_>>> =
            filled.map(|line| cells::split(line.text, self.delimiter)).collect();
        let cells =
            |place: usize| rows.iter().filter_map(move |row| row.get(place)).map(|cell| cell.text.trim());
        let are = |place: usize, kind: &dyn Fn(&str) -> bool| {
            cells(place).next().is_some_and(kind) && cells(place).all(|cell| cell.is_empty() || kind(cell))
        };
        let only = |kind: &dyn Fn(&str) -> bool| {
            let mut found = (0..self.names.len()).filter(|&place| are(place, kind));
            found.next().filter(|_| found.next().is_none())
        };
        let Some(clock) = only(&|cell| stamp::clock(cell).is_some()) else { return };
        let date = only(&stamp::is_date);
        let name = self.names[clock].to_lowercase();
        let is_named = CLOCKS.iter().any(|word| name.contains(word));
        let seconds: Vec<f64> = cells(clock).filter_map(stamp::clock).collect();
        let passes_midnight = || {
            seconds.iter().all(|&seconds| seconds < stamp::DAY)
                && seconds.windows(2).any(|pair| pair[1] < pair[0] - 0.5 * stamp::DAY)
        };
        if date.is_some() || !self.stamps[clock] && (is_named || passes_midnight()) {
            self.clock = Some((clock, date));
            self.stamps[date.unwrap_or(clock)] = true;
        }
    }

    /// True if the last column has remarks: rows without one may lack its cell.
    pub fn ends_with_remarks(&self) -> bool {
        self.names.len() > 2 && self.names.last().is_some_and(|name| header::is_remark(name))
    }

    /// Names and units of a MicroMag magnetometer, which writes the system of units before the table, and often no names.
    fn name_micromag(&mut self, lines: &[TextLine<'_>]) {
        if !lines.iter().find(|line| !line.is_blank()).is_some_and(|line| line.text.starts_with("MicroMag")) {
            return;
        }
        let is_cgs = |line: &TextLine<'_>| {
            line.text.starts_with("Units of measure") && line.text.to_lowercase().contains("cgs")
        };
        let [field, moment] = if lines.iter().any(is_cgs) { ["Oe", "emu"] } else { ["T", "A m2"] };
        if self.header_lines.is_empty() && self.names.len() == 2 {
            self.names = ["Field", "Moment"].map(String::from).to_vec();
        }
        for name in &mut self.names {
            match name {
                name if name.ends_with("Field") => header::add_unit(name, field),
                name if name.ends_with("Moment") => header::add_unit(name, moment),
                _ => {}
            }
        }
    }

    /// Adds units to names that have none: those in the cells, and the seconds that dates and clocks become.
    pub fn name_units(&mut self) {
        for (place, name) in self.names.iter_mut().enumerate() {
            // Records have names, such as those of frequencies.
            if is_record(name) {
                self.cell_units[place] = None;
                continue;
            }
            let unit = match (&self.cell_units[place], self.stamps[place]) {
                (Some(unit), _) => unit.as_str(),
                (None, true) => "s",
                (None, false) => continue,
            };
            header::add_unit(name, unit);
        }
    }
}

/// A run with its first rows and its header. The last cell of every row may be empty: it is a column if it has a name.
fn settled(
    file: &str,
    lines: &[TextLine<'_>],
    run: &LineRun,
    reading: &Reading,
) -> Result<(LineRun, Header)> {
    let run = run.clone().with_rows_above(lines);
    let header = |run: &LineRun| match reading.no_header {
        true => Ok(Header::none(run.width)),
        false => Header::above(file, lines, run, reading.units_row),
    };
    let whole = header(&run);
    match run.trimmed() {
        Some(trimmed) if !whole.as_ref().is_ok_and(|header| header.names_last) => {
            let header = header(&trimmed)?;
            Ok((trimmed, header))
        }
        _ => Ok((run, whole?)),
    }
}

/// The table: the best run, or one before it that is a table with names too. What follows it is reported where it is
/// read, and nothing is passed over in silence.
fn table(
    runs: &[LineRun],
    best: &LineRun,
    settled: impl Fn(&LineRun) -> Result<(LineRun, Header)>,
) -> Result<(LineRun, Header)> {
    let has_names = |(_, header): &(LineRun, Header)| !header.lines.is_empty();
    let settled_best = settled(best);
    let fewest_rows = if settled_best.as_ref().is_ok_and(has_names) { FEWEST_ROWS } else { 0 };
    let before = runs.iter().take_while(|run| run.lines.start < best.lines.start);
    let mut tables =
        before.filter(|run| run.is_pure() && run.rows() >= fewest_rows).filter_map(|run| settled(run).ok());
    tables.find(has_names).map_or(settled_best, Ok)
}

/// Message on a row with more or fewer cells than the table has columns.
pub fn width_problem(found: usize, expected: usize, row: &[&str], delimiter: Delimiter) -> Words {
    let words = cells_and_names(found, expected);
    match delimiter {
        _ if row.iter().any(|cell| cell.contains(['\n', '\r'])) => {
            words.advised("is a quotation mark not closed?")
        }
        Delimiter::COMMA if found > expected => words.advised(DECIMAL_COMMAS),
        _ => words,
    }
}

/// Advice on rows with more cells than names, separated by commas.
const DECIMAL_COMMAS: &str = "decimal commas? separate the columns by semicolons";

/// That a row has another number of cells than the header has names.
pub fn cells_and_names(cells: usize, names: usize) -> Words {
    format!("has {cells} cell{} where the header has {names}", if cells == 1 { "" } else { "s" }).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::DecimalSign;

    fn layout(text: &str) -> Layout {
        Layout::find("f", text, true, &Reading::default()).unwrap()
    }

    fn names(text: &str) -> Vec<String> {
        layout(text).names
    }

    #[test]
    fn names_of_any_length_are_not_taken() {
        let text = |length: usize| format!("{},y\n1,2\n3,4\n5,6\n", "x".repeat(length));
        assert_eq!(names(&text(LONGEST_NAME))[0].len(), LONGEST_NAME);
        let error =
            Layout::find("f", &text(LONGEST_NAME + 1), true, &Reading::default()).unwrap_err().to_string();
        assert!(error.starts_with("f, line 1: the name of a column has 10001 characters"), "{error}");
    }

    #[test]
    fn row_numbers_of_any_size_are_numbers() {
        let text = "n,x,y\n-9223372036854775808,1,2\n9223372036854775807,2,3\n-9223372036854775808,3,5\n";
        assert_eq!(names(text), ["n", "x", "y"]);
    }

    #[test]
    fn delimiters_and_decimal_signs_are_found() {
        use DecimalSign::{Comma, Point};
        for (text, delimiter, decimal) in [
            ("t;x;y\n0;1,5;2,5\n", "semicolon", Some(Comma)),
            ("Force, kN;Travel, mm\n1,5;2,5\n", "semicolon", Some(Comma)),
            ("t\tx, mm\n0\t1,5\n", "tab", Some(Comma)),
            ("t,\"x;1\"\n0,1\n", "comma", None),
            ("t,x\n0,1.5\n1,2.5\n", "comma", Some(Point)),
            ("t x y\n 0.0  1.5 2.5\n 0.1  1.6 2.7\n", "blanks", Some(Point)),
            ("0,0  1,5 2,5\n0,1  1,6 2,7\n", "blanks", Some(Comma)),
            ("t|x\n0|1.5\n", "bar", Some(Point)),
            ("x,y\n\"1,234.5\",\"2,000.25\"\n", "comma", Some(Point)),
            ("x;y\n850;1\n920;2\n990;3\n1.012;4\n1.234;5\n-1.100;6\n", "semicolon", Some(Comma)),
            ("t,x\n2024-03-01 12:00:00.5,1.25\n2024-03-01 12:00:01,1.5\n", "comma", Some(Point)),
        ] {
            let found = layout(text);
            assert_eq!(
                (found.delimiter.name().as_str(), found.numbers.decimal),
                (delimiter, decimal),
                "{text}"
            );
        }
    }

    #[test]
    fn the_table_begins_where_columns_begin() {
        let text = "Instrument: X-12\nDate;2024-03-01\nRate;1000;Hz\n\nTime;Displacement;Force\ns;mm;kN\n0;1,5;2\n1;2,5;3\n2;3;4\n";
        let found = layout(text);
        assert_eq!(found.names, ["Time [s]", "Displacement [mm]", "Force [kN]"]);
        assert_eq!((found.preamble, found.line), (4, 7));
        assert_eq!((found.header_lines, found.units_line), (vec![5], Some(6)));
        assert_eq!(&text[found.start..found.start + 5], "0;1,5");
    }

    #[test]
    fn tables_without_names_have_numbered_columns() {
        assert_eq!(names("0 1.5 2\n1 2.5 3\n"), ["c1", "c2", "c3"]);
        assert_eq!(names("# measured on Monday\n0,1.5\n1,2.5\n"), ["c1", "c2"]);
        assert_eq!(names("0,1\n"), ["c1", "c2"]);
    }

    #[test]
    fn names_may_stand_in_a_comment_or_lack_that_of_an_index() {
        assert_eq!(names("# t x y\n0 1.5 2\n1 2.5 3\n"), ["t", "x", "y"]);
        assert_eq!(names("\"x\" \"y\"\n\"1\" 0.5 2\n\"2\" 0.7 3\n"), ["c1", "x", "y"]);
        assert_eq!(names(",x,y\n0,1.5,2\n1,2.5,3\n"), ["c1", "x", "y"]);
        assert_eq!(
            names("X_Value\tForce\tComment\n0\t1.5\t\n1\t2.5\n2\t3.5\n"),
            ["X_Value", "Force", "Comment"]
        );
        assert_eq!(names("t,x,\n0,1.5,\n1,2.5,\n"), ["t", "x"]);
    }

    #[test]
    fn units_stand_in_their_own_line_or_in_the_cells() {
        assert_eq!(names("x,y\n1.5 mm,2 kN\n2.5 mm,3 kN\n"), ["x [mm]", "y [kN]"]);
        assert_eq!(names("x\ty\n[mm]\t[kN]\n1\t2\n3\t4\n"), ["x [mm]", "y [kN]"]);
        assert_eq!(names("x [mm],y\n1,2 N\n3,4 N\n"), ["x [mm]", "y [N]"]);
        assert_eq!(names("clock,y\n12:00:00.5,2\n12:00:01,4\n"), ["clock [s]", "y"]);
        // Names that are units too, over numbers.
        assert_eq!(names("s,N\n1,2\n3,4\n"), ["s", "N"]);
    }

    #[test]
    fn text_between_names_and_rows_does_not_hide_the_names() {
        let rows = "0,1.5,2\n1,2.5,3\n2,3.5,4\n";
        for (header, expected) in [
            ("t,x,y\n# a remark\n", ["t", "x", "y"]),
            ("t,x,y\n#one\n! two\n\n", ["t", "x", "y"]),
            ("t,x,y\n// three, words, here\n", ["t", "x", "y"]),
            ("t,x,y\n# s, mm, kN\n", ["t [s]", "x [mm]", "y [kN]"]),
            ("t,x,y\ns,mm,kN\n,,\n", ["t [s]", "x [mm]", "y [kN]"]),
            ("t,x,y\nremark: none\n", ["t", "x", "y"]),
            ("t,x,y\nfloat,float,float\n", ["t", "x", "y"]),
            ("Data,Data,Data\nt,x,y\nMean,Mean,Mean\n", ["t", "x", "y"]),
            (
                "Time,Disp,Force\n,Actuator 1,Cell 2\ns,mm,kN\n",
                ["Time [s]", "Actuator 1 [mm]", "Cell 2 [kN]"],
            ),
            ("% t,x,y\n% s,mm,kN\n", ["t [s]", "x [mm]", "y [kN]"]),
            ("Averages: ,3,4\nt,x,y\n", ["t", "x", "y"]),
            ("A,A,A\nt,H,M\ns,Oe,emu\n", ["t [s]", "H [Oe]", "M [emu]"]),
            ("H (Oe),5 K,300 K\n", ["H (Oe)", "5 K", "300 K"]),
        ] {
            assert_eq!(names(&format!("{header}{rows}")), expected, "{header}");
        }
        let micromag = |units: &str| {
            format!("MicroMag 2900 Data File\nUnits of measure: {units}\n\n+1.5,2.5\n+2.5,3.5\n")
        };
        assert_eq!(names(&micromag("cgs")), ["Field [Oe]", "Moment [emu]"]);
        assert_eq!(names(&micromag("SI")), ["Field [T]", "Moment [A m2]"]);
        assert_eq!(names("Units: cgs\nNCrv     = 40\n\n+1.5,2.5\n+2.5,3.5\n"), ["c1", "c2"]);
    }

    #[test]
    fn names_that_come_again_are_groups() {
        let groups = |header: &str| {
            let row = |k: usize| vec![format!("{k}.5"); header.split(',').count()].join(",");
            let found = layout(&format!("{header}\n{}\n{}\n{}\n", row(0), row(1), row(2))).groups;
            found.map(|groups| (groups.shared, groups.names.join(" "), groups.labels.join(" ")))
        };
        let text = |shared, names: &str, labels: &str| Some((shared, names.to_string(), labels.to_string()));
        assert_eq!(groups("H,M,H,M,H,M"), text(0, "H M", "1 2 3"));
        assert_eq!(groups("t,x,F,x,F"), text(1, "t x F", "1 2"));
        assert_eq!(groups("H1 (Oe),M1 (emu),H2 (Oe),M2 (emu)"), text(0, "H (Oe) M (emu)", "1 2"));
        for other in ["t,x,x", "t,x,t,F", "x1,x2,y", "H,M,H,B", "t,x1,x2,x3"] {
            assert_eq!(groups(other), None, "{other}");
        }
    }

    #[test]
    fn equal_names_are_numbered_or_told_by_the_line_above() {
        assert_eq!(names("t,x,x\n0,1,2\n1,2,3\n"), ["t", "x", "x (2)"]);
        assert_eq!(names("Left,Left,Right\nx,F,x\n0,1,2\n1,2,3\n"), ["Left x", "Left F", "Right x"]);
    }

    #[test]
    fn a_line_of_text_among_rows_does_not_end_the_search() {
        let found = layout("t,x,state\n0,1.5,ok\n1,2.5,ok\n2,n/a,fault\n3,4,ok\n");
        assert_eq!((found.names.len(), found.line), (3, 2));
    }

    #[test]
    fn text_without_rows_has_the_first_line_as_its_header() {
        assert_eq!(names("t;x;y\n"), ["t", "x", "y"]);
        assert_eq!(names("# remark\nt,x\na,b\n"), ["t", "x"]);
        let error = |is_all| Layout::find("f", " \n\n", is_all, &Reading::default()).unwrap_err().to_string();
        assert!(error(true).starts_with("f: is empty"), "{}", error(true));
        assert_eq!(error(false), "f: begins with more than 2 blank lines (remove them)");
    }
}

//! Several tables of one file as one table: tables one below the other in a text, sheets of a spreadsheet, and loops
//! side by side. Those with equal columns are records, which a column tells apart; others are left out and listed.

mod branches;

use hysid_core::words::{Hint, Words};
use hysid_document::visible::{clipped, listed};
use hysid_document::{Problem, Result};

use crate::container::{TextSheet, is_lying, push_words};
use crate::layout::{CellKind, Layout, LineCell, first_line, is_comment, is_name, is_record, split};
use crate::number::{DecimalSign, is_missing, parsed};
use crate::reading::{Delimiter, Reading};
use branches::LoopBranches;
pub use branches::are_branches;

const MOST_TABLES: usize = 500;

/// Longest row that may be a column.
const LONGEST_COLUMN: usize = 1 << 20;

/// Rows of a table that is left out, per row that is read, from which on it may be meant.
const DOUBTFUL: f64 = 0.1;

/// Rows without names that are a table, and no text behind one.
const FEWEST_ROWS: usize = 3;

/// Name of the column that tells the tables apart.
const RECORD: &str = "record";

pub enum Found {
    /// The sheet of this place, with one table or none.
    Alone(usize),
    Gathered(Box<GatheredTables>),
}

/// Tables with equal columns as one.
pub struct GatheredTables {
    pub layout: Layout,
    /// The rows, with tabs between their cells.
    pub text: String,
    /// Line of each row in the file, or in its sheet.
    pub lines: Vec<u64>,
    /// Names of the tables that are read.
    pub described: String,
    /// Those that are not read.
    pub left_out: Vec<String>,
    /// One of these has so many rows that it may be meant, although no option chose.
    pub is_doubtful: bool,
}

/// A table of a sheet, or a group of its columns.
struct TablePart<'t> {
    name: String,
    sheet: &'t TextSheet,
    layout: Layout,
    /// Places of its columns.
    columns: Vec<usize>,
    /// Columns before the first of its own.
    shared: usize,
    /// It is a group of columns.
    is_group: bool,
    delimiter: Delimiter,
    rows: Vec<(u64, &'t str)>,
}

/// Finds the tables of sheets, or of a text as the only sheet, whose name is empty.
pub fn gather(file: &str, sheets: &[TextSheet], reading: &Reading) -> Result<Found> {
    let mut parts = Vec::new();
    let (mut empty, mut undivided) = (Vec::new(), None);
    for (place, sheet) in sheets.iter().enumerate() {
        match tables(file, sheet, reading) {
            Some(tables) if tables.is_empty() => empty.push(sheet.described.clone()),
            Some(tables) => {
                let is_single = tables.len() == 1;
                for (number, table) in tables.into_iter().enumerate() {
                    let name = |inner: String| match (sheets.len() > 1, inner.is_empty()) {
                        (true, true) => sheet.name.clone(),
                        (true, false) => format!("{}/{inner}", sheet.name),
                        (false, _) => inner,
                    };
                    let own = if is_single { String::new() } else { format!("table {}", number + 1) };
                    parts.extend(table.groups(&name(own)));
                }
            }
            None => undivided = undivided.or(Some(place)),
        }
    }
    let is_plain = parts.len() == 1 && sheets.len() == 1 && parts[0].columns.len() == parts[0].width();
    if is_plain && let Some(changed) = parts[0].standing().or_else(|| parts[0].loop_of_branches()) {
        return Ok(Found::Gathered(Box::new(changed)));
    }
    if is_plain || undivided.is_some() || parts.is_empty() && sheets.len() == 1 {
        return Ok(Found::Alone(undivided.unwrap_or(0)));
    }
    if parts.is_empty() {
        let names: Vec<&String> = sheets.iter().map(|sheet| &sheet.described).collect();
        return Err(Problem::in_file(file, format!("has no rows of numbers in {}", listed(&names))));
    }
    let is_text = sheets.len() == 1 && sheets[0].name.is_empty();
    let chosen: Vec<bool> = match reading.sheet.as_deref().filter(|_| is_text) {
        Some(chosen) => by_name(file, &parts, chosen)?,
        None => largest(&parts),
    };
    let rest = parts.iter().zip(&chosen).filter(|(_, chosen)| !**chosen);
    let left_out = rest.map(|(part, _)| format!("{} ({} rows)", clipped(&part.name), part.rows.len()));
    let left_out = left_out.chain(empty).collect();
    let rows = |is_read: bool| -> Vec<usize> {
        let parts = parts.iter().zip(&chosen).filter(|(_, chosen)| **chosen == is_read);
        parts.map(|(part, _)| part.rows.len()).collect()
    };
    let least = DOUBTFUL * rows(true).iter().sum::<usize>() as f64;
    let is_doubtful = reading.sheet.is_none() && rows(false).iter().any(|&rows| rows as f64 >= least);
    let mut kept = chosen.iter();
    parts.retain(|_| kept.next() == Some(&true));
    let tables = loops_of_branches(&parts).unwrap_or_else(|| joined(&parts));
    Ok(Found::Gathered(Box::new(GatheredTables { left_out, is_doubtful, ..tables })))
}

/// The part of this name or number.
fn by_name(file: &str, parts: &[TablePart<'_>], chosen: &str) -> Result<Vec<bool>> {
    let number = chosen.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
    let is_it = |(place, part): (usize, &TablePart<'_>)| part.name == chosen || number == Some(place);
    let found: Vec<bool> = parts.iter().enumerate().map(is_it).collect();
    if found.contains(&true) {
        return Ok(found);
    }
    let names: Vec<&String> = parts.iter().map(|part| &part.name).collect();
    let words =
        Words::from(format!("there is no table \"{}\" for ", clipped(chosen))) + Hint::Option("sheet");
    Err(Problem::in_file(file, words.advised(format!("tables: {}", listed(&names)))))
}

/// Those with equal columns that have the most rows together.
fn largest(parts: &[TablePart<'_>]) -> Vec<bool> {
    let rows = |names: &[String]| -> usize {
        parts.iter().filter(|part| part.layout.names == names).map(|part| part.rows.len() * names.len()).sum()
    };
    let mut best = &parts[0].layout.names;
    for part in parts {
        if rows(&part.layout.names) > rows(best) {
            best = &part.layout.names;
        }
    }
    parts.iter().map(|part| part.layout.names == *best).collect()
}

/// Adds the column of the names of the parts, as the first.
fn begin_with_records(layout: &mut Layout) {
    layout.names.insert(0, RECORD.into());
    layout.cell_units.insert(0, None);
    layout.stamps.insert(0, false);
    layout.clock = layout.clock.map(|(clock, date)| (clock + 1, date.map(|date| date + 1)));
}

/// Parts with equal columns one below the other, with a column of their names if there are several.
fn joined(parts: &[TablePart<'_>]) -> GatheredTables {
    let mut layout = parts[0].layout.clone();
    let known = layout.names.iter().position(|name| is_record(name));
    if parts.len() > 1 && known.is_none() {
        begin_with_records(&mut layout);
    }
    let (mut text, mut lines) = (String::new(), Vec::new());
    for part in parts {
        for &(line, row) in &part.rows {
            let cells = split(row, part.delimiter);
            let cell = |place: usize| cells.get(place).map_or("", |cell| cell.text.trim());
            if parts.len() > 1 && part.columns[part.shared..].iter().all(|&place| is_missing(cell(place))) {
                continue;
            }
            if parts.len() > 1 && known.is_none() {
                push_words(&mut text, &part.name);
                text.push('\t');
            }
            for (place, &column) in part.columns.iter().enumerate() {
                text.push_str(if place == 0 { "" } else { "\t" });
                match known == Some(place) && parts.len() > 1 {
                    true => push_words(&mut text, &format!("{}/{}", part.name, cell(column))),
                    false => push_words(&mut text, cell(column)),
                }
            }
            text.push('\n');
            lines.push(line);
        }
    }
    GatheredTables {
        layout,
        text,
        lines,
        described: described(parts),
        left_out: Vec::new(),
        is_doubtful: false,
    }
}

/// Parts of two branches each, as loops one below the other.
fn loops_of_branches(parts: &[TablePart<'_>]) -> Option<GatheredTables> {
    let loops: Vec<GatheredTables> = parts.iter().map(TablePart::loop_of_branches).collect::<Option<_>>()?;
    let mut layout = loops[0].layout.clone();
    begin_with_records(&mut layout);
    let mut text = String::new();
    for (part, rows) in parts.iter().zip(&loops) {
        for row in rows.text.lines() {
            push_words(&mut text, &part.name);
            text.push_str(&format!("\t{row}\n"));
        }
    }
    let lines = loops.into_iter().flat_map(|rows| rows.lines).collect();
    let described = format!("{}, two branches as one loop", described(parts));
    Some(GatheredTables { layout, text, lines, described, left_out: Vec::new(), is_doubtful: false })
}

/// Which tables are read.
fn described(parts: &[TablePart<'_>]) -> String {
    let names: Vec<&String> = parts.iter().map(|part| &part.name).collect();
    match parts {
        [part] if !part.sheet.described.is_empty() && !part.is_group => part.sheet.described.clone(),
        [part] if part.is_group => format!("columns of {}", clipped(&part.name)),
        [_, ..] if parts.iter().all(|part| part.is_group) => format!("{} groups of columns", parts.len()),
        [part, ..] if part.sheet.described.starts_with("sheet ") => format!("sheets {}", listed(&names)),
        _ => listed(&names),
    }
}

/// The tables of a sheet; `None` for one that must be read row by row, because something in it is no table.
fn tables<'t>(file: &str, sheet: &'t TextSheet, reading: &Reading) -> Option<Vec<TablePart<'t>>> {
    let text: &str = &sheet.text;
    let mut reading = Reading { skip: reading.skip, ..reading.clone() };
    let mut found: Vec<TablePart<'t>> = Vec::new();
    let (mut at, mut line) = (0, 0);
    while found.len() < MOST_TABLES {
        let rest = &text[at..];
        let layout = Layout::find(file, rest, true, &reading).ok();
        let Some(mut layout) = layout else { return (!found.is_empty()).then_some(found) };
        reading.skip = 0;
        let scanned = rows(rest, &layout)?;
        let is_table = !scanned.rows.is_empty();
        if !found.is_empty() && layout.header_lines.is_empty() && is_table {
            return (scanned.rows.len() < FEWEST_ROWS && scanned.end == rest.len()).then_some(found);
        }
        if !is_table {
            return Some(found);
        }
        let lines = scanned.rows.iter().map(|&(number, row)| (number + line, row)).collect();
        layout.header_lines.iter_mut().chain(&mut layout.units_line).for_each(|number| *number += line);
        layout.line += line;
        layout.preamble += line as usize;
        let columns = (0..layout.names.len()).collect();
        let delimiter = layout.delimiter;
        let name = String::new();
        found.push(TablePart {
            name,
            sheet,
            layout,
            columns,
            shared: 0,
            is_group: false,
            delimiter,
            rows: lines,
        });
        at += scanned.end;
        line += scanned.lines;
        if at >= text.len() {
            return Some(found);
        }
    }
    None
}

/// Rows of a table, and where the text behind it begins.
struct ScannedRows<'t> {
    rows: Vec<(u64, &'t str)>,
    end: usize,
    /// Lines before that place.
    lines: u64,
}

/// The rows from the first on; `None` for a line among them that is no row.
fn rows<'t>(text: &'t str, layout: &Layout) -> Option<ScannedRows<'t>> {
    let width = layout.names.len();
    let (mut at, mut number, mut rows, mut is_after_blank) = (layout.start, layout.line, Vec::new(), false);
    let header = header_text(text, layout);
    while at < text.len() {
        let (line, next) = first_line(&text[at..]);
        if line.trim().is_empty() {
            is_after_blank = true;
        } else {
            let cells = cells_of(line, layout.delimiter);
            let fits = cells == width
                || cells == width + 1 && ends_empty(line, layout.delimiter)
                || cells + 1 == width && layout.ends_with_remarks();
            let is_header = header == Some(line.trim()) && !rows.is_empty();
            if is_header {
                break;
            }
            if is_comment(line) && (!fits || !is_after_blank && !has_cell_with_number(line, layout.delimiter))
            {
                (at, number) = (at + next, number + 1);
                continue;
            }
            // Behind a blank line, names such as `2nd` may begin another table.
            let has_number = match is_after_blank {
                true => split(line, layout.delimiter)
                    .iter()
                    .any(|cell| matches!(cell.kind(), CellKind::Number(_) | CellKind::Stamp)),
                false => begins_with_number(line) || has_cell_with_number(line, layout.delimiter),
            };
            let is_empty =
                || split(line, layout.delimiter).iter().all(|cell| cell.kind() == CellKind::Missing);
            let is_row = has_number || is_empty();
            match (fits, is_row) {
                (true, true) => {
                    rows.push((number, line));
                    is_after_blank = false;
                }
                (true, false) if !rows.is_empty() && !is_after_blank => {
                    return None;
                }
                (false, true) if !is_after_blank && begins_with_number(line) => return None,
                _ => break,
            }
        }
        (at, number) = (at + next, number + 1);
    }
    Some(ScannedRows { rows, end: at, lines: number - 1 })
}

/// The line of the names, if it is one.
fn header_text<'t>(text: &'t str, layout: &Layout) -> Option<&'t str> {
    let [line] = layout.header_lines.as_slice() else { return None };
    let mut rest = text;
    for _ in 1..*line {
        rest = &rest[first_line(rest).1..];
    }
    Some(first_line(rest).0.trim())
}

/// Number of the cells of a line, without cutting it where that is not needed.
fn cells_of(line: &str, delimiter: Delimiter) -> usize {
    match delimiter {
        Delimiter::Character(character) if !line.contains('"') => {
            1 + line.bytes().filter(|&byte| byte == character).count()
        }
        _ => split(line, delimiter).len(),
    }
}

fn ends_empty(line: &str, delimiter: Delimiter) -> bool {
    split(line, delimiter).last().is_some_and(|cell| cell.text.trim().is_empty())
}

/// True for a line with a cell that begins with a number.
fn has_cell_with_number(line: &str, delimiter: Delimiter) -> bool {
    match delimiter {
        Delimiter::Character(character) => line.split(char::from(character)).any(begins_with_number),
        Delimiter::Blanks => line.split([' ', '\t']).any(begins_with_number),
    }
}

fn begins_with_number(line: &str) -> bool {
    let line = line.trim_start().trim_start_matches(['"', '+', '-', '.', ',', ' ']);
    line.starts_with(|letter: char| letter.is_ascii_digit())
}

impl<'t> TablePart<'t> {
    fn width(&self) -> usize {
        self.layout.names.len()
    }

    /// Its groups of columns, or itself, with this name.
    fn groups(mut self, name: &str) -> Vec<Self> {
        let Some(groups) = self.layout.groups.take() else {
            self.name = name.to_string();
            return vec![self];
        };
        let (shared, width) = (groups.shared, groups.names.len() - groups.shared);
        let part = |(number, label): (usize, &String)| {
            let first = shared + number * width;
            let columns: Vec<usize> = (0..shared).chain(first..first + width).collect();
            let mut layout = self.layout.clone();
            layout.names.clone_from(&groups.names);
            layout.cell_units = columns.iter().map(|&place| self.layout.cell_units[place].clone()).collect();
            layout.stamps = columns.iter().map(|&place| self.layout.stamps[place]).collect();
            layout.clock = None;
            layout.name_units();
            let name = if name.is_empty() { label.clone() } else { format!("{name}/{label}") };
            let (sheet, delimiter, rows) = (self.sheet, self.delimiter, self.rows.clone());
            Self { name, sheet, layout, columns, shared, is_group: true, delimiter, rows }
        };
        groups.labels.iter().enumerate().map(part).collect()
    }

    /// The two branches of a loop one behind the other, if the columns are that.
    fn loop_of_branches(&self) -> Option<GatheredTables> {
        let branches = LoopBranches::of(&self.layout.names)?;
        // Line, input and output of each row of a branch.
        let branch = |[input, output]: [usize; 2]| -> Vec<(u64, [String; 2])> {
            let row = |&(line, row): &(u64, &str)| {
                let cells = split(row, self.delimiter);
                let cell = |place: usize| {
                    cells.get(self.columns[place]).map_or("", |cell| cell.text.trim()).to_string()
                };
                (line, [cell(input), cell(output)])
            };
            self.rows.iter().map(row).filter(|(_, [_, output])| !is_missing(output)).collect()
        };
        let decimal = self.layout.numbers.decimal;
        let numbers = |rows: &[(u64, [String; 2])], place: usize| -> Option<Vec<f64>> {
            rows.iter()
                .map(|(_, cells)| parsed(&cells[place], decimal).ok().map(|(number, _)| number))
                .collect()
        };
        let (mut rows, mut returning) = (branch(branches.out), branch(branches.back));
        let [out, back] = [numbers(&rows, 0)?, numbers(&returning, 0)?];
        if LoopBranches::is_turned(&out, &back)? {
            if LoopBranches::is_counted(&numbers(&rows, 1)?, &numbers(&returning, 1)?) {
                for ((_, [input, _]), counted) in returning.iter_mut().zip(&back) {
                    *input = (out[out.len() - 1] + back[0] - counted).to_string();
                    if decimal == Some(DecimalSign::Comma) {
                        *input = input.replace('.', ",");
                    }
                }
            } else {
                returning.reverse();
            }
        }
        rows.append(&mut returning);
        let mut layout = self.layout.clone();
        layout.cell_units = branches.out.map(|place| self.layout.cell_units[place].clone()).to_vec();
        (layout.stamps, layout.clock) = (vec![false; 2], None);
        layout.names = branches.names.to_vec();
        let mut text = String::new();
        for (_, [input, output]) in &rows {
            push_words(&mut text, input);
            text.push('\t');
            push_words(&mut text, output);
            text.push('\n');
        }
        let lines = rows.iter().map(|(line, _)| *line).collect();
        let described = "two branches as one loop".to_string();
        Some(GatheredTables { layout, text, lines, described, left_out: Vec::new(), is_doubtful: false })
    }

    /// The same with rows and columns interchanged, of a table with few long rows and no names above.
    fn standing(&self) -> Option<GatheredTables> {
        let is_table = !is_lying(self.rows.len(), self.width()) || self.width() > LONGEST_COLUMN;
        if is_table || !self.layout.header_lines.is_empty() {
            return None;
        }
        let rows: Vec<Vec<LineCell<'_>>> =
            self.rows.iter().map(|(_, row)| split(row, self.delimiter)).collect();
        let first = |row: &Vec<LineCell<'_>>| row[0].text.trim().to_string();
        let is_named = rows.iter().all(|row| is_name(&row[0].text));
        let mut layout = self.layout.clone();
        let numbered = (1..=rows.len()).map(|number| format!("c{number}"));
        layout.names = if is_named { rows.iter().map(first).collect() } else { numbered.collect() };
        layout.header_lines = if is_named { vec![self.rows[0].0] } else { Vec::new() };
        layout.cell_units = vec![None; rows.len()];
        (layout.stamps, layout.clock) = (vec![false; rows.len()], None);
        let mut text = String::new();
        let columns = usize::from(is_named)..self.width();
        for place in columns.clone() {
            for (number, row) in rows.iter().enumerate() {
                text.push_str(if number == 0 { "" } else { "\t" });
                push_words(&mut text, row.get(place).map_or("", |cell| cell.text.trim()));
            }
            text.push('\n');
        }
        let lines = vec![self.rows[0].0; columns.len()];
        let described = "its rows as columns".to_string();
        Some(GatheredTables { layout, text, lines, described, left_out: Vec::new(), is_doubtful: false })
    }
}

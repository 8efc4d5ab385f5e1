//! The names and units above the rows of a table.

use std::collections::{HashMap, HashSet};

use hysid_core::data::unit;
use hysid_core::words::{Hint, Words};

use super::cells::{CellKind, LineCell, split};
use super::lines::TextLine;
use super::run::LineRun;
use super::{DECIMAL_COMMAS, cells_and_names};
use crate::number::is_missing;
use crate::reading::Delimiter;
use hysid_document::{Problem, Result};

/// Lines with names above a table.
const MOST_LINES: usize = 4;

/// Names of a column at the end that has a cell in few rows, or in none.
const REMARKS: [&str; 6] = ["comment", "comments", "remark", "remarks", "kommentar", "bemerkung"];

/// Names of columns, and where they stand.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Header {
    /// A name for each column.
    pub names: Vec<String>,
    /// Numbers of the lines with names.
    pub lines: Vec<u64>,
    /// Number of the line with units.
    pub units_line: Option<u64>,
    /// The last column has a name of its own.
    pub names_last: bool,
    pub groups: Option<ColumnGroups>,
    /// Name of a column of remarks behind the cells of the rows.
    pub remarks: Option<String>,
}

/// Columns whose names come again and again, as of loops side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnGroups {
    /// Columns before the groups, which belong to each of them.
    pub shared: usize,
    /// Names of the shared columns and of a group.
    pub names: Vec<String>,
    /// A name for each group.
    pub labels: Vec<String>,
}

/// A line above the rows.
struct HeaderLine {
    line: u64,
    cells: Vec<String>,
    /// Name of a further column, of remarks.
    remarks: Option<String>,
}

impl Header {
    /// That of a table without names: `c1`, `c2` and so on.
    pub fn none(width: usize) -> Self {
        Self { names: distinct(vec![String::new(); width]), ..Self::default() }
    }

    /// The names and units above a run of rows.
    ///
    /// # Errors
    /// Names that do not fit the rows.
    pub fn above(file: &str, lines: &[TextLine<'_>], run: &LineRun, has_units: bool) -> Result<Self> {
        let mut rows: Vec<HeaderLine> = Vec::new();
        let names = names_above_remarks(lines, run);
        for (place, line) in lines[..run.lines.start].iter().enumerate().rev() {
            let is_remark = names.is_some_and(|names| place > names);
            if line.is_blank() && rows.is_empty() {
                continue;
            }
            if line.is_blank() || rows.len() == MOST_LINES {
                break;
            }
            let cells = split(line.content(), run.delimiter);
            let below = rows.last().and_then(|row| lines.iter().find(|line| line.number == row.line));
            let fit = match below.and_then(|below| stages_over(line, below, run.width)) {
                Some(cells) => HeaderFit::Row(HeaderLine { line: line.number, cells, remarks: None }),
                None => row(line, &cells, run, is_first(lines, place)),
            };
            match fit {
                // Between the names and the rows, only units count.
                HeaderFit::Row(row) if is_remark && !are_units(&row.cells) => {}
                // Of a comment above others, only names above units.
                HeaderFit::Row(row)
                    if line.is_comment && rows.last().is_some_and(|below| !are_units(&below.cells)) =>
                {
                    drop(row);
                    break;
                }
                HeaderFit::Row(row) => rows.push(row),
                _ if is_remark => {}
                HeaderFit::Nothing => break,
                HeaderFit::OtherWidth if rows.is_empty() && !line.is_comment && is_first(lines, place) => {
                    return Err(other_width(file, line, &cells, run, &lines[run.lines.clone()]));
                }
                HeaderFit::OtherWidth => break,
            }
        }
        if rows.is_empty() && is_quoted_header(lines, run) {
            let words = Words::from("the names of the columns are numbers in quotation marks");
            return Err(Problem::at(file, lines[run.lines.start].number, words.advised("rename them")));
        }
        rows.reverse();
        Ok(Self::of(rows, run.width, has_units))
    }

    fn of(mut rows: Vec<HeaderLine>, width: usize, has_units: bool) -> Self {
        if rows.is_empty() {
            return Self::none(width);
        }
        let units = match has_units {
            true => Some(rows.len() - 1),
            // A single line has the names, even if they are units too.
            false => (1..rows.len()).rev().find(|&place| are_units(&rows[place].cells)),
        };
        let units = units.map(|place| (place, rows[place].line, rows[place].cells.clone()));
        if let Some((place, ..)) = units {
            // What stands below the units is a remark.
            rows.truncate(place);
        }
        // A line with one text over all columns, such as a type, has no names.
        let is_uniform = |row: &HeaderLine| row.cells.iter().all(|cell| *cell == row.cells[0]);
        while width > 1 && rows.len() > 1 && rows.last().is_some_and(is_uniform) {
            rows.pop();
        }
        let lines = rows.iter().map(|row| row.line).collect();
        let remarks = rows.last().and_then(|row| row.remarks.clone());
        let mut names = rows.pop().map_or_else(|| vec![String::new(); width], |row| row.cells);
        if let Some(above) = rows.last() {
            let empty = names.iter_mut().zip(&above.cells).filter(|(name, _)| name.is_empty());
            empty.for_each(|(name, above)| name.clone_from(above));
        }
        let with_units = |mut names: Vec<String>| {
            let units = units.iter().flat_map(|(.., cells)| cells);
            names.iter_mut().zip(units).for_each(|(name, unit)| add_unit(name, unit));
            names
        };
        let mut groups = numbered_groups(&with_units(names.clone()));
        if !are_distinct(&names) {
            let above = rows.pop().map(|row| row.cells);
            groups = column_groups(&with_units(names.clone()), above.as_deref());
            names = above.map_or(names.clone(), |above| joined(&above, &names));
        }
        names = with_units(names);
        let names_last = names.last().is_some_and(|last| !is_remark(last));
        let units_line = units.map(|(_, line, _)| line);
        Self { names: distinct(names), lines, units_line, names_last, groups, remarks }
    }
}

/// Most lines of text between names and rows.
const MOST_REMARKS: usize = 3;

/// The line of the names, if comments or other text that is no names stand between it and the rows.
fn names_above_remarks(lines: &[TextLine<'_>], run: &LineRun) -> Option<usize> {
    let mut others = 0;
    for (place, line) in lines[..run.lines.start].iter().enumerate().rev() {
        if line.is_blank() || line.is_comment {
            continue;
        }
        let cells = split(line.content(), run.delimiter);
        let is_empty = cells.iter().all(|cell| cell.text.trim().is_empty());
        match row(line, &cells, run, is_first(lines, place)) {
            HeaderFit::Row(_) if place + 1 < run.lines.start => return Some(place),
            HeaderFit::Nothing
                if run.delimiter != Delimiter::Blanks
                    && others < MOST_REMARKS
                    && (is_empty || cells.len() == 1 && run.width > 1) =>
            {
                others += 1;
            }
            _ => return None,
        }
    }
    None
}

/// Whether a line belongs to the header.
enum HeaderFit {
    Row(HeaderLine),
    /// It has names, but not as many as the rows have cells.
    OtherWidth,
    Nothing,
}

fn row(line: &TextLine<'_>, cells: &[LineCell<'_>], run: &LineRun, is_first: bool) -> HeaderFit {
    let mut texts: Vec<String> = cells.iter().map(|cell| cell.text.trim().to_string()).collect();
    let width = run.width;
    let mut remarks = None;
    if texts.len() == width + 1 && texts.last().is_some_and(|last| is_remark(last)) {
        remarks = texts.pop().filter(|name| !name.is_empty() && width > 1);
    } else if texts.len() != width && (run.delimiter == Delimiter::Blanks || texts.len() == 1 && width > 1) {
        // Some instruments print names in columns of blanks over rows with commas.
        texts = with_their_units(line.content()).filter(|texts| texts.len() == width).unwrap_or(texts);
    }
    // Tools for statistics leave out the name of the index.
    if texts.len() + 1 == width && width > 2 && texts.iter().all(|text| is_name(text)) && run.counts {
        texts.insert(0, String::new());
    }
    // Keys and values of a preamble, such as `Averages: 3` or `NCrv = 40`.
    let is_key = |text: &String| text.ends_with([':', '=']);
    if texts.iter().any(|text| text.starts_with('=')) || is_key(&texts[0]) && !texts.iter().all(is_key) {
        return HeaderFit::Nothing;
    }
    let names = texts.iter().filter(|text| is_name(text)).count();
    if texts.len() != width {
        let is_like_names = 2 * names > texts.len() && texts.len() > 1;
        return if is_like_names { HeaderFit::OtherWidth } else { HeaderFit::Nothing };
    }
    // Over a column of numbers stands a name, or nothing; in the first line of a file, some names may be numbers.
    let numbers =
        texts.iter().zip(&run.columns).filter(|(text, column)| column.is_numeric() && is_number(text));
    let filled = texts.iter().filter(|text| !text.is_empty()).count();
    let numbers = numbers.count();
    let has_names = names > 0 && 2 * names >= filled && (numbers == 0 || is_first && names > numbers);
    if has_names && 2 * filled >= width {
        HeaderFit::Row(HeaderLine { line: line.number, cells: texts, remarks })
    } else {
        HeaderFit::Nothing
    }
}

/// The labels of stages of a measurement that stand above some names alone, in columns of blanks: `Adjusted` over the second
/// field and moment of a magnetometer.
fn stages_over(line: &TextLine<'_>, names: &TextLine<'_>, width: usize) -> Option<Vec<String>> {
    let labels = words_with_middles(line.content());
    let names = words_with_middles(names.content());
    if names.len() != width || labels.len() >= width || !labels.iter().all(|(label, _)| is_stage(label)) {
        return None;
    }
    let mut cells = vec![String::new(); width];
    for (label, middle) in labels {
        let distance = |place: &usize| names[*place].1.abs_diff(middle);
        cells[(0..width).min_by_key(distance)?] = label.into();
    }
    Some(cells)
}

/// Words between blanks, each with twice the place of its middle in the line.
fn words_with_middles(line: &str) -> Vec<(&str, usize)> {
    let place = |word: &str| line[..word.as_ptr() as usize - line.as_ptr() as usize].chars().count();
    line.split_whitespace().map(|word| (word, 2 * place(word) + word.chars().count())).collect()
}

fn is_stage(label: &str) -> bool {
    STAGES.contains(&label.to_lowercase().as_str())
}

pub fn is_remark(name: &str) -> bool {
    name.is_empty() || REMARKS.contains(&name.to_lowercase().as_str())
}

fn is_number(text: &str) -> bool {
    matches!(
        LineCell { text: text.into(), is_quoted: false }.kind(),
        CellKind::Number(None) | CellKind::Stamp
    )
}

pub fn is_name(text: &str) -> bool {
    !text.is_empty() && !is_number(text)
}

/// Names separated by blanks, of which some have their unit in brackets behind a blank, or that are separated by several
/// blanks.
fn with_their_units(line: &str) -> Option<Vec<String>> {
    let mut names: Vec<String> = Vec::new();
    for word in line.split_whitespace() {
        match names.last_mut() {
            Some(name) if word.starts_with(['(', '[']) => {
                name.push(' ');
                name.push_str(word);
            }
            _ => names.push(word.to_string()),
        }
    }
    let by_gaps: Vec<String> =
        line.split("  ").map(str::trim).filter(|name| !name.is_empty()).map(String::from).collect();
    let has_units = names.iter().any(|name| name.contains(' '));
    if has_units { Some(names) } else { Some(by_gaps).filter(|names| names.len() > 1) }
}

/// The first line that is neither blank nor a comment.
fn is_first(lines: &[TextLine<'_>], place: usize) -> bool {
    lines[..place].iter().all(|line| line.is_blank() || line.is_comment)
}

fn other_width(
    file: &str,
    line: &TextLine<'_>,
    cells: &[LineCell<'_>],
    run: &LineRun,
    rows: &[TextLine<'_>],
) -> Problem {
    let (names, width) = (cells.len(), run.width);
    let advice = match run.delimiter {
        Delimiter::COMMA if width == 2 * names => DECIMAL_COMMAS.into(),
        _ => {
            let skip = Hint::Value("skip", line.number.to_string());
            Words::from("skip the header with ") + skip + " " + Hint::Option("no_header")
        }
    };
    // A row before may have a remark.
    let is_wide = |row: &&TextLine<'_>| split(row.text, run.delimiter).len() == width;
    let first = rows.iter().find(is_wide).unwrap_or(&rows[0]);
    Problem::at(file, first.number, cells_and_names(width, names).advised(advice))
}

/// True if the first row is in quotation marks and the others are not: its numbers are names.
fn is_quoted_header(lines: &[TextLine<'_>], run: &LineRun) -> bool {
    let first = split(lines[run.lines.start].text, run.delimiter);
    first.iter().all(|cell| cell.is_quoted) && run.columns.iter().all(|column| !column.is_quoted)
}

/// Units that stand in lines of units and that no factor converts.
const UNITS_IN_ROWS: [&str; 4] = ["segments", "counts", "cycles", "a.u."];

/// True for a line of units: in brackets, known, or none.
fn are_units(cells: &[String]) -> bool {
    let filled: Vec<&String> = cells.iter().filter(|cell| !is_missing(cell)).collect();
    let is_one = |cell: &&&String| {
        in_brackets(cell).is_some()
            || unit::is_unit(cell)
            || UNITS_IN_ROWS.contains(&cell.to_lowercase().as_str())
    };
    let units = filled.iter().filter(is_one).count();
    units > 0 && units == filled.len() || units > 1 && 2 * units > filled.len()
}

fn in_brackets(text: &str) -> Option<&str> {
    let inner = |open, close| text.strip_prefix(open)?.strip_suffix(close);
    inner('[', ']').or_else(|| inner('(', ')'))
}

/// Adds a unit to a name that has none.
pub fn add_unit(name: &mut String, unit: &str) {
    let unit = in_brackets(unit).unwrap_or(unit).trim();
    if !unit.is_empty() && !is_missing(unit) && unit::of_column(name).is_none() {
        name.push_str(&format!(" [{unit}]"));
    }
}

/// Most columns before groups of columns: an index and a time.
const MOST_SHARED: usize = 2;

/// Labels of stages of one measurement, which are no records.
const STAGES: [&str; 12] = [
    "raw",
    "adjusted",
    "corrected",
    "filtered",
    "calibrated",
    "command",
    "feedback",
    "reference",
    "target",
    "actual",
    "measured",
    "model",
];

/// Groups of columns whose names have the number of the group: `H1 (Oe)`, `M1 (emu)`, `H2 (Oe)`, `M2 (emu)`.
fn numbered_groups(names: &[String]) -> Option<ColumnGroups> {
    let parts: Vec<(String, Option<usize>)> = names.iter().map(|name| without_number(name)).collect();
    let shared = parts.iter().take_while(|(_, number)| number.is_none()).count();
    let width = parts[shared..].iter().take_while(|(_, number)| *number == Some(1)).count();
    let is_of_group =
        |(place, (_, number)): (usize, &(String, Option<usize>))| *number == Some(1 + place / width.max(1));
    if shared > MOST_SHARED || width < 2 || !parts[shared..].iter().enumerate().all(is_of_group) {
        return None;
    }
    let bare: Vec<String> = parts.into_iter().map(|(name, _)| name).collect();
    column_groups(&bare, None)
}

/// A name without the number at the end of its quantity, and that number.
fn without_number(name: &str) -> (String, Option<usize>) {
    let quantity = unit::split(name).0;
    let bare = quantity.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let number = quantity[bare.len()..].parse().ok();
    let bare = bare.trim_end_matches(['_', '-', ' ', '#']);
    match number {
        Some(_) if !bare.is_empty() => (format!("{bare}{}", &name.trim()[quantity.len()..]), number),
        _ => (name.to_string(), None),
    }
}

/// Groups of columns with equal names, at least two besides time in each; the line above may have their labels.
fn column_groups(names: &[String], above: Option<&[String]>) -> Option<ColumnGroups> {
    for shared in 0..=MOST_SHARED.min(names.len()) {
        let own = &names[shared..];
        let Some(width) = own.iter().skip(1).position(|name| *name == own[0]).map(|place| place + 1) else {
            continue;
        };
        let group = &own[..width];
        let others = group.iter().filter(|name| !unit::may_be_time(name)).count();
        let is_repeated = own.len().is_multiple_of(width) && own.chunks(width).all(|other| other == group);
        if !is_repeated || others < 2 || !are_distinct(&names[..shared + width]) {
            continue;
        }
        let count = own.len() / width;
        let labels: Vec<String> = match above {
            Some(above) => above[shared..].iter().step_by(width).cloned().collect(),
            None => Vec::new(),
        };
        if labels.iter().any(|label| is_stage(label)) {
            return None;
        }
        let is_labelled =
            !labels.is_empty() && are_distinct(&labels) && labels.iter().all(|label| is_name(label));
        let numbered = || (1..=count).map(|number| number.to_string()).collect();
        let labels = if is_labelled { labels } else { numbered() };
        return Some(ColumnGroups { shared, names: distinct(names[..shared + width].to_vec()), labels });
    }
    None
}

fn are_distinct(names: &[String]) -> bool {
    let mut seen = HashSet::new();
    names.iter().all(|name| seen.insert(name))
}

/// Each name behind the one above it; an empty cell above stands for the one to its left.
fn joined(above: &[String], names: &[String]) -> Vec<String> {
    let mut group = "";
    let both = above.iter().zip(names).map(|(above, name)| {
        group = if above.is_empty() { group } else { above };
        format!("{group} {name}").trim().to_string()
    });
    both.collect()
}

/// Names of which none is empty and no two are equal.
pub fn distinct(names: Vec<String>) -> Vec<String> {
    let mut seen: HashSet<String> = HashSet::new();
    // The next number of a name, so that many equal names cost no more than others.
    let mut next: HashMap<String, usize> = HashMap::new();
    let mut all = Vec::with_capacity(names.len());
    for (place, name) in names.into_iter().enumerate() {
        let name = if name.is_empty() { format!("c{}", place + 1) } else { name };
        let mut free = name.clone();
        let count = next.entry(name.clone()).or_insert(2);
        while !seen.insert(free.clone()) {
            free = format!("{name} ({count})");
            *count += 1;
        }
        all.push(free);
    }
    all
}

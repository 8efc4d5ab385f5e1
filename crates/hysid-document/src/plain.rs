//! Documents as plain text for a terminal: paragraphs wrapped to its width, tables with aligned columns, no charts.

use crate::part::{Card, Part};
use crate::table::{Cell, Table};
use crate::visible::{clipped, visible};

/// Number of characters in a line.
pub const WIDTH: usize = 80;

/// Gap between two columns of a table.
const GAP: &str = "  ";

/// A longer word is the name of a column or a record: it is cut.
const LONGEST_WORD: usize = 300;

/// The parts as text, separated by empty lines.
pub fn rendered(parts: &[Part]) -> String {
    blocks(parts).join("\n\n") + "\n"
}

fn blocks(parts: &[Part]) -> Vec<String> {
    parts.iter().flat_map(block).collect()
}

/// A part, and what is in it, without empty lines at the ends.
fn block(part: &Part) -> Vec<String> {
    let below = |heading: &str, parts: &[Part]| [vec![visible(heading).into_owned()], blocks(parts)].concat();
    match part {
        Part::Section(_, parts) if parts.is_empty() => Vec::new(),
        Part::Section(heading, parts) | Part::Folded(heading, parts) => below(heading, parts),
        Part::Heading(text) => vec![visible(&text.plain()).into_owned()],
        Part::Lead(text) | Part::Paragraph(text) | Part::Note(text) => vec![paragraph(&text.plain())],
        Part::Command(command) => vec![format!("  {}", visible(command))],
        Part::List(_) | Part::Contents(_) | Part::Verdicts(_) | Part::Definitions(_) => {
            let items = part.items().into_iter().map(|item| paragraph(&format!("- {}", item.plain())));
            vec![items.collect::<Vec<String>>().join("\n")]
        }
        Part::Table(content) => vec![table(content)],
        Part::Chart(_) | Part::Charts(_) => Vec::new(),
        Part::Columns(columns) => columns.iter().flat_map(|parts| blocks(parts)).collect(),
        Part::Cards(cards) => {
            let card = |card: &Card| below(&card.heading.plain(), &card.parts);
            cards.iter().flat_map(card).collect()
        }
    }
}

fn paragraph(text: &str) -> String {
    wrapped(text, WIDTH).join("\n")
}

/// A table in aligned columns below its heading.
fn table(table: &Table) -> String {
    let heading = match table.heading.as_str() {
        "" => Vec::new(),
        heading => wrapped(&format!("{heading}."), WIDTH),
    };
    let rows = fitted(&rows(table, Cell::shown));
    heading.into_iter().chain(aligned(&rows)).collect::<Vec<String>>().join("\n")
}

/// The rows of a table in [`WIDTH`] characters, as far as the words of its cells allow: a cell that is too long
/// continues in the next row.
fn fitted(rows: &[Vec<String>]) -> Vec<Vec<String>> {
    let mut widths = column_widths(rows, letters);
    let narrowest = column_widths(rows, |cell| cell.split(' ').map(letters).max().unwrap_or(0));
    let room = WIDTH.saturating_sub(GAP.len() * widths.len().saturating_sub(1));
    while widths.iter().sum::<usize>() > room {
        let shrinkable = (0..widths.len()).filter(|&column| widths[column] > narrowest[column]);
        let Some(column) = shrinkable.max_by_key(|&column| widths[column]) else { break };
        widths[column] -= 1;
    }
    rows.iter().flat_map(|row| broken(row, &widths)).collect()
}

/// A row as rows whose cells have at most these widths.
fn broken(row: &[String], widths: &[usize]) -> Vec<Vec<String>> {
    let cells: Vec<Vec<String>> = row.iter().zip(widths).map(|(cell, &width)| wrapped(cell, width)).collect();
    let lines = cells.iter().map(Vec::len).max().unwrap_or(0);
    let cell = |line: usize, cell: &Vec<String>| cell.get(line).cloned().unwrap_or_default();
    (0..lines).map(|line| cells.iter().map(|it| cell(line, it)).collect()).collect()
}

/// The lines of a table without its heading; `shown` gives the text of a cell.
pub fn columns(table: &Table, shown: impl Fn(&Cell) -> String) -> Vec<String> {
    aligned(&rows(table, shown))
}

/// The headings of the columns, then the cells.
fn rows(table: &Table, shown: impl Fn(&Cell) -> String) -> Vec<Vec<String>> {
    let rows = table.rows.iter().map(|row| row.iter().map(&shown).collect());
    std::iter::once(table.columns.clone()).chain(rows).collect()
}

/// The largest measure of a cell in each column.
fn column_widths(rows: &[Vec<String>], measure: impl Fn(&str) -> usize) -> Vec<usize> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let of = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|cell| measure(cell)).max();
    (0..columns).map(|column| of(column).unwrap_or(0)).collect()
}

/// Number of letters as a terminal shows them.
fn letters(text: &str) -> usize {
    visible(text).chars().count()
}

/// The words of a text in lines of at most `width` characters; a longer word has a line of its own. Control
/// characters are made visible.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let word = if word.len() > LONGEST_WORD { clipped(word) } else { visible(word) };
        let line = lines.last_mut().expect("there is a line");
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > width {
            lines.push(word.into_owned());
        } else {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(&word);
        }
    }
    lines
}

/// The words of a text in lines of [`WIDTH`] characters, of which the first `indent` are blank, also in the
/// first line.
pub fn indented(text: &str, indent: usize) -> String {
    wrapped(text, WIDTH - indent).iter().map(|line| format!("{:indent$}{line}\n", "")).collect()
}

/// Rows of a table as lines: columns as wide as their longest cell, the first aligned left, the others right.
/// Control characters are made visible.
pub fn aligned(rows: &[Vec<String>]) -> Vec<String> {
    let visible_cells = |row: &Vec<String>| row.iter().map(|cell| visible(cell).into_owned()).collect();
    let rows: Vec<Vec<String>> = rows.iter().map(visible_cells).collect();
    let widths = column_widths(&rows, letters);
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate();
        let cells: Vec<String> = cells
            .map(|(column, (cell, &width))| match column {
                0 => format!("{cell:<width$}"),
                _ => format!("{cell:>width$}"),
            })
            .collect();
        cells.join(GAP).trim_end().to_string()
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_fill_lines_and_long_ones_stand_alone() {
        assert_eq!(wrapped("one two three", 7), ["one two", "three"]);
        assert_eq!(wrapped("a incomprehensible b", 5), ["a", "incomprehensible", "b"]);
        assert_eq!(wrapped("µµµ µµµ", 7), ["µµµ µµµ"], "letters count, not bytes");
        assert_eq!(wrapped("", 5), [""]);
        assert_eq!(indented("one two", 75), format!("{0}one\n{0}two\n", " ".repeat(75)));
    }

    #[test]
    fn columns_are_aligned_and_short_rows_end_early() {
        let rows = [vec!["a", "1.5"], vec!["long", "12"], vec!["b"]];
        let rows = rows.map(|row| row.into_iter().map(String::from).collect());
        assert_eq!(aligned(&rows), ["a     1.5", "long   12", "b"]);
    }

    #[test]
    fn a_table_that_is_too_wide_is_broken_between_words() {
        let words = ["word"; 9].join(" ");
        let mut wide = Table::new(["model", &words, "error"]);
        wide.push(["one".into(), words.as_str().into(), "0.159 to 0.164 or as much as that".into()]);
        wide.push(["two".into(), "µ".into(), "1".into()]);
        let text = table(&wide);
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert_eq!(text.matches("word").count(), 18, "{text}");
        assert!(text.lines().last().unwrap().starts_with("two"), "{text}");
        // What fits is left as it is, and a word is never broken.
        assert_eq!(fitted(&[vec!["a b".to_string()]]), [["a b"]]);
        let long = "x".repeat(WIDTH + 1);
        let broken = fitted(&[vec!["a b".to_string(), long.clone()]]);
        assert_eq!(broken, [["a".to_string(), long], ["b".into(), "".into()]]);
    }
}

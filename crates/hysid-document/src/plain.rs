//! Documents as plain text for a terminal: paragraphs wrapped to its width, tables with aligned columns, no charts.

use crate::part::{Card, Part};
use crate::table::{Cell, Table};
use crate::visible::{clipped, visible};

/// Number of characters in a line.
pub const WIDTH: usize = 80;

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
    heading.into_iter().chain(columns(table, Cell::shown)).collect::<Vec<String>>().join("\n")
}

/// The lines of a table without its heading; `shown` gives the text of a cell.
pub fn columns(table: &Table, shown: impl Fn(&Cell) -> String) -> Vec<String> {
    let rows = table.rows.iter().map(|row| row.iter().map(&shown).collect());
    aligned(&std::iter::once(table.columns.clone()).chain(rows).collect::<Vec<_>>())
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
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let letters = |row: &Vec<String>, column: usize| row.get(column).map_or(0, |cell| cell.chars().count());
    let widths: Vec<usize> =
        (0..columns).map(|column| rows.iter().map(|row| letters(row, column)).max().unwrap_or(0)).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate();
        let cells: Vec<String> = cells
            .map(|(column, (cell, &width))| match column {
                0 => format!("{cell:<width$}"),
                _ => format!("{cell:>width$}"),
            })
            .collect();
        cells.join("  ").trim_end().to_string()
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
}

//! Chapters as HTML, Markdown, CSV and plain text.

use super::{Cell, Chapter, Part, Table, targets};
use crate::lines::{WIDTH, aligned, wrapped};
use crate::page;

/// A page of one chapter, or of several with a table of targets before them. `made` says when and by what.
pub fn html(title: &str, made: &str, chapters: &[Chapter]) -> String {
    let mut content = match chapters {
        [chapter] => page::verdict(&chapter.verdict),
        _ => String::new(),
    };
    content += &page::note(made);
    if let Some(targets) = targets(chapters) {
        content += &page::section("Targets", &table_html(&targets));
    }
    for chapter in chapters {
        let heading = match chapters {
            [_] => "Results".to_string(),
            _ => format!("{}: {}", chapter.name, chapter.title),
        };
        let mut parts = match chapters {
            [_] => String::new(),
            _ => page::verdict(&chapter.verdict),
        };
        parts.extend(chapter.parts.iter().map(part_html));
        content += &page::section(&heading, &parts);
    }
    page::whole(title, &content)
}

fn part_html(part: &Part) -> String {
    match part {
        Part::Heading(text) => page::subheading(text),
        Part::Paragraph(text) => page::paragraph(text),
        Part::Note(text) => page::note(text),
        Part::Table(table) => table_html(table),
        Part::Figure(svg) => page::figure(svg, true),
        Part::Figures(drawings) => {
            page::small_figures(&drawings.iter().map(String::as_str).collect::<Vec<_>>())
        }
    }
}

fn table_html(table: &Table) -> String {
    let rows: Vec<Vec<String>> = table.rows.iter().map(|row| row.iter().map(Cell::shown).collect()).collect();
    page::note(&format!("{}.", table.heading)) + &page::table(&table.columns, &rows)
}

/// The same as Markdown, without the figures.
pub fn markdown(title: &str, made: &str, chapters: &[Chapter]) -> String {
    let mut text = format!("# {title}\n\n{made}\n\n");
    if let Some(targets) = targets(chapters) {
        text += &format!("## Targets\n\n{}", table_markdown(&targets));
    }
    for chapter in chapters {
        text += &format!("## {}: {}\n\n{}\n\n", chapter.name, chapter.title, chapter.verdict);
        for part in &chapter.parts {
            text += &match part {
                Part::Heading(text) => format!("### {text}\n\n"),
                Part::Paragraph(text) | Part::Note(text) => format!("{text}\n\n"),
                Part::Table(table) => table_markdown(table),
                Part::Figure(_) | Part::Figures(_) => String::new(),
            };
        }
    }
    without_tags(&text).trim_end().to_string() + "\n"
}

/// Markdown lets HTML through: what would begin a tag is plain text.
fn without_tags(text: &str) -> String {
    let mut pieces = text.split('<');
    let first = pieces.next().unwrap_or_default().to_string();
    pieces.fold(first, |text, piece| {
        let is_tag = piece.starts_with(|letter: char| letter.is_ascii_alphabetic() || "/!?".contains(letter));
        text + if is_tag { "\\<" } else { "<" } + piece
    })
}

fn table_markdown(table: &Table) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | ").replace('\n', " "));
    let mut text = format!("{}.\n\n", table.heading) + &line(&table.columns);
    text += &format!("|---|{}\n", "---:|".repeat(table.columns.len() - 1));
    for row in &table.rows {
        let cells: Vec<String> = row.iter().map(|cell| cell.shown().replace('|', "\\|")).collect();
        text += &line(&cells);
    }
    text + "\n"
}

/// Header line of [`csv`].
pub const CSV_HEADER: &str = "experiment,table,row,column,value\n";

/// All tables, a line for each cell, numbers with all their digits.
pub fn csv(chapters: &[Chapter]) -> String {
    let mut text = String::from(CSV_HEADER);
    let mut add = |name: &str, table: &Table| {
        for row in &table.rows {
            let heading = row.first().map(Cell::shown).unwrap_or_default();
            for (column, cell) in table.columns.iter().zip(row).skip(1) {
                let value = match cell {
                    Cell::Number(value) => value.to_string(),
                    Cell::Words(words) => words.clone(),
                };
                let line = [name, &table.heading, &heading, column, &value].map(quoted);
                text += &(line.join(",") + "\n");
            }
        }
    };
    for chapter in chapters {
        for part in &chapter.parts {
            if let Part::Table(table) = part {
                add(&chapter.name, table);
            }
        }
        if let Some(targets) = targets(std::slice::from_ref(chapter)) {
            // Specimen and figure together tell the rows of this table apart.
            let row = |row: &Vec<Cell>| {
                let heading = format!("{}: {}", row[0].shown(), row[1].shown()).into();
                std::iter::once(heading).chain(row[2..].iter().cloned()).collect()
            };
            let rows = targets.rows.iter().map(row).collect();
            add(&chapter.name, &Table { columns: targets.columns[1..].to_vec(), rows, ..targets });
        }
    }
    text
}

/// A field of CSV.
fn quoted(field: &str) -> String {
    match field.contains([',', '"', '\n']) {
        true => format!("\"{}\"", field.replace('"', "\"\"")),
        false => field.to_string(),
    }
}

/// A chapter as plain text: verdict, tables and targets.
pub fn text(chapter: &Chapter) -> String {
    let mut paragraphs = vec![chapter.title.clone()];
    for part in &chapter.parts {
        match part {
            Part::Table(table) => paragraphs.push(table_text(table)),
            Part::Heading(text) => paragraphs.push(text.clone()),
            Part::Paragraph(_) | Part::Note(_) | Part::Figure(_) | Part::Figures(_) => {}
        }
    }
    paragraphs.extend(targets(std::slice::from_ref(chapter)).as_ref().map(table_text));
    paragraphs.push(wrapped(&chapter.verdict, WIDTH).join("\n"));
    paragraphs.join("\n\n") + "\n"
}

/// A table in aligned columns below its heading.
pub fn table_text(table: &Table) -> String {
    let shown = table.rows.iter().map(|row| row.iter().map(Cell::shown).collect());
    let lines: Vec<Vec<String>> = std::iter::once(table.columns.clone()).chain(shown).collect();
    let heading = wrapped(&format!("{}.", table.heading), WIDTH);
    heading.into_iter().chain(aligned(&lines)).collect::<Vec<String>>().join("\n")
}

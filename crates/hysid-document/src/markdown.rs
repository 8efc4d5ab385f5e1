//! Documents as Markdown. Charts are left out.

use crate::part::{Card, Page, Part, anchor};
use crate::table::{Cell, Table};
use crate::text::{Piece, Text};

pub fn page(page: &Page) -> String {
    let text = format!("# {}\n\n{}", page.title, parts(&page.parts));
    without_tags(&text).trim_end().to_string() + "\n"
}

fn parts(parts: &[Part]) -> String {
    parts.iter().map(part).collect()
}

fn part(part: &Part) -> String {
    match part {
        Part::Section(heading, content) => format!("## {heading}\n\n{}", parts(content)),
        Part::Contents(headings) => {
            let entry = |heading: &String| format!("- [{heading}](#{})\n", anchor(heading));
            headings.iter().map(entry).collect::<String>() + "\n"
        }
        Part::Heading(heading) => format!("### {}\n\n", text(heading)),
        Part::Lead(words) | Part::Paragraph(words) | Part::Note(words) => format!("{}\n\n", text(words)),
        Part::Command(command) => format!("```\n{command}\n```\n\n"),
        Part::List(_) | Part::Verdicts(_) | Part::Definitions(_) => {
            part.items().iter().map(|item| format!("- {}\n", text(item))).collect::<String>() + "\n"
        }
        Part::Table(content) => table(content),
        Part::Chart(_) | Part::Charts(_) => String::new(),
        Part::Columns(columns) => columns.iter().map(|column| parts(column)).collect(),
        Part::Cards(cards) => cards.iter().map(card).collect(),
        Part::Folded(summary, content) => format!("### {summary}\n\n{}", parts(content)),
    }
}

fn card(card: &Card) -> String {
    format!("### {}\n\n{}", text(&card.heading), parts(&card.parts))
}

fn text(text: &Text) -> String {
    let piece = |piece: &Piece| match piece {
        Piece::Code(code) => format!("`{code}`"),
        Piece::Strong(text) | Piece::Badge(_, text) => format!("**{text}**"),
        plain => plain.text().to_string(),
    };
    text.0.iter().map(piece).collect()
}

fn table(table: &Table) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | ").replace('\n', " "));
    let heading = if table.heading.is_empty() { String::new() } else { format!("{}.\n\n", table.heading) };
    let mut text = heading + &line(&table.columns);
    text += &format!("|---|{}\n", "---:|".repeat(table.columns.len().saturating_sub(1)));
    for row in &table.rows {
        let cells: Vec<String> = row.iter().map(Cell::shown).map(|cell| cell.replace('|', "\\|")).collect();
        text += &line(&cells);
    }
    text + "\n"
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

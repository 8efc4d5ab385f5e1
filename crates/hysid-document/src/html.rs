//! Documents as self-contained HTML pages.

mod contents;

use crate::chart::{self, Chart};
use crate::escape::escape;
use crate::part::{Card, Item, Page, Part, anchor};
use crate::table::{Cell, Table};
use crate::text::{Badge, Piece, Text};

const STYLE: &str = include_str!("html/style.css");

/// A table of so many columns fits a narrow screen.
const NARROW_COLUMNS: usize = 3;

/// A table of so many rows fits a printed page, and is not split.
const ROWS_OF_A_PAGE: usize = 25;

/// Script by which figures react to pointer and keys. A page is complete without it.
const SCRIPT: &str = concat!("\n", include_str!("html/page.js"));

/// Beginning of a page without a mark of the program that wrote it.
pub const BEGINNING: &str = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">";

/// The whole page. `beginning` is its HTML up to the inside of the head; it may contain a mark by which a
/// program recognizes its own files.
pub fn page(page: &Page, beginning: &str) -> String {
    let title = escape(&page.title);
    format!(
        "{beginning}\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{title}</title>\n<style>\n{STYLE}{}</style>\n</head>\n<body>\n<main>\n\
         <h1>{title}</h1>\n{}</main>\n{}</body>\n</html>\n",
        chart::style(),
        content(&page.parts),
        if page.parts.iter().any(|part| !part.charts().is_empty()) { script() } else { String::new() },
    )
}

/// The parts of a page by themselves, for another page that has their [`style`].
pub fn parts(parts: &[Part]) -> String {
    parts.iter().map(part).collect()
}

/// The style sheet of parts inside elements that a selector chooses, for another page.
pub fn style(selector: &str) -> String {
    // The first rules define the colours and the page.
    let (colours, rest) = STYLE.split_once("* {").expect("the style sheet has rules for all elements");
    format!("{colours}{}\n{selector} {{\n* {{{rest}}}\n", chart::style())
}

fn script() -> String {
    format!("<script>{SCRIPT}</script>\n")
}

/// The content of the one element `script` that a page may have, for a policy that allows no other.
pub fn script_of_pages() -> &'static str {
    SCRIPT
}

/// The parts, with a table of contents before the sections of a long page that has none.
fn content(all: &[Part]) -> String {
    let contents = contents::of(all);
    let before = all.iter().position(|part| matches!(part, Part::Section(..))).unwrap_or(all.len());
    let (lead, sections) = all.split_at(before);
    format!("{}{}{}", parts(lead), contents.as_ref().map_or_else(String::new, part), parts(sections))
}

fn part(part: &Part) -> String {
    match part {
        Part::Lead(words) => format!("<p class=\"verdict\">{}</p>\n", text(words)),
        Part::Section(_, content) if content.is_empty() => String::new(),
        Part::Section(heading, content) => {
            let id = escape(&anchor(heading));
            format!("<section id=\"{id}\">\n<h2>{}</h2>\n{}</section>\n", escape(heading), parts(content))
        }
        Part::Contents(headings) => {
            format!("<nav>\n<ul>\n{}</ul>\n</nav>\n", headings.iter().map(|it| entry(it)).collect::<String>())
        }
        Part::Heading(heading) => format!("<h3>{}</h3>\n", text(heading)),
        Part::Paragraph(words) => format!("<p>{}</p>\n", text(words)),
        Part::Note(words) => note(&text(words)),
        Part::Command(command) => format!("<pre tabindex=\"0\"><code>{}</code></pre>\n", escape(command)),
        Part::List(items) => format!("<ul>\n{}</ul>\n", items.iter().map(item).collect::<String>()),
        Part::Verdicts(verdicts) => {
            let items: String =
                verdicts.iter().map(|verdict| format!("<li>{}</li>\n", text(verdict))).collect();
            format!("<ul class=\"verdicts\">\n{items}</ul>\n")
        }
        Part::Definitions(pairs) => {
            format!("<dl>\n{}</dl>\n", pairs.iter().map(definition).collect::<String>())
        }
        Part::Table(content) => table(content),
        Part::Chart(chart) if chart.is_wide() => figure(chart, "class=\"wide scroll\" tabindex=\"0\""),
        Part::Chart(chart) => charts("charts", std::slice::from_ref(chart)),
        Part::Charts(content) => charts("charts small", content),
        Part::Cards(cards) => {
            format!("<div class=\"cards\">\n{}</div>\n", cards.iter().map(card).collect::<String>())
        }
        Part::Columns(columns) => {
            let column = |content: &Vec<Part>| format!("<div>\n{}</div>\n", parts(content));
            format!("<div class=\"columns\">\n{}</div>\n", columns.iter().map(column).collect::<String>())
        }
        Part::Folded(summary, content) => {
            format!("<details>\n<summary>{}</summary>\n{}</details>\n", escape(summary), parts(content))
        }
    }
}

fn text(text: &Text) -> String {
    text.0.iter().map(piece).collect()
}

fn piece(piece: &Piece) -> String {
    let text = escape(piece.text());
    match piece {
        Piece::Plain(_) => text,
        Piece::Code(_) => format!("<code>{text}</code>"),
        Piece::Strong(_) => format!("<strong>{text}</strong>"),
        Piece::Aside(_) => format!("<small>{text}</small>"),
        Piece::Link { anchor, .. } => format!("<a href=\"#{}\">{text}</a>", escape(anchor)),
        Piece::Badge(badge, _) => {
            let class = match badge {
                Badge::Yes => "yes",
                Badge::No => "no",
                Badge::Unknown => "untold",
            };
            format!("<span class=\"badge {class}\">{text}</span>")
        }
    }
}

/// A remark; `content` is HTML.
fn note(content: &str) -> String {
    format!("<p class=\"note\">{content}</p>\n")
}

fn item(item: &Item) -> String {
    let class = if item.is_warning { " class=\"warnings\"" } else { "" };
    format!("<li{class}>{}</li>\n", text(&item.text))
}

/// A line of a table of contents.
fn entry(heading: &str) -> String {
    format!("<li><a href=\"#{}\">{}</a></li>\n", escape(&anchor(heading)), escape(heading))
}

fn definition((name, value): &(String, String)) -> String {
    format!("<dt>{}</dt><dd>{}</dd>\n", escape(name), escape(value))
}

fn card(card: &Card) -> String {
    format!(
        "<article class=\"card\" id=\"{}\">\n<h3>{}</h3>\n{}</article>\n",
        escape(&card.anchor),
        text(&card.heading),
        parts(&card.parts)
    )
}

fn figure(chart: &Chart, attributes: &str) -> String {
    format!("<figure {attributes}>{}</figure>\n", chart.svg())
}

fn charts(class: &str, charts: &[Chart]) -> String {
    let charts: String = charts.iter().map(|chart| figure(chart, "class=\"chart\"")).collect();
    format!("<div class=\"{class}\">\n{charts}</div>\n")
}

fn table(table: &Table) -> String {
    let heading =
        if table.heading.is_empty() { String::new() } else { note(&format!("{}.", escape(&table.heading))) };
    let of_words: Vec<bool> = (0..table.columns.len()).map(|column| table.is_of_words(column)).collect();
    let cell = |(cell, &is_of_words): (&String, &bool)| {
        format!("<th scope=\"col\"{}>{}</th>", alignment(is_of_words), escape(cell))
    };
    let head: String = table.columns.iter().zip(&of_words).map(cell).collect();
    let body: String = table.rows.iter().map(|row| table_row(row, &table.columns, &of_words)).collect();
    // On a narrow screen, each row of a wide table becomes a list with the names of the columns.
    let class = if table.columns.len() > NARROW_COLUMNS { " class=\"many\"" } else { "" };
    let whole = if table.rows.len() <= ROWS_OF_A_PAGE { " whole" } else { "" };
    format!(
        "{heading}<div class=\"scroll{whole}\" role=\"region\" aria-label=\"table\" tabindex=\"0\"><table{class}>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table></div>\n"
    )
}

/// Words begin at the left, numbers end at the right.
fn alignment(is_of_words: bool) -> &'static str {
    if is_of_words { " class=\"text\"" } else { "" }
}

/// A row; if it has fewer cells than the table has columns, its last one goes over all that are left.
fn table_row(cells: &[Cell], columns: &[String], of_words: &[bool]) -> String {
    let mut row = String::from("<tr>");
    for (index, cell) in cells.iter().enumerate() {
        let cell = escape(&cell.shown());
        let class = alignment(of_words.get(index).copied().unwrap_or(false));
        row += &match index {
            0 => format!("<th scope=\"row\">{cell}</th>"),
            last if last + 1 == cells.len() && cells.len() < columns.len() => {
                format!("<td class=\"words\" colspan=\"{}\">{cell}</td>", columns.len() - last)
            }
            _ if columns.len() > NARROW_COLUMNS && !cell.is_empty() => {
                format!("<td{class} data-column=\"{}\">{cell}</td>", escape(&columns[index]))
            }
            _ => format!("<td{class}>{cell}</td>"),
        };
    }
    row + "</tr>\n"
}

#[cfg(test)]
mod tests;

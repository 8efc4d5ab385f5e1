//! Pages of HTML that need nothing but themselves, and their pieces. Cells and headings come in as text and are escaped here.

use hysid::significant::Significant;
use hysid_files::PAGE_MARK;

use crate::plot::{self, escape};

const STYLE: &str = include_str!("page/style.css");

/// A whole page; `content` is HTML.
pub fn whole(title: &str, content: &str) -> String {
    let title = escape(title);
    format!(
        "{PAGE_MARK}{}\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{title}</title>\n<style>\n{STYLE}{}</style>\n</head>\n<body>\n<main>\n\
         <h1>{title}</h1>\n{content}</main>\n</body>\n</html>\n",
        env!("CARGO_PKG_VERSION"),
        plot::STYLE,
    )
}

/// The sentence that a reader should take away.
pub fn verdict(text: &str) -> String {
    format!("<p class=\"verdict\">{}</p>\n", escape(text))
}

/// A section with its heading; none without content. `content` is HTML.
pub fn section(heading: &str, content: &str) -> String {
    match content.is_empty() {
        true => String::new(),
        false => format!("<section>\n<h2>{}</h2>\n{content}</section>\n", escape(heading)),
    }
}

/// A heading within a section.
pub fn subheading(text: &str) -> String {
    format!("<h3>{}</h3>\n", escape(text))
}

/// A paragraph of text.
pub fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escape(text))
}

/// A remark in smaller type.
pub fn note(text: &str) -> String {
    format!("<p class=\"note\">{}</p>\n", escape(text))
}

/// What is shown when it is asked for; `content` is HTML.
pub fn folded(summary: &str, content: &str) -> String {
    format!("<details>\n<summary>{}</summary>\n{content}</details>\n", escape(summary))
}

/// A table; the first cell of each row is its heading. A row that is cut short ends in words.
pub fn table(headings: &[String], rows: &[Vec<String>]) -> String {
    let head: String =
        headings.iter().map(|cell| format!("<th scope=\"col\">{}</th>", escape(cell))).collect();
    let body: String = rows.iter().map(|row| table_row(row, headings.len())).collect();
    format!(
        "<div class=\"scroll\" role=\"region\" aria-label=\"table\" tabindex=\"0\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table></div>\n"
    )
}

/// A row; if it has fewer cells than the table has columns, its last one goes over all that are left.
fn table_row(cells: &[String], columns: usize) -> String {
    let mut row = String::from("<tr>");
    for (index, cell) in cells.iter().enumerate() {
        let cell = escape(cell);
        row += &match index {
            0 => format!("<th scope=\"row\">{cell}</th>"),
            last if last + 1 == cells.len() && cells.len() < columns => {
                format!("<td class=\"words\" colspan=\"{}\">{cell}</td>", columns - last)
            }
            _ => format!("<td>{cell}</td>"),
        };
    }
    row + "</tr>\n"
}

/// Names and what they are.
pub fn definitions(pairs: &[(String, String)]) -> String {
    let pairs: String = pairs
        .iter()
        .map(|(name, value)| format!("<dt>{}</dt><dd>{}</dd>\n", escape(name), escape(value)))
        .collect();
    format!("<dl>\n{pairs}</dl>\n")
}

/// A drawing; `wide` for one that needs the width of the page.
pub fn figure(svg: &str, wide: bool) -> String {
    let attributes = if wide { "class=\"wide scroll\" tabindex=\"0\"" } else { "class=\"chart\"" };
    format!("<figure {attributes}>{svg}</figure>\n")
}

/// Small drawings side by side.
pub fn small_figures(drawings: &[&str]) -> String {
    let drawings: String = drawings.iter().map(|svg| figure(svg, false)).collect();
    format!("<div class=\"charts small\">\n{drawings}</div>\n")
}

/// A number with so many significant digits, with a true minus sign.
pub fn number(value: f64, digits: usize) -> String {
    format!("{:.*}", digits, Significant(value)).replace('-', "−")
}

/// A range in words.
pub fn span((low, high): (f64, f64)) -> String {
    format!("{} to {}", number(low, 4), number(high, 4))
}

/// `3 records`, `1 record`.
pub fn count(n: usize, singular: &str) -> String {
    if n == 1 { format!("1 {singular}") } else { format!("{n} {singular}s") }
}

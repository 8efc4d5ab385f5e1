//! The table of contents of a long page.

use crate::part::Part;
use crate::table::Table;
use crate::text::Text;

/// A page longer than three screens, in pixels, has a table of contents.
const LONG: f64 = 3.0 * 900.0;

/// Fewest sections that are worth a table of contents.
const FEWEST: usize = 3;

/// Height of a line of text and of a row of a table, in pixels.
const LINE: f64 = 26.0;

/// Letters of a line of text.
const LETTERS: usize = 90;

/// The contents of a page, if it is long and has several sections but no contents of its own.
pub(super) fn of(parts: &[Part]) -> Option<Part> {
    let has_own = parts.iter().any(|part| matches!(part, Part::Contents(_)));
    let headings: Vec<String> = parts.iter().filter_map(heading).collect();
    let is_long = parts.iter().map(height).sum::<f64>() > LONG;
    (!has_own && is_long && headings.len() >= FEWEST).then_some(Part::Contents(headings))
}

fn heading(part: &Part) -> Option<String> {
    match part {
        Part::Section(heading, content) if !content.is_empty() => Some(heading.clone()),
        _ => None,
    }
}

/// About how high a part is on a page, in pixels.
fn height(part: &Part) -> f64 {
    let inside = |parts: &[Part]| parts.iter().map(height).sum::<f64>();
    let table = |table: &Table| LINE * (table.rows.len() + 2) as f64;
    match part {
        Part::Section(_, parts) => 3.0 * LINE + inside(parts),
        Part::Lead(words) | Part::Paragraph(words) | Part::Note(words) | Part::Heading(words) => lines(words),
        Part::Command(_) | Part::Folded(..) => 2.0 * LINE,
        Part::List(items) => items.iter().map(|item| lines(&item.text)).sum(),
        Part::Verdicts(verdicts) => verdicts.iter().map(lines).sum(),
        Part::Definitions(pairs) => LINE * pairs.len() as f64,
        Part::Contents(headings) => LINE * headings.len() as f64,
        Part::Table(content) => table(content),
        Part::Chart(chart) => chart.size.1,
        // Three small charts or two cards stand beside each other.
        Part::Charts(charts) => charts.iter().map(|chart| chart.size.1).sum::<f64>() / 3.0,
        Part::Columns(columns) => columns.iter().map(|column| inside(column)).fold(0.0, f64::max),
        Part::Cards(cards) => cards.iter().map(|card| inside(&card.parts)).sum::<f64>() / 2.0,
    }
}

fn lines(text: &Text) -> f64 {
    let letters: usize = text.0.iter().map(|piece| piece.text().chars().count()).sum();
    LINE * (1 + letters / LETTERS) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sections(count: usize, paragraphs: usize) -> Vec<Part> {
        let content = || vec![Part::paragraph("words"); paragraphs];
        (0..count).map(|number| Part::section(format!("Section {number}"), content())).collect()
    }

    #[test]
    fn only_long_pages_have_contents() {
        assert_eq!(of(&sections(4, 3)), None);
        let names = (0..4).map(|number| format!("Section {number}")).collect();
        assert_eq!(of(&sections(4, 40)), Some(Part::Contents(names)));
        assert_eq!(of(&sections(2, 400)), None);
        let with_own = [vec![Part::Contents(vec!["Section 1".into()])], sections(4, 40)].concat();
        assert_eq!(of(&with_own), None);
    }
}

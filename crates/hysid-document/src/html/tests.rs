use super::*;
use crate::balance::assert_balanced;
use crate::{Curve, Label, markdown, plain};

const HOSTILE: &str = "<script>alert(\"1\")</script> & 'more'\u{1b}";

/// A part of each kind with hostile text wherever there is text.
fn all_parts() -> Vec<Part> {
    let text = || Text::from(HOSTILE);
    let styled = text()
        .with(Piece::Code(HOSTILE.into()))
        .with(Piece::Strong(HOSTILE.into()))
        .with(Piece::Aside(HOSTILE.into()))
        .with(Piece::Link { anchor: HOSTILE.into(), text: HOSTILE.into() })
        .with(Piece::Badge(Badge::Unknown, HOSTILE.into()));
    let mut chart =
        Chart::new(HOSTILE, HOSTILE, HOSTILE, vec![Curve::dots([(0.0, 1.0)], crate::Colour::Error, 2.0)])
            .with_legend([(crate::Colour::Error, HOSTILE)]);
    chart.title = HOSTILE.into();
    chart.labels.push(Label { point: (0.0, 1.0), rise: 0.0, text: HOSTILE.into() });
    let mut table = Table::new([HOSTILE, "b", "c"]).headed(HOSTILE);
    table.push([HOSTILE.into(), Cell::Percent(-1.25, 2), Cell::Missing]);
    table.push([HOSTILE.into(), HOSTILE.into()]);
    let content = vec![
        Part::Lead(text()),
        Part::heading(styled.clone()),
        Part::paragraph(styled.clone()),
        Part::note(text()),
        Part::Command(HOSTILE.into()),
        Part::warnings(&[HOSTILE.to_string()]),
        Part::Verdicts(vec![styled]),
        Part::Definitions(vec![(HOSTILE.into(), HOSTILE.into())]),
        Part::Table(table),
        Part::chart(chart.clone()),
        Part::chart(chart.clone().sized(560.0, 400.0)),
        Part::Charts(vec![chart.clone(), chart]),
        Part::Columns(vec![vec![Part::paragraph(text())], vec![Part::note(text())]]),
    ];
    let card = Card { anchor: HOSTILE.into(), heading: text(), parts: content.clone() };
    vec![
        Part::Contents(vec![HOSTILE.into()]),
        Part::section(HOSTILE, content.clone()),
        Part::Cards(vec![card]),
        Part::Folded(HOSTILE.into(), content),
    ]
}

#[test]
fn whatever_a_part_says_is_text() {
    let page = page(&Page { title: HOSTILE.into(), parts: all_parts() }, BEGINNING);
    let (page, end) = page.split_once(&script()).expect("a page with figures has the script once");
    assert_eq!(end, "</body>\n</html>\n");
    assert!(!page.contains("<script") && !page.contains('\u{1b}') && page.contains("&lt;script&gt;"));
    let body = page.split("<body>").last().unwrap();
    assert_balanced(body);
    assert_eq!(page.matches("<svg class=\"plot\"").count(), 12);
}

/// A short table stays on one printed page, a long one is split between rows.
#[test]
fn a_table_that_fits_a_page_is_not_split() {
    let table = |rows: usize| {
        let rows = (0..rows).map(|row| vec![Cell::from(row)]);
        parts(&[Part::Table(Table::new(["row"]).with_rows(rows))])
    };
    assert!(table(ROWS_OF_A_PAGE).contains("class=\"scroll whole\""));
    assert!(table(ROWS_OF_A_PAGE + 1).contains("class=\"scroll\""));
    let print = STYLE.split("@media print").nth(1).unwrap();
    assert!(print.contains(".whole { break-inside: avoid; }"), "{print}");
}

#[test]
fn a_section_without_content_is_not_shown() {
    assert_eq!(parts(&[Part::section("Empty", [])]), "");
}

/// Every line of the contents leads to its section, in HTML and, as GitHub makes targets of headings, in Markdown.
#[test]
fn contents_lead_to_their_sections() {
    let heading = "example1: the paper's Example 1, 10_Hz";
    let document = Page {
        title: "Title".into(),
        parts: vec![
            Part::Contents(vec![heading.into()]),
            Part::section(heading, [Part::paragraph("content")]),
        ],
    };
    let target = "example1-the-papers-example-1-10_hz";
    let html = page(&document, BEGINNING);
    assert!(html.contains(&format!("<a href=\"#{target}\">")), "{html}");
    assert!(html.contains(&format!("<section id=\"{target}\">")), "{html}");
    let text = markdown::page(&document);
    assert!(text.contains(&format!("- [{heading}](#{target})\n")), "{text}");
    assert_eq!(plain::rendered(&document.parts[..1]), format!("- {heading}\n"));
}

#[test]
fn a_row_that_ends_early_ends_in_words() {
    let mut table = Table::new(["model", "error", "seconds"]);
    table.push(["pnn".into(), Cell::number(-0.5, 3), Cell::Missing]);
    table.push(["xpnn".into(), "needs the rate".into()]);
    let page = parts(&[Part::Table(table)]);
    assert!(page.contains("<th scope=\"row\">pnn</th><td>−0.5</td><td>–</td>"), "{page}");
    assert!(page.contains("<td class=\"words\" colspan=\"2\">needs the rate</td>"), "{page}");
}

#[test]
fn markdown_and_plain_text_have_every_part_but_charts() {
    let page = Page { title: "Title".into(), parts: all_parts() };
    let text = markdown::page(&page);
    assert!(text.starts_with("# Title\n\n- [") && text.contains("\n## ") && !text.contains("svg"), "{text}");
    assert!(!text.replace("\\<", "").contains("<script"), "{text}");
    let text = plain::rendered(&page.parts);
    assert!(text.contains("−1.2 %") && !text.contains('\u{1b}') && !text.contains("svg"), "{text}");
}

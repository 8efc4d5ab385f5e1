//! Chapters as documents and as CSV.

use anyhow::Result;
use hysid_document::{Cell, Item, Page, Part, Piece, Table, Text, capitalised};
use hysid_paper::{Chapter, ChapterTarget, targets};

/// Header line of [`csv`].
pub const CSV_HEADER: &str = "experiment,table,row,column,value\n";

/// A page of one chapter. `made` holds date and program.
pub fn page(made: Text, chapter: &Chapter) -> Page {
    let mut parts = vec![lead(chapter), Part::Note(made)];
    parts.extend(targets_sections(std::slice::from_ref(chapter)));
    parts.push(Part::section("Results", chapter.parts.as_slice()));
    Page { title: capitalised(&chapter.title), parts }
}

/// A page of all chapters, with a table of contents and tables of targets before them.
pub fn together(made: Text, chapters: &[Chapter]) -> Page {
    let mut sections = targets_sections(chapters);
    sections.extend(chapters.iter().map(|chapter| {
        let content = [&[lead(chapter)], chapter.parts.as_slice()].concat();
        Part::section(format!("{}: {}", chapter.name, chapter.title), content)
    }));
    let headings = sections.iter().filter_map(|part| match part {
        Part::Section(heading, _) => Some(heading.clone()),
        _ => None,
    });
    let mut parts = vec![Part::Note(made), Part::Contents(headings.collect())];
    parts.extend(sections);
    Page { title: "The paper reproduced".into(), parts }
}

fn lead(chapter: &Chapter) -> Part {
    Part::Lead(chapter.verdict.as_str().into())
}

/// The paper's claims, then Hysid's own targets.
fn targets_sections(chapters: &[Chapter]) -> Vec<Part> {
    let section = |(heading, of_paper): (&str, bool)| {
        targets(chapters, of_paper).map(|targets| Part::section(heading, [Part::Table(targets)]))
    };
    [("Claims of the paper", true), ("Targets of Hysid", false)].into_iter().filter_map(section).collect()
}

/// The targets as a terminal shows them, which has no room for their tables.
pub fn targets_list(chapters: &[Chapter]) -> Vec<Part> {
    let item = |(chapter, target): (&Chapter, &ChapterTarget)| {
        let several =
            target.several.as_ref().map_or(String::new(), |it| format!("; median of networks {it}"));
        let text = format!(
            "{}: {}, {}, {}: {} ({}), one network {}{several}",
            target.verdict.words(),
            chapter.name,
            target.specimen,
            target.figure,
            target.wanted,
            target.source.words(),
            target.one,
        );
        Item { text: text.into(), is_warning: false }
    };
    let all = chapters.iter().flat_map(|chapter| chapter.targets.iter().map(move |target| (chapter, target)));
    let items: Vec<Item> = all.map(item).collect();
    if items.is_empty() {
        return Vec::new();
    }
    let heading = "Targets: medians of the seeds, lowest to highest in brackets";
    vec![Part::heading(heading), Part::List(items)]
}

/// When, by what and how the chapters were made; `conditions` is what follows the command.
pub fn made(conditions: &str) -> Text {
    Text::from(concat!("Made by hysid ", env!("CARGO_PKG_VERSION"), ", "))
        .with(Piece::Code("hysid reproduce".into()))
        .with(Piece::Plain(conditions.into()))
}

/// Chapter in short, for a terminal: headings, tables and targets, then the verdict.
pub fn summary(chapter: &Chapter) -> Vec<Part> {
    let shown = chapter.parts.iter().filter(|part| matches!(part, Part::Table(_) | Part::Heading(_)));
    let targets = targets_list(std::slice::from_ref(chapter));
    let heading = Part::heading(chapter.title.as_str());
    std::iter::once(heading).chain(shown.cloned()).chain(targets).chain([lead(chapter)]).collect()
}

/// All tables, a line for each cell, numbers with all their digits.
pub fn csv(chapters: &[Chapter]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(CSV_HEADER.as_bytes().to_vec());
    for chapter in chapters {
        for table in chapter.parts.iter().flat_map(Part::tables) {
            write_table(&mut writer, &chapter.name, table)?;
        }
        let both = [true, false].map(|of_paper| targets(std::slice::from_ref(chapter), of_paper));
        for mut targets in both.into_iter().flatten() {
            // Specimen and figure together tell the rows of this table apart.
            targets.columns.remove(0);
            for row in &mut targets.rows {
                let specimen = row.remove(0);
                row[0] = format!("{}: {}", specimen.shown(), row[0].shown()).into();
            }
            write_table(&mut writer, &chapter.name, &targets)?;
        }
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

fn write_table(writer: &mut csv::Writer<Vec<u8>>, name: &str, table: &Table) -> Result<()> {
    for row in &table.rows {
        let heading = row.first().map(Cell::shown).unwrap_or_default();
        for (column, cell) in table.columns.iter().zip(row).skip(1) {
            let value = match cell {
                Cell::Number(value, _) | Cell::Percent(value, _) => value.to_string(),
                Cell::Text(_) | Cell::Missing => cell.shown(),
            };
            writer.write_record([name, &table.heading, &heading, column, &value])?;
        }
    }
    Ok(())
}

//! What an experiment comes to: a chapter of text, tables and figures, as data. It is stored as it is, and
//! page, Markdown, CSV and plain text are made of it.

mod rendering;

use serde::{Deserialize, Serialize};

pub use rendering::{CSV_HEADER, csv, html, markdown, table_text, text};

use hysid_files::Kind;

use super::Experiment;
use crate::page::number;
use crate::plot;

/// The result of an experiment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Chapter {
    /// Name of the experiment.
    pub name: String,
    /// Headline.
    pub title: String,
    /// What a reader should take away, in a sentence.
    pub verdict: String,
    /// Text, tables and figures in their order.
    pub parts: Vec<Part>,
    /// What was to be reached, and what was.
    pub targets: Vec<Target>,
    /// Further files, by name.
    pub files: Vec<(String, String)>,
}

/// A piece of a chapter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// A heading.
    Heading(String),
    /// A paragraph.
    Paragraph(String),
    /// A remark.
    Note(String),
    /// A table.
    Table(Table),
    /// A drawing over the width of the page, an `svg` element.
    Figure(String),
    /// Small drawings side by side.
    Figures(Vec<String>),
}

/// A table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// What the figures are of, and what stands in for the measured data.
    pub heading: String,
    /// Headings of the columns.
    pub columns: Vec<String>,
    /// Rows, each with a cell for every column; the first is the row's heading.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Cell {
    /// A number; the pages show three significant digits, CSV all.
    Number(f64),
    /// Words.
    Words(String),
}

/// A figure that was to be reached.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// The specimen.
    pub specimen: String,
    /// Which of its figures.
    pub figure: String,
    /// What was asked for.
    pub wanted: String,
    /// What was measured.
    pub measured: Cell,
    /// Was it reached?
    pub is_met: bool,
}

impl Chapter {
    /// True for a chapter as this experiment makes them. One that was stored may have been changed in its file, and
    /// drawings and names of files are used as they are.
    pub fn is_sound(&self, experiment: Experiment) -> bool {
        let drawings: Vec<&str> = self.parts.iter().flat_map(Part::drawings).collect();
        let is_file = |(name, content): &(String, String)| {
            let known = experiment.further_files().into_iter().find(|(known, _)| known == name);
            known.is_some_and(|(_, kind)| match kind {
                Kind::Drawing => drawings.iter().any(|drawing| plot::standalone(drawing) == *content),
                Kind::Beginning(header) => content.as_bytes().starts_with(&header),
                _ => false,
            })
        };
        self.name == experiment.name()
            && self.parts.iter().all(Part::is_sound)
            && drawings.iter().all(|drawing| plot::is_drawing(drawing))
            && self.files.iter().all(is_file)
    }
}

impl Part {
    fn drawings(&self) -> Vec<&str> {
        match self {
            Part::Figure(svg) => vec![svg],
            Part::Figures(drawings) => drawings.iter().map(String::as_str).collect(),
            _ => Vec::new(),
        }
    }

    fn is_sound(&self) -> bool {
        match self {
            Part::Table(table) => {
                !table.columns.is_empty() && table.rows.iter().all(|row| row.len() == table.columns.len())
            }
            _ => true,
        }
    }
}

impl Cell {
    /// As the pages show it.
    pub fn shown(&self) -> String {
        match self {
            Cell::Number(value) => number(*value, 3),
            Cell::Words(words) => words.clone(),
        }
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        // What is stored must be a number.
        if value.is_finite() { Cell::Number(value) } else { Cell::Words("–".into()) }
    }
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        value.unwrap_or(f64::NAN).into()
    }
}

impl From<&str> for Cell {
    fn from(words: &str) -> Self {
        Cell::Words(words.into())
    }
}

impl From<String> for Cell {
    fn from(words: String) -> Self {
        Cell::Words(words)
    }
}

/// Begins the heading of every table whose figures are of a specimen.
pub fn stands_in(specimen: &str, of: &str) -> String {
    format!("Synthetic specimen {specimen} in the place of the paper's measured data ({of})")
}

/// The text with a large first letter.
pub fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The targets of all these chapters as a table; `None` if there are none.
pub fn targets(chapters: &[Chapter]) -> Option<Table> {
    let rows = chapters.iter().flat_map(|chapter| {
        chapter.targets.iter().map(|target| {
            let verdict = if target.is_met { "met" } else { "missed" };
            vec![
                format!("{}, {}", chapter.name, target.specimen).into(),
                target.figure.as_str().into(),
                target.wanted.as_str().into(),
                target.measured.clone(),
                verdict.into(),
            ]
        })
    });
    let rows: Vec<Vec<Cell>> = rows.collect();
    (!rows.is_empty()).then(|| Table {
        heading: "What was to be reached. Synthetic specimens stand in for the paper's measured data".into(),
        columns: ["experiment", "figure", "target", "measured", "verdict"].map(String::from).into(),
        rows,
    })
}

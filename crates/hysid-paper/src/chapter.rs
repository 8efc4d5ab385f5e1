//! What an experiment comes to: a chapter of text, tables and charts, as data.

use hysid_document::{Cell, Chart, Part, Table};
use serde::{Deserialize, Serialize};

/// The result of an experiment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Chapter {
    /// Name of the experiment.
    pub name: String,
    /// Headline.
    pub title: String,
    /// What a reader should take away, in a sentence.
    pub verdict: String,
    /// Text, tables and charts in their order.
    pub parts: Vec<Part>,
    /// What was to be reached, and what was.
    pub targets: Vec<Target>,
    /// Further files, by name.
    pub files: Vec<(String, Content)>,
}

/// What is in a further file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Content {
    /// A table as CSV.
    Text(String),
    /// A chart, to be drawn.
    Drawing(Box<Chart>),
}

/// A file that an experiment has beside its chapter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FurtherFile {
    /// Name of the file.
    pub name: &'static str,
    /// Header line of a table; `None` for a drawing.
    pub header: Option<&'static str>,
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

/// Begins the heading of every table whose figures are of a specimen.
pub fn stands_in(specimen: &str, of: &str) -> String {
    format!("Synthetic specimen {specimen} in place of the paper's measured data ({of})")
}

/// The targets of all these chapters as a table; `None` if there are none.
pub fn targets(chapters: &[Chapter]) -> Option<Table> {
    let mut table = Table::new(["experiment", "figure", "target", "measured", "verdict"])
        .headed("Targets and results. Synthetic specimens replace the paper's measured data");
    for chapter in chapters {
        for target in &chapter.targets {
            table.push([
                format!("{}, {}", chapter.name, target.specimen).into(),
                target.figure.as_str().into(),
                target.wanted.as_str().into(),
                target.measured.clone(),
                if target.is_met { "met".into() } else { "missed".into() },
            ]);
        }
    }
    (!table.rows.is_empty()).then_some(table)
}

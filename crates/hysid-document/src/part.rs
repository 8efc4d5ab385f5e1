//! Pages and their parts.

use crate::chart::Chart;
use crate::table::Table;
use crate::text::Text;

#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    pub title: String,
    pub parts: Vec<Part>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// The main message, in one sentence.
    Lead(Text),
    /// A section with its heading; a section without parts is not shown.
    Section(String, Vec<Part>),
    /// A table of contents: the headings of these sections of the page, each a link to it.
    Contents(Vec<String>),
    Heading(Text),
    Paragraph(Text),
    /// A remark in smaller type.
    Note(Text),
    Command(String),
    List(Vec<Item>),
    /// A list of results, each a badge, a link and a sentence.
    Verdicts(Vec<Text>),
    Definitions(Vec<(String, String)>),
    Table(Table),
    Chart(Box<Chart>),
    /// Small charts side by side.
    Charts(Vec<Chart>),
    Cards(Vec<Card>),
    /// Columns side by side, each of parts; on a narrow screen and in text, one below the other.
    Columns(Vec<Vec<Part>>),
    /// Parts that are hidden until the reader opens them, below a summary.
    Folded(String, Vec<Part>),
}

#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    pub text: Text,
    /// True for an item that is shown as a warning.
    pub is_warning: bool,
}

/// Parts in a frame, which can be the target of links.
#[derive(Debug, Clone, PartialEq)]
pub struct Card {
    /// Name of the card as the target of links.
    pub anchor: String,
    pub heading: Text,
    pub parts: Vec<Part>,
}

/// The target of links to a section, made of its heading as GitHub makes it of a heading in Markdown: small
/// letters and digits, hyphens for spaces, nothing else.
pub(crate) fn anchor(heading: &str) -> String {
    let letter = |letter: char| match letter {
        ' ' => Some('-'),
        '-' | '_' => Some(letter),
        letter => letter.is_alphanumeric().then_some(letter),
    };
    heading.to_lowercase().chars().filter_map(letter).collect()
}

impl Part {
    pub fn section(heading: impl Into<String>, parts: impl Into<Vec<Part>>) -> Self {
        Part::Section(heading.into(), parts.into())
    }

    pub fn heading(text: impl Into<Text>) -> Self {
        Part::Heading(text.into())
    }

    pub fn paragraph(text: impl Into<Text>) -> Self {
        Part::Paragraph(text.into())
    }

    pub fn note(text: impl Into<Text>) -> Self {
        Part::Note(text.into())
    }

    pub fn chart(chart: Chart) -> Self {
        Part::Chart(Box::new(chart))
    }

    pub fn warnings(warnings: &[String]) -> Self {
        let item = |warning: &String| Item { text: warning.as_str().into(), is_warning: true };
        Part::List(warnings.iter().map(item).collect())
    }

    /// The items of a list, of verdicts or of definitions.
    pub(crate) fn items(&self) -> Vec<Text> {
        match self {
            Part::List(items) => items.iter().map(|item| item.text.clone()).collect(),
            Part::Verdicts(verdicts) => verdicts.clone(),
            Part::Contents(headings) => headings.iter().map(|heading| heading.as_str().into()).collect(),
            Part::Definitions(pairs) => {
                pairs.iter().map(|(name, value)| format!("{name}: {value}").into()).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The parts in it: of a section, of what is folded, of cards.
    fn inner(&self) -> Vec<&Part> {
        match self {
            Part::Section(_, parts) | Part::Folded(_, parts) => parts.iter().collect(),
            Part::Cards(cards) => cards.iter().flat_map(|card| &card.parts).collect(),
            Part::Columns(columns) => columns.iter().flatten().collect(),
            _ => Vec::new(),
        }
    }

    pub fn charts(&self) -> Vec<&Chart> {
        match self {
            Part::Chart(chart) => vec![chart.as_ref()],
            Part::Charts(charts) => charts.iter().collect(),
            other => other.inner().into_iter().flat_map(Part::charts).collect(),
        }
    }

    pub fn tables(&self) -> Vec<&Table> {
        match self {
            Part::Table(table) => vec![table],
            other => other.inner().into_iter().flat_map(Part::tables).collect(),
        }
    }
}

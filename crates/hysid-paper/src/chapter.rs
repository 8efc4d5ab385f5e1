//! Result of an experiment: a chapter of text, tables and charts, as data.

use hysid_document::{Chart, Part, Table};

/// The result of an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Chapter {
    /// Name of the experiment.
    pub name: String,
    /// Headline.
    pub title: String,
    /// Conclusion for the reader, in a sentence.
    pub verdict: String,
    /// Text, tables and charts in their order.
    pub parts: Vec<Part>,
    /// Targets and the results beside them.
    pub targets: Vec<ChapterTarget>,
    /// Further files, by name.
    pub files: Vec<(String, Content)>,
}

/// Content of a further file.
#[derive(Debug, Clone, PartialEq)]
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

/// Whose target it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TargetSource {
    /// The paper claims it, with this number.
    Paper,
    /// The paper claims it in words; the number is ours.
    Words,
    /// Ours: the paper does not claim it.
    Ours,
}

impl TargetSource {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Words => "paper, in words",
            Self::Ours => "Hysid",
        }
    }
}

/// Was a target met?
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TargetVerdict {
    /// By the median of the seeds.
    Met,
    /// Not by one network, but by the median of several.
    MetBySeveral,
    /// Neither by one network nor by several.
    Missed,
    /// The other model is worse than a constant, so that a ratio to its error has no meaning.
    OtherDiverged,
}

impl TargetVerdict {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Met => "met",
            Self::MetBySeveral => "met by several only",
            Self::Missed => "missed",
            Self::OtherDiverged => "other model diverged",
        }
    }
}

/// A figure that was to be reached.
#[derive(Debug, Clone, PartialEq)]
pub struct ChapterTarget {
    /// The specimen.
    pub specimen: String,
    /// Which of its figures.
    pub figure: String,
    /// Whose target it is.
    pub source: TargetSource,
    /// Limit of the target, in words.
    pub wanted: String,
    /// Result of one network: median and range of the seeds.
    pub one: String,
    /// Result of the median of several networks, likewise.
    pub several: Option<String>,
    /// Was it reached?
    pub verdict: TargetVerdict,
}

/// Begins the heading of every table whose figures are of a specimen.
pub fn stands_in(specimen: &str, of: &str) -> String {
    format!("Synthetic specimen {specimen} in place of the paper's measured data ({of})")
}

/// The targets of these chapters that are the paper's claims, or the others, as a table; `None` if there are none.
pub fn targets(chapters: &[Chapter], of_paper: bool) -> Option<Table> {
    let heading = match of_paper {
        true => "The paper's claims and what was measured",
        false => "Hysid's own targets, which the paper does not claim, and what was measured",
    };
    let columns =
        ["experiment", "figure", "claimed by", "target", "one network", "median of networks", "verdict"];
    let mut table = Table::new(columns).headed(format!(
        "{heading}: median of the seeds, lowest to highest in brackets. Synthetic specimens replace the paper's measured data"
    ));
    for chapter in chapters {
        for target in
            chapter.targets.iter().filter(|target| (target.source != TargetSource::Ours) == of_paper)
        {
            table.push([
                format!("{}, {}", chapter.name, target.specimen).into(),
                target.figure.as_str().into(),
                target.source.words().into(),
                target.wanted.as_str().into(),
                target.one.as_str().into(),
                target.several.as_deref().unwrap_or("–").into(),
                target.verdict.words().into(),
            ]);
        }
    }
    (!table.rows.is_empty()).then_some(table)
}

//! Text with emphasis, code and links.

use hysid_core::from;

/// A line or a paragraph.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Text(pub Vec<Piece>);

/// A piece of text in one style.
#[derive(Debug, Clone, PartialEq)]
pub enum Piece {
    Plain(String),
    /// Code: input or content of a file.
    Code(String),
    /// Emphasized text.
    Strong(String),
    /// Text of less importance.
    Aside(String),
    /// A link to a [`Card`](crate::Card) of the same page.
    Link {
        anchor: String,
        text: String,
    },
    /// A word in a coloured frame.
    Badge(Badge, String),
}

/// Meaning of a badge, which determines its colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Badge {
    Yes,
    No,
    Unknown,
}

impl Text {
    pub fn with(mut self, piece: Piece) -> Self {
        self.0.push(piece);
        self
    }

    /// The text with a piece appended as the next word.
    pub fn and(self, piece: Piece) -> Self {
        self.with(Piece::Plain(" ".into())).with(piece)
    }

    /// The text without any style.
    pub fn plain(&self) -> String {
        self.0.iter().map(Piece::text).collect()
    }
}

impl Piece {
    pub fn text(&self) -> &str {
        match self {
            Piece::Plain(text) | Piece::Code(text) | Piece::Strong(text) | Piece::Aside(text) => text,
            Piece::Link { text, .. } | Piece::Badge(_, text) => text,
        }
    }
}

from! {
    Piece => Text: piece => Text(vec![piece]);
    String => Text: text => Piece::Plain(text).into();
    &str => Text: text => text.to_string().into();
}

//! Messages with references to options, which the terminal, the studio and Python each show in their own notation.

use std::ops::Add;

/// Reference to an option that solves the problem.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Hint {
    /// An option, by its name in words joined by underscores.
    Option(&'static str),
    /// An option with a value.
    Value(&'static str, String),
    /// The option that names a word or number that stands for missing values.
    MissingWord(String),
}

impl Hint {
    /// The name of the option.
    pub fn option(&self) -> &'static str {
        match self {
            Self::Option(name) | Self::Value(name, _) => name,
            Self::MissingWord(_) => "missing",
        }
    }
}

/// A part of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Phrase {
    /// Plain text.
    Text(String),
    /// A reference to an option.
    Hint(Hint),
}

/// A text with hints.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Words {
    phrases: Vec<Phrase>,
    helps: bool,
}

impl Words {
    /// Text and hints in their order.
    pub fn phrases(&self) -> &[Phrase] {
        &self.phrases
    }

    /// True if the message contains advice.
    pub fn helps(&self) -> bool {
        self.helps
    }

    /// Marks a message as advice although it names no option.
    pub fn helpful(self) -> Self {
        Self { helps: true, ..self }
    }

    /// Appends advice in parentheses.
    pub fn advised(self, advice: impl Into<Self>) -> Self {
        (self + " (" + advice.into() + ")").helpful()
    }
}

impl<W: Into<Words>> Add<W> for Words {
    type Output = Self;

    fn add(mut self, other: W) -> Self {
        let other = other.into();
        for phrase in other.phrases {
            match (self.phrases.last_mut(), phrase) {
                (Some(Phrase::Text(text)), Phrase::Text(more)) => text.push_str(&more),
                (_, phrase) => self.phrases.push(phrase),
            }
        }
        Self { helps: self.helps || other.helps, ..self }
    }
}

impl From<String> for Words {
    fn from(text: String) -> Self {
        Self { phrases: vec![Phrase::Text(text)], helps: false }
    }
}

impl From<&str> for Words {
    fn from(text: &str) -> Self {
        text.to_string().into()
    }
}

impl From<Hint> for Words {
    fn from(hint: Hint) -> Self {
        Self { phrases: vec![Phrase::Hint(hint)], helps: true }
    }
}

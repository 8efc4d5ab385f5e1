//! Words of errors: never empty, and of bounded length, whatever a file contains.

use std::borrow::Cow;

use hysid_core::words::{Hint, Phrase, Words};
use hysid_document::shell::flag;
use hysid_document::{Face, Problem};
use serde::{Serialize, Serializer};
use serde_json::json;

const MOST_LETTERS: usize = 1000;

/// Words of a problem for the page, which makes links of the hints: a text, or texts and controls by their options, with
/// the value that the hint gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Said(Words);

impl Said {
    /// All of it as text.
    pub fn text(&self) -> String {
        Face::Studio.told(&self.0)
    }
}

impl From<Words> for Said {
    fn from(words: Words) -> Self {
        Self(words)
    }
}

impl From<String> for Said {
    fn from(text: String) -> Self {
        Self(text.into())
    }
}

impl From<&str> for Said {
    fn from(text: &str) -> Self {
        Self(text.into())
    }
}

impl From<Said> for Problem {
    fn from(said: Said) -> Self {
        Self::Other(said.0)
    }
}

impl Serialize for Said {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let value = |phrase: &Phrase| match phrase {
            Phrase::Text(text) => json!(shortened(text)),
            Phrase::Hint(hint) => {
                let value = match hint {
                    Hint::Value(_, value) => Some(value),
                    Hint::Option(_) | Hint::MissingWord(_) => None,
                };
                json!({"flag": flag(hint.option()), "words": Face::Studio.hint(hint), "value": value})
            }
        };
        match self.0.phrases() {
            [Phrase::Text(text)] => serializer.serialize_str(&shortened(text)),
            phrases => serializer.collect_seq(phrases.iter().map(value)),
        }
    }
}

pub fn said(problem: &Problem) -> Said {
    Said(problem.words())
}

/// The text, or its beginning and end if it is long.
pub fn shortened(text: &str) -> Cow<'_, str> {
    let letters = text.chars().count();
    if letters <= MOST_LETTERS {
        return text.into();
    }
    let half = MOST_LETTERS / 2;
    let beginning: String = text.chars().take(half).collect();
    let end: String = text.chars().skip(letters - half).collect();
    format!("{beginning} \u{2026} {end}").into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_words_keep_their_beginning_and_their_end() {
        assert_eq!(shortened("short"), "short");
        let long = format!("begin {} end", "\u{b5}".repeat(100_000));
        let words = shortened(&long);
        assert!(words.starts_with("begin ") && words.ends_with(" end"));
        assert!(words.len() < 2200, "{}", words.len());
    }
}

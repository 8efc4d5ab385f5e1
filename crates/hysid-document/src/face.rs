//! Messages in the notation of each interface: terminal, studio, Python.

use hysid_core::words::{Hint, Phrase, Words};

use crate::shell;

/// Roles of columns, which the studio has in its table of columns.
const ROLES: [&str; 5] = ["record", "time", "input", "rate", "output"];

/// Interface that shows a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Face {
    /// Options as they are typed: `--missing -999`.
    Terminal,
    /// Labels of controls.
    Studio,
    /// Arguments of functions: `rate='none'`.
    Python,
}

impl Face {
    /// The message in the notation of the interface.
    pub fn told(self, words: &Words) -> String {
        let phrase = |phrase: &Phrase| match phrase {
            Phrase::Text(text) => text.clone(),
            Phrase::Hint(hint) => self.hint(hint),
        };
        words.phrases().iter().map(phrase).collect()
    }

    /// A hint as a part of a sentence.
    pub fn hint(self, hint: &Hint) -> String {
        let is_number = |word: &str| word.parse().is_ok_and(f64::is_finite);
        let (name, value) = match hint {
            Hint::Option(name) => (*name, None),
            Hint::Value(name, value) => (*name, Some(value)),
            Hint::MissingWord(word) if self == Self::Python => {
                return format!("put NaN in the place of {word}");
            }
            // A number may begin with a minus sign.
            Hint::MissingWord(word) if self == Self::Terminal && is_number(word) => {
                return format!("--missing {word}");
            }
            Hint::MissingWord(word) => ("missing", Some(word)),
        };
        match (self, value) {
            (Self::Terminal, None) => shell::flag(name),
            (Self::Terminal, Some(value)) => shell::option(name, value),
            (Self::Python, None) => format!("{name}="),
            (Self::Python, Some(value)) if is_number(value) => format!("{name}={value}"),
            (Self::Python, Some(value)) => format!("{name}='{}'", value.replace('\'', r"\'")),
            (Self::Studio, Some(value)) if value == "none" && name == "time" => "no role \"time\"".into(),
            (Self::Studio, Some(value)) => format!("{} {value}", control(name)),
            (Self::Studio, None) => control(name),
        }
    }
}

/// The control of the studio for an option, by its label.
fn control(name: &str) -> String {
    if ROLES.contains(&name) {
        return format!("the role \"{name}\"");
    }
    let (first, rest) = name.split_at(1);
    format!("\"{}{}\"", first.to_uppercase(), rest.replace('_', " "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_face_names_an_option_in_its_own_words() {
        let told = |hint: Hint| [Face::Terminal, Face::Studio, Face::Python].map(|face| face.hint(&hint));
        assert_eq!(
            told(Hint::MissingWord("-999".into())),
            ["--missing -999", "\"Missing\" -999", "put NaN in the place of -999"]
        );
        assert_eq!(told(Hint::Option("time")), ["--time", "the role \"time\"", "time="]);
        assert_eq!(told(Hint::Option("units_row")), ["--units-row", "\"Units row\"", "units_row="]);
        let none = Hint::Value("rate", "none".into());
        assert_eq!(told(none), ["--rate none", "the role \"rate\" none", "rate='none'"]);
    }
}

//! What is asked for on the command line of `cargo xtask questions`.

use std::path::PathBuf;

use anyhow::Result;

use super::{QUESTIONS, Question};
use crate::arguments::{option_and_value, usage};

/// What is asked for.
#[derive(Debug)]
pub struct Request {
    /// Where to write the page.
    pub out: Option<PathBuf>,
    /// The only question; all without.
    only: Option<usize>,
    /// The arguments as they were typed.
    pub typed: Vec<String>,
}

impl Request {
    /// Reads the arguments behind the command.
    pub fn parse(arguments: &[&str]) -> Result<Self> {
        let typed = arguments.iter().map(ToString::to_string).collect();
        let mut request = Self { out: None, only: None, typed };
        let mut rest = arguments.iter().copied();
        while let Some(argument) = rest.next() {
            let (option, value) = option_and_value(argument, &mut rest);
            let value = value.unwrap_or_default();
            match option {
                "--only" => match QUESTIONS.iter().position(|question| question.name == value) {
                    Some(index) => request.only = Some(index),
                    None => {
                        let known = QUESTIONS.map(|question| question.name).join(", ");
                        return usage(format!("question `{value}` is unknown; there are {known}"));
                    }
                },
                "--out" if value.is_empty() => return usage("--out needs a value".into()),
                "--out" => request.out = Some(value.into()),
                _ => return usage(format!("`{option}` is no option")),
            }
        }
        Ok(request)
    }

    /// The questions that are asked for.
    pub(super) fn questions(&self) -> &'static [Question] {
        self.only.map_or(&QUESTIONS, |index| &QUESTIONS[index..=index])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_question_or_all_are_asked() {
        assert_eq!(Request::parse(&[]).unwrap().questions().len(), QUESTIONS.len());
        let one = Request::parse(&["--only=wear", "--out", "page.md"]).unwrap();
        assert_eq!(one.questions().iter().map(|question| question.name).collect::<Vec<_>>(), ["wear"]);
        assert_eq!(one.out, Some("page.md".into()));
        for typed in [&["--only", "jelly"][..], &["--only"], &["--out"], &["wear"]] {
            assert!(Request::parse(typed).is_err(), "{typed:?}");
        }
    }

    #[test]
    fn the_usage_lists_every_question() {
        for question in &QUESTIONS {
            assert!(crate::USAGE.contains(question.name), "{}", question.name);
        }
    }
}

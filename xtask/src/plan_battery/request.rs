//! What is asked for on the command line of `cargo xtask plan-battery`.

use std::path::PathBuf;

use anyhow::Result;

use super::SPECIMENS;
use super::trial::FirstTest;
use crate::arguments::{option_and_value, usage};

/// What is asked for.
#[derive(Debug, PartialEq)]
pub struct Request {
    /// Where to write the page.
    pub out: Option<PathBuf>,
    /// Seeds, from 1 on.
    pub seeds: u64,
    specimens: Option<String>,
    first: Option<FirstTest>,
    /// The arguments as they were typed.
    pub typed: Vec<String>,
}

impl Request {
    /// Reads the arguments behind the command.
    pub fn parse(arguments: &[&str]) -> Result<Self> {
        let typed = arguments.iter().map(ToString::to_string).collect();
        let mut request = Self { out: None, seeds: 3, specimens: None, first: None, typed };
        let mut rest = arguments.iter().copied();
        while let Some(argument) = rest.next() {
            let (option, value) = option_and_value(argument, &mut rest);
            let value = value.unwrap_or_default();
            match (option, value.parse::<u64>()) {
                ("--seeds", Ok(seeds)) if seeds > 0 => request.seeds = seeds,
                ("--seeds", _) => {
                    return usage(format!("--seeds needs a whole number from 1, not `{value}`"));
                }
                ("--first", _) => match FirstTest::ALL.into_iter().find(|first| first.word() == value) {
                    Some(first) => request.first = Some(first),
                    None => return usage(format!("--first needs constant or rising, not `{value}`")),
                },
                ("--out" | "--specimens", _) if value.is_empty() => {
                    return usage(format!("{option} needs a value"));
                }
                ("--out", _) => request.out = Some(value.into()),
                ("--specimens", _) => request.specimens = Some(value.into()),
                _ => return usage(format!("`{option}` is no option")),
            }
        }
        Ok(request)
    }

    /// The first tests that are asked for, all without.
    pub fn first_tests(&self) -> Vec<FirstTest> {
        self.first.map_or(FirstTest::ALL.to_vec(), |first| vec![first])
    }

    /// The specimens that are asked for, all without.
    pub fn specimens(&self) -> Result<Vec<&'static str>> {
        let Some(list) = &self.specimens else { return Ok(SPECIMENS.to_vec()) };
        let known = |name: &str| SPECIMENS.into_iter().find(|known| *known == name);
        let of_name = |name: &str| match known(name) {
            Some(name) => Ok(name),
            None => usage(format!("specimen `{name}` is unknown; there are {}", SPECIMENS.join(", "))),
        };
        list.split(',').map(of_name).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_nonsense_is_refused() {
        let request = Request::parse(&["--seeds", "2", "--specimens=bush-random"]).unwrap();
        assert_eq!(Request::parse(&["--first", "rising"]).unwrap().first_tests(), [FirstTest::Rising]);
        assert_eq!(request.first_tests(), FirstTest::ALL);
        assert_eq!((request.seeds, request.specimens().unwrap()), (2, vec!["bush-random"]));
        for typed in [&["--seeds", "0"][..], &["--out"], &["x"], &["--first", "last"]] {
            assert!(Request::parse(typed).is_err(), "{typed:?}");
        }
        assert!(Request::parse(&["--specimens", "jelly"]).unwrap().specimens().is_err());
    }
}

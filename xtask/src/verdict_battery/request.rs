//! What is asked for on the command line of `cargo xtask verdict-battery`.

use std::path::PathBuf;

use anyhow::Result;

use crate::arguments::{option_and_value, usage};

/// What is asked for.
#[derive(Debug, PartialEq)]
pub struct Request {
    /// Where to write the page.
    pub out: Option<PathBuf>,
    /// What chance begins from.
    pub seed: u64,
    /// Names of laws; all without.
    pub laws: Option<Vec<String>>,
    /// Names of disturbances; all without.
    pub disturbances: Option<Vec<String>>,
    /// The program in the place of the one that is built.
    pub program: Option<PathBuf>,
    /// Where to write the wrong verdicts.
    pub list_wrong: Option<PathBuf>,
    /// The arguments as they were typed.
    pub typed: Vec<String>,
}

impl Request {
    /// Reads the arguments behind the command.
    pub fn parse(arguments: &[&str]) -> Result<Self> {
        let mut request = Self {
            out: None,
            seed: 1,
            laws: None,
            disturbances: None,
            program: None,
            list_wrong: None,
            typed: arguments.iter().map(ToString::to_string).collect(),
        };
        let mut rest = arguments.iter().copied();
        while let Some(argument) = rest.next() {
            if !argument.starts_with('-') {
                return usage(format!("`{argument}` is no option"));
            }
            let (option, value) = option_and_value(argument, &mut rest);
            let value = value.unwrap_or_default();
            request.set(option, value)?;
        }
        Ok(request)
    }

    fn set(&mut self, option: &str, value: &str) -> Result<()> {
        let list = || Some(value.split(',').map(str::to_owned).collect());
        match option {
            "--out" | "--seed" | "--laws" | "--disturbances" | "--program" | "--list-wrong"
                if value.is_empty() =>
            {
                return usage(format!("{option} needs a value"));
            }
            "--out" => self.out = Some(value.into()),
            "--laws" => self.laws = list(),
            "--disturbances" => self.disturbances = list(),
            "--program" => self.program = Some(value.into()),
            "--list-wrong" => self.list_wrong = Some(value.into()),
            "--seed" => match value.parse() {
                Ok(seed) => self.seed = seed,
                Err(_) => return usage(format!("--seed needs a whole number from 0, not `{value}`")),
            },
            _ => return usage(format!("option `{option}` is unknown")),
        }
        Ok(())
    }
}

/// Those of all that are named, in their own order; an error for a name that none has.
pub fn named<T>(all: Vec<T>, names: Option<&[String]>, what: &str, name: fn(&T) -> &str) -> Result<Vec<T>> {
    let Some(names) = names else { return Ok(all) };
    let known: Vec<&str> = all.iter().map(name).collect();
    if let Some(unknown) = names.iter().find(|wanted| !known.contains(&wanted.as_str())) {
        return usage(format!("{what} `{unknown}` is unknown; there are {}", known.join(", ")));
    }
    Ok(all.into_iter().filter(|one| names.iter().any(|wanted| wanted == name(one))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Usage;

    #[test]
    fn options_are_read() {
        let typed = "--laws=play,stop --seed 7 --out a.md --list-wrong b.csv --disturbances none";
        let typed: Vec<&str> = typed.split(' ').collect();
        let request = Request::parse(&typed).unwrap();
        let expected = Request {
            out: Some("a.md".into()),
            seed: 7,
            laws: Some(vec!["play".into(), "stop".into()]),
            disturbances: Some(vec!["none".into()]),
            program: None,
            list_wrong: Some("b.csv".into()),
            typed: typed.iter().map(ToString::to_string).collect(),
        };
        assert_eq!(request, expected);
        assert_eq!(Request::parse(&[]).unwrap().seed, 1);
    }

    #[test]
    fn what_cannot_be_understood_is_said() {
        let refusal = |typed: &[&str]| {
            let error = Request::parse(typed).unwrap_err();
            assert!(error.is::<Usage>());
            error.to_string().replace(" (`cargo xtask` alone lists the commands)", "")
        };
        assert_eq!(refusal(&["a"]), "`a` is no option");
        assert_eq!(refusal(&["--models", "a"]), "option `--models` is unknown");
        assert_eq!(refusal(&["--laws"]), "--laws needs a value");
        assert_eq!(refusal(&["--seed", "x"]), "--seed needs a whole number from 0, not `x`");
        let names = ["b".to_owned()];
        let unknown = named(vec!["a", "c"], Some(&names), "law", |name| name).unwrap_err();
        assert!(unknown.to_string().starts_with("law `b` is unknown; there are a, c"));
    }
}

//! What is asked for on the command line of `cargo xtask generate-cases`.

use std::path::PathBuf;

use anyhow::Result;
use hysid::specimens::cases::KINDS;

use crate::arguments::{option_and_value, usage};

/// Most cases at once.
const MOST: usize = 10_000;

/// What is asked for.
#[derive(Debug, PartialEq)]
pub struct Request {
    /// Where the folders of the cases go.
    pub folder: PathBuf,
    /// How many cases.
    pub count: usize,
    /// What chance begins from.
    pub seed: u64,
    /// Cases that train on one loop.
    pub one_loop: bool,
}

impl Request {
    /// Reads the arguments behind the command.
    pub fn parse(arguments: &[&str]) -> Result<Self> {
        let (mut folder, mut count, mut seed, mut one_loop) = (None, KINDS, 1, false);
        let mut rest = arguments.iter().copied();
        while let Some(argument) = rest.next() {
            if argument == "--one-loop" {
                one_loop = true;
            } else if argument.starts_with('-') {
                let (option, value) = option_and_value(argument, &mut rest);
                let value = value.unwrap_or_default();
                match option {
                    "--count" => count = number(option, value, 1, MOST as u64)? as usize,
                    "--seed" => seed = number(option, value, 0, u64::MAX)?,
                    _ => return usage(format!("option `{option}` is unknown")),
                }
            } else if folder.replace(PathBuf::from(argument)).is_some() {
                return usage(format!("one folder is enough: what is `{argument}`?"));
            }
        }
        match folder {
            Some(folder) => Ok(Self { folder, count, seed, one_loop }),
            None => usage("name the folder for the cases".into()),
        }
    }
}

fn number(option: &str, value: &str, least: u64, most: u64) -> Result<u64> {
    match value.parse() {
        Ok(number) if (least..=most).contains(&number) => Ok(number),
        _ => usage(format!("{option} needs a whole number from {least} to {most}, not `{value}`")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Usage;

    #[test]
    fn options_stand_anywhere() {
        let request = Request::parse(&["--count=5", "out", "--one-loop", "--seed", "7"]).unwrap();
        assert_eq!(request, Request { folder: "out".into(), count: 5, seed: 7, one_loop: true });
        let request = Request::parse(&["out"]).unwrap();
        assert_eq!(request, Request { folder: "out".into(), count: 36, seed: 1, one_loop: false });
    }

    #[test]
    fn what_cannot_be_understood_is_said() {
        let refusal = |typed: &[&str]| {
            let error = Request::parse(typed).unwrap_err();
            assert!(error.is::<Usage>());
            error.to_string().replace(" (`cargo xtask` alone lists the commands)", "")
        };
        assert_eq!(refusal(&[]), "name the folder for the cases");
        assert_eq!(refusal(&["a", "b"]), "one folder is enough: what is `b`?");
        assert_eq!(refusal(&["a", "--out", "b"]), "option `--out` is unknown");
        assert_eq!(refusal(&["a", "--count", "0"]), "--count needs a whole number from 1 to 10000, not `0`");
        let seeds = "--seed needs a whole number from 0 to 18446744073709551615, not ";
        assert_eq!(refusal(&["a", "--seed"]), format!("{seeds}``"));
    }
}

//! What is asked for on the command lines of `cargo xtask cases` and `verdicts`.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::Result;

use crate::arguments::{option_and_value, usage};

/// What is asked for.
#[derive(Debug, Default, PartialEq)]
pub struct Request {
    /// The folder of the cases.
    pub folder: PathBuf,
    /// The models to compare, as `hysid compare` takes them; its own choice without.
    pub models: Option<String>,
    /// Where to write the tables.
    pub out: Option<PathBuf>,
    /// Seconds for each model, as `hysid compare` takes them; its own choice without.
    pub time_limit: Option<f64>,
    /// Time after which a case is given up.
    pub case_limit: Option<Duration>,
    /// The program in the place of the one that is built.
    pub program: Option<PathBuf>,
    /// Further arguments for the program.
    pub passed_on: Vec<String>,
    /// The arguments as they were typed.
    pub typed: Vec<String>,
}

impl Request {
    /// Reads the arguments behind the command, which has these options.
    pub fn parse(arguments: &[&str], options: &[&str]) -> Result<Self> {
        let mut request =
            Self { typed: arguments.iter().map(ToString::to_string).collect(), ..Self::default() };
        let mut folder = None;
        let mut rest = arguments.iter().copied();
        while let Some(argument) = rest.next() {
            if argument == "--" {
                request.passed_on = rest.by_ref().map(str::to_owned).collect();
            } else if argument.starts_with('-') {
                let (option, value) = option_and_value(argument, &mut rest);
                if !options.contains(&option) {
                    return usage(format!("option `{option}` is unknown"));
                }
                request.set(option, value)?;
            } else if folder.replace(PathBuf::from(argument)).is_some() {
                return usage(format!("one folder is enough: what is `{argument}`?"));
            }
        }
        match folder {
            Some(folder) => Ok(Self { folder, ..request }),
            None => usage("name the folder of the cases".into()),
        }
    }

    fn set(&mut self, option: &str, value: Option<&str>) -> Result<()> {
        let Some(value) = value.filter(|value| !value.is_empty()) else {
            return usage(format!("{option} needs a value"));
        };
        match option {
            "--models" => self.models = Some(value.into()),
            "--out" => self.out = Some(value.into()),
            "--program" => self.program = Some(value.into()),
            "--time-limit" => self.time_limit = Some(seconds(option, value)?),
            _ => self.case_limit = Some(Duration::from_secs_f64(seconds(option, value)?)),
        }
        Ok(())
    }
}

fn seconds(option: &str, value: &str) -> Result<f64> {
    match value.parse() {
        Ok(seconds) if seconds > 0.0 && seconds < 1e9 => Ok(seconds),
        _ => usage(format!("{option} needs a number of seconds above 0, not `{value}`")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::OPTIONS;
    use super::*;
    use crate::Usage;

    #[test]
    fn options_stand_anywhere_and_the_rest_is_passed_on() {
        let typed = "--models=pnn,xpnn data --time-limit 5 --case-limit 1.5 --out a.md -- --seed 2";
        let typed: Vec<&str> = typed.split(' ').collect();
        let request = Request::parse(&typed, &OPTIONS).unwrap();
        let expected = Request {
            folder: "data".into(),
            models: Some("pnn,xpnn".into()),
            out: Some("a.md".into()),
            time_limit: Some(5.0),
            case_limit: Some(Duration::from_millis(1500)),
            program: None,
            passed_on: vec!["--seed".into(), "2".into()],
            typed: typed.iter().map(ToString::to_string).collect(),
        };
        assert_eq!(request, expected);
    }

    #[test]
    fn what_cannot_be_understood_is_said() {
        let refusal = |typed: &[&str]| {
            let error = Request::parse(typed, &OPTIONS).unwrap_err();
            assert!(error.is::<Usage>());
            error.to_string().replace(" (`cargo xtask` alone lists the commands)", "")
        };
        assert_eq!(refusal(&[]), "name the folder of the cases");
        assert_eq!(refusal(&["a", "b"]), "one folder is enough: what is `b`?");
        assert_eq!(refusal(&["a", "--seed", "2"]), "option `--seed` is unknown");
        assert_eq!(refusal(&["a", "--out"]), "--out needs a value");
        let other = Request::parse(&["a", "--models", "pnn"], &["--out"]).unwrap_err().to_string();
        assert!(other.starts_with("option `--models` is unknown"), "{other}");
        for (option, value) in [("--time-limit", "0"), ("--time-limit", "soon"), ("--case-limit", "inf")] {
            let expected = format!("{option} needs a number of seconds above 0, not `{value}`");
            assert_eq!(refusal(&["a", option, value]), expected);
        }
    }
}

//! `roles-battery`: what `hysid look` takes for time, input and output in tables with the headers of twelve fields. The
//! headers and the true role of each column are in `roles_battery/headers.txt`, to which the code that guesses was adjusted,
//! and in `roles_battery/independent.txt`, to which it was not.

mod signals;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde_json::Value;

use crate::program;

/// Headers and true roles.
const HEADERS: &str = include_str!("roles_battery/headers.txt");
const INDEPENDENT: &str = include_str!("roles_battery/independent.txt");

/// What to measure.
#[derive(Args)]
pub struct Request {
    /// The program [default: a release build]
    #[arg(long)]
    program: Option<PathBuf>,
    /// Only this field, such as "batteries"
    #[arg(long)]
    only: Option<String>,
}

/// A column: its name, and the letter of its signal.
type Column = (String, char);

/// A table that is tried.
struct Case {
    field: &'static str,
    columns: Vec<Column>,
}

/// What came of a case.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Answer {
    Right,
    Asked,
    Wrong(String),
}

/// Runs the battery and prints its table; an error if a role is wrong.
pub fn run(request: &Request) -> Result<()> {
    let program = match &request.program {
        Some(program) => program.clone(),
        None => program::build()?,
    };
    let folder = tempfile::tempdir()?;
    let mut fields: BTreeMap<&str, [usize; 3]> = BTreeMap::new();
    for case in cases().iter().filter(|case| request.only.as_ref().is_none_or(|only| case.field == only)) {
        let answer = case.answer(&program, &folder.path().join("table.csv"))?;
        let counts = fields.entry(case.field).or_default();
        counts[match &answer {
            Answer::Right => 0,
            Answer::Asked => 1,
            Answer::Wrong(_) => 2,
        }] += 1;
        if let Answer::Wrong(words) = answer {
            eprintln!("wrong: {}: {words}", case.header());
        }
    }
    print!("{}", table(&fields));
    let wrong: usize = fields.values().map(|counts| counts[2]).sum();
    ensure!(wrong == 0, "{wrong} headers are understood wrongly, without a question");
    Ok(())
}

fn table(fields: &BTreeMap<&str, [usize; 3]>) -> String {
    let mut text = String::from("| field | headers | right | asked | wrong |\n|---|---|---|---|---|\n");
    let mut all = [0; 3];
    for (field, counts) in fields {
        let _ = writeln!(text, "{}", row(field, counts));
        all.iter_mut().zip(counts).for_each(|(all, count)| *all += count);
    }
    text + &row("all", &all) + "\n"
}

fn row(field: &str, [right, asked, wrong]: &[usize; 3]) -> String {
    format!("| {field} | {} | {right} | {asked} | {wrong} |", right + asked + wrong)
}

/// Every header as it is written, with its units in square brackets, with a counter before it, with a temperature behind.
fn cases() -> Vec<Case> {
    let mut field = "";
    let mut cases = Vec::new();
    let lines = |text: &'static str| {
        text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'))
    };
    let of_field = lines(HEADERS).map(|line| (line, None));
    for (line, of_all) in of_field.chain(lines(INDEPENDENT).map(|line| (line, Some("independent")))) {
        if let Some(name) = line.strip_prefix('[') {
            field = of_all.unwrap_or(name.trim_end_matches(']'));
            continue;
        }
        let cell = |cell: &str| -> Column {
            let (name, signal) = cell.trim().rsplit_once('=').expect("a column is NAME=SIGNAL");
            (name.to_string(), signal.chars().next().expect("a signal has a letter"))
        };
        let columns: Vec<Column> = line.trim_start_matches('?').trim_start().split(" | ").map(cell).collect();
        let extra = |name: &str, signal| vec![(name.to_string(), signal)];
        let bracketed: Vec<Column> =
            columns.iter().map(|(name, signal)| (in_brackets(name), *signal)).collect();
        let all = [
            columns.clone(),
            bracketed.clone(),
            [extra("Cycle", 'n'), columns.clone()].concat(),
            [columns.clone(), extra("Chamber temperature (°C)", 'd')].concat(),
        ];
        for (place, columns_of_case) in all.into_iter().enumerate() {
            let is_new = place != 1 || bracketed != columns;
            let mut names: Vec<&String> = columns_of_case.iter().map(|(name, _)| name).collect();
            names.sort_unstable();
            names.dedup();
            if is_new && names.len() == columns_of_case.len() {
                cases.push(Case { field, columns: columns_of_case });
            }
        }
    }
    cases
}

/// `Force (kN)` as `Force [kN]`.
fn in_brackets(name: &str) -> String {
    match name.strip_suffix(')').and_then(|name| name.rsplit_once('(')) {
        Some((quantity, unit)) => format!("{quantity}[{unit}]"),
        None => name.to_string(),
    }
}

impl Case {
    fn header(&self) -> String {
        let name = |(name, _): &Column| if name.contains(',') { format!("\"{name}\"") } else { name.clone() };
        self.columns.iter().map(name).collect::<Vec<_>>().join(",")
    }

    fn answer(&self, program: &Path, file: &Path) -> Result<Answer> {
        std::fs::write(file, self.header() + "\n" + &signals::rows(&self.columns))?;
        let output = Command::new(program).args(["look", "--json"]).arg(file).output();
        let output = output.with_context(|| format!("{} could not be started", program.display()))?;
        let told: Value = serde_json::from_slice(&output.stdout)
            .with_context(|| format!("{}: {}", self.header(), String::from_utf8_lossy(&output.stderr)))?;
        let doubts = String::from_utf8_lossy(&output.stderr).contains("(to change it: --");
        if told.get("problem").is_some() {
            return Ok(Answer::Asked);
        }
        let mut has_time = false;
        for (place, (name, signal)) in self.columns.iter().enumerate() {
            let role = told["files"][0]["columns"][place]["role"].as_str().unwrap_or_default();
            let expected = match signal {
                't' | 'm' if !has_time => "time",
                'x' => "input",
                'y' => "output",
                'g' => "record",
                _ => "unused",
            };
            has_time |= expected == "time";
            if role != expected && doubts {
                return Ok(Answer::Asked);
            }
            if role != expected {
                return Ok(Answer::Wrong(format!("\"{name}\" is {role} in place of {expected}")));
            }
        }
        Ok(Answer::Right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_headers_of_twelve_fields_with_one_input_and_one_output() {
        let cases = cases();
        let mut fields: Vec<&str> = cases.iter().map(|case| case.field).collect();
        fields.dedup();
        assert_eq!(fields.len(), 12 + 1);
        assert!(cases.len() >= 300, "{}", cases.len());
        for case in &cases {
            let count = |signal| case.columns.iter().filter(|(_, other)| *other == signal).count();
            assert_eq!((count('x'), count('y')), (1, 1), "{}", case.header());
        }
    }
}

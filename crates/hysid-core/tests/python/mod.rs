//! The options in the Python package: types, signatures, and the parameters in docstrings.

use std::fmt::Write as _;

use hysid_core::options::table::{FitOption, OPTIONS, OptionGroup, OptionValues};

/// The text of a file as a function of its present text.
type Generator = fn(&str) -> String;

/// Files with generated parts.
pub const GENERATED: [(&str, Generator); 3] =
    [("_options.py", |_| types()), ("_fitting.py", fitting), ("regressor.py", regressor)];

const HEAD: &str = "\
\"\"\"Types of the options of a fit, generated from the table in crates/hysid-core/src/options/table.rs.\"\"\"

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypeAlias, TypedDict

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

";

/// Columns of a line of Python.
const COLUMNS: usize = 120;

/// Names in the type of a docstring; more follow the meaning.
const MOST_NAMES: usize = 6;

/// The module of types: the names of each option that has some, and all options as keywords.
fn types() -> String {
    let mut text = HEAD.to_string();
    for option in OPTIONS {
        let OptionValues::Names(names) = option.values else { continue };
        let names: String = names().iter().map(|name| format!("    \"{name}\",\n")).collect();
        let _ = writeln!(text, "{}: TypeAlias = Literal[\n{names}]", alias(option));
    }
    text += "\n\nclass Options(TypedDict, total=False):\n    \"\"\"Options of a fit, as keywords of `hysid.fit`.\"\"\"\n";
    text + &grouped("    ", |option| format!("{}: {} | None", option.name, kind(option, "")))
}

fn fitting(text: &str) -> String {
    let keywords =
        grouped("    ", |option| format!("{}: {} | None = None,", option.name, kind(option, "_options.")));
    let keywords = keywords.trim_start().replace("\n\n", "\n");
    let text = replaced(text, "    *,\n", "    time_limit: ", &format!("    {keywords}    # Run\n"));
    let parameters = groups_of_parameters();
    let last_before = " A column `record` of a table has the labels if nothing else is given.\n";
    replaced(&text, last_before, "    time_limit : ", &parameters)
}

fn regressor(text: &str) -> String {
    // Its name in scikit-learn is random_state.
    let all = || OPTIONS.iter().filter(|option| option.name != "seed");
    let names: Vec<&str> = all().map(|option| option.name).filter(|name| *name != "model").collect();
    let lines = wrapped(&names.join(", "), COLUMNS - "    , : optional".len());
    let parameters: String =
        lines.iter().map(|line| format!("    {} : optional\n", line.trim_end_matches(','))).collect();
    let keyword = |option: &FitOption| {
        format!("        {}: {} | None = None,\n", option.name, kind(option, "_options."))
    };
    let attribute = |option: &FitOption| format!("        self.{0} = {0}\n", option.name);
    let text = replaced(text, "model, which takes seconds.\n", "    time_limit, threads : ", &parameters);
    let keywords: String = all().map(keyword).collect();
    let text = replaced(&text, "        rate: str = \"auto\",\n", "        time_limit: ", &keywords);
    let attributes: String = all().map(attribute).collect();
    replaced(&text, "        self.rate = rate\n", "        self.time_limit = ", &attributes)
}

/// The text with another part between the first place of `before` and the next of `after`.
fn replaced(text: &str, before: &str, after: &str, part: &str) -> String {
    let (head, rest) = text.split_once(before).unwrap_or_else(|| panic!("`{before}` is missing"));
    let (_, tail) = rest.split_once(after).unwrap_or_else(|| panic!("`{after}` is missing"));
    format!("{head}{before}{part}{after}{tail}")
}

/// A line for each option, below a comment with the heading of its group.
fn grouped(indent: &str, line: impl Fn(&FitOption) -> String) -> String {
    let mut text = String::new();
    for group in OptionGroup::ALL {
        let _ = write!(text, "\n{indent}# {}\n", group.heading());
        for option in OPTIONS.iter().filter(|option| option.group == group) {
            let _ = writeln!(text, "{indent}{}", line(option));
        }
    }
    text
}

/// The paragraphs of a docstring in sections, one for each group.
fn groups_of_parameters() -> String {
    let heading = |text: &str| format!("\n    {text}\n    {}\n", "-".repeat(text.len()));
    let mut text = String::new();
    for group in OptionGroup::ALL {
        text += &heading(group.heading());
        text.extend(OPTIONS.iter().filter(|option| option.group == group).map(parameter));
    }
    text + &heading("Run")
}

/// The type of a value.
fn kind(option: &FitOption, module: &str) -> String {
    match option.values {
        OptionValues::Count(..) | OptionValues::Whole => "int".into(),
        OptionValues::Fraction | OptionValues::ZeroOr(..) | OptionValues::Number(..) => "float".into(),
        OptionValues::Positive => "ArrayLike".into(),
        OptionValues::Flag | OptionValues::Truth => "bool".into(),
        OptionValues::Span => "int | str".into(),
        OptionValues::Names(_) => format!("{module}{}", alias(option)),
    }
}

/// The name of the type of an option with names, such as `InitialStateName`.
fn alias(option: &FitOption) -> String {
    let capital = |word: &str| word[..1].to_uppercase() + &word[1..];
    option.name.split('_').map(capital).chain(["Name".into()]).collect()
}

/// The paragraph of a docstring.
fn parameter(option: &FitOption) -> String {
    let (kind, names) = match option.values {
        OptionValues::Names(names) if names().len() <= MOST_NAMES => {
            (format!("{{\"{}\"}}", names().join("\", \"")), String::new())
        }
        // A long list has lines of its own.
        OptionValues::Names(names) => ("str".into(), format!(" One of \"{}\".", names().join("\", \""))),
        OptionValues::Positive => ("array of numbers".into(), String::new()),
        _ => (kind(option, ""), String::new()),
    };
    let words = format!("{}.{names} Default: {}.", option.meaning, option.default_in_words());
    let lines = wrapped(&words, COLUMNS - 8).into_iter().map(|line| format!("        {line}\n"));
    format!("    {} : {kind}, optional\n", option.name) + &lines.collect::<String>()
}

fn wrapped(text: &str, columns: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().expect("a first line");
        if line.is_empty() {
            *line += word;
        } else if line.chars().count() + 1 + word.chars().count() <= columns {
            *line += &format!(" {word}");
        } else {
            lines.push(word.into());
        }
    }
    lines
}

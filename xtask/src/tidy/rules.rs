//! The rules, each a function of a file's path from the root and its text.

use std::collections::{BTreeMap, BTreeSet};

use super::Violation;
use super::rust_code::{code_only, contains_word};
use crate::markdown::{is_fence, links, resolve};

/// Where the numbered equations are.
pub const THEORY: &str = "docs/theory.md";

const LONGEST_SOURCE: usize = 800;

/// Names that say nothing about what is inside.
const EMPTY_NAMES: [&str; 7] = ["utils", "util", "helpers", "helper", "manager", "common", "misc"];

/// The crates of the library.
const LIBRARY: [&str; 12] = [
    "crates/hysid-core/src/",
    "crates/hysid/src/",
    "crates/hysid-diagnosis/src/",
    "crates/hysid-specimens/src/",
    "crates/hysid-export/src/",
    "crates/hysid-paper/src/",
    "crates/hysid-tables/src/",
    "crates/hysid-records/src/",
    "crates/hysid-app/src/",
    "crates/hysid-document/src/",
    "crates/hysid-files/src/",
    "crates/hysid-studio/src/",
];

/// An effect that the library is without, or one place of it only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Effect {
    Unsafe,
    Output,
    Files,
    Clock,
}

/// Words that the code of the library does not contain, each with its effect.
const EFFECTS: [(&str, Effect); 10] = [
    ("unsafe", Effect::Unsafe),
    ("println!", Effect::Output),
    ("eprintln!", Effect::Output),
    ("print!", Effect::Output),
    ("eprint!", Effect::Output),
    ("dbg!", Effect::Output),
    ("std::fs", Effect::Files),
    ("fs::", Effect::Files),
    ("Instant", Effect::Clock),
    ("SystemTime", Effect::Clock),
];

/// The crates and files of the library that may have an effect.
const ALLOWED: [(&str, Effect); 10] = [
    // The time limit of a fit.
    ("crates/hysid/src/builder.rs", Effect::Clock),
    // The C compiler that builds a Functional Mock-up Unit works on files.
    ("crates/hysid-export/src/target/fmu/binary.rs", Effect::Files),
    // Fits of a comparison have a time limit; a validation is timed. A page names the day, the checksums of its files, the time of a simulation.
    ("crates/hysid-app/src/compare.rs", Effect::Clock),
    ("crates/hysid-app/src/date.rs", Effect::Clock),
    ("crates/hysid-app/src/origin.rs", Effect::Files),
    ("crates/hysid-app/src/timing.rs", Effect::Clock),
    ("crates/hysid-app/src/validation.rs", Effect::Clock),
    ("crates/hysid-files/src/", Effect::Files),
    ("crates/hysid-studio/src/", Effect::Files),
    ("crates/hysid-studio/src/", Effect::Clock),
];

/// The folders that may have tables of data, all of them generated: measured ones belong to others.
const TABLES_IN: [&str; 3] = ["crates/hysid-cli/tests/files/", "docs/tutorials/data/", "fuzz/corpus/table/"];

/// Written in two parts, or this file would break its own rule.
const LEFT_TO_DO: [&str; 3] = [concat!("TO", "DO"), concat!("FIX", "ME"), concat!("XX", "X")];

fn violation(path: &str, line: usize, what: impl Into<String>) -> Violation {
    let path = path.to_owned();
    let what = what.into();
    Violation { path, line, what }
}

/// The lines of a text with their numbers, which count from 1.
fn numbered(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..).zip(text.split('\n'))
}

fn is_rust(path: &str) -> bool {
    path.ends_with(".rs")
}

/// No tabs and no whitespace at the end of a line.
pub fn clean_whitespace(path: &str, text: &str) -> Vec<Violation> {
    let mut found = Vec::new();
    for (number, line) in numbered(text) {
        if line.contains('\t') {
            found.push(violation(path, number, "a tab"));
        }
        if line.trim_end() != line {
            found.push(violation(path, number, "whitespace at the end of the line"));
        }
    }
    found
}

/// Finds marks of unfinished work, which belongs into the issue tracker.
pub fn nothing_left_to_do(path: &str, text: &str) -> Vec<Violation> {
    let mut found = Vec::new();
    for (number, line) in numbered(text) {
        for mark in LEFT_TO_DO {
            if contains_word(line, mark) {
                found.push(violation(path, number, format!("{mark} left behind")));
            }
        }
    }
    found
}

/// No Rust source is longer than one can keep in mind.
pub fn length(path: &str, text: &str) -> Vec<Violation> {
    let lines = text.lines().count();
    if is_rust(path) && lines > LONGEST_SOURCE {
        let what = format!("{lines} lines; split the file, {LONGEST_SOURCE} is the most");
        vec![violation(path, LONGEST_SOURCE + 1, what)]
    } else {
        Vec::new()
    }
}

/// The name of a file or folder tells what is inside.
pub fn telling_name(path: &str) -> Vec<Violation> {
    path.split('/')
        .map(|part| part.split_once('.').map_or(part, |(stem, _)| stem))
        .filter(|stem| EMPTY_NAMES.contains(stem))
        .map(|stem| violation(path, 1, format!("a file or folder named `{stem}`")))
        .collect()
}

/// The name of a module tells what is inside.
pub fn telling_module_names(path: &str, text: &str) -> Vec<Violation> {
    if !is_rust(path) {
        return Vec::new();
    }
    let mut found = Vec::new();
    for (number, line) in numbered(&code_only(text)) {
        for name in EMPTY_NAMES {
            if contains_word(line, &format!("mod {name}")) {
                found.push(violation(path, number, format!("a module named `{name}`")));
            }
        }
    }
    found
}

/// The library has safe code, prints nothing, touches no files and reads no clock, but for [`ALLOWED`]. Comments and
/// strings may say what they like.
pub fn pure_library(path: &str, text: &str) -> Vec<Violation> {
    if !is_rust(path) || !LIBRARY.iter().any(|folder| path.starts_with(folder)) {
        return Vec::new();
    }
    let mut found = Vec::new();
    for (number, line) in numbered(&code_only(text)) {
        for (pattern, effect) in EFFECTS {
            let is_allowed =
                ALLOWED.iter().any(|(place, allowed)| path.starts_with(place) && *allowed == effect);
            if contains_word(line, pattern) && !is_allowed {
                let what = match effect {
                    Effect::Unsafe => "has no unsafe code",
                    Effect::Output => "prints nothing",
                    Effect::Files => "reads and writes no files here",
                    Effect::Clock => "reads no clock here",
                };
                found.push(violation(path, number, format!("`{pattern}`: the library {what}")));
            }
        }
    }
    found
}

/// Every equation cited from Rust code as `theory.md (X.Y)` is there.
pub fn equations_exist(path: &str, text: &str, equations: &BTreeSet<String>) -> Vec<Violation> {
    if !is_rust(path) {
        return Vec::new();
    }
    let mut found = Vec::new();
    for (number, line) in numbered(text) {
        for equation in cited_equations(line) {
            if !equations.contains(&equation) {
                let what = format!("equation ({equation}) is not in {THEORY}");
                found.push(violation(path, number, what));
            }
        }
    }
    found
}

/// No equation number is given twice.
pub fn equations_unique(path: &str, text: &str) -> Vec<Violation> {
    if path != THEORY {
        return Vec::new();
    }
    let mut first_line = BTreeMap::new();
    let mut found = Vec::new();
    for (number, equation) in displayed_equations(text) {
        if let Some(first) = first_line.get(&equation) {
            let what = format!("equation number ({equation}) is taken by line {first}");
            found.push(violation(path, number, what));
        } else {
            first_line.insert(equation, number);
        }
    }
    found
}

/// The numbers of the equations displayed in the text.
pub fn equations(text: &str) -> BTreeSet<String> {
    displayed_equations(text).into_iter().map(|(_, equation)| equation).collect()
}

/// The equations of the text with their lines: in a code block, a line that ends with `(X.Y)`.
fn displayed_equations(text: &str) -> Vec<(usize, String)> {
    let mut inside_block = false;
    let mut equations = Vec::new();
    for (number, line) in numbered(text) {
        if is_fence(line) {
            inside_block = !inside_block;
        } else if inside_block
            && let Some(start) = line.rfind('(')
            && let Some((equation, "")) = equation_number(&line[start..])
        {
            equations.push((number, equation));
        }
    }
    equations
}

/// The numbers in `theory.md (1.2)`, and also in `theory.md (1.2), (1.3) and (1.5)`.
fn cited_equations(line: &str) -> Vec<String> {
    let mut cited = Vec::new();
    for (start, name) in line.match_indices("theory.md") {
        let mut rest = line[start + name.len()..].trim_start_matches(['`', ']', '>']);
        while let Some((equation, after)) = equation_number(rest.trim_start()) {
            cited.push(equation);
            rest = after.trim_start_matches([',', ' ', '-', '–']);
            rest = ["and ", "or ", "to "].iter().find_map(|word| rest.strip_prefix(word)).unwrap_or(rest);
        }
    }
    cited
}

/// Splits `(12.3)...` into `12.3` and what follows.
fn equation_number(text: &str) -> Option<(String, &str)> {
    let (number, rest) = text.strip_prefix('(')?.split_once(')')?;
    let (section, count) = number.split_once('.')?;
    let is_count = |digits: &str| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
    (is_count(section) && is_count(count)).then(|| (number.to_owned(), rest))
}

/// Tables of data are where they are expected, so that none is committed with a change by mistake.
pub fn table_in_its_place(path: &str) -> Option<Violation> {
    let endings = [".csv", ".dat", ".frc", ".h5", ".mat", ".npy", ".npz", ".tsv", ".xlsx"];
    let is_elsewhere = !TABLES_IN.iter().any(|folder| path.starts_with(folder));
    let is_table = endings.iter().any(|ending| path.ends_with(ending));
    (is_table && is_elsewhere)
        .then(|| violation(path, 1, format!("tables are in {} only", TABLES_IN.join(", "))))
}

/// Every relative link in the repository's documents leads to a file or folder of the repository.
pub fn links_lead_somewhere(path: &str, text: &str, paths: &BTreeSet<String>) -> Vec<Violation> {
    let at_the_door = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"];
    let is_document = path.starts_with("docs/") && path.ends_with(".md");
    if !is_document && !at_the_door.contains(&path) {
        return Vec::new();
    }
    let mut found = Vec::new();
    for link in links(text).into_iter().filter(|link| !link.is_elsewhere()) {
        let (file, _) = link.file_and_anchor();
        let leads_somewhere = resolve(path, file).is_some_and(|resolved| {
            let folder = format!("{resolved}/");
            resolved.is_empty()
                || paths.contains(&resolved)
                || paths.iter().any(|path| path.starts_with(&folder))
        });
        if !leads_somewhere {
            found.push(violation(path, link.line, format!("broken link to `{}`", link.target)));
        }
    }
    found
}

/// The changelog has a heading for the workspace's version, or one for what is not released yet.
pub fn version_in_changelog(manifest: &str, changelog: &str) -> Vec<Violation> {
    let Some(version) = workspace_version(manifest) else {
        let what = "no version in [workspace.package]";
        return vec![violation("Cargo.toml", 1, what)];
    };
    let mut headings = changelog.lines().filter_map(|line| line.strip_prefix("## "));
    let known = headings.any(|heading| {
        let name = heading.split_whitespace().next().unwrap_or_default();
        let name = name.trim_matches(['[', ']']);
        name == "Unreleased" || name == version
    });
    if known {
        Vec::new()
    } else {
        let what = format!("no heading `## {version}` and none `## Unreleased`");
        vec![violation("CHANGELOG.md", 1, what)]
    }
}

fn workspace_version(manifest: &str) -> Option<&str> {
    manifest
        .lines()
        .skip_while(|line| line.trim() != "[workspace.package]")
        .skip(1)
        .take_while(|line| !line.starts_with('['))
        .find_map(|line| {
            let (key, value) = line.split_once('=')?;
            (key.trim() == "version").then(|| value.trim().trim_matches('"'))
        })
}

#[cfg(test)]
mod tests;

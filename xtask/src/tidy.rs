//! `cargo xtask tidy`: the house rules that no compiler checks. Each rule is a function of a file's path and text in
//! [`rules`]; this file reads the files and applies the rules to them.

mod circles;
mod rules;
mod rust_code;

use std::collections::BTreeSet;
use std::fmt;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::cargo::workspace_root;
use crate::repository;

/// A broken rule and where. The line counts from 1.
#[derive(Debug, PartialEq, Eq)]
struct Violation {
    path: String,
    line: usize,
    what: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.path, self.line, self.what)
    }
}

/// A file of the repository that the rules read: its path from the root, with `/`, and its text.
struct SourceFile {
    path: String,
    text: String,
}

pub fn run() -> Result<()> {
    println!("==> tidy");
    let root = workspace_root();
    let paths = repository::paths(&root).context("step `tidy`")?;
    let files = read_text_files(&root, &paths)?;
    let mut violations = violations(&paths, &files);
    violations.extend(circles::found(&files)?);
    for violation in &violations {
        eprintln!("{violation}");
    }
    match violations.len() {
        0 => Ok(()),
        1 => bail!("step `tidy` failed: 1 violation"),
        count => bail!("step `tidy` failed: {count} violations"),
    }
}

fn read_text_files(root: &Path, paths: &BTreeSet<String>) -> Result<Vec<SourceFile>> {
    paths
        .iter()
        .filter(|path| [".rs", ".md", ".toml", ".py"].iter().any(|end| path.ends_with(end)))
        .map(|path| {
            let text = fs::read_to_string(root.join(path))
                .with_context(|| format!("step `tidy`: {path} could not be read as text"))?;
            Ok(SourceFile { path: path.clone(), text })
        })
        .collect()
}

fn violations(paths: &BTreeSet<String>, files: &[SourceFile]) -> Vec<Violation> {
    let text_of = |path: &str| {
        let file = files.iter().find(|file| file.path == path);
        file.map_or("", |file| file.text.as_str())
    };
    let equations = rules::equations(text_of(rules::THEORY));

    let mut found = Vec::new();
    for path in paths {
        found.extend(rules::telling_name(path));
        found.extend(rules::table_in_its_place(path));
    }
    for SourceFile { path, text } in files {
        found.extend(rules::clean_whitespace(path, text));
        found.extend(rules::nothing_left_to_do(path, text));
        found.extend(rules::length(path, text));
        found.extend(rules::telling_module_names(path, text));
        found.extend(rules::pure_library(path, text));
        found.extend(rules::equations_exist(path, text, &equations));
        found.extend(rules::equations_unique(path, text));
        found.extend(rules::links_lead_somewhere(path, text, paths));
    }
    found.extend(rules::version_in_changelog(text_of("Cargo.toml"), text_of("CHANGELOG.md")));
    found.sort_by(|a, b| (&a.path, a.line).cmp(&(&b.path, b.line)));
    found
}

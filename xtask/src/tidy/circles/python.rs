//! Which file of the Python package imports which.

use super::{Place, Uses};
use crate::tidy::SourceFile;

/// The package that a path is in, if it is its `__init__.py`.
pub fn package_folder(path: &str) -> Option<String> {
    path.strip_suffix("__init__.py").filter(|folder| folder.contains("/python/")).map(str::to_owned)
}

/// The imports of all files of a package.
pub fn uses(package: &str, files: &[SourceFile]) -> Uses {
    let name = package.trim_end_matches('/').rsplit('/').next().unwrap_or_default();
    let module = |path: &str| path.strip_prefix(package)?.strip_suffix(".py").map(str::to_owned);
    let modules: Vec<String> = files.iter().filter_map(|file| module(&file.path)).collect();
    let mut uses = Uses::default();
    for file in files {
        let Some(from) = module(&file.path) else { continue };
        for (number, statement) in imports(&file.text) {
            for to in imported(&statement, name).into_iter().filter(|to| modules.contains(to)) {
                uses.add(&from, &to, Place { path: file.path.clone(), line: number });
            }
        }
    }
    uses
}

/// The imports of a text, each as one line, with the line where it begins.
fn imports(text: &str) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let mut is_open = false;
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default().trim();
        match found.last_mut().filter(|_| is_open) {
            Some((_, statement)) => statement.push_str(line),
            None if line.starts_with("from ") || line.starts_with("import ") => {
                found.push((number, line.to_owned()));
            }
            None => continue,
        }
        is_open =
            found.last().is_some_and(|(_, statement)| statement.contains('(') && !statement.contains(')'));
    }
    found
}

/// The modules of the package that a statement may import.
fn imported(statement: &str, package: &str) -> Vec<String> {
    let first = |path: &str| path.split(['.', ' ']).next().unwrap_or_default().to_owned();
    let each = |listed: &str| -> Vec<String> {
        listed.replace(['(', ')'], "").split(',').map(|name| first(name.trim())).collect()
    };
    let (whole, inside) = (format!("{package} import "), format!("{package}."));
    if let Some(listed) = statement.strip_prefix("import ") {
        return listed.split(',').filter_map(|name| name.trim().strip_prefix(&inside)).map(first).collect();
    }
    let Some(from) = statement.strip_prefix("from ") else { return Vec::new() };
    if let Some(listed) = from.strip_prefix(". import ").or_else(|| from.strip_prefix(&whole)) {
        return each(listed);
    }
    from.strip_prefix('.').or_else(|| from.strip_prefix(&inside)).map(first).into_iter().collect()
}

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
        for (number, line) in (1..).zip(file.text.lines()) {
            for to in imported(line.trim(), name).filter(|to| modules.contains(to)) {
                uses.add(&from, &to, Place { path: file.path.clone(), line: number });
            }
        }
    }
    uses
}

/// The modules of the package that a line may import.
fn imported<'l>(line: &'l str, package: &str) -> impl Iterator<Item = String> + 'l {
    let first = |path: &str| path.split(['.', ' ', ',']).next().unwrap_or_default().to_owned();
    let (whole, inside) = (format!("{package} import "), format!("{package}."));
    let mut found = Vec::new();
    if let Some(from) = line.strip_prefix("from ") {
        let listed = from.strip_prefix(". import ").or_else(|| from.strip_prefix(&whole));
        if let Some(listed) = listed {
            found.extend(listed.trim_matches(['(', ')']).split(',').map(|name| first(name.trim())));
        } else if let Some(path) = from.strip_prefix('.').or_else(|| from.strip_prefix(&inside)) {
            found.push(first(path));
        }
    } else if let Some(path) = line.strip_prefix("import ").and_then(|path| path.strip_prefix(&inside)) {
        found.push(first(path));
    }
    found.into_iter()
}

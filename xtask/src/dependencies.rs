//! The dependencies part of `cargo xtask check`: licences that may be passed on, and one source. It works without
//! the internet; known vulnerabilities are in SECURITY.md.

use std::process::Command;

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::workspace_root;

/// Licences whose terms allow all that ours allow.
const ALLOWED: [&str; 8] = [
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Where every dependency comes from.
const SOURCE: &str = "registry+https://github.com/rust-lang/crates.io-index";

pub fn run() -> Result<()> {
    println!("==> dependencies");
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked"])
        .current_dir(workspace_root())
        .output()
        .context("step `dependencies`: cargo could not be started")?;
    if !output.status.success() {
        bail!("step `dependencies` failed: {}", String::from_utf8_lossy(&output.stderr).trim_end());
    }
    let metadata: Value = serde_json::from_slice(&output.stdout).context("what `cargo metadata` printed")?;
    let packages = metadata["packages"].as_array().context("`cargo metadata` names no packages")?;
    let violations: Vec<String> = packages.iter().filter_map(violation).collect();
    violations.iter().for_each(|violation| eprintln!("{violation}"));
    if violations.is_empty() { Ok(()) } else { bail!("step `dependencies` failed: {}", violations.len()) }
}

/// What is wrong with a package; those of the workspace have no source.
fn violation(package: &Value) -> Option<String> {
    let name = package["name"].as_str().unwrap_or("?");
    let source = package["source"].as_str()?;
    if source != SOURCE {
        return Some(format!("{name}: comes from {source}, not from crates.io"));
    }
    let licence = package["license"].as_str().unwrap_or("");
    (!is_allowed(licence)).then(|| format!("{name}: its licence is `{licence}`"))
}

/// True if a licence expression can be met by the licences that are allowed. Old ones have `/` for `OR`.
fn is_allowed(expression: &str) -> bool {
    let expression = expression.replace('/', " OR ").replace(['(', ')'], "");
    // In the expressions of crates, AND joins alternatives, as in `(MIT OR Apache-2.0) AND Unicode-3.0`.
    expression.split(" AND ").all(|all| all.split(" OR ").any(|one| ALLOWED.contains(&one.trim())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn licences_that_can_be_met_are_allowed() {
        for expression in [
            "MIT",
            "MIT/Apache-2.0",
            "MIT OR Apache-2.0 OR LGPL-2.1-or-later",
            "(MIT OR Apache-2.0) AND Unicode-3.0",
            "Apache-2.0 WITH LLVM-exception",
        ] {
            assert!(is_allowed(expression), "{expression}");
        }
        for expression in ["GPL-3.0", "", "MIT AND GPL-3.0", "MPL-2.0", "LGPL-2.1-or-later OR GPL-2.0"] {
            assert!(!is_allowed(expression), "{expression}");
        }
    }

    #[test]
    fn packages_from_elsewhere_and_without_a_licence_are_refused() {
        let package = |source: Value, license: &str| {
            violation(&json!({"name": "p", "source": source, "license": license}))
        };
        assert_eq!(package(Value::Null, ""), None);
        assert_eq!(package(json!(SOURCE), "MIT"), None);
        assert!(package(json!(SOURCE), "GPL-3.0").unwrap().contains("GPL-3.0"));
        assert!(package(json!("git+https://example.org/p"), "MIT").unwrap().contains("example.org"));
    }
}

//! The dependencies part of `cargo xtask check`: licences that may be passed on, one source, and crates that stay light
//! because they need none of those above them. It works without the internet; known vulnerabilities are in SECURITY.md.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::cargo::{program, workspace_root};

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

/// Crates, and what they must not need: what runs a model has neither threads nor random numbers nor checkpoints, what
/// renders a document or reads columns identifies nothing, the studio is no program, and experiments have no files and no
/// terminal.
const NOT_NEEDED: [(&str, &[&str]); 6] = [
    ("hysid-core", &["rayon", "rand", "rand_xoshiro", "rmp-serde", "rmp"]),
    ("hysid-document", &["hysid", "hysid-files", "rayon", "rand", "clap"]),
    ("hysid-records", &["hysid", "hysid-cli", "rayon", "rand", "clap"]),
    ("hysid-studio", &["hysid-cli", "clap", "indicatif", "resvg"]),
    ("hysid-app", &["hysid-cli", "clap", "anyhow"]),
    ("hysid-paper", &["hysid-cli", "hysid-files", "clap", "indicatif", "anyhow"]),
];

pub fn run() -> Result<()> {
    println!("==> dependencies");
    let output = Command::new(program())
        .args(["metadata", "--format-version", "1", "--locked"])
        .current_dir(workspace_root())
        .output()
        .context("step `dependencies`: cargo could not be started")?;
    if !output.status.success() {
        bail!("step `dependencies` failed: {}", String::from_utf8_lossy(&output.stderr).trim_end());
    }
    let metadata: Value = serde_json::from_slice(&output.stdout).context("what `cargo metadata` printed")?;
    let packages = metadata["packages"].as_array().context("`cargo metadata` names no packages")?;
    let mut violations: Vec<String> = packages.iter().filter_map(violation).collect();
    for (package, unwanted) in NOT_NEEDED {
        let needed = needed_by(package, &metadata);
        let heavy = unwanted.iter().filter(|name| needed.contains(**name));
        violations.extend(heavy.map(|name| format!("{package} depends on {name}")));
        if !needed.contains("serde") {
            violations.push(format!("{package} is not among the packages"));
        }
    }
    violations.iter().for_each(|violation| eprintln!("{violation}"));
    if violations.is_empty() { Ok(()) } else { bail!("step `dependencies` failed: {}", violations.len()) }
}

/// Fault of a package; those of the workspace have no source.
fn violation(package: &Value) -> Option<String> {
    let name = package["name"].as_str().unwrap_or("?");
    let source = package["source"].as_str()?;
    if source != SOURCE {
        return Some(format!("{name}: comes from {source}, not from crates.io"));
    }
    let licence = package["license"].as_str().unwrap_or("");
    (!is_allowed(licence)).then(|| format!("{name}: its licence is `{licence}`"))
}

/// The names of all packages that one needs to be built, in the output of `cargo metadata`.
fn needed_by(package: &str, metadata: &Value) -> BTreeSet<String> {
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let names: BTreeMap<String, String> =
        list(&metadata["packages"]).iter().map(|one| (text(&one["id"]), text(&one["name"]))).collect();
    let is_normal = |needed: &&Value| list(&needed["dep_kinds"]).iter().any(|kind| kind["kind"].is_null());
    let needed: BTreeMap<String, Vec<String>> = list(&metadata["resolve"]["nodes"])
        .iter()
        .map(|node| {
            let normal = list(&node["deps"]);
            (text(&node["id"]), normal.iter().filter(is_normal).map(|needed| text(&needed["pkg"])).collect())
        })
        .collect();
    let mut open: Vec<&String> =
        names.iter().filter(|(_, name)| *name == package).map(|(id, _)| id).collect();
    let mut seen = BTreeSet::new();
    while let Some(id) = open.pop() {
        let next = needed.get(id).into_iter().flatten().filter(|id| seen.insert((*id).clone()));
        open.extend(next.collect::<Vec<_>>());
    }
    seen.iter().filter_map(|id| names.get(id).cloned()).collect()
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
    fn packages_that_are_needed_for_tests_only_are_not_needed() {
        let package = |name: &str| json!({ "id": format!("{name} 1"), "name": name });
        let needs =
            |name: &str, kind: Value| json!({ "pkg": format!("{name} 1"), "dep_kinds": [{ "kind": kind }] });
        let node = |name: &str, deps: Vec<Value>| json!({ "id": format!("{name} 1"), "deps": deps });
        let packages = ["core", "a", "b", "rand"].map(package);
        let metadata = json!({
            "packages": packages,
            "resolve": { "nodes": [
                node("core", vec![needs("a", Value::Null), needs("rand", json!("dev"))]),
                node("a", vec![needs("b", Value::Null), needs("core", Value::Null)]),
                node("b", vec![]),
            ] },
        });
        let needed = needed_by("core", &metadata);
        assert!(needed.contains("a") && needed.contains("b") && !needed.contains("rand"), "{needed:?}");
    }

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

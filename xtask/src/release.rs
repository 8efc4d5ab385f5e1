//! `cargo xtask release`: everything of a release but the upload.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::cargo::{cargo, oldest_cargo, target, workspace_root};
use crate::python;

/// Members of the workspace that are not published as crates.
const UNPUBLISHED: [&str; 3] = ["xtask", "hysid-fuzz", "hysid-python"];

/// What the archive of every crate has.
const IN_EACH: [&str; 4] = ["LICENSE-APACHE", "LICENSE-MIT", "README.md", "Cargo.toml"];

/// What no archive has.
const IN_NONE: [&str; 4] = ["shared/", "lab/", "target/", ".ci/"];

/// Checks that all places name one version and that the oldest Rust compiles the workspace, builds each crate from its own
/// archive in order, looks into the archives, installs the program as locked, and builds and tests the source distribution of
/// the Python package in an empty environment.
pub fn run() -> Result<()> {
    let root = workspace_root();
    let text = |name: &str| fs::read_to_string(root.join(name)).with_context(|| name.to_string());
    let version = env!("CARGO_PKG_VERSION");
    let others = disagreements(version, &text("Cargo.toml")?, &text("CITATION.cff")?, &text("CHANGELOG.md")?);
    ensure!(others.is_empty(), "not all places have the version {version}:\n{}", others.join("\n"));
    let tags = git(&["tag", "--points-at", "HEAD", "v*"])?;
    let tag = format!("v{version}");
    ensure!(
        tags.is_empty() || tags.lines().any(|found| found == tag),
        "this commit has the tag {tags}, not {tag}"
    );
    ensure!(git(&["status", "--porcelain"])?.is_empty(), "there are changes that are not committed");

    let place = target()?.join("oldest");
    let place = place.to_str().context("the target folder is no text")?;
    let everything = ["--workspace", "--all-targets", "--exclude", "hysid-python"];
    oldest_cargo(&[&["check", "--locked", "--target-dir", place], &everything[..]].concat())?;
    let mut package = vec!["package", "--workspace", "--locked"];
    package.extend(UNPUBLISHED.iter().flat_map(|member| ["--exclude", member]));
    cargo(&package, &[])?;
    let archives = archives(&target()?.join("package"), version)?;
    ensure!(!archives.is_empty(), "cargo made no archive");
    for archive in &archives {
        let wrong = wrong_in(&files_of(archive)?);
        ensure!(wrong.is_empty(), "{}: {}", archive.display(), wrong.join(", "));
    }
    println!("{} archives, each with its licences and its README", archives.len());

    let place = target()?.join("release-installed");
    let place = place.to_str().context("the target folder is no text")?;
    cargo(&["install", "--locked", "--force", "--path", "crates/hysid-cli", "--root", place], &[])?;
    python::source_distribution()?;
    match tags.is_empty() {
        true => println!("ready; then: git tag {tag}, and cargo publish --workspace"),
        false => println!("ready; then: cargo publish --workspace"),
    }
    Ok(())
}

/// Places that name another version, or none.
fn disagreements(version: &str, manifest: &str, citation: &str, changelog: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let members = manifest.lines().filter(|line| line.contains("path = \"crates/"));
    let wanted = format!("version = \"{version}\"");
    found.extend(members.filter(|line| !line.contains(&wanted)).map(|line| format!("Cargo.toml: {line}")));
    if !citation.lines().any(|line| line == format!("version: {version}")) {
        found.push("CITATION.cff has no such line `version:`".into());
    }
    let newest = changelog.lines().find_map(|line| line.strip_prefix("## ")).unwrap_or_default();
    if newest.split_whitespace().next() != Some(version) {
        found.push(format!("CHANGELOG.md begins with `{newest}`"));
    }
    found
}

/// What is missing in an archive, or must not be there.
fn wrong_in(files: &[String]) -> Vec<String> {
    let missing = IN_EACH.iter().filter(|name| !files.iter().any(|file| file == *name));
    let mut wrong: Vec<String> = missing.map(|name| format!("{name} is missing")).collect();
    let is_odd = |file: &&String| IN_NONE.iter().any(|part| file.starts_with(part));
    wrong.extend(files.iter().filter(is_odd).map(|file| format!("{file} does not belong there")));
    wrong
}

/// The files of an archive, without the folder that holds them all.
fn files_of(archive: &Path) -> Result<Vec<String>> {
    let listed = output(Command::new("tar").arg("tzf").arg(archive))?;
    Ok(listed.lines().filter_map(|line| line.split_once('/')).map(|(_, file)| file.to_string()).collect())
}

/// The archives of this version in a folder.
fn archives(folder: &Path, version: &str) -> Result<Vec<PathBuf>> {
    let ending = format!("-{version}.crate");
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.to_string_lossy().ends_with(&ending) {
            found.push(path);
        }
    }
    Ok(found)
}

fn git(arguments: &[&str]) -> Result<String> {
    output(Command::new("git").args(arguments).current_dir(workspace_root()))
}

fn output(command: &mut Command) -> Result<String> {
    let ran = command.output().with_context(|| format!("{} could not be started", program_name(command)))?;
    if !ran.status.success() {
        bail!("{} failed: {}", program_name(command), String::from_utf8_lossy(&ran.stderr));
    }
    Ok(String::from_utf8_lossy(&ran.stdout).trim_end().to_string())
}

fn program_name(command: &Command) -> String {
    command.get_program().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MANIFEST: &str = "[workspace.package]\nversion = \"1.2.0\"\n\
                            hysid = { path = \"crates/hysid\", version = \"1.2.0\" }\n";

    #[test]
    fn one_version_stands_in_all_places() {
        let changelog = "# Changelog\n\n## 1.2.0\n";
        assert!(disagreements("1.2.0", MANIFEST, "version: 1.2.0\n", changelog).is_empty());
        let wrong = disagreements("1.3.0", MANIFEST, "version: 1.2.0\n", "## Unreleased\n");
        assert_eq!(wrong.len(), 3, "{wrong:?}");
    }

    #[test]
    fn archives_have_licences_and_nothing_of_the_workshop() {
        let files = |names: &[&str]| names.iter().map(|name| name.to_string()).collect::<Vec<_>>();
        assert!(wrong_in(&files(&IN_EACH)).is_empty());
        let wrong = wrong_in(&files(&["LICENSE-MIT", "README.md", "Cargo.toml", "lab/src/main.rs"]));
        assert_eq!(wrong, ["LICENSE-APACHE is missing", "lab/src/main.rs does not belong there"]);
    }
}

//! The list of an export's files with their checksums.

use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::subject::{File, Subject};

/// Name of the file.
pub const MANIFEST: &str = "manifest.json";

const FORMAT: &str = "hysid-export";

/// The files of an export, from the text of its manifest; `None` if it is none.
pub fn files_of(manifest: &str) -> Option<Vec<String>> {
    let manifest: serde_json::Value = serde_json::from_str(manifest).ok()?;
    if manifest["format"] != FORMAT {
        return None;
    }
    let paths =
        manifest["files"].as_array()?.iter().filter_map(|file| file["path"].as_str().map(String::from));
    Some(paths.collect())
}

#[derive(Serialize)]
struct Manifest<'a> {
    format: &'static str,
    version: u32,
    name: &'a str,
    target: &'static str,
    precision: &'static str,
    model: Vec<Fact<'a>>,
    files: Vec<Entry<'a>>,
}

#[derive(Serialize)]
struct Fact<'a> {
    fact: &'a str,
    value: &'a str,
}

#[derive(Serialize)]
struct Entry<'a> {
    path: &'a str,
    bytes: usize,
    sha256: String,
}

/// The text of `manifest.json`.
pub(crate) fn manifest(subject: &Subject<'_>, to: &'static str, files: &[File]) -> String {
    let facts = subject.facts();
    let manifest = Manifest {
        format: FORMAT,
        version: 1,
        name: subject.name(),
        target: to,
        precision: subject.precision().name(),
        model: facts.iter().map(|(fact, value)| Fact { fact, value }).collect(),
        files: files.iter().map(Entry::of).collect(),
    };
    let text = serde_json::to_string_pretty(&manifest).unwrap_or_default();
    text + "\n"
}

impl<'a> Entry<'a> {
    fn of(file: &'a File) -> Self {
        Self { path: &file.path, bytes: file.content.len(), sha256: checksum(&file.content) }
    }
}

/// The SHA-256 checksum in hexadecimal digits.
pub(crate) fn checksum(content: &[u8]) -> String {
    format!("{:x}", Sha256::digest(content))
}

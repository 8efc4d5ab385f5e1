//! The list of an export's files with their checksums.

use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::subject::{ExportFile, ExportSubject};

/// Name of the file.
pub const MANIFEST: &str = "manifest.json";

const FORMAT: &str = "hysid-export";

/// Name of the field with the checksum of the manifest itself, over its text with [`NO_SUM`] in this place.
const OWN_SUM: &str = "manifest_sha256";

const NO_SUM: &str = "";

/// Endings of files that exports have and nobody else's folder is likely to: what a manifest names otherwise is not removed.
const ENDINGS: [&str; 12] =
    [".c", ".h", ".cpp", ".tcl", ".m", ".py", ".onnx", ".fmu", ".csv", ".xml", "README.md", "manifest.json"];

/// The files of an export with their checksums, from the text of its manifest; `None` if Hysid did not write it so.
pub fn files_of(manifest: &str) -> Option<Vec<(String, String)>> {
    let value: serde_json::Value = serde_json::from_str(manifest).ok()?;
    let own = value[OWN_SUM].as_str()?;
    let without = manifest.replacen(&field(own), &field(NO_SUM), 1);
    if value["format"] != FORMAT || checksum(without.as_bytes()) != own {
        return None;
    }
    let entry = |file: &serde_json::Value| {
        let path =
            file["path"].as_str().filter(|path| ENDINGS.iter().any(|ending| path.ends_with(ending)))?;
        Some((path.to_string(), file["sha256"].as_str()?.to_string()))
    };
    value["files"].as_array()?.iter().map(entry).collect()
}

fn field(sum: &str) -> String {
    format!("\"{OWN_SUM}\": \"{sum}\"")
}

#[derive(Serialize)]
struct Manifest<'a> {
    format: &'static str,
    version: u32,
    manifest_sha256: &'static str,
    name: &'a str,
    target: &'static str,
    precision: &'static str,
    model: Vec<Fact<'a>>,
    files: Vec<ManifestEntry<'a>>,
}

#[derive(Serialize)]
struct Fact<'a> {
    fact: &'a str,
    value: &'a str,
}

#[derive(Serialize)]
struct ManifestEntry<'a> {
    path: &'a str,
    bytes: usize,
    sha256: String,
}

pub(crate) fn manifest(subject: &ExportSubject<'_>, to: &'static str, files: &[ExportFile]) -> String {
    let facts = subject.facts();
    let manifest = Manifest {
        format: FORMAT,
        version: 1,
        manifest_sha256: NO_SUM,
        name: subject.name(),
        target: to,
        precision: subject.precision().name(),
        model: facts.iter().map(|(fact, value)| Fact { fact, value }).collect(),
        files: files.iter().map(ManifestEntry::of).collect(),
    };
    let text = serde_json::to_string_pretty(&manifest).unwrap_or_default() + "\n";
    let sum = checksum(text.as_bytes());
    text.replacen(&field(NO_SUM), &field(&sum), 1)
}

impl<'a> ManifestEntry<'a> {
    fn of(file: &'a ExportFile) -> Self {
        Self { path: &file.path, bytes: file.content.len(), sha256: checksum(&file.content) }
    }
}

/// The SHA-256 checksum in hexadecimal digits.
pub fn checksum(content: &[u8]) -> String {
    format!("{:x}", Sha256::digest(content))
}

/// A number that distinguishes a model from others, of the source code of its step.
pub(crate) fn token_of(source: &str) -> u32 {
    u32::from_str_radix(&checksum(source.as_bytes())[..8], 16).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_manifest_made_by_hand_or_changed_is_none() {
        let text = format!(
            "{{\n  \"format\": \"hysid-export\",\n  {},\n  \"files\": [{{\"path\": \"a.c\", \"sha256\": \"1\"}}]\n}}\n",
            field(NO_SUM)
        );
        assert_eq!(files_of(&text), None);
        let ours = text.replacen(&field(NO_SUM), &field(&checksum(text.as_bytes())), 1);
        assert_eq!(files_of(&ours), Some(vec![("a.c".into(), "1".into())]));
        assert_eq!(files_of(&ours.replace("a.c", "b.c")), None);
    }

    #[test]
    fn a_manifest_lists_files_of_exports_alone() {
        let listed = |path: &str| {
            let entry = format!("{{\"path\": \"{path}\", \"sha256\": \"00\"}}");
            let text = format!("{{\"format\": \"{FORMAT}\", {}, \"files\": [{entry}]}}", field(NO_SUM));
            let own = checksum(text.as_bytes());
            files_of(&text.replacen(&field(NO_SUM), &field(&own), 1))
        };
        assert_eq!(listed("stage.c"), Some(vec![("stage.c".into(), "00".into())]));
        for other in ["LICENSE", ".git/HEAD", "thesis.doc"] {
            assert_eq!(listed(other), None, "{other}");
        }
    }
}

//! `generate-files DIR`: small files with one and the same record as instruments and tools write it, for the
//! tests of `hysid look`. `DIR` is `crates/hysid-cli/tests/files`.

mod binary;
mod instruments;
mod record;
mod text;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

/// A file of the collection.
pub struct File {
    /// Its name.
    pub name: &'static str,
    /// What it contains.
    pub content: Vec<u8>,
}

/// All files.
pub fn all() -> Vec<File> {
    let texts = text::all().into_iter().chain(instruments::all());
    let texts = texts.map(|(name, text)| File { name, content: text.into_bytes() });
    texts.chain(binary::all()).collect()
}

/// Writes all files into a folder.
pub fn run(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("{} cannot be made", folder.display()))?;
    for file in all() {
        write(&folder.join(file.name), &file.content)?;
    }
    Ok(())
}

fn write(path: &Path, content: &[u8]) -> Result<()> {
    fs::write(path, content).with_context(|| format!("{} cannot be written", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compressed files depend on the version of the compressor.
    const COMPRESSED: [&str; 3] = [".gz", ".xlsx", ".mat"];

    #[test]
    fn the_collection_is_what_the_command_writes() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/hysid-cli/tests/files");
        let mut names: Vec<String> = all().iter().map(|file| file.name.to_string()).collect();
        for file in all() {
            let found =
                fs::read(folder.join(file.name)).unwrap_or_else(|error| panic!("{}: {error}", file.name));
            let is_compressed = COMPRESSED.iter().any(|ending| file.name.ends_with(ending));
            assert!(is_compressed || found == file.content, "{} differs: run `generate-files`", file.name);
        }
        let entries = fs::read_dir(folder).unwrap();
        let mut found: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        found.sort();
        assert_eq!(found, names);
    }
}

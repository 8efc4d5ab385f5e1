//! How a page was made: when, by which command, from which files.

use std::fs::File;
use std::io;
use std::path::Path;

use anyhow::Result;
use hysid_document::{Page, Part};
use hysid_files::Destination;
use sha2::{Digest, Sha256};

use crate::{date, files};

/// Writes a page, as [`files::write`] does. Its last section says how it was made, from these files.
pub fn write_page(destination: &Destination, mut page: Page, inputs: &[&Path]) -> Result<()> {
    page.parts.push(section(inputs));
    files::write(destination, files::page_text(&page).as_bytes())
}

/// The last section of a page: date, program, command, and files that were read with their checksums.
fn section(inputs: &[&Path]) -> Part {
    let mut pairs = vec![
        ("Date".to_string(), format!("{} UTC", date::now())),
        ("Program".into(), format!("hysid {}", env!("CARGO_PKG_VERSION"))),
        ("Command".into(), command()),
    ];
    for path in inputs {
        let sum = match checksum(path) {
            Some(sum) => format!("SHA-256 {sum}"),
            None => "no checksum: standard input, or the file can no longer be read".into(),
        };
        pairs.push((format!("Read: {}", path.display()), sum));
    }
    Part::section("How this page was made", [Part::Definitions(pairs)])
}

/// The command line as a shell takes it.
fn command() -> String {
    let arguments = std::env::args_os().skip(1);
    let shown = arguments.map(|argument| files::shown(Path::new(&argument)));
    std::iter::once("hysid".to_string()).chain(shown).collect::<Vec<_>>().join(" ")
}

/// The checksum of a file as `sha256sum` prints it; `None` if it cannot be read (again).
fn checksum(path: &Path) -> Option<String> {
    let mut sum = Sha256::new();
    io::copy(&mut File::open(path).ok()?, &mut sum).ok()?;
    Some(format!("{:x}", sum.finalize()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_are_those_of_sha256sum() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("abc.csv");
        std::fs::write(&path, "abc").unwrap();
        // The first example of FIPS 180-2.
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(checksum(&path).as_deref(), Some(expected));
        assert_eq!(checksum(&folder.path().join("none.csv")), None);
        let Part::Section(_, parts) = section(&[&path]) else { panic!("a section") };
        let [Part::Definitions(pairs)] = &*parts else { panic!("definitions") };
        assert_eq!(pairs[3], (format!("Read: {}", path.display()), format!("SHA-256 {expected}")));
    }
}

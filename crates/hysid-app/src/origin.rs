//! How a page was made: when, by which command, from which files.

use std::fs::File;
use std::io;
use std::path::Path;

use hysid_document::Part;
use sha2::{Digest, Sha256};

use crate::date;

/// The last section of a page: date, program, command, and files that were read with their checksums.
pub fn section(command: &str, inputs: &[&Path]) -> Part {
    let mut pairs = vec![
        ("Date".to_string(), format!("{} UTC", date::now())),
        ("Program".into(), format!("hysid {}", env!("CARGO_PKG_VERSION"))),
        ("Command".into(), command.into()),
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
        let Part::Section(_, parts) = section("hysid look", &[&path]) else { panic!("a section") };
        let [Part::Definitions(pairs)] = &*parts else { panic!("definitions") };
        assert_eq!(pairs[3], (format!("Read: {}", path.display()), format!("SHA-256 {expected}")));
    }
}

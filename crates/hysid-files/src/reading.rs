//! Opening files to read them.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crate::failure::reason;

pub fn open(path: &Path) -> Result<File, String> {
    let name = path.display().to_string();
    match File::open(path) {
        _ if path.is_dir() => Err(format!("{name}: is a directory, not a file")),
        Ok(file) => Ok(file),
        Err(error) => Err(unreadable(&name, &error)),
    }
}

/// The largest model, checkpoint, project or report that is read, in bytes.
const LARGEST: u64 = 1 << 28;

/// All of a file that is not a table.
///
/// # Errors
/// As [`open`]; a file of more than 256 MB.
pub fn read(path: &Path) -> Result<Vec<u8>, String> {
    let file = open(path)?;
    let name = path.display().to_string();
    // What has no length, such as a pipe, is read as far as it may be long.
    match file.metadata() {
        Ok(found) if found.is_file() && found.len() > LARGEST => Err(too_large(&name)),
        _ => read_from(&name, file),
    }
}

/// As [`read`], from what is open under this name.
pub fn read_from(name: &str, from: impl Read) -> Result<Vec<u8>, String> {
    let mut content = Vec::new();
    from.take(LARGEST + 1).read_to_end(&mut content).map_err(|error| unreadable(name, &error))?;
    if content.len() as u64 > LARGEST { Err(too_large(name)) } else { Ok(content) }
}

fn too_large(name: &str) -> String {
    format!("{name}: has more than {} MB", LARGEST >> 20)
}

/// The checksum of a content, by which a file is known that somebody changed: CRC-32.
pub fn checksum(from: impl Read) -> io::Result<String> {
    Ok(format!("{:08x}", checksum_of(from)?))
}

pub(crate) fn checksum_of(mut from: impl Read) -> io::Result<u32> {
    let mut sum = crc32fast::Hasher::new();
    let mut block = vec![0; 1 << 16];
    loop {
        match from.read(&mut block)? {
            0 => return Ok(sum.finalize()),
            read => sum.update(&block[..read]),
        }
    }
}

/// Message for a file of this name that cannot be read.
pub fn unreadable(name: &str, error: &io::Error) -> String {
    format!("{name}: cannot be read: {}", reason(error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_never_ends_is_refused() {
        assert_eq!(read_from("x", io::repeat(b'0')).unwrap_err(), "x: has more than 256 MB");
        assert_eq!(read_from("x", &b"12"[..]).unwrap(), b"12");
    }
}

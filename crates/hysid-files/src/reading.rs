//! Opening files to read them.

use std::fs::File;
use std::io;
use std::path::Path;

use crate::failure::reason;

/// A file, to be read.
///
/// # Errors
/// Why it cannot be read, with its name.
pub fn open(path: &Path) -> Result<File, String> {
    let name = path.display().to_string();
    match File::open(path) {
        _ if path.is_dir() => Err(format!("{name}: is a directory, not a file")),
        Ok(file) => Ok(file),
        Err(error) => Err(unreadable(&name, &error)),
    }
}

/// What is said of a file of this name that cannot be read.
pub fn unreadable(name: &str, error: &io::Error) -> String {
    format!("{name}: cannot be read: {}", reason(error))
}

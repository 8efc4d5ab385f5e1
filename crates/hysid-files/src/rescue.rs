//! Where to put a file that took long to compute and cannot be written where it was asked for.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::target::Target;
use crate::temporary::{folder_of, plain};

/// Writes the content under a new name: beside the file that could not be written, in the system's folder for temporary
/// files, or in the user's home. Gives its path; `None` if that failed everywhere.
pub fn rescue(path: &Path, content: &[u8]) -> Option<PathBuf> {
    // Nothing is put beside a device or a pipe.
    let is_stream = matches!(Target::of(path), Ok(Target::Stream(_) | Target::Stdout));
    let beside = (!is_stream).then(|| folder_of(path).to_path_buf());
    let folders = [beside, Some(std::env::temp_dir()), std::env::home_dir()];
    folders.into_iter().flatten().find_map(|folder| write_new(&folder, path, content).ok())
}

/// Writes a new file `STEM-XXXXXX.EXTENSION` into the folder.
fn write_new(folder: &Path, path: &Path, content: &[u8]) -> io::Result<PathBuf> {
    let part = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
    let beginning = format!("{}-", part(path.file_stem()));
    let ending = path.extension().map_or_else(String::new, |ending| format!(".{}", part(Some(ending))));
    let mut builder = tempfile::Builder::new();
    builder.prefix(&beginning).suffix(&ending);
    let mut file = builder.tempfile_in(folder).map_err(plain)?;
    file.write_all(content)?;
    file.as_file().sync_all()?;
    Ok(file.keep().map_err(|error| error.error)?.1)
}

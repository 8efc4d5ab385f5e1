//! Files that commands write.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

/// The last part of a path.
pub fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Writes a file by way of another beside it: it is there completely or as it was.
pub fn write(path: &Path, text: &str) -> Result<()> {
    let partial = path.with_file_name(format!(".{}.partial", name(path)));
    fs::write(&partial, text)
        .and_then(|()| fs::rename(&partial, path))
        .with_context(|| format!("{} cannot be written", path.display()))
}

/// Refuses, before long work, a file that could not be written.
pub fn check_writable(path: &Path) -> Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if path.is_dir() || !folder.is_dir() {
        bail!("{} cannot be written: name a file in a folder that is there", path.display());
    }
    Ok(())
}

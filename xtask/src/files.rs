//! Files that commands write.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

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

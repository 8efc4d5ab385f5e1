//! The files of the repository.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail};

/// Every file that is in the repository or would be if all were added: tracked or not, but not ignored.
pub fn paths(root: &Path) -> Result<BTreeSet<String>> {
    let git = Command::new("git")
        .args(["ls-files", "-co", "--exclude-standard", "-z"])
        .current_dir(root)
        .output()
        .context("git could not be started")?;
    if !git.status.success() {
        let message = String::from_utf8_lossy(&git.stderr);
        bail!("git ls-files failed: {}", message.trim());
    }
    let listing = String::from_utf8(git.stdout).context("a path is not UTF-8")?;
    Ok(listing
        .split_terminator('\0')
        .filter(|path| root.join(path).is_file()) // git still lists tracked files that were deleted
        .map(str::to_owned)
        .collect())
}

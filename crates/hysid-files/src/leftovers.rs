//! Temporary files and folders of processes that were killed.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::Path;

use crate::temporary::{ENDING, RANDOM_LETTERS, beginning, folder_of, is_linked};

/// Removes the temporary files and folders of a target whose processes are dead. What cannot be removed stays: it does no harm.
pub(crate) fn clean(target: &Path) {
    let beginning = beginning(target);
    let Ok(entries) = fs::read_dir(folder_of(target)) else { return };
    for entry in entries.flatten() {
        if entry.file_name().to_str().is_some_and(|name| is_temporary(name, &beginning)) {
            let _ = remove_if_abandoned(&entry.path());
        }
    }
}

fn is_temporary(name: &str, beginning: &str) -> bool {
    let letters = name.strip_prefix(beginning).and_then(|rest| rest.strip_suffix(ENDING));
    letters.is_some_and(|letters| {
        letters.len() == RANDOM_LETTERS && letters.bytes().all(|letter| letter.is_ascii_alphanumeric())
    })
}

/// A living process holds a lock on its file.
fn remove_if_abandoned(path: &Path) -> io::Result<()> {
    let found = fs::symlink_metadata(path)?.file_type();
    if !found.is_file() && !found.is_dir() {
        return Ok(());
    }
    let file = open_without_following(path)?;
    if file.try_lock().is_ok() && is_linked(&file, path) {
        return if found.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    }
    Ok(())
}

fn open_without_following(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        // A pipe of this name, put there meanwhile, would block.
        options.custom_flags(libc::O_NOFOLLOW | libc::O_NONBLOCK);
    }
    options.open(path)
}

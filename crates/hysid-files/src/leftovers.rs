//! Temporary files and folders of processes that were killed.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::Path;

use crate::temporary::{ENDING, RANDOM_LETTERS, beginning, folder_of, is_linked};

/// Removes the temporary files and folders of a target whose processes are dead. What cannot be removed stays: it does no harm.
pub(crate) fn clean(target: &Path) {
    let beginning = beginning(target);
    clean_named(folder_of(target), |name| name.strip_prefix(&beginning));
}

/// Removes from a folder the temporary files and folders of all targets whose processes are dead.
pub fn remove_leftovers(folder: &Path) {
    clean_named(folder, |name| name.strip_prefix('.')?.rsplit_once('.').map(|(_, letters)| letters));
}

/// `letters` gives the random letters of a name without its ending, if the name may be one of a temporary file.
fn clean_named(folder: &Path, letters: impl Fn(&str) -> Option<&str>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let is_random = |letters: &str| {
        letters.len() == RANDOM_LETTERS && letters.bytes().all(|letter| letter.is_ascii_alphanumeric())
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_str().and_then(|name| name.strip_suffix(ENDING));
        if name.and_then(&letters).is_some_and(is_random) {
            let _ = remove_if_abandoned(&entry.path());
        }
    }
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

//! Changes of files in a folder that are made together or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::temporary::{self, TemporaryFolder};
use crate::{backup, leftovers};

/// Changes of files in a folder. New files wait in a temporary folder there until all are written.
pub(super) struct Changes {
    root: PathBuf,
    waiting: TemporaryFolder,
    changes: Vec<Change>,
}

struct Change {
    name: String,
    /// False for a file that is removed.
    is_new: bool,
    /// The old file is kept as `NAME.bak`.
    is_kept: bool,
}

/// How far a change is.
struct Done {
    target: PathBuf,
    /// Where the old file is meanwhile.
    old: Option<PathBuf>,
    is_new: bool,
}

impl Changes {
    /// None so far. Removes what killed processes left behind.
    pub fn begin(root: &Path, manifest: &str) -> io::Result<Self> {
        leftovers::clean(&root.join(manifest));
        let waiting = temporary::create_folder(&root.join(manifest))?;
        Ok(Self { root: root.to_path_buf(), waiting, changes: Vec::new() })
    }

    /// True for the temporary folder.
    pub fn is_own(&self, entry: &fs::DirEntry) -> bool {
        entry.file_name() == self.waiting.path().file_name().unwrap_or_default()
    }

    pub fn add(&mut self, name: &str, content: &[u8], is_kept: bool) -> io::Result<()> {
        temporary::write_synced(&self.waiting.path().join("new").join(name), content)?;
        self.changes.push(Change { name: name.into(), is_new: true, is_kept });
        Ok(())
    }

    /// A file that is to be gone.
    pub fn remove(&mut self, name: &str) {
        self.changes.push(Change { name: name.into(), is_new: false, is_kept: false });
    }

    /// Makes all changes; gives the copies of files that are kept. If one fails, those before are taken back.
    pub fn commit(self) -> io::Result<Vec<PathBuf>> {
        let mut done = Vec::new();
        let mut kept = Vec::new();
        for change in &self.changes {
            if let Err(error) = self.make(change, &mut done, &mut kept) {
                for Done { target, old, is_new } in done.into_iter().rev() {
                    match old {
                        Some(old) => drop(fs::rename(old, target)),
                        None if is_new => drop(fs::remove_file(target)),
                        None => {}
                    }
                }
                kept.iter().for_each(|copy| drop(fs::remove_file(copy)));
                return Err(error);
            }
        }
        temporary::sync_folder(&self.root);
        Ok(kept)
    }

    fn make(&self, change: &Change, done: &mut Vec<Done>, kept: &mut Vec<PathBuf>) -> io::Result<()> {
        let target = self.root.join(&change.name);
        fs::create_dir_all(temporary::folder_of(&target))?;
        let found = fs::symlink_metadata(&target);
        let is_there = found.is_ok();
        // What was put there meanwhile is not moved.
        if found.is_ok_and(|found| !found.is_file()) {
            return Err(io::ErrorKind::AlreadyExists.into());
        }
        if change.is_kept {
            kept.push(backup::copied_aside(&target)?);
        }
        let old = self.waiting.path().join("old").join(&change.name);
        if is_there {
            fs::create_dir_all(temporary::folder_of(&old))?;
            fs::rename(&target, &old)?;
        }
        done.push(Done { target: target.clone(), old: is_there.then_some(old), is_new: change.is_new });
        if change.is_new {
            fs::rename(self.waiting.path().join("new").join(&change.name), &target)?;
        }
        Ok(())
    }
}

//! Which files of data are being read. A file whose reading killed the studio is held back at the next start, so that it
//! can be removed.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

use super::{Folder, ProjectFolder};
use hysid_document::{Result, problem};

/// Begins the names of empty files that mark which data were being read. The number of the file follows.
const READING: &str = ".reading-";

/// Files that are held back, until one is read again or removed.
#[derive(Debug, Default)]
pub(super) struct Readings(Mutex<ReadingState>);

#[derive(Debug, Default)]
struct ReadingState {
    held_back: HashSet<u64>,
    is_ending: bool,
}

impl Readings {
    /// Those that a studio left in a folder of data when it was killed.
    pub fn left_in(data: &Path) -> Self {
        Self(Mutex::new(ReadingState { held_back: numbers(data), is_ending: false }))
    }
}

impl Folder {
    /// The content of a file of data, which `read` takes apart. If that ends the process, the file is held back at the
    /// next start.
    pub fn read_data<T>(&self, id: u64, name: &str, read: impl FnOnce(Vec<u8>) -> Result<T>) -> Result<T> {
        let (path, mark) = (self.data(name), self.mark_of_reading(id));
        self.check_file(&path)?;
        {
            let readings = self.readings();
            if readings.held_back.contains(&id) {
                let words = "the studio was killed while it read this file: remove it, or read it again";
                return Err(problem!("{name}: {words}"));
            }
            if !readings.is_ending {
                let _ = fs::File::create_new(&mark);
            }
        }
        let result = self.read(&path).and_then(read);
        self.remove(&mark);
        result
    }

    /// True for a file that is not read because that ended the studio before.
    pub fn is_held_back(&self, id: u64) -> bool {
        self.readings().held_back.contains(&id)
    }

    /// No longer holds a file back.
    pub fn release(&self, id: u64) {
        if self.readings().held_back.remove(&id) {
            self.remove(&self.mark_of_reading(id));
        }
    }

    /// The process ends in good order: what is being read now is not to be held back.
    pub fn end_readings(&self) {
        let mut readings = self.readings();
        readings.is_ending = true;
        for id in numbers(&self.root.join(ProjectFolder::Data.name())) {
            if !readings.held_back.contains(&id) {
                self.remove(&self.mark_of_reading(id));
            }
        }
    }

    fn mark_of_reading(&self, id: u64) -> PathBuf {
        self.root.join(ProjectFolder::Data.name()).join(format!("{READING}{id}"))
    }

    fn readings(&self) -> MutexGuard<'_, ReadingState> {
        self.readings.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

/// Numbers of the files that were being read.
fn numbers(data: &Path) -> HashSet<u64> {
    let entries = fs::read_dir(data).into_iter().flatten().flatten();
    let number = |entry: fs::DirEntry| entry.file_name().to_str()?.strip_prefix(READING)?.parse::<u64>().ok();
    entries.filter_map(number).collect()
}

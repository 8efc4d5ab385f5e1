//! A lock for a file that is written again and again. It ends with its process, however that ends.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::target::Target;
use crate::temporary::{folder_of, is_linked};

/// Attempts to lock a file that its last owner removes at the same moment.
const ATTEMPTS: usize = 100;

/// A lock on a file. The system's lock is on an empty file `.NAME.lock` beside it, since the file itself is replaced.
#[derive(Debug)]
pub struct Lock {
    held: Option<(File, PathBuf)>,
}

impl Lock {
    /// Name of the empty file that is locked for a file of this name.
    pub(crate) fn name_beside(name: &str) -> String {
        format!(".{name}.lock")
    }

    /// Locks a file. Devices and pipes, and files on systems without locks, need none and get none.
    ///
    /// # Errors
    /// [`Failure::InUse`] if another process holds the lock; a place that cannot be written to.
    pub fn acquire(path: &Path) -> Result<Self, Failure> {
        let target = match Target::of(path).map_err(Failure::refused(path))? {
            Target::File(target) => target,
            Target::Stream(_) | Target::Stdout => return Ok(Self { held: None }),
        };
        let name = target.file_name().unwrap_or_default().to_string_lossy();
        let place = folder_of(&target).join(Self::name_beside(&name));
        for _ in 0..ATTEMPTS {
            let file = open(&place).map_err(Failure::refused(path))?;
            match file.try_lock() {
                // The owner before may have removed the file between opening and locking.
                Ok(()) if is_linked(&file, &place) => return Ok(Self { held: Some((file, place)) }),
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(Failure::InUse(path.to_path_buf())),
                Err(TryLockError::Error(_)) => return Ok(Self { held: None }),
            }
        }
        Err(Failure::InUse(path.to_path_buf()))
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        if let Some((locked, place)) = &self.held
            // A file of the user's may have this name.
            && locked.metadata().is_ok_and(|file| file.len() == 0)
        {
            // Whoever opened it meanwhile notices that it is gone. One that stays behind does no harm.
            let _ = fs::remove_file(place);
        }
    }
}

fn open(place: &Path) -> std::io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(libc::O_NOFOLLOW);
    }
    options.open(place)
}

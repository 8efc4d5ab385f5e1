//! Temporary files beside a target. Their names contain the target's, and a lock shows that their process lives.

use std::ffi::OsString;
use std::fs::{File, TryLockError};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempDir};

pub(crate) const RANDOM_LETTERS: usize = 8;

pub(crate) const ENDING: &str = ".hysid-partial";

/// Letters of the target's name that are kept: file systems allow 255 bytes in all.
const MOST_LETTERS: usize = 50;

/// Attempts to keep a file that another process takes for a leftover.
const ATTEMPTS: usize = 16;

/// Begins the names of all temporary files of a target.
pub(crate) fn beginning(target: &Path) -> String {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    format!(".{}.", name.chars().take(MOST_LETTERS).collect::<String>())
}

pub(crate) fn folder_of(target: &Path) -> &Path {
    match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// The target's path with an ending behind its name.
pub(crate) fn with_ending(target: &Path, ending: &str) -> PathBuf {
    let mut name = OsString::from(target);
    name.push(ending);
    name.into()
}

/// A builder of temporary files of a target.
pub(crate) fn builder<'a>(beginning: &'a str) -> tempfile::Builder<'a, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(beginning).suffix(ENDING).rand_bytes(RANDOM_LETTERS);
    builder
}

/// Creates a temporary file beside a target, under a name that was not there, and locks it. A file that replaces
/// nobody's gets the permissions that the user's mask leaves; any other is private until it has those of the old file.
pub(crate) fn create(target: &Path) -> io::Result<NamedTempFile> {
    let beginning = beginning(target);
    let mut builder = builder(&beginning);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = if target.exists() { 0o600 } else { 0o666 };
        builder.permissions(std::fs::Permissions::from_mode(mode));
    }
    for _ in 0..ATTEMPTS {
        let file = builder.tempfile_in(folder_of(target)).map_err(plain)?;
        match file.as_file().try_lock() {
            // Without locks on this file system, leftovers are not cleaned either.
            Ok(()) | Err(TryLockError::Error(_)) if is_linked(file.as_file(), file.path()) => {
                return Ok(file);
            }
            _ => {}
        }
    }
    Err(io::Error::other("temporary files vanish as soon as they are made"))
}

/// The error without the name of the temporary file, which tempfile adds.
pub(crate) fn plain(error: io::Error) -> io::Error {
    match error.raw_os_error() {
        Some(number) => io::Error::from_raw_os_error(number),
        None => error.kind().into(),
    }
}

/// True if the open file is still the one of this name.
#[cfg(unix)]
pub(crate) fn is_linked(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |metadata: std::fs::Metadata| (metadata.dev(), metadata.ino());
    match (file.metadata(), std::fs::symlink_metadata(path)) {
        (Ok(open), Ok(named)) => place(open) == place(named),
        _ => false,
    }
}

/// True if the open file is still the one of this name: elsewhere than on Unix an open file keeps its name.
#[cfg(not(unix))]
pub(crate) fn is_linked(_: &File, path: &Path) -> bool {
    path.exists()
}

/// A temporary folder, removed unless it is renamed. A lock shows that its process lives.
pub(crate) struct TemporaryFolder {
    folder: TempDir,
    /// Elsewhere than on Unix a folder cannot be opened, and leftovers stay.
    _lock: Option<File>,
}

impl TemporaryFolder {
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

pub(crate) fn create_folder(target: &Path) -> io::Result<TemporaryFolder> {
    let folder = builder(&beginning(target)).tempdir_in(folder_of(target)).map_err(plain)?;
    let lock = File::open(folder.path()).ok().filter(|lock| lock.try_lock().is_ok());
    Ok(TemporaryFolder { folder, _lock: lock })
}

/// Gives a temporary folder the permissions that the user's mask leaves for new ones.
pub(crate) fn publish(folder: &Path) -> io::Result<()> {
    #[cfg(unix)]
    {
        // That of a folder that is made there in the usual way.
        let probe = folder.join(".mode");
        std::fs::create_dir(&probe)?;
        let permissions = std::fs::metadata(&probe)?.permissions();
        std::fs::remove_dir(&probe)?;
        std::fs::set_permissions(folder, permissions)?;
    }
    #[cfg(not(unix))]
    let _ = folder;
    Ok(())
}

/// Writes a new file to the disk, with the folders that it is in.
pub(crate) fn write_synced(path: &Path, content: &[u8]) -> io::Result<()> {
    std::fs::create_dir_all(folder_of(path))?;
    let mut file = File::create_new(path)?;
    file.write_all(content)?;
    file.sync_all()
}

/// After a power failure a renamed file is where it was put only if its folder is on the disk too.
pub(crate) fn sync_folder(folder: &Path) {
    #[cfg(unix)]
    // Some file systems cannot, and the file is written all the same.
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
    #[cfg(not(unix))]
    let _ = folder;
}

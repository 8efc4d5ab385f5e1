//! Why a file was not written, in one line.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file was not written.
#[derive(Debug)]
pub enum Failure {
    /// A file is there already that Hysid did not write.
    NotOurs {
        path: PathBuf,
        /// Expected kind of file, such as "model of Hysid".
        expected: &'static str,
    },
    /// A file of a folder is not as Hysid wrote it.
    Changed(PathBuf),
    /// A link, a device or a folder is in the place of a file.
    NotPlain(PathBuf),
    HoldsInput {
        folder: PathBuf,
        input: PathBuf,
    },
    /// Another process holds the lock of the file.
    InUse(PathBuf),
    Refused {
        path: PathBuf,
        error: io::Error,
    },
}

impl Failure {
    pub(crate) fn refused(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        |error| Self::Refused { path, error }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotOurs { path, expected } => {
                write!(f, "{}: a file is there already and is no {expected}", path.display())
            }
            Self::Changed(path) => {
                write!(f, "{}: this file is not as Hysid wrote it", path.display())
            }
            Self::NotPlain(path) => {
                write!(f, "{}: a link, a folder or a device is in the place of this file", path.display())
            }
            Self::HoldsInput { folder, input } => {
                let (folder, input) = (folder.display(), input.display());
                write!(f, "{folder}: holds {input}, which is read: results go to a folder of their own")
            }
            Self::InUse(path) => write!(f, "{}: another process is writing this file", path.display()),
            Self::Refused { path, error } => {
                write!(f, "{}: cannot be written: {}", path.display(), reason(error))
            }
        }
    }
}

impl std::error::Error for Failure {}

/// Why an operation on a file failed, without the system's numbers.
pub fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "no such file or directory".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        io::ErrorKind::StorageFull => "the disk is full".into(),
        io::ErrorKind::QuotaExceeded => "the disk quota is used up".into(),
        io::ErrorKind::ReadOnlyFilesystem => "the disk is read-only".into(),
        io::ErrorKind::FileTooLarge => "the file grew beyond the size allowed here".into(),
        _ => {
            let text = error.to_string();
            let end = text.find(" (os error").unwrap_or(text.len());
            let mut letters = text[..end].chars();
            let first = letters.next().map(|first| first.to_lowercase().to_string());
            first.unwrap_or_default() + letters.as_str()
        }
    }
}

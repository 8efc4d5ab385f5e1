//! Reading and writing whole files. Writing is atomic: a file is there completely or as it was.

use std::fs;
use std::io::{self, Write};
use std::path::{self, Path, PathBuf};

use anyhow::{Result, anyhow, bail};
use tempfile::NamedTempFile;

/// Why an operation on a file failed, in the program's words.
pub fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "no such file or directory".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        io::ErrorKind::StorageFull => "the disk is full".into(),
        io::ErrorKind::ReadOnlyFilesystem => "the disk is read-only".into(),
        io::ErrorKind::FileTooLarge => "the file grew beyond the size allowed here".into(),
        _ => {
            let text = error.to_string();
            let end = text.find(" (os error").unwrap_or(text.len());
            text[..end].to_lowercase()
        }
    }
}

/// The content of a file.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    match fs::read(path) {
        Ok(bytes) => Ok(bytes),
        Err(_) if path.is_dir() => bail!("{}: is a directory, not a file", path.display()),
        Err(error) => bail!("{}: cannot be read: {}", path.display(), reason(&error)),
    }
}

/// Writes a file by way of a temporary one beside it, so that an old file survives any failure.
pub fn write(path: &Path, content: &[u8]) -> Result<()> {
    put(path, content).map_err(|error| anyhow!("{}: cannot be written: {}", path.display(), reason(&error)))
}

/// Writes a file again and again: as [`write()`], but by way of a temporary file that always has the same
/// name, so that a process killed in the middle leaves at most that one behind, and the next replaces it.
pub fn replace(path: &Path, content: &[u8]) -> Result<()> {
    let attempt = || {
        let target = target(path);
        let mut name = std::ffi::OsString::from(".");
        name.push(target.file_name().unwrap_or_default());
        name.push(".partial");
        let partial = target.with_file_name(name);
        let mut file = fs::File::create(&partial)?;
        file.write_all(content)?;
        file.sync_all()?;
        fs::rename(&partial, &target)
    };
    attempt().map_err(|error| anyhow!("{}: cannot be written: {}", path.display(), reason(&error)))
}

/// Refuses, before long work, a path that could not be written to.
pub fn check_writable(path: &Path) -> Result<()> {
    let attempt = || match fs::metadata(path) {
        Ok(there) if there.is_dir() => Err(io::Error::from(io::ErrorKind::IsADirectory)),
        Ok(there) if !there.is_file() => Ok(()),
        _ => temporary_beside(&target(path)).map(drop),
    };
    attempt().map_err(|error| anyhow!("{}: cannot be written: {}", path.display(), reason(&error)))
}

/// True if both are the same file, under whatever name.
pub fn same(a: &Path, b: &Path) -> bool {
    match (fs::canonicalize(a), fs::canonicalize(b)) {
        (Ok(a), Ok(b)) => a == b,
        // At least one is not there yet.
        _ => match (path::absolute(a), path::absolute(b)) {
            (Ok(a), Ok(b)) => a == b,
            _ => a == b,
        },
    }
}

/// The path as an argument of a shell command.
pub fn shown(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/._-+:@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}

fn put(path: &Path, content: &[u8]) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(there) if there.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        // A device or a pipe has no old content to save.
        Ok(there) if !there.is_file() => {
            return fs::OpenOptions::new().write(true).open(path)?.write_all(content);
        }
        _ => {}
    }
    let target = target(path);
    let mut file = temporary_beside(&target)?;
    file.write_all(content)?;
    file.as_file().sync_all()?;
    if let Ok(old) = fs::metadata(&target) {
        fs::set_permissions(file.path(), old.permissions())?;
    }
    file.persist(&target).map_err(|error| error.error)?;
    Ok(())
}

/// Where a path leads, links followed.
fn target(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf())
}

fn temporary_beside(path: &Path) -> io::Result<NamedTempFile> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".hysid-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What the user's mask leaves of these.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    // tempfile's own text names the temporary file; its kind and number say why.
    builder.tempfile_in(folder).map_err(|error| match error.raw_os_error() {
        Some(number) => io::Error::from_raw_os_error(number),
        None => error.kind().into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_file_replaces_the_old_and_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        for content in ["one", "two, longer"] {
            write(&path, content.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), content);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn reasons_are_short() {
        let folder = tempfile::tempdir().unwrap();
        let nowhere = folder.path().join("missing/a.json");
        let error = write(&nowhere, b"").unwrap_err().to_string();
        assert!(error.ends_with("cannot be written: no such file or directory"), "{error}");
        let error = check_writable(folder.path()).unwrap_err().to_string();
        assert!(error.ends_with("is a directory"), "{error}");
    }

    #[test]
    fn a_file_is_the_same_under_any_name_even_before_it_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let detour = folder.path().join("./a.csv");
        assert!(same(&path, &detour));
        write(&path, b"x").unwrap();
        assert!(same(&path, &detour));
        assert!(!same(&path, &folder.path().join("b.csv")));
        assert!(same(Path::new("./new.csv"), Path::new("new.csv")));
    }

    #[test]
    fn shell_arguments_are_quoted_where_needed() {
        assert_eq!(shown(Path::new("a/b-1.csv")), "a/b-1.csv");
        assert_eq!(shown(Path::new("my data.csv")), "'my data.csv'");
    }
}

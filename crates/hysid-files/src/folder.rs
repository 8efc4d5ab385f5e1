//! Writing a folder whole or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::temporary;

/// A folder that is written at once. One of its files, the manifest, lists the others.
#[derive(Debug)]
pub struct Folder<'a> {
    /// Where it is to be.
    pub path: &'a Path,
    /// What it is, such as `export of Hysid`.
    pub what: &'static str,
    /// Name of the manifest.
    pub manifest: &'static str,
    /// The files that the text of a manifest lists; `None` if the text is no manifest.
    pub listed: fn(&str) -> Option<Vec<String>>,
    /// Replace a folder that Hysid did not write, with all that is in it.
    pub force: bool,
}

impl Folder<'_> {
    /// Writes the files, each with its path in the folder. A folder that is there already is replaced if it is empty, or
    /// holds nothing but what its own manifest lists.
    ///
    /// The files are written into a folder beside it, which is then renamed.
    ///
    /// # Errors
    /// A file or somebody else's folder at the path; what the system refuses. Nothing is then changed.
    pub fn write(&self, files: &[(&str, &[u8])]) -> Result<(), Failure> {
        let refused = || Failure::refused(self.path);
        let exists = self.check_old()?;
        let beside = temporary::folder_of(self.path);
        fs::create_dir_all(beside).map_err(refused())?;
        let beginning = temporary::beginning(self.path);
        let mut builder = temporary::builder(&beginning);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o777));
        }
        let new = builder.tempdir_in(beside).map_err(refused())?;
        for (path, content) in files {
            let file = new.path().join(path);
            fs::create_dir_all(temporary::folder_of(&file)).map_err(refused())?;
            fs::write(&file, content).map_err(refused())?;
        }
        if exists {
            let old = builder.tempdir_in(beside).map_err(refused())?;
            let old = old.path().join("old");
            fs::rename(self.path, &old).map_err(refused())?;
            if let Err(error) = fs::rename(new.path(), self.path) {
                fs::rename(&old, self.path).map_err(refused())?;
                return Err(refused()(error));
            }
        } else {
            fs::rename(new.path(), self.path).map_err(refused())?;
        }
        Ok(())
    }

    /// Refuses to replace what is at the path, if anything; tells if there is a folder.
    fn check_old(&self) -> Result<bool, Failure> {
        let refused = || Failure::refused(self.path);
        let not_ours = || Failure::NotOurs { path: self.path.to_path_buf(), expected: self.what };
        match fs::symlink_metadata(self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(refused()(error)),
            Ok(found) if !found.is_dir() => return Err(not_ours()),
            Ok(_) => {}
        }
        let is_empty = fs::read_dir(self.path).map_err(refused())?.next().is_none();
        if is_empty || self.force || self.holds_only_listed_files().map_err(refused())? {
            return Ok(true);
        }
        Err(not_ours())
    }

    fn holds_only_listed_files(&self) -> io::Result<bool> {
        let Ok(manifest) = fs::read_to_string(self.path.join(self.manifest)) else { return Ok(false) };
        let Some(listed) = (self.listed)(&manifest) else { return Ok(false) };
        let is_known = |file: &PathBuf| {
            file == Path::new(self.manifest) || listed.iter().any(|known| Path::new(known) == file)
        };
        Ok(files_in(self.path)?.iter().all(is_known))
    }
}

/// All files in a folder and the folders in it, by their paths in it, sorted.
fn files_in(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let mut waiting = vec![folder.to_path_buf()];
    while let Some(next) = waiting.pop() {
        for entry in fs::read_dir(next)? {
            let entry = entry?;
            match entry.file_type()?.is_dir() {
                true => waiting.push(entry.path()),
                false => {
                    files.push(entry.path().strip_prefix(folder).map_or(entry.path(), Path::to_path_buf))
                }
            }
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILES: [(&str, &[u8]); 3] =
        [("list", b"list:a.txt b/c.txt"), ("a.txt", b"one"), ("b/c.txt", b"two")];

    fn listed(manifest: &str) -> Option<Vec<String>> {
        Some(manifest.strip_prefix("list:")?.split(' ').map(String::from).collect())
    }

    fn folder(path: &Path, force: bool) -> Folder<'_> {
        Folder { path, what: "export", manifest: "list", listed, force }
    }

    #[test]
    fn a_folder_appears_whole_and_replaces_only_its_own() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("new/export");
        folder(&path, false).write(&FILES).unwrap();
        assert_eq!(fs::read(path.join("b/c.txt")).unwrap(), b"two");
        folder(&path, false).write(&FILES[..2]).unwrap();
        assert_eq!(files_in(&path).unwrap(), [Path::new("a.txt"), Path::new("list")]);
        fs::write(path.join("mine.txt"), "mine").unwrap();
        assert!(matches!(folder(&path, false).write(&FILES), Err(Failure::NotOurs { .. })));
        assert_eq!(fs::read(path.join("mine.txt")).unwrap(), b"mine");
        folder(&path, true).write(&FILES).unwrap();
        assert_eq!(files_in(&path).unwrap().len(), 3);
        assert_eq!(fs::read_dir(place.path().join("new")).unwrap().count(), 1, "nothing is left beside it");
    }

    #[test]
    fn files_are_not_replaced() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("export");
        fs::write(&path, "mine").unwrap();
        assert!(matches!(folder(&path, true).write(&FILES), Err(Failure::NotOurs { .. })));
        assert_eq!(fs::read(&path).unwrap(), b"mine");
    }
}

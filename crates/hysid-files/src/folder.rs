//! Writing the files of a folder together or not at all.

mod changes;

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use crate::failure::Failure;
use crate::lock::Lock;
use crate::{leftovers, reading, temporary};
use changes::Changes;

/// Files of a manifest with their checksums.
pub type Listed = Vec<(String, String)>;

/// A folder whose files are written together. One of them, the manifest, lists the others with their checksums.
#[derive(Debug)]
pub struct Folder<'a> {
    pub path: &'a Path,
    /// Kind of folder, such as `export of Hysid`.
    pub what: &'static str,
    pub manifest: &'static str,
    /// The files that the text of a manifest lists, with their checksums; `None` if Hysid did not write the text.
    pub listed: fn(&str) -> Option<Listed>,
    pub checksum: fn(&[u8]) -> String,
    /// Files that the content is made from. A folder with one of them in it is not written to.
    pub inputs: &'a [&'a Path],
    /// Write also into a folder of others, and over files that are no longer as Hysid wrote them. Each is kept as
    /// `NAME.bak`.
    pub force: bool,
}

impl Folder<'_> {
    /// Writes the files, each with its path in the folder; the manifest comes last. Files that an earlier manifest lists
    /// are replaced or removed if they are as Hysid wrote them; all others stay. Gives the copies of files that were
    /// replaced by force.
    ///
    /// # Errors
    /// A path that is no folder; a folder of others; a file there that is not as Hysid wrote it, or that is a link or no
    /// plain file; a folder with an input in it; what the system refuses. Everything is then as it was.
    pub fn write(&self, files: &[(&str, &[u8])]) -> Result<Vec<PathBuf>, Failure> {
        let refused = || Failure::refused(self.path);
        let found = match fs::symlink_metadata(self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            found => Some(found.map_err(refused())?),
        };
        if self.path.file_name().is_none() && found.is_none() {
            return Err(refused()(io::ErrorKind::NotFound.into()));
        }
        match found {
            Some(found) if !found.is_dir() => {
                Err(Failure::NotOurs { path: self.path.to_path_buf(), expected: self.what })
            }
            Some(_) => self.write_into(&fs::canonicalize(self.path).map_err(refused())?, files),
            None => self.write_new(files).map(|()| Vec::new()),
        }
    }

    /// Writes into a new folder, which appears whole.
    fn write_new(&self, files: &[(&str, &[u8])]) -> Result<(), Failure> {
        let refused = || Failure::refused(self.path);
        let beside = temporary::folder_of(self.path);
        fs::create_dir_all(beside).map_err(refused())?;
        // From here on the working folder no longer matters.
        let path =
            fs::canonicalize(beside).map_err(refused())?.join(self.path.file_name().unwrap_or_default());
        leftovers::clean(&path);
        let waiting = temporary::create_folder(&path).map_err(refused())?;
        for (name, content) in files {
            temporary::write_synced(&waiting.path().join(name), content).map_err(refused())?;
        }
        temporary::publish(waiting.path()).map_err(refused())?;
        fs::rename(waiting.path(), &path).map_err(refused())?;
        temporary::sync_folder(temporary::folder_of(&path));
        Ok(())
    }

    /// Writes into a folder that is there. `root` is its path whatever the working folder is.
    fn write_into(&self, root: &Path, files: &[(&str, &[u8])]) -> Result<Vec<PathBuf>, Failure> {
        let refused = || Failure::refused(self.path);
        let holds = |input: &&&Path| fs::canonicalize(input).is_ok_and(|input| input.starts_with(root));
        if let Some(input) = self.inputs.iter().find(holds) {
            return Err(Failure::HoldsInput { folder: self.path.into(), input: input.to_path_buf() });
        }
        // Others that write here at the same moment would mix their files with these.
        let _lock = Lock::acquire(&root.join(self.manifest))?;
        let mut changes = Changes::begin(root, self.manifest).map_err(refused())?;
        let listed = self.listed_in(root);
        let is_lock = |entry: &fs::DirEntry| *entry.file_name() == *Lock::name_beside(self.manifest);
        let mut found = fs::read_dir(root).map_err(refused())?.flatten();
        let is_empty = found.all(|entry| changes.is_own(&entry) || is_lock(&entry));
        if listed.is_none() && !is_empty && !self.force {
            return Err(Failure::NotOurs { path: self.path.into(), expected: self.what });
        }
        let listed = listed.unwrap_or_default();
        for (name, content) in files {
            let is_kept = self.check_old(root, name, content, &listed)?;
            changes.add(name, content, is_kept).map_err(refused())?;
        }
        for (name, sum) in &listed {
            let is_new = files.iter().any(|(new, _)| new == name);
            if !is_new && is_plain(root, name) && self.has_sum(&root.join(name), sum) {
                changes.remove(name);
            }
        }
        changes.commit().map_err(refused())
    }

    /// Files of the manifest that is there, with their checksums; `None` if it is none of Hysid. It lists itself.
    fn listed_in(&self, root: &Path) -> Option<BTreeMap<String, String>> {
        if !is_plain(root, self.manifest) {
            return None;
        }
        let text = String::from_utf8(reading::read(&root.join(self.manifest)).ok()?).ok()?;
        let mut listed: BTreeMap<String, String> = (self.listed)(&text)?.into_iter().collect();
        listed.insert(self.manifest.into(), (self.checksum)(text.as_bytes()));
        Some(listed)
    }

    /// Refuses to replace what is there under this name unless Hysid wrote it; with force, returns whether to keep it.
    fn check_old(
        &self,
        root: &Path,
        name: &str,
        content: &[u8],
        listed: &BTreeMap<String, String>,
    ) -> Result<bool, Failure> {
        let path = root.join(name);
        let shown = self.path.join(name);
        match fs::symlink_metadata(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(Failure::refused(&shown)(error)),
            Ok(_) if !is_plain(root, name) => return Err(Failure::NotPlain(shown)),
            Ok(_) => {}
        }
        let is_ours = listed.get(name).is_some_and(|sum| self.has_sum(&path, sum));
        if is_ours || reading::read(&path).is_ok_and(|old| old == content) {
            return Ok(false);
        }
        if self.force { Ok(true) } else { Err(Failure::Changed(shown)) }
    }

    fn has_sum(&self, path: &Path, sum: &str) -> bool {
        // Nothing that Hysid writes into a folder is larger than what is read.
        reading::read(path).is_ok_and(|content| (self.checksum)(&content) == sum)
    }
}

/// True for a plain file in the folder, whose path leads through plain folders.
fn is_plain(root: &Path, name: &str) -> bool {
    let mut path = root.to_path_buf();
    let mut last = false;
    for part in Path::new(name).components() {
        let Component::Normal(part) = part else { return false };
        path.push(part);
        let Ok(found) = fs::symlink_metadata(&path) else { return false };
        last = found.is_file();
        if !last && !found.is_dir() {
            return false;
        }
    }
    last
}

#[cfg(test)]
mod tests {
    use tempfile::TempDir;

    use super::*;

    const FILES: [(&str, &[u8]); 3] =
        [("a.txt", b"one"), ("b/c.txt", b"two"), ("list", b"list:a.txt=one b/c.txt=two")];

    /// The checksum of a file is here its content.
    fn listed(manifest: &str) -> Option<Listed> {
        let entries = manifest.strip_prefix("list:")?.split(' ');
        entries.map(|entry| entry.split_once('=').map(|(name, sum)| (name.into(), sum.into()))).collect()
    }

    fn checksum(content: &[u8]) -> String {
        String::from_utf8_lossy(content).into_owned()
    }

    fn folder(path: &Path, force: bool) -> Folder<'_> {
        Folder { path, what: "export", manifest: "list", listed, checksum, inputs: &[], force }
    }

    /// A place with a folder `export`, in which these files were written.
    fn written() -> (TempDir, PathBuf) {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("export");
        folder(&path, false).write(&FILES).unwrap();
        (place, path)
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// Killed at any moment: a file is the old one, gone for a moment, or the new one; the manifest is the old one.
    #[test]
    fn the_next_writer_finishes_what_a_killed_one_began() {
        let next: [(&str, &[u8]); 3] =
            [("a.txt", b"new"), ("b/c.txt", b"newer"), ("list", b"list:a.txt=new b/c.txt=newer")];
        for (a, c) in [
            (None, Some("two")),
            (Some("new"), Some("two")),
            (Some("new"), None),
            (Some("new"), Some("newer")),
        ] {
            let (_place, path) = written();
            for (name, content) in [("a.txt", a), ("b/c.txt", c)] {
                match content {
                    Some(content) => fs::write(path.join(name), content).unwrap(),
                    None => fs::remove_file(path.join(name)).unwrap(),
                }
            }
            let waiting = path.join(".list.abcdEF12.hysid-partial/old");
            fs::create_dir_all(&waiting).unwrap();
            fs::write(waiting.join("a.txt"), "one").unwrap();
            assert!(folder(&path, false).write(&next).unwrap().is_empty());
            assert_eq!(names(&path), ["a.txt", "b", "list"]);
            assert_eq!(fs::read(path.join("b/c.txt")).unwrap(), b"newer");
        }
    }

    #[test]
    fn writers_wait_for_nobody_and_go_nowhere_else() {
        let (place, path) = written();
        let held = Lock::acquire(&path.join("list")).unwrap();
        assert!(matches!(folder(&path, false).write(&FILES), Err(Failure::InUse(_))));
        drop(held);
        folder(&path, false).write(&FILES).unwrap();
        assert_eq!(names(&path), ["a.txt", "b", "list"]);
        // The folder is not the one that the path names before its end.
        assert!(folder(&place.path().join("new/.."), false).write(&FILES).is_err());
        assert_eq!(names(place.path()), ["export"]);
    }

    #[test]
    fn a_folder_appears_whole_and_its_own_files_are_replaced() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("new/export");
        folder(&path, false).write(&FILES).unwrap();
        assert_eq!(fs::read(path.join("b/c.txt")).unwrap(), b"two");
        fs::write(path.join("mine.txt"), "mine").unwrap();
        let next: [(&str, &[u8]); 2] = [("a.txt", b"new"), ("list", b"list:a.txt=new")];
        assert!(folder(&path, false).write(&next).unwrap().is_empty());
        // The file that is no longer of the export is gone, and that of others is there.
        assert_eq!(names(&path), ["a.txt", "b", "list", "mine.txt"]);
        assert_eq!(names(&path.join("b")), [""; 0]);
        assert_eq!(fs::read(path.join("a.txt")).unwrap(), b"new");
        assert_eq!(names(&place.path().join("new")), ["export"], "nothing is left beside it");
    }

    #[test]
    fn files_that_were_changed_are_kept() {
        let (_place, path) = written();
        fs::write(path.join("b/c.txt"), "edited").unwrap();
        let next: [(&str, &[u8]); 3] =
            [("a.txt", b"new"), ("b/c.txt", b"three"), ("list", b"list:a.txt=new b/c.txt=three")];
        let refused = folder(&path, false).write(&next);
        assert!(matches!(&refused, Err(Failure::Changed(file)) if file.ends_with("b/c.txt")), "{refused:?}");
        assert_eq!(fs::read(path.join("a.txt")).unwrap(), b"one", "nothing was changed");
        let kept = folder(&path, true).write(&next).unwrap();
        assert_eq!(fs::read(&kept[0]).unwrap(), b"edited");
        assert!(kept[0].ends_with("b/c.txt.bak"), "{kept:?}");
        // A second one does not replace the first.
        fs::write(path.join("b/c.txt"), "edited again").unwrap();
        let kept = folder(&path, true).write(&FILES).unwrap();
        assert!(kept[0].ends_with("b/c.txt.bak2"), "{kept:?}");
        assert_eq!(fs::read(path.join("b/c.txt.bak")).unwrap(), b"edited");
        // One that the export no longer has stays if it was changed.
        fs::write(path.join("b/c.txt"), "mine").unwrap();
        folder(&path, false).write(&[("list", b"list:")]).unwrap();
        assert_eq!(fs::read(path.join("b/c.txt")).unwrap(), b"mine");
    }

    #[test]
    fn folders_of_others_lose_nothing_even_by_force() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("mine");
        fs::create_dir_all(path.join("notes")).unwrap();
        fs::write(path.join("notes/t"), "thesis").unwrap();
        fs::write(path.join("a.txt"), "mine").unwrap();
        fs::write(path.join("list"), "shopping").unwrap();
        assert!(matches!(folder(&path, false).write(&FILES), Err(Failure::NotOurs { .. })));
        let kept = folder(&path, true).write(&FILES).unwrap();
        assert_eq!(kept.len(), 2, "{kept:?}");
        assert_eq!(fs::read(path.join("a.txt.bak")).unwrap(), b"mine");
        assert_eq!(fs::read(path.join("list.bak")).unwrap(), b"shopping");
        assert_eq!(fs::read(path.join("notes/t")).unwrap(), b"thesis");
        assert_eq!(names(&path), ["a.txt", "a.txt.bak", "b", "list", "list.bak", "notes"]);
        let inputs = [path.join("notes/t")];
        let inputs = [inputs[0].as_path()];
        let refused = Folder { inputs: &inputs, ..folder(&path, true) }.write(&FILES);
        assert!(matches!(refused, Err(Failure::HoldsInput { .. })), "{refused:?}");
    }

    #[test]
    fn a_manifest_that_names_files_elsewhere_removes_none() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("export");
        fs::create_dir(&path).unwrap();
        fs::write(place.path().join("mine"), "mine").unwrap();
        fs::write(path.join("list"), "list:../mine=mine").unwrap();
        folder(&path, false).write(&FILES).unwrap();
        assert_eq!(fs::read(place.path().join("mine")).unwrap(), b"mine");
    }

    #[test]
    fn a_manifest_that_names_an_endless_file_reads_none_of_it() {
        let (_place, path) = written();
        fs::File::create(path.join("huge")).unwrap().set_len(1 << 40).unwrap();
        fs::write(path.join("list"), "list:a.txt=one huge=one").unwrap();
        folder(&path, false).write(&FILES).unwrap();
        assert!(path.join("huge").exists());
        fs::File::options().write(true).open(path.join("a.txt")).unwrap().set_len(1 << 40).unwrap();
        assert!(matches!(folder(&path, false).write(&FILES), Err(Failure::Changed(_))));
    }

    #[test]
    fn a_failure_leaves_what_was_there() {
        let (_place, path) = written();
        fs::create_dir(path.join("d")).unwrap();
        // The last of the files has the name of a folder.
        let next: [(&str, &[u8]); 3] = [("a.txt", b"new"), ("b/c.txt", b"new"), ("d", b"new")];
        for force in [false, true] {
            assert!(matches!(folder(&path, force).write(&next), Err(Failure::NotPlain(_))));
        }
        assert_eq!(names(&path), ["a.txt", "b", "d", "list"]);
        assert_eq!(fs::read(path.join("a.txt")).unwrap(), b"one");
        // The same when it only shows while the files are put in their places.
        let mut changes = Changes::begin(&path, "list").unwrap();
        changes.add("a.txt", b"new", true).unwrap();
        changes.remove("b/c.txt");
        changes.add("d", b"new", false).unwrap();
        fs::write(path.join("d/full"), "").unwrap();
        assert!(changes.commit().is_err());
        assert_eq!(names(&path), ["a.txt", "b", "d", "list"]);
        assert_eq!(fs::read(path.join("a.txt")).unwrap(), b"one");
        assert_eq!(fs::read(path.join("b/c.txt")).unwrap(), b"two");
    }

    #[test]
    fn links_and_files_in_the_place_of_a_folder_are_refused() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("export");
        fs::write(&path, "mine").unwrap();
        assert!(matches!(folder(&path, true).write(&FILES), Err(Failure::NotOurs { .. })));
        assert_eq!(fs::read(&path).unwrap(), b"mine");
        #[cfg(unix)]
        {
            let other = place.path().join("other");
            folder(&other, false).write(&FILES).unwrap();
            fs::remove_file(other.join("a.txt")).unwrap();
            std::os::unix::fs::symlink(&path, other.join("a.txt")).unwrap();
            assert!(matches!(folder(&other, true).write(&FILES), Err(Failure::NotPlain(_))));
            assert_eq!(fs::read(&path).unwrap(), b"mine");
        }
    }

    #[test]
    fn temporary_folders_of_killed_processes_go() {
        let (place, path) = written();
        fs::create_dir(path.join(".list.AbCdEf12.hysid-partial")).unwrap();
        fs::create_dir(place.path().join(".next.AbCdEf12.hysid-partial")).unwrap();
        folder(&path, false).write(&FILES).unwrap();
        folder(&place.path().join("next"), false).write(&FILES).unwrap();
        assert_eq!(names(&path), ["a.txt", "b", "list"]);
        assert_eq!(names(place.path()), ["export", "next"]);
    }
}

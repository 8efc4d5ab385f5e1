//! A copy of a file that is about to be replaced.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

use crate::seal;
use crate::temporary::{beginning, builder, folder_of, plain, with_ending};

/// Names for copies of the target: `NAME.bak`, `NAME.bak2` and so on.
fn names(target: &Path) -> impl Iterator<Item = PathBuf> {
    let endings = std::iter::once(".bak".to_string()).chain((2..).map(|number| format!(".bak{number}")));
    endings.map(|ending| with_ending(target, &ending))
}

/// True if nothing is there, or an older file that nobody changed.
fn is_free(path: &Path) -> bool {
    match fs::symlink_metadata(path) {
        Ok(there) => there.is_file() && seal::is_sealed(path),
        Err(error) => error.kind() == io::ErrorKind::NotFound,
    }
}

/// Keeps the target as `NAME.bak`, in the place of an older copy that nobody changed. At every moment the target is there.
pub(crate) fn keep(target: &Path) -> io::Result<PathBuf> {
    let path = names(target).find(|name| is_free(name)).expect("there is always a further name");
    let beginning = beginning(target);
    let folder = folder_of(target);
    let linked = builder(&beginning).make_in(folder, |name| fs::hard_link(target, name));
    match linked {
        Ok(copy) => {
            let name = copy.path().to_path_buf();
            copy.persist(&path).map_err(|error| error.error)?;
            // Renaming does nothing if both names are of one file: another writer may have kept it just now.
            let _ = fs::remove_file(name);
        }
        // Not every file system has hard links.
        Err(_) => {
            let mut copy = builder(&beginning).tempfile_in(folder).map_err(plain)?;
            io::copy(&mut File::open(target)?, &mut copy)?;
            let old = fs::metadata(target)?;
            copy.as_file().set_permissions(old.permissions())?;
            copy.as_file().set_modified(old.modified()?)?;
            copy.as_file().sync_all()?;
            copy.persist(&path).map_err(|error| error.error)?;
        }
    }
    Ok(path)
}

/// A copy of a file under a name beside it that is free.
pub(crate) fn copied_aside(target: &Path) -> io::Result<PathBuf> {
    for copy in names(target) {
        match File::create_new(&copy) {
            Ok(mut file) => {
                io::copy(&mut File::open(target)?, &mut file)?;
                file.set_permissions(fs::metadata(target)?.permissions())?;
                file.sync_all()?;
                return Ok(copy);
            }
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    unreachable!("there is always a further name")
}

/// True if both files have the same content. They may be larger than the memory.
pub(crate) fn are_same(a: &Path, b: &Path) -> io::Result<bool> {
    if fs::metadata(a)?.len() != fs::metadata(b)?.len() {
        return Ok(false);
    }
    let (mut a, mut b) = (BufReader::new(File::open(a)?), BufReader::new(File::open(b)?));
    loop {
        let (of_a, of_b) = (a.fill_buf()?, b.fill_buf()?);
        let common = of_a.len().min(of_b.len());
        if of_a[..common] != of_b[..common] {
            return Ok(false);
        }
        if common == 0 {
            return Ok(of_a.len() == of_b.len());
        }
        a.consume(common);
        b.consume(common);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_compared_to_their_last_byte() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
        let mut content = vec![7; 100_000];
        fs::write(&a, &content).unwrap();
        fs::write(&b, &content).unwrap();
        assert!(are_same(&a, &b).unwrap());
        content[99_999] = 8;
        fs::write(&b, &content).unwrap();
        assert!(!are_same(&a, &b).unwrap());
        fs::write(&b, &content[..99_999]).unwrap();
        assert!(!are_same(&a, &b).unwrap());
    }

    #[test]
    fn a_file_that_another_writer_kept_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("m.json");
        fs::write(&target, "new").unwrap();
        seal::seal(&target).unwrap();
        let copy = keep(&target).unwrap();
        assert_eq!(copy, with_ending(&target, ".bak"));
        assert_eq!(keep(&target).unwrap(), copy);
        assert_eq!(fs::read_to_string(copy).unwrap(), "new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}

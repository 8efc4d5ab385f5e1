//! A seal by which Hysid recognizes a file unchanged since it wrote it: the digits of its time of change below a
//! millisecond are made of its content. Whoever changes the file sets another time. Where a file system stores no such
//! digits, and on copies, no file is sealed: it counts as changed.

use std::fs::{File, FileTimes};
use std::io;
use std::path::Path;
use std::time::{Duration, UNIX_EPOCH};

use crate::reading::checksum_of;

const MILLISECOND: u32 = 1_000_000;

/// Seals a file that is complete. It looks up to a millisecond older.
pub fn seal(path: &Path) -> io::Result<()> {
    let (digits, found) = (digits_of_content(path)?, digits_of_time(path)?);
    let earlier = if digits > found { MILLISECOND } else { 0 };
    let time = path.metadata()?.modified()? - Duration::from_nanos((found + earlier - digits).into());
    File::options().append(true).open(path)?.set_times(FileTimes::new().set_modified(time))
}

/// True for a file with a seal of its content.
pub fn is_sealed(path: &Path) -> bool {
    digits_of_time(path).is_ok_and(|digits| digits_of_content(path).is_ok_and(|expected| expected == digits))
}

fn digits_of_time(path: &Path) -> io::Result<u32> {
    let since = path.metadata()?.modified()?.duration_since(UNIX_EPOCH).map_err(io::Error::other)?;
    Ok(since.subsec_nanos() % MILLISECOND)
}

fn digits_of_content(path: &Path) -> io::Result<u32> {
    Ok(checksum_of(File::open(path)?)? % MILLISECOND)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_seal_breaks_when_the_file_changes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        for k in 0..50 {
            fs::write(&path, format!("x,y\n{k},1\n")).unwrap();
            assert!(!is_sealed(&path));
            let changed = || path.metadata().unwrap().modified().unwrap();
            let before = changed();
            seal(&path).unwrap();
            assert!(is_sealed(&path));
            assert!(changed() <= before && changed() + Duration::from_millis(1) > before);
        }
        fs::write(&path, "x,y\n49,2\n").unwrap();
        assert!(!is_sealed(&path));
        assert!(!is_sealed(&folder.path().join("none")));
    }
}

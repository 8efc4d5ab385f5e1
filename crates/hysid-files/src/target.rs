//! Where a path leads.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Links that are followed, as many as Linux does.
const MOST_LINKS: usize = 40;

/// Where a path leads once links are followed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Target {
    /// A regular file, or a place where there is none yet.
    File(PathBuf),
    /// A device, a pipe, a socket or an open file, which is written through.
    Stream(PathBuf),
    /// Standard output under its name as a file.
    Stdout,
}

impl Target {
    /// # Errors
    /// A directory, links that go round in a circle, or a path that cannot be looked at.
    pub fn of(path: &Path) -> io::Result<Self> {
        let mut place = path.to_path_buf();
        for _ in 0..MOST_LINKS {
            if let Some(stream) = open_file(&place) {
                return Ok(stream);
            }
            let Ok(next) = fs::read_link(&place) else { return Self::of_end(place) };
            place = place.parent().map_or(next.clone(), |folder| folder.join(&next));
        }
        Err(io::Error::other("too many links"))
    }

    /// Where a path leads that is no link.
    fn of_end(place: PathBuf) -> io::Result<Self> {
        match fs::metadata(&place) {
            Ok(there) if there.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
            Ok(there) if there.is_file() => Ok(Self::File(place)),
            Ok(_) => Ok(Self::Stream(place)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Self::File(place)),
            Err(error) => Err(error),
        }
    }
}

/// A path that names an open file of a process, as `/dev/stdout` does. A regular file behind it has a writer already,
/// so it must not be replaced.
fn open_file(place: &Path) -> Option<Target> {
    let place_name = place.to_str()?;
    let own = format!("/proc/{}/fd/1", std::process::id());
    if ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", own.as_str()].contains(&place_name) {
        return Some(Target::Stdout);
    }
    let is_descriptor = place.parent().is_some_and(|folder| {
        folder == Path::new("/dev/fd") || folder.starts_with("/proc") && folder.ends_with("fd")
    });
    is_descriptor.then(|| Target::Stream(place.to_path_buf()))
}

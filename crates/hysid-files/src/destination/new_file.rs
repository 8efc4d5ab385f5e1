//! A file on its way to its destination.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::destination::{Copy, Destination};
use crate::failure::Failure;
use crate::target::Target;
use crate::{backup, seal, temporary};

/// A file on its way to its destination: the old one stays until [`NewFile::commit`]. Dropped before that, it leaves
/// nothing behind. It is not buffered.
#[derive(Debug)]
pub struct NewFile<'d> {
    destination: &'d Destination,
    sink: Sink,
}

#[derive(Debug)]
enum Sink {
    /// A temporary file that takes the place of the target.
    Beside(NamedTempFile, PathBuf),
    /// A device or a pipe.
    Stream(File),
    Stdout(io::Stdout),
}

impl<'d> NewFile<'d> {
    pub(crate) fn begin(destination: &'d Destination, target: Target) -> Result<Self, Failure> {
        let refused = || Failure::refused(destination.path());
        let sink = match target {
            Target::File(target) => {
                destination.check_old(&target)?;
                Sink::Beside(temporary::create(&target).map_err(refused())?, target)
            }
            // Behind what others write to the same file, and without following a link put there meanwhile.
            Target::Stream(path) => {
                Sink::Stream(OpenOptions::new().append(true).open(path).map_err(refused())?)
            }
            Target::Stdout => Sink::Stdout(io::stdout()),
        };
        Ok(Self { destination, sink })
    }

    pub fn path(&self) -> &Path {
        self.destination.path()
    }

    /// Failure for an error while writing.
    pub fn failed(&self, error: io::Error) -> Failure {
        Failure::refused(self.destination.path())(error)
    }

    /// Puts the file in its place; gives the copy of the file that was replaced, if one is kept.
    ///
    /// # Errors
    /// A full disk; a file of somebody else that was put there meanwhile.
    pub fn commit(mut self) -> Result<Option<PathBuf>, Failure> {
        let destination = self.destination;
        let refused = || Failure::refused(destination.path());
        self.flush().map_err(refused())?;
        let Sink::Beside(file, target) = self.sink else { return Ok(None) };
        let mut kept = None;
        if destination.kind.is_kept() {
            // Without a seal the file counts as changed, so nothing is lost.
            let _ = seal::seal(file.path());
        }
        if destination.check_old(&target)? {
            take_over(file.as_file(), &target).map_err(refused())?;
            file.as_file().sync_all().map_err(refused())?;
            let copy = destination.copy_of_the_old(&target).map_err(refused())?;
            if copy != Copy::None && !backup::are_same(file.path(), &target).map_err(refused())? {
                let keep = if copy == Copy::Replacing { backup::keep } else { backup::copied_aside };
                kept = Some(keep(&target).map_err(refused())?);
            }
        } else {
            file.as_file().sync_all().map_err(refused())?;
        }
        file.persist(&target).map_err(|error| refused()(error.error))?;
        temporary::sync_folder(temporary::folder_of(&target));
        Ok(kept)
    }
}

/// Gives a new file owner and permissions of the old one, as far as this user may.
fn take_over(file: &File, old: &Path) -> io::Result<()> {
    let old = fs::metadata(old)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
        let new = file.metadata()?;
        let mut mode = old.mode() & 0o7777;
        let is_same = (old.uid(), old.gid()) == (new.uid(), new.gid());
        if !is_same && fchown(file, Some(old.uid()), Some(old.gid())).is_err() {
            let keeps_group = old.gid() == new.gid() || fchown(file, None, Some(old.gid())).is_ok();
            // What the old group was allowed is not for another, nor is running as the old owner.
            mode &= 0o777;
            if !keeps_group {
                mode &= !0o070 | ((mode & 0o007) << 3);
            }
        }
        file.set_permissions(fs::Permissions::from_mode(mode))
    }
    #[cfg(not(unix))]
    file.set_permissions(old.permissions())
}

impl Write for NewFile<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.sink {
            Sink::Beside(file, _) => file.as_file_mut().write(bytes),
            Sink::Stream(file) => file.write(bytes),
            Sink::Stdout(stdout) => stdout.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.sink {
            Sink::Beside(file, _) => file.as_file_mut().flush(),
            Sink::Stream(file) => file.flush(),
            Sink::Stdout(stdout) => stdout.flush(),
        }
    }
}

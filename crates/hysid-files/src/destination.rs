//! A path and what goes there.

mod new_file;

use std::fs::{self, OpenOptions};
use std::io;
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::kind::{Kind, is_page_as_written};
use crate::target::Target;
use crate::{leftovers, reading, seal, temporary};
pub use new_file::NewFile;

#[derive(Debug, Clone)]
pub struct Destination {
    path: PathBuf,
    kind: Kind,
    force: bool,
    keep: bool,
}

/// How a file that is replaced is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Copy {
    None,
    /// As `NAME.bak`, in the place of the one before.
    Replacing,
    /// As `NAME.bak`, or as `NAME.bak2` and so on if that is there.
    Aside,
}

impl Destination {
    /// A destination for a file of this kind. With `force`, any regular file there is replaced; one
    /// that Hysid did not write is kept as `NAME.bak`.
    pub fn new(path: impl Into<PathBuf>, kind: Kind, force: bool) -> Self {
        let keep = kind.is_kept();
        Self { path: path.into(), kind, force, keep }
    }

    /// The same, with a copy `NAME.bak` of the file that is replaced, or without.
    pub fn keeping_the_old(mut self, keep: bool) -> Self {
        self.keep = keep;
        self
    }

    /// The path, as the user gave it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Refuses, before any work, a place that cannot be written to or that holds a file of somebody else. Removes the
    /// temporary files that killed processes left for this destination.
    pub fn check(&self) -> Result<(), Failure> {
        let target = match self.target()? {
            Target::File(target) => target,
            Target::Stream(_) | Target::Stdout => return Ok(()),
        };
        self.check_old(&target)?;
        leftovers::clean(&target);
        temporary::create(&target).map(drop).map_err(Failure::refused(&self.path))
    }

    /// Begins a new file there. The old one stays until [`NewFile::commit`].
    pub fn create(&self) -> Result<NewFile<'_>, Failure> {
        NewFile::begin(self, self.target()?)
    }

    /// Writes a whole file there; gives the copy of the file that was replaced, if one is kept.
    pub fn write(&self, content: &[u8]) -> Result<Option<PathBuf>, Failure> {
        let mut file = self.create()?;
        file.write_all(content).map_err(Failure::refused(&self.path))?;
        file.commit()
    }

    fn target(&self) -> Result<Target, Failure> {
        Target::of(&self.path).map_err(Failure::refused(&self.path))
    }

    /// Refuses to replace what is at the target, if anything; returns whether there is a file.
    pub(crate) fn check_old(&self, target: &Path) -> Result<bool, Failure> {
        match fs::metadata(target) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(Failure::refused(&self.path)(error)),
            Ok(_) => {}
        }
        // A file that the user may not write to is not replaced behind the user's back.
        OpenOptions::new().append(true).open(target).map_err(Failure::refused(&self.path))?;
        if self.force {
            return Ok(true);
        }
        if !self.kind.recognises(target).map_err(Failure::refused(&self.path))? {
            return Err(Failure::NotOurs { path: self.path.clone(), expected: self.kind.words() });
        }
        Ok(true)
    }

    /// How what is at the target is kept: what Hysid did not write in any case, under a name of its own.
    pub(crate) fn copy_of_the_old(&self, target: &Path) -> io::Result<Copy> {
        let is_edited = || match self.kind {
            // A page that is too large to be read is none as Hysid wrote it.
            Kind::Page => !reading::read(target).is_ok_and(|page| is_page_as_written(&page)),
            _ => self.keep && !seal::is_sealed(target),
        };
        Ok(match (self.kind.recognises(target)?, self.keep) {
            _ if fs::metadata(target)?.len() == 0 => Copy::None,
            (true, _) if is_edited() => Copy::Aside,
            (true, false) => Copy::None,
            (true, true) => Copy::Replacing,
            (false, _) => Copy::Aside,
        })
    }
}

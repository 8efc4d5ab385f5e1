//! Checkpoint files: what is needed to go on with a fit that was cut short.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use hysid::training::{Checkpoint, Progress};

use crate::files;

/// Time between two checkpoints.
const BETWEEN: Duration = Duration::from_secs(3);

/// Largest share of the time that may go into checkpoints.
const LARGEST_SHARE: f64 = 0.05;

/// Reads a checkpoint file.
pub fn read(path: &Path) -> Result<Checkpoint> {
    let bytes = files::read(path)?;
    Checkpoint::from_bytes(&bytes).map_err(|error| anyhow!("{}: {error}", path.display()))
}

/// Keeps a checkpoint file up to date.
pub struct Keeper {
    path: PathBuf,
    due: Instant,
}

impl Keeper {
    /// Writes the first checkpoint at once, so that from then on there is one.
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_path_buf(), due: Instant::now() }
    }

    /// Writes the file if it is time to, or if this is the `last` chance.
    pub fn observe(&mut self, progress: &Progress, last: bool) -> Result<()> {
        let now = Instant::now();
        if now < self.due && !last {
            return Ok(());
        }
        let Some(checkpoint) = progress.checkpoint() else { return Ok(()) };
        files::replace(&self.path, &checkpoint.to_bytes())?;
        // A slow disk or a large network must not make the fit slow.
        let spent = now.elapsed();
        self.due = Instant::now() + BETWEEN.max(spent.div_f64(LARGEST_SHARE));
        Ok(())
    }
}

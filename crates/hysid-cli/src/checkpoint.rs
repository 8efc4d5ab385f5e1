//! Checkpoint files: what is needed to go on with a fit that was cut short.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use hysid::fit::progress::{Checkpoint, Progress};
use hysid_files::{Destination, Failure, Lock};

use crate::files;

/// Time between two checkpoints.
const BETWEEN: Duration = Duration::from_secs(3);

/// Largest share of the time that may go into checkpoints.
const LARGEST_SHARE: f64 = 0.05;

pub fn read(path: &Path) -> Result<Checkpoint> {
    let bytes = files::read(path)?;
    Checkpoint::from_bytes(&bytes).map_err(|error| anyhow!("{}: {error}", path.display()))
}

/// Keeps a checkpoint file up to date. No other process can meanwhile.
pub struct Keeper {
    destination: Destination,
    due: Instant,
    _lock: Lock,
}

impl Keeper {
    /// Writes the first checkpoint at once, so that from then on there is one.
    pub fn new(destination: Destination) -> Result<Self> {
        let lock = Lock::acquire(destination.path()).map_err(|failure| match failure {
            Failure::InUse(path) => anyhow!(
                "{}: another fit writes its checkpoint to this file: wait until it ends, or name another \
                 file with --checkpoint",
                path.display()
            ),
            failure => files::explained(failure),
        })?;
        Ok(Self { destination, due: Instant::now(), _lock: lock })
    }

    /// The checkpoint file.
    pub fn path(&self) -> &Path {
        self.destination.path()
    }

    /// Writes the file if it is time to, or if this is the `last` chance.
    pub fn observe(&mut self, progress: &Progress, last: bool) -> Result<()> {
        let now = Instant::now();
        if now < self.due && !last {
            return Ok(());
        }
        let Some(checkpoint) = progress.checkpoint() else { return Ok(()) };
        files::write(&self.destination, &checkpoint.to_bytes())?;
        // What the first one replaced is kept; what this fit wrote itself need not be.
        self.destination = self.destination.clone().keeping_the_old(false);
        // A slow disk or a large network must not make the fit slow.
        let spent = now.elapsed();
        self.due = Instant::now() + BETWEEN.max(spent.div_f64(LARGEST_SHARE));
        Ok(())
    }
}

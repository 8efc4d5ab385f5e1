//! Settings of experiments.

use std::time::Duration;

/// Settings that decide all figures but those in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Seed of all randomness.
    pub seed: u64,
    /// A fraction of the effort, to see how it looks.
    pub quick: bool,
}

/// Whoever runs an experiment. Several may run at the same time with one observer.
pub trait Observer: Sync {
    /// The time since some moment, always the same: experiments that compare times take differences.
    fn clock(&self) -> Duration;

    /// True once experiments are to stop: they then end with [`hysid::Error::Stopped`].
    fn is_stopped(&self) -> bool;

    /// Takes a line on what has just been done.
    fn say(&self, line: &str);
}

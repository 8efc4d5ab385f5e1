//! `hysid reproduce`: the paper's experiments, our figures beside its own.

use std::fs;

use anyhow::{Result, anyhow};

use crate::Outcome;
use crate::arguments::Reproduce;
use crate::files;
use crate::interrupt;
use crate::reproduction::{self, Settings};

/// Runs the command.
pub fn run(arguments: &Reproduce) -> Result<Outcome> {
    let folder = &arguments.out;
    fs::create_dir_all(folder)
        .map_err(|error| anyhow!("{}: cannot be made: {}", folder.display(), files::reason(&error)))?;
    interrupt::listen("stopping; what is finished is kept")?;
    let settings = Settings { seed: arguments.seed, quick: arguments.quick };
    reproduction::run(&arguments.experiments, settings, folder)
}

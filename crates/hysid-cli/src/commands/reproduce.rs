//! `hysid reproduce`: the paper's experiments, our figures beside its own.

use std::fs;

use anyhow::{Result, anyhow};

use crate::Outcome;
use crate::arguments::Reproduce;
use crate::files;
use crate::interrupt;
use crate::reproduction::training;

/// Runs the command.
pub fn run(arguments: &Reproduce) -> Result<Outcome> {
    let folder = &arguments.out;
    fs::create_dir_all(folder)
        .map_err(|error| anyhow!("{}: cannot be made: {}", folder.display(), files::reason(&error)))?;
    interrupt::listen("stopping; what is finished is kept")?;
    let protocol = training::Protocol::new(arguments.seed, arguments.quick);
    training::run(&protocol, folder)
}

//! `hysid reproduce`: the paper's experiments, our figures beside its own.

use anyhow::Result;
use hysid_paper::Settings;

use crate::Outcome;
use crate::arguments::Reproduce;
use crate::reproduction::{self, Outputs};
use crate::{files, interrupt};

pub fn run(arguments: &Reproduce) -> Result<Outcome> {
    files::make_folder(&arguments.out)?;
    interrupt::listen("stopping; what is finished is kept")?;
    let settings = Settings { seed: arguments.seed, quick: arguments.quick };
    let outputs = Outputs { folder: &arguments.out, force: arguments.overwriting.force };
    reproduction::run(&arguments.experiments, settings, outputs)
}

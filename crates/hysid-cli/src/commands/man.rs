//! `hysid man`: manual pages of the program and of its commands.

use std::path::Path;

use anyhow::Result;
use clap_mangen::Man;
use hysid_document::count;
use hysid_files::{Destination, Kind};

use crate::Outcome;
use crate::arguments::{self, Arguments};
use crate::files::{self, NO_INPUTS, check_outputs};
use crate::messages::note;

/// Begins every page, so that Hysid recognizes its own. It is a comment of roff.
const MARK: &str = ".\\\" Written by hysid man.\n";

pub fn run(arguments: &arguments::Man) -> Result<Outcome> {
    let pages = pages()?;
    files::make_folder(&arguments.out)?;
    let destination = |name: &str| {
        let kind = Kind::Beginning(MARK.as_bytes().to_vec());
        Destination::new(arguments.out.join(name), kind, arguments.overwriting.force)
    };
    let destinations: Vec<Destination> = pages.iter().map(|(name, _)| destination(name)).collect();
    check_outputs(&destinations, &NO_INPUTS)?;
    for (destination, (_, page)) in destinations.iter().zip(&pages) {
        files::write(destination, page)?;
    }
    let first = Path::new("hysid.1");
    note(format_args!(
        "wrote {} to {}; to read one: man -l {}",
        count(pages.len(), "page"),
        files::shown(&arguments.out),
        files::shown(&arguments.out.join(first))
    ));
    Ok(Outcome::Done)
}

/// Name and content of each page: the program, then its commands.
fn pages() -> Result<Vec<(String, Vec<u8>)>> {
    let mut program = Arguments::whole().disable_help_subcommand(true);
    program.build();
    let commands = program.get_subcommands().cloned();
    std::iter::once(program.clone())
        .chain(commands)
        .map(|command| {
            // A command is called `hysid fit`, its page `hysid-fit.1`.
            let name = command.get_display_name().unwrap_or(command.get_name()).to_string();
            let mut page = MARK.as_bytes().to_vec();
            Man::new(command.name(name.clone())).render(&mut page)?;
            Ok((format!("{name}.1"), page))
        })
        .collect()
}

//! `hysid studio`: identification in the browser, on this machine.

use std::sync::Arc;
use std::thread;
use std::time::Duration;

use anyhow::Result;
use hysid_studio::{Ending, Folder, Server, Studio as Opened};

use crate::Outcome;
use crate::arguments::Studio;
use crate::files;
use crate::interrupt;
use crate::messages::{insist, note, results, warning};

/// Time between two looks whether Ctrl-C was pressed.
const BETWEEN_LOOKS: Duration = Duration::from_millis(100);

/// Time that answers on their way get when the studio ends.
const LONGEST_END: Duration = Duration::from_secs(5);

/// Runs the command.
pub fn run(arguments: &Studio) -> Result<Outcome> {
    let studio = Arc::new(Opened::open(Folder::open(arguments.project.as_deref())?)?);
    for file in &arguments.data {
        studio.take_path(file)?;
    }
    let (server, ending) = Server::bind(Arc::clone(&studio), arguments.port)?;
    let address = server.address();
    results(&format!("{address}\n"))?;
    note(format_args!("project {}", files::shown(studio.folder().root())));
    note(format_args!("Ctrl-C ends the studio; the project stays"));
    interrupt::listen("ending the studio")?;
    if !arguments.no_open && open::that_detached(&address).is_err() {
        warning("no browser could be opened: open the address above");
    }
    let watching = thread::spawn(move || end_when_asked(&studio, &ending));
    server.serve()?;
    match watching.join() {
        Ok(true) => Ok(Outcome::Interrupted),
        _ => Ok(Outcome::Done),
    }
}

/// Waits for Ctrl-C, then ends the studio; true if a fit was running, whose best model so far is saved.
fn end_when_asked(studio: &Opened, ending: &Ending) -> bool {
    while !interrupt::requested() {
        thread::sleep(BETWEEN_LOOKS);
    }
    let is_fitting = studio.fit().is_some_and(|fit| fit.is_running);
    if is_fitting {
        studio.end();
        let root = studio.folder().root().display();
        insist(format_args!("interrupted: the best model so far is in the project {root}"));
    }
    ending.end();
    // A browser may keep a connection that it does not use.
    thread::spawn(|| {
        thread::sleep(LONGEST_END);
        std::process::exit(interrupt::exit_status().into());
    });
    is_fitting
}

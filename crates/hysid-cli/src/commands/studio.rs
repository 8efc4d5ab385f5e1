//! `hysid studio`: identification in the browser, on this machine.

use std::path::PathBuf;
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

/// Longest time that requests under way may take when the studio ends.
const LONGEST_END: Duration = Duration::from_secs(5);

pub fn run(arguments: &Studio) -> Result<Outcome> {
    let studio = Arc::new(Opened::open(Folder::open(arguments.project.as_deref())?)?);
    for file in &arguments.data {
        studio.take_path(file)?;
    }
    let (server, ending) = Server::bind(Arc::clone(&studio), arguments.port)?;
    let address = server.address();
    results(&format!("{address}\n"))?;
    note(format_args!("project {}", files::shown(studio.folder().root())));
    let entrance = server.entrance();
    match &entrance {
        Some(file) => {
            note(format_args!("the address opens one browser; for others open {}", files::shown(file)))
        }
        None => warning("studio.html cannot be written to the project: the address opens one browser"),
    }
    note(format_args!("Ctrl-C ends the studio; the project stays"));
    interrupt::listen("ending the studio")?;
    // Other users see the arguments of a browser: it gets the file with its token, which they cannot read.
    let is_opened = |file: PathBuf| open::that_detached(file).is_ok();
    if !arguments.no_open && !entrance.is_some_and(is_opened) {
        warning("no browser could be opened: open the address above");
    }
    let watching = thread::spawn(move || end_when_asked(&studio, &ending));
    server.serve();
    watching.join().unwrap_or(Ok(()))?;
    Ok(Outcome::Interrupted)
}

/// Waits for Ctrl-C, then ends the studio. The best model so far of a fit that was running is saved.
fn end_when_asked(studio: &Opened, ending: &Ending) -> Result<()> {
    while !interrupt::requested() {
        thread::sleep(BETWEEN_LOOKS);
    }
    let is_fitting = studio.fit().is_some_and(|fit| fit.is_running);
    let ended = studio.end();
    if is_fitting && ended.is_ok() {
        let root = studio.folder().root().display();
        insist(format_args!("interrupted: the best model so far is in the project {root}"));
    }
    ending.end();
    // Answers may take longer than somebody waits who has pressed Ctrl-C.
    let failed = ended.as_ref().err().map(|error| format!("error: {error:#}"));
    thread::spawn(move || {
        thread::sleep(LONGEST_END);
        failed.iter().for_each(|words| insist(format_args!("{words}")));
        std::process::exit(failed.map_or(interrupt::exit_status().into(), |_| 1));
    });
    Ok(ended?)
}

//! Ctrl-C: the first asks to stop and save, the second stops at once.

use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, Result};

use crate::messages::note;

/// Exit status after Ctrl-C.
pub const EXIT_STATUS: u8 = 130;

static PRESSED: AtomicUsize = AtomicUsize::new(0);

/// From now on Ctrl-C asks instead of killing, and gets this answer.
pub fn listen(answer: &'static str) -> Result<()> {
    ctrlc::set_handler(move || {
        if PRESSED.fetch_add(1, Ordering::SeqCst) > 0 {
            std::process::exit(EXIT_STATUS.into());
        }
        note(format_args!("{answer} (Ctrl-C again stops at once)"));
    })
    .context("cannot listen for Ctrl-C")
}

/// True once Ctrl-C was pressed.
pub fn requested() -> bool {
    PRESSED.load(Ordering::SeqCst) > 0
}

//! Ctrl-C and the signals that end a process: the first stops and saves, the second stops at once.

use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Duration;

use anyhow::{Context, Result};

use crate::messages::insist;

/// Added to a signal's number to give the exit status, as shells do.
const SIGNALLED: u8 = 128;

/// Number of Ctrl-C's signal.
const CTRL_C: u8 = 2;

/// The first signal; 0 before it.
static HEARD: AtomicU8 = AtomicU8::new(0);

/// A command that loses nothing ends this long after the first signal.
const PATIENCE: Duration = Duration::from_secs(3);

/// As [`listen`], for a command that loses nothing: it ends within [`PATIENCE`] in any case.
pub fn listen_briefly(answer: &'static str) -> Result<()> {
    handle(answer, true).context("cannot handle Ctrl-C")
}

/// A file beyond the limit of `ulimit -f` is from now on an error like a full disk, and no sudden end.
pub fn survive_limits_of_files() {
    #[cfg(unix)]
    {
        use signal_hook::consts::SIGXFSZ;

        // It fails for signals that cannot be handled only.
        let _ =
            signal_hook::flag::register(SIGXFSZ, std::sync::Arc::<std::sync::atomic::AtomicBool>::default());
    }
}

/// From now on Ctrl-C, SIGTERM and SIGHUP stop the work instead of killing the process, and print this text.
pub fn listen(answer: &'static str) -> Result<()> {
    handle(answer, false).context("cannot handle Ctrl-C")
}

/// True once a signal asked to stop.
pub fn requested() -> bool {
    HEARD.load(Ordering::SeqCst) != 0
}

/// Exit status after the signal that asked to stop: 130 after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP.
pub fn exit_status() -> u8 {
    SIGNALLED + HEARD.load(Ordering::SeqCst)
}

fn hear(signal: u8, answer: &str, briefly: bool) {
    if HEARD.compare_exchange(0, signal, Ordering::SeqCst, Ordering::SeqCst).is_err() {
        std::process::exit((SIGNALLED + signal).into());
    }
    insist(format_args!("{answer} (Ctrl-C again stops at once)"));
    if briefly {
        std::thread::spawn(|| {
            std::thread::sleep(PATIENCE);
            std::process::exit(exit_status().into());
        });
    }
}

#[cfg(unix)]
fn handle(answer: &'static str, briefly: bool) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

    let hangup = (!is_hangup_ignored()).then_some(SIGHUP);
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM].into_iter().chain(hangup))?;
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        for signal in signals.forever() {
            hear(u8::try_from(signal).unwrap_or(CTRL_C), answer, briefly);
        }
    })?;
    Ok(())
}

/// True under `nohup`, as far as the system shows it: then a closed terminal is to be ignored.
#[cfg(unix)]
fn is_hangup_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 1)
}

#[cfg(not(unix))]
fn handle(answer: &'static str, briefly: bool) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(move || hear(CTRL_C, answer, briefly))
}

//! Output of the program: results on stdout, all else on stderr. A stream that was closed is never a
//! panic.

use std::borrow::Cow;
use std::fmt;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Result;
use hysid_core::words::Words;
use hysid_document::{Face, Problem};
pub use hysid_records::summarised;
use hysid_records::understanding::labelled;
use serde::Serialize;

use crate::terminal;

/// A wrong command line, with what helps.
#[derive(Debug)]
pub struct Usage(pub String);

impl fmt::Display for Usage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Usage {}

/// True for an error that is invalid whatever the data.
pub fn is_usage(error: &anyhow::Error) -> bool {
    error.is::<Usage>() || matches!(error.downcast_ref(), Some(Problem::Request(_)))
}

/// Stdout's reader went away, as `head` does.
#[derive(Debug)]
pub struct StdoutClosed;

impl fmt::Display for StdoutClosed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("stdout was closed")
    }
}

impl std::error::Error for StdoutClosed {}

/// Writes lines of text to stdout, for a reader.
pub fn results(text: &str) -> Result<()> {
    let lines: Vec<Cow<str>> = text.split('\n').map(terminal::visible).collect();
    raw_results(&lines.join("\n"))
}

/// Writes results to stdout: as one JSON value, or as text for a reader.
pub fn told<T: Serialize>(
    as_json: bool,
    value: impl FnOnce() -> Result<T>,
    text: impl FnOnce() -> String,
) -> Result<()> {
    if as_json { json_results(&value()?) } else { results(&text()) }
}

/// Writes results to stdout as one JSON value.
pub fn json_results(value: &impl Serialize) -> Result<()> {
    raw_results(&terminal::json(value)?)
}

/// Writes results to stdout as they are: tables and whatever else a program reads.
pub fn raw_results(text: &str) -> Result<()> {
    HAS_RESULTS.store(true, Ordering::Relaxed);
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).map_err(stdout_failed)
}

/// Why stdout took no more.
pub fn stdout_failed(error: io::Error) -> anyhow::Error {
    match error.kind() {
        io::ErrorKind::BrokenPipe => StdoutClosed.into(),
        _ => anyhow::anyhow!("cannot write to stdout: {}", hysid_files::reason(&error)),
    }
}

/// Something was printed to stdout.
static HAS_RESULTS: AtomicBool = AtomicBool::new(false);

/// True once something was printed to stdout.
pub fn has_results() -> bool {
    HAS_RESULTS.load(Ordering::Relaxed)
}

/// True after `--quiet`.
static QUIET: AtomicBool = AtomicBool::new(false);

/// From now on stderr gets only warnings, errors and what a signal caused.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// True under `--quiet`: only warnings and errors are printed.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Prints one line on stderr, unless quiet: the reading of the data, progress, where files are.
pub fn note(text: fmt::Arguments) {
    if !is_quiet() {
        insist(text);
    }
}

/// Says labels and their texts, within 80 columns where words allow.
pub fn note_labelled(lines: &[(String, String)]) {
    for (label, text) in lines {
        for line in labelled(label, text).lines() {
            note(format_args!("{line}"));
        }
    }
    note(format_args!(""));
}

/// Says one line on stderr, whether or not the program is to be quiet: an error, or what a signal caused.
pub fn insist(text: fmt::Arguments) {
    // Nobody is left to be told if this fails.
    let _ = writeln!(io::stderr().lock(), "{}", terminal::line(&text.to_string()));
}

pub fn warning(text: impl fmt::Display) {
    insist(format_args!("warning: {text}"));
}

/// A warning with options that help.
pub fn warning_words(words: &Words) {
    warning(Face::Terminal.told(words));
}

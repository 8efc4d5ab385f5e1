//! What the program says: results on stdout, all else on stderr. A stream that was closed is never a
//! panic.

use std::borrow::Cow;
use std::fmt;
use std::io::{self, Write};
use std::mem::{self, Discriminant};
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Result;
use hysid::data::warning::Warning;
use serde::Serialize;

use crate::terminal;

/// Stdout's reader went away, as `head` does.
#[derive(Debug)]
pub struct StdoutClosed;

impl fmt::Display for StdoutClosed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("stdout was closed")
    }
}

impl std::error::Error for StdoutClosed {}

/// A command line that cannot be obeyed; the exit status is 2.
#[derive(Debug)]
pub struct Usage(pub String);

impl fmt::Display for Usage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Usage {}

/// Writes lines of text to stdout, for a reader.
pub fn results(text: &str) -> Result<()> {
    let lines: Vec<Cow<str>> = text.split('\n').map(terminal::visible).collect();
    raw_results(&lines.join("\n"))
}

/// Writes results to stdout as one JSON value.
pub fn json_results(value: &impl Serialize) -> Result<()> {
    raw_results(&terminal::json(value)?)
}

/// Writes results to stdout as they are: tables and whatever else a program reads.
pub fn raw_results(text: &str) -> Result<()> {
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

/// True after `--quiet`.
static QUIET: AtomicBool = AtomicBool::new(false);

/// From now on stderr gets only warnings, errors and what a signal caused.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// True if only warnings and errors are wanted.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Says one line on stderr, unless only warnings and errors are wanted: what was understood, progress, where files are.
pub fn note(text: fmt::Arguments) {
    if !is_quiet() {
        insist(text);
    }
}

/// Says one line on stderr, whether or not the program is to be quiet: an error, or what a signal caused.
pub fn insist(text: fmt::Arguments) {
    // Nobody is left to be told if this fails.
    let _ = writeln!(io::stderr().lock(), "{}", terminal::line(&text.to_string()));
}

/// Warnings of a kind that are said one by one: a file may have a hundred thousand records.
const MOST_OF_A_KIND: usize = 5;

/// Warnings in words, kind by kind: the first few, and how many more there are.
pub fn summarised(warnings: &[Warning]) -> Vec<String> {
    let mut kinds: Vec<(Discriminant<Warning>, Vec<&Warning>)> = Vec::new();
    for warning in warnings {
        let kind = mem::discriminant(warning);
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, warnings)) => warnings.push(warning),
            None => kinds.push((kind, vec![warning])),
        }
    }
    let words = kinds.iter().flat_map(|(_, warnings)| {
        let more = warnings.len().saturating_sub(MOST_OF_A_KIND);
        let more = (more > 0).then(|| format!("and {more} more of this kind"));
        warnings.iter().take(MOST_OF_A_KIND).map(ToString::to_string).chain(more)
    });
    words.collect()
}

/// Warns on stderr.
pub fn warning(text: impl fmt::Display) {
    insist(format_args!("warning: {text}"));
}

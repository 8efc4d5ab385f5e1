//! What the program says: results on stdout, all else on stderr. A stream that was closed is never a
//! panic.

use std::fmt;
use std::io::{self, Write};

use anyhow::Result;

use crate::files;

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

/// Writes results to stdout, as they are.
pub fn results(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).map_err(|error| match error.kind() {
        io::ErrorKind::BrokenPipe => StdoutClosed.into(),
        _ => anyhow::anyhow!("cannot write to stdout: {}", files::reason(&error)),
    })
}

/// Says one line on stderr.
pub fn note(text: fmt::Arguments) {
    // Nobody is left to be told if this fails.
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Warns on stderr.
pub fn warning(text: impl fmt::Display) {
    note(format_args!("warning: {text}"));
}

//! What is asked for on the command lines of `cases` and `verdicts`.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

/// Cases, and the program to ask about each.
#[derive(Debug, Default, Args)]
pub struct CaseRequest {
    /// Folder of the cases
    pub folder: PathBuf,
    /// Write the tables to this file too, with their origin
    #[arg(long, value_name = "FILE.md")]
    pub out: Option<PathBuf>,
    /// Give up a case after this time
    #[arg(long, value_name = "SECONDS", value_parser = duration)]
    pub case_limit: Option<Duration>,
    /// Program in the place of the release build
    #[arg(long, value_name = "HYSID")]
    pub program: Option<PathBuf>,
    /// Further arguments for the program
    #[arg(last = true, value_name = "ARG")]
    pub passed_on: Vec<String>,
}

/// A positive number of seconds.
pub fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if seconds > 0.0 && seconds < 1e9 => Ok(seconds),
        _ => Err("a number of seconds above 0 is needed".into()),
    }
}

fn duration(text: &str) -> Result<Duration, String> {
    seconds(text).map(Duration::from_secs_f64)
}

//! The program `hysid`; all of it is in the library beside it.

use std::process::ExitCode;

fn main() -> ExitCode {
    hysid_cli::run()
}

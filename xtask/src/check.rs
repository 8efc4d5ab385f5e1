//! `cargo xtask check`: all that can be judged without running the code.

use anyhow::Result;

use crate::{cargo, dependencies, tidy};

pub fn run() -> Result<()> {
    cargo(&["fmt", "--all", "--", "--check"], &[])?;
    cargo(&["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"], &[])?;
    cargo(&["doc", "--workspace", "--no-deps", "--locked"], &[("RUSTDOCFLAGS", "-D warnings")])?;
    dependencies::run()?;
    tidy::run()
}

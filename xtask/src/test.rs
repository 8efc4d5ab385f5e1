//! `cargo xtask test`: every test there is, one step after the other. A step that needs something installed
//! installs it first, so that a fresh clone needs nothing but a Rust toolchain.

use anyhow::Result;

use crate::cargo;

pub fn run() -> Result<()> {
    rust()
}

/// Unit, integration and documentation tests. They need nothing beyond cargo.
fn rust() -> Result<()> {
    cargo(&["test", "--workspace", "--locked"], &[])
}

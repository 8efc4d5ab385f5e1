//! `cargo xtask test`: every test there is, one step after the other. A step that needs something installed
//! installs it first, so that a fresh clone needs nothing but a Rust toolchain, and Python for the package.

use anyhow::Result;

use crate::{cargo, fuzz, python};

pub fn run() -> Result<()> {
    rust()?;
    fuzz::in_tests()?;
    python::test()
}

/// The tests inside the crates, without those that run programs or fit many models: for after a small change.
pub fn quick() -> Result<()> {
    cargo(
        &[
            "test",
            "--workspace",
            "--exclude",
            "hysid-python",
            "--exclude",
            "hysid-fuzz",
            "--locked",
            "--lib",
            "--bins",
        ],
        &[],
    )
}

/// Unit, integration and documentation tests. They need nothing beyond cargo. The Python package has its own.
fn rust() -> Result<()> {
    cargo(&["test", "--workspace", "--exclude", "hysid-python", "--locked"], &[])
}

//! `cargo xtask check`: all that can be judged without running the code.

use anyhow::Result;

use crate::cargo::{cargo, workspace_root};
use crate::environment::{Environment, step};
use crate::{dependencies, tidy};

pub fn run() -> Result<()> {
    cargo(&["fmt", "--all", "--", "--check"], &[])?;
    cargo(&["fmt", "--manifest-path", "lab/Cargo.toml", "--", "--check"], &[])?;
    cargo(&["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"], &[])?;
    cargo(&["doc", "--workspace", "--no-deps", "--locked"], &[("RUSTDOCFLAGS", "-D warnings")])?;
    dependencies::run()?;
    let mut unused = Environment::of_tools()?.program("cargo-shear");
    step("cargo-shear", unused.args(["--locked", "--deny-warnings"]).current_dir(workspace_root()))?;
    tidy::run()
}

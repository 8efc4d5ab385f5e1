//! `cargo xtask bench`: the benchmarks.

use anyhow::Result;

use crate::cargo;

pub fn run(passed_on: &[&str]) -> Result<()> {
    let arguments = [&["bench", "--workspace"], passed_on].concat();
    cargo(&arguments, &[])
}

//! Steps that cargo does, and where it puts what it builds.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

/// The whole workspace. Python's symbols are those of the interpreter that loads the native module.
pub const EVERYTHING: [&str; 4] = ["--workspace", "--features", "hysid-python/extension-module", "--locked"];

/// Runs `cargo` with these arguments and environment variables at the root of the workspace, as one step.
pub fn cargo(arguments: &[&str], environment: &[(&str, &str)]) -> Result<()> {
    step("cargo", &program(), arguments, environment)
}

/// Runs `cargo` of the oldest Rust that the workspace names, as one step; rustup installs it where it is missing.
pub fn oldest_cargo(arguments: &[&str]) -> Result<()> {
    let rustup = Path::new("rustup");
    let version = format!("{}.0", env!("CARGO_PKG_RUST_VERSION"));
    step("rustup", rustup, &["toolchain", "install", "--profile", "minimal", &version], &[])?;
    step("rustup", rustup, &[&["run", &version, "cargo"], arguments].concat(), &[])
}

fn step(name: &str, program: &Path, arguments: &[&str], environment: &[(&str, &str)]) -> Result<()> {
    let step = format!("{name} {}", arguments.join(" "));
    println!("==> {step}");
    let status = Command::new(program)
        .args(arguments)
        .envs(environment.iter().copied())
        .current_dir(workspace_root())
        .status()
        .with_context(|| format!("step `{step}` could not be started"))?;
    if !status.success() {
        bail!("step `{step}` failed ({status})");
    }
    Ok(())
}

/// The cargo that started us, under `cargo xtask`.
pub fn program() -> PathBuf {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()).into()
}

/// Builds the whole workspace once: libraries, the program, the native module of the Python package, and every test.
/// Cargo chooses the features of a dependency by what is built with it, so that parts by themselves would build many
/// dependencies anew.
pub fn build_everything() -> Result<()> {
    cargo(&[&["build", "--lib", "--bins", "--tests"], &EVERYTHING[..]].concat(), &[])
}

/// A file that [`build_everything`] makes.
pub fn built(name: &str) -> Result<PathBuf> {
    Ok(target()?.join("debug").join(name))
}

/// The program `hysid`, of [`build_everything`].
pub fn built_program() -> Result<PathBuf> {
    built(&format!("hysid{}", std::env::consts::EXE_SUFFIX))
}

/// Cargo's target folder: we lie in a folder of it ourselves, wherever it was put.
pub fn target() -> Result<PathBuf> {
    let xtask = std::env::current_exe().context("the path of xtask is unknown")?;
    Ok(xtask.parent().and_then(Path::parent).context("xtask lies in no target folder")?.to_path_buf())
}

/// The folder of the workspace's `Cargo.toml`.
pub fn workspace_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("xtask lies in a folder of the workspace")
        .to_path_buf()
}

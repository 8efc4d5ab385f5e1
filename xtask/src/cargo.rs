//! Steps that cargo does, and where it puts what it builds.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

/// Runs `cargo` with these arguments and environment variables at the root of the workspace, as one step.
pub fn cargo(arguments: &[&str], environment: &[(&str, &str)]) -> Result<()> {
    let step = format!("cargo {}", arguments.join(" "));
    println!("==> {step}");
    let status = Command::new(program())
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

/// The release build of the program `hysid`.
pub fn built_program() -> Result<PathBuf> {
    cargo(&["build", "--release", "--locked", "--package", "hysid-cli"], &[])?;
    Ok(target()?.join("release").join(format!("hysid{}", std::env::consts::EXE_SUFFIX)))
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

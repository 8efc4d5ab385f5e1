//! Developer commands: `cargo xtask check | test | bench | tidy`.

mod bench;
mod check;
mod test;
mod tidy;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use anyhow::{Context, Result, bail};

const USAGE: &str = "\
Usage: cargo xtask COMMAND

Commands:
  check          formatting, lints, documentation, tidiness
  test           every test of the workspace
  bench [ARG]..  every benchmark; the arguments are passed on to `cargo bench`
  tidy           only the tidiness part of `check`
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match arguments.as_slice() {
        ["check"] => check::run(),
        ["test"] => test::run(),
        ["bench", passed_on @ ..] => bench::run(passed_on),
        ["tidy"] => tidy::run(),
        _ => {
            eprint!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Runs `cargo` with these arguments and environment variables at the root of the workspace, as one step.
fn cargo(arguments: &[&str], environment: &[(&str, &str)]) -> Result<()> {
    let step = format!("cargo {}", arguments.join(" "));
    println!("==> {step}");
    // Under `cargo xtask`, CARGO names the very cargo that started us.
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
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

/// The folder of the workspace's `Cargo.toml`.
fn workspace_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("xtask lies in a folder of the workspace")
        .to_path_buf()
}

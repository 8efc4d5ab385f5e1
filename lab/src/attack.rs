//! `attack`: what comes from elsewhere and is believed, at length. Mutated files of every container in a process whose
//! memory is limited, then every fuzz target, then saved states of exports of all kinds of models and names through every
//! target. CI runs the same for seconds.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use clap::Args;

use crate::program;

/// Memory of the process that reads mutated files, in kB.
const MOST_MEMORY: usize = 800_000;

/// Packages and filters of the tests that go through every kind and name with `HYSID_AT_LENGTH`.
const TESTS: [&str; 5] = ["states::", "names::", "foreign::", "invalid::", "hostile"];

/// How long to try.
#[derive(Debug, Args)]
pub struct Request {
    /// Seconds of each fuzz target
    #[arg(long, default_value_t = 600)]
    seconds: u64,
    /// Seed of the mutations
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

pub fn run(request: &Request) -> Result<()> {
    let product = program::product();
    let cargo = || {
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        cargo.current_dir(&product);
        cargo
    };
    succeeds(cargo().args(["build", "--locked", "--profile", "fuzz", "--package", "hysid-fuzz"]))?;
    let fuzz = program::target().join("fuzz").join(format!("hysid-fuzz{}", std::env::consts::EXE_SUFFIX));
    succeeds(&mut limited(&fuzz, request))?;
    let numbers = [request.seconds, request.seed].map(|number| number.to_string());
    succeeds(Command::new(&fuzz).args(["--seconds", &numbers[0], "--seed", &numbers[1]]))?;
    let tests =
        "test --locked --no-fail-fast --package hysid-export --package hysid-cli --test suite --".split(' ');
    succeeds(cargo().env("HYSID_AT_LENGTH", "1").args(tests).args(TESTS))?;
    println!("nothing was found");
    Ok(())
}

/// The target of containers with little memory: a process that is refused memory aborts.
fn limited(fuzz: &Path, request: &Request) -> Command {
    let Request { seconds, seed } = request;
    let program = fuzz.display();
    let line =
        format!("ulimit -v {MOST_MEMORY}; exec '{program}' container --seconds {seconds} --seed {seed}");
    let mut command = Command::new("sh");
    // An arena of memory for each thread is address space that is not used.
    command.env("MALLOC_ARENA_MAX", "2").args(["-c", &line]);
    command
}

fn succeeds(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("{command:?} could not be started"))?;
    ensure!(status.success(), "{command:?}: {status}");
    Ok(())
}

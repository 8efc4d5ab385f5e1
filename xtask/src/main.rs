//! Developer commands: `cargo xtask check | test | python | sdist | bench | cases | generate-cases | generate-files |
//! verdicts | verdict-battery | plan-battery | questions | fuzz | soak | same-models | tidy | site`.

mod arguments;
mod bench;
mod browser;
mod cases;
mod check;
mod dependencies;
mod files;
mod fuzz;
mod generate_cases;
mod generate_files;
mod markdown;
mod plan_battery;
mod program;
mod proofs;
mod python;
mod questions;
mod repository;
mod rig;
mod same_models;
mod site;
mod soak;
mod statistics;
mod test;
mod tidy;
mod verdict_battery;
mod verdicts;

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use anyhow::{Context, Result, bail};

const USAGE: &str = "\
Usage: cargo xtask COMMAND

Commands:
  check          formatting, lints, documentation, licences of dependencies, tidiness
  test [--quick] every test of the workspace, of the Python package in an environment of its own, and of the links of
                 the site. With --quick, only the tests inside the library's crates, and whether the rest compiles
  python         only the Python package's part of `test`
  sdist          builds the Python package's source distribution and installs it alone (some minutes)
  bench [ARG]..  every benchmark; the arguments are passed on to `cargo bench`
  tidy           only the tidiness part of `check`
  site           the documentation as a site, target/site/index.html, and whether its links lead somewhere
  fuzz [TARGET] [SECONDS] [--seed NUMBER] [--coverage]
                 the targets of fuzz/ (all of them) on mutated inputs, for so many seconds (60) each. The same seed (1)
                 gives the same inputs. With --coverage, one target under libFuzzer
  soak [KILLS]   kills fits at KILLS (200) random moments, fills the disk, races writers, fits every model to nasty
                 data under a time limit, and reports
  same-models OLD [--program NEW]
                 fits of every model by the program OLD and by the release build (or NEW): model files and what they
                 simulate must be the same, byte by byte
  cases DIR [--models LIST] [--time-limit SECONDS] [--case-limit SECONDS] [--out FILE.md] [--program HYSID]
            [-- ARG..]
                 `hysid compare` on every subfolder of DIR that has train.csv and test.csv, as tables: test and
                 training errors, seconds, what auto chose. LIST, time limit and ARG are passed on to it; a case that takes longer
                 than its limit is given up; HYSID takes the place of the release build
  generate-cases DIR [--count NUMBER] [--seed NUMBER] [--one-loop]
                 writes folders with train.csv and test.csv for `cases`: laws with parameters of their own, driven as
                 engineers measure, with noise. The same seed (1) gives the same cases; the first 36 all differ in
                 kind. With --one-loop, one loop to train on and smaller loops inside it to test
  generate-files DIR
                 writes small files with one record as instruments and tools write it, for the tests of `hysid look`
                 (DIR is crates/hysid-cli/tests/files)
  verdicts DIR [--case-limit SECONDS] [--out FILE.md] [--program HYSID] [-- ARG..]
                 `hysid diagnose` on every subfolder of DIR that has train.csv, as a table of verdicts; otherwise as
                 `cases`
  verdict-battery [--out FILE.md] [--seed NUMBER] [--laws LIST] [--disturbances LIST] [--program HYSID]
            [--list-wrong FILE]
                 `hysid diagnose` on records of laws with known properties and the disturbances of a laboratory, as
                 tables of right and wrong verdicts. The same seed (1) gives the same records. With --list-wrong, a
                 line of CSV for each wrong verdict, and its record in the folder FILE with the ending .records
  plan-battery [--first constant|rising] [--seeds NUMBER] [--specimens LIST] [--out FILE.md]
                 the error on unseen data after a first test and a second one: the same again, the plan of
                 `hysid plan`, random reversals. Long: run it as `cargo run --release -p xtask -- plan-battery`
  questions [--only NAME] [--out FILE.md]
                 the tables of docs/questions.md, all or one: cycles, columns, one-loop, rates,
                 wear, durations, models, inverses, disturbances, amplitudes or errors.
                 Long: run it as `cargo run --release -p xtask -- questions`
";

/// A command line that cannot be obeyed; the exit status is 2.
#[derive(Debug)]
struct Usage(String);

impl fmt::Display for Usage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (`cargo xtask` alone lists the commands)", self.0)
    }
}

impl std::error::Error for Usage {}

/// Ctrl-C ended a command that has told so; the exit status is 130.
#[derive(Debug)]
struct Interrupted;

impl fmt::Display for Interrupted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("interrupted")
    }
}

impl std::error::Error for Interrupted {}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match arguments.as_slice() {
        ["check"] => check::run(),
        ["test"] => test::run(),
        ["test", "--quick"] => test::quick(),
        ["python"] => python::test(),
        ["sdist"] => python::source_distribution(),
        ["bench", passed_on @ ..] => bench::run(passed_on),
        ["tidy"] => tidy::run(),
        ["site"] => site::run(),
        ["fuzz", rest @ ..] => fuzz::Request::parse(rest).and_then(|request| fuzz::run(&request)),
        ["soak", rest @ ..] if soak::kills(rest).is_some() => {
            soak::run(soak::kills(rest).unwrap_or_default())
        }
        ["same-models", rest @ ..] => {
            same_models::Request::parse(rest).and_then(|request| same_models::run(&request))
        }
        ["cases", rest @ ..] => {
            cases::Request::parse(rest, &cases::OPTIONS).and_then(|request| cases::run(&request))
        }
        ["generate-cases", rest @ ..] => {
            generate_cases::Request::parse(rest).and_then(|request| generate_cases::run(&request))
        }
        ["generate-files", folder] => generate_files::run(&PathBuf::from(folder)),
        ["verdicts", rest @ ..] => {
            cases::Request::parse(rest, &verdicts::OPTIONS).and_then(|request| verdicts::run(&request))
        }
        ["plan-battery", rest @ ..] => {
            plan_battery::Request::parse(rest).and_then(|request| plan_battery::run(&request))
        }
        ["questions", rest @ ..] => {
            questions::Request::parse(rest).and_then(|request| questions::run(&request))
        }
        ["verdict-battery", rest @ ..] => {
            verdict_battery::Request::parse(rest).and_then(|request| verdict_battery::run(&request))
        }
        _ => {
            eprint!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.is::<Interrupted>() => ExitCode::from(130),
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::from(if error.is::<Usage>() { 2 } else { 1 })
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

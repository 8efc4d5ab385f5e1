//! `cargo xtask fuzz [TARGET] [SECONDS] [--seed NUMBER] [--coverage]`: the targets of `fuzz/` on mutated inputs, with
//! the seeded driver or, guided by coverage, with libFuzzer. Both work with a stable toolchain.

use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::{Usage, cargo, workspace_root};

/// Seconds for each target unless said otherwise.
const SECONDS: &str = "60";

/// Seconds for each target among all tests.
const SECONDS_IN_TESTS: &str = "5";

/// What the compiler adds for libFuzzer: counters of every edge and of comparisons.
const COVERAGE: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing -Ccodegen-units=1";

/// What was asked for.
#[derive(Debug, PartialEq)]
pub struct Request {
    target: String,
    seconds: String,
    seed: String,
    coverage: bool,
}

impl Request {
    /// From the arguments after `fuzz`.
    pub fn parse(arguments: &[&str]) -> Result<Self> {
        let mut request =
            Self { target: "all".into(), seconds: SECONDS.into(), seed: "1".into(), coverage: false };
        let (mut rest, mut given) = (arguments.iter(), Vec::new());
        while let Some(&argument) = rest.next() {
            match argument {
                "--coverage" => request.coverage = true,
                "--seed" => {
                    request.seed = rest.next().map(|seed| (*seed).into()).unwrap_or_default();
                }
                argument => given.push(argument),
            }
        }
        let (mut given, mut seconds) = (given.into_iter(), None);
        for argument in given.by_ref().take(2) {
            match argument.parse::<f64>() {
                Ok(_) => seconds = Some(argument),
                Err(_) => request.target = argument.into(),
            }
        }
        request.seconds = seconds.unwrap_or(SECONDS).into();
        let is_number = request.seed.parse::<u64>().is_ok() && given.next().is_none();
        if is_number && (request.target != "all" || !request.coverage) {
            return Ok(request);
        }
        let advice = "fuzz [TARGET] [SECONDS] [--seed NUMBER] [--coverage]; --coverage needs a TARGET";
        Err(Usage(advice.into()).into())
    }
}

pub fn run(request: &Request) -> Result<()> {
    if request.coverage {
        return with_coverage(request);
    }
    let Request { target, seconds, seed, .. } = request;
    let build = ["run", "--quiet", "--profile", "fuzz", "--locked", "--package", "hysid-fuzz", "--"];
    cargo(&[&build[..], &[target, seconds, seed]].concat(), &[])
}

/// Every target for a short time with a fixed seed, built as the tests are.
pub fn in_tests() -> Result<()> {
    let target =
        ["run", "--quiet", "--locked", "--package", "hysid-fuzz", "--", "all", SECONDS_IN_TESTS, "1"];
    cargo(&target, &[])
}

fn with_coverage(request: &Request) -> Result<()> {
    let Request { target, seconds, seed, .. } = request;
    let fuzz = workspace_root().join("fuzz");
    let found = fuzz.join("artifacts").join("coverage").join(target);
    std::fs::create_dir_all(&found).with_context(|| format!("cannot make {}", found.display()))?;
    let host = host()?;
    let manifest = fuzz.join("coverage").join("Cargo.toml");
    let (manifest, found) = (manifest.to_string_lossy(), found.to_string_lossy());
    let corpus = Some(fuzz.join("corpus").join(target)).filter(|folder| folder.is_dir());
    let corpus = corpus.as_ref().map(|folder| folder.to_string_lossy());
    let (time, seed) = (format!("-max_total_time={seconds}"), format!("-seed={seed}"));
    // With a target triple the flags leave build scripts alone.
    let mut arguments = vec!["run", "--release", "--manifest-path", &manifest, "--target", &host, "--"];
    let limits = ["-timeout=30", "-rss_limit_mb=4000"];
    arguments.extend([found.as_ref()].into_iter().chain(corpus.as_deref()));
    arguments.extend([time.as_str(), &seed].into_iter().chain(limits));
    let variables = [("RUSTFLAGS", COVERAGE), ("HYSID_FUZZ_TARGET", target), ("HYSID_FUZZ_SEEDS", &found)];
    cargo(&arguments, &variables)
}

/// The triple of this machine.
fn host() -> Result<String> {
    let output = Command::new("rustc").arg("-vV").output().context("rustc could not be started")?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let host = text.lines().find_map(|line| line.strip_prefix("host: ")).map(str::to_owned);
    ensure!(host.is_some(), "rustc does not tell its host");
    Ok(host.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_understood_in_any_order() {
        let all = Request::parse(&[]).unwrap();
        assert_eq!((all.target.as_str(), all.seconds.as_str(), all.seed.as_str()), ("all", "60", "1"));
        let one = Request::parse(&["steps", "5", "--seed", "7", "--coverage"]).unwrap();
        assert_eq!((one.target.as_str(), one.seconds.as_str(), one.coverage), ("steps", "5", true));
        for wrong in [&["--coverage"][..], &["steps", "5", "6"], &["--seed", "x"]] {
            assert!(Request::parse(wrong).is_err(), "{wrong:?}");
        }
    }
}

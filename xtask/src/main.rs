//! Developer commands: `cargo xtask check | test | python | site | sdist | release | same-arithmetic`.

mod browser;
mod cargo;
mod check;
mod dependencies;
mod environment;
mod markdown;
mod proofs;
mod python;
mod release;
mod repository;
mod same_arithmetic;
mod site;
mod test;
mod tidy;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Developer commands
#[derive(Parser)]
#[command(name = "cargo xtask", max_term_width = 100)]
struct CommandLine {
    #[command(subcommand)]
    command: DeveloperCommand,
}

#[derive(Subcommand)]
enum DeveloperCommand {
    /// Check formatting, lints, documentation, dependencies and tidiness
    Check,
    /// Run every test: the workspace, the Python package, pages in a browser, links of the site
    Test {
        /// Run the tests inside the library's crates, and check that the rest compiles
        #[arg(long)]
        quick: bool,
    },
    /// Test the Python package in a virtual environment of its own, target/python
    Python,
    /// Build the documentation as a site, target/site/index.html, and check its links
    Site,
    /// Build the Python package's source distribution and install it alone (some minutes)
    Sdist,
    /// Check versions, build every crate from its archive, install the program and the source distribution: a release
    /// without its upload (half an hour)
    Release,
    /// Compare models and exported C to the last bit with several instruction sets, some of them emulated
    SameArithmetic {
        /// Only every so many of the fits: all of them take hours where a processor is emulated
        #[arg(long, value_name = "NUMBER", default_value = "1")]
        every: std::num::NonZeroUsize,
    },
    /// Check the house rules; a part of `check`
    Tidy,
}

fn main() -> ExitCode {
    let outcome = match CommandLine::parse().command {
        DeveloperCommand::Check => check::run(),
        DeveloperCommand::Test { quick: false } => test::run(),
        DeveloperCommand::Test { quick: true } => test::quick(),
        DeveloperCommand::Python => python::build_and_test(),
        DeveloperCommand::Site => site::run(),
        DeveloperCommand::Sdist => python::source_distribution(),
        DeveloperCommand::Release => release::run(),
        DeveloperCommand::SameArithmetic { every } => same_arithmetic::run(every.get()),
        DeveloperCommand::Tidy => tidy::run(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}

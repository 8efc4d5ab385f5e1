//! Measurements of Hysid: `cd lab && cargo run --release -- COMMAND`. README.md lists what each command measures.

mod attack;
mod bench;
mod cases;
mod compensation;
mod cycle_battery;
mod files;
mod generate_cases;
mod generate_files;
mod growth;
mod origin;
mod plan_battery;
mod program;
mod questions;
mod residual_battery;
mod rig;
mod roles_battery;
mod same_models;
mod soak;
mod statistics;
mod steps;
mod verdict_battery;
mod verdicts;

use std::fmt;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};

/// Measures Hysid
#[derive(Parser)]
#[command(name = "hysid-lab", max_term_width = 100)]
struct CommandLine {
    #[command(subcommand)]
    command: Measurement,
}

#[derive(Subcommand)]
enum Measurement {
    /// Attack readers, exports and saved states with files that were made to break them (an hour and a half)
    Attack(attack::Request),
    /// Measure simulation, training and single steps on this machine (a minute or two)
    Bench(bench::Request),
    /// Fit models to every case of a folder; tables of errors, times and chosen structures
    ///
    /// Runs `hysid compare` on every subfolder that has train.csv and test.csv.
    Cases(cases::Request),
    /// Measure the tables of docs/compensation.md: synthetic actuators driven by inverses of models
    Compensation,
    /// Count right and wrong tables of `hysid cycles` on protocols and loops that are known
    CycleBattery(cycle_battery::Request),
    /// Write synthetic cases as folders with train.csv and test.csv, for `cases`
    ///
    /// Laws with random parameters, protocols as engineers use them, and noise. The same seed gives the same cases; the
    /// first 36 all differ in kind.
    GenerateCases(generate_cases::Request),
    /// Write small files with one record as instruments and tools write it, for the tests of `hysid look`
    GenerateFiles {
        /// Folder of the files: crates/hysid-cli/tests/files
        folder: PathBuf,
    },
    /// Measure how cost grows with rows, stops, neurons and members of an ensemble (a minute)
    Growth(growth::Request),
    /// Compare a second test by `hysid plan` with the first test repeated and with random reversals
    ///
    /// Errors on unseen data after each. Takes about 40 minutes on two cores.
    PlanBattery(plan_battery::Request),
    /// Measure the tables of docs/questions.md
    Questions(questions::Request),
    /// Measure power and false alarms of the tests of the residual on planted dependences
    ResidualBattery(residual_battery::Request),
    /// Count right, asked and wrong roles of columns under the headers of twelve fields
    ///
    /// Runs `hysid look` on tables with these headers; fails if a role is wrong.
    RolesBattery(roles_battery::Request),
    /// Check that two programs fit the same models, byte by byte
    ///
    /// Fits every model with both; model files and simulations must be the same.
    SameModels(same_models::Request),
    /// Kill fits at random moments, fill the disk, race writers, fit nasty data under a time limit
    Soak(soak::Request),
    /// Measure steps of exported C code beside those of the library, and times of exports (needs cc)
    Steps,
    /// Count right and wrong verdicts of `hysid diagnose` on records of laws with known properties
    VerdictBattery(verdict_battery::Request),
    /// Diagnose every case of a folder; a table of verdicts
    ///
    /// Runs `hysid diagnose` on every subfolder that has train.csv.
    Verdicts(verdicts::Request),
}

/// Ctrl-C ended a command, which has reported so; the exit status is 130.
#[derive(Debug)]
struct Interrupted;

impl fmt::Display for Interrupted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("interrupted")
    }
}

impl std::error::Error for Interrupted {}

fn main() -> ExitCode {
    match run(&CommandLine::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.is::<Interrupted>() => ExitCode::from(130),
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(measurement: &Measurement) -> Result<()> {
    match measurement {
        Measurement::Attack(request) => attack::run(request),
        Measurement::Bench(request) => bench::run(request),
        Measurement::Cases(request) => cases::run(request),
        Measurement::Compensation => compensation::run(),
        Measurement::CycleBattery(request) => cycle_battery::run(request),
        Measurement::GenerateCases(request) => generate_cases::run(request),
        Measurement::GenerateFiles { folder } => generate_files::run(folder),
        Measurement::Growth(request) => growth::run(request),
        Measurement::PlanBattery(request) => plan_battery::run(request),
        Measurement::Questions(request) => questions::run(request),
        Measurement::ResidualBattery(request) => residual_battery::run(request),
        Measurement::RolesBattery(request) => roles_battery::run(request),
        Measurement::SameModels(request) => same_models::run(request),
        Measurement::Soak(request) => soak::run(request),
        Measurement::Steps => {
            steps::run();
            Ok(())
        }
        Measurement::VerdictBattery(request) => verdict_battery::run(request),
        Measurement::Verdicts(request) => verdicts::run(request),
    }
}

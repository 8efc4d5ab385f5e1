//! `hysid-fuzz TARGET|all SECONDS [SEED]`: the seeded driver, and `hysid-fuzz TARGET FILE`: one input.

use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use hysid_fuzz::{TARGETS, Target, driver, target};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (name, what, seed) = match arguments.as_slice() {
        [name, what] => (*name, *what, Some(1)),
        [name, what, seed] => (*name, *what, seed.parse().ok()),
        _ => ("", "", None),
    };
    let targets: Vec<&Target> = match name {
        "all" => TARGETS.iter().collect(),
        name => target(name).into_iter().collect(),
    };
    let Some(seed) = seed.filter(|_| !targets.is_empty()) else {
        let names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
        eprintln!("hysid-fuzz TARGET|all SECONDS|FILE [SEED], with a target of {}", names.join(", "));
        return ExitCode::from(2);
    };
    let Ok(seconds) = what.parse::<f64>() else {
        return match std::fs::read(what) {
            Ok(input) => {
                targets.iter().for_each(|target| (target.run)(&input));
                ExitCode::SUCCESS
            }
            Err(error) => {
                eprintln!("{what}: {error}");
                ExitCode::FAILURE
            }
        };
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (corpus, artifacts) = (root.join("corpus"), root.join("artifacts"));
    let mut failed = false;
    for target in targets {
        match driver::run(target, &corpus, &artifacts, Duration::from_secs_f64(seconds), seed) {
            Ok(outcome) => {
                println!("{:13} {:8} inputs, {} failed", target.name, outcome.inputs, outcome.failures.len());
                outcome.failures.iter().for_each(|path| println!("  {}", path.display()));
                failed |= !outcome.failures.is_empty();
            }
            Err(error) => {
                eprintln!("{}: {error}", target.name);
                failed = true;
            }
        }
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

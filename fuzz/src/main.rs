//! The fuzz targets on mutated inputs: `cargo run --profile fuzz -p hysid-fuzz -- [TARGET] [--seconds N] [--seed N]`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use clap::builder::PossibleValuesParser;
use hysid_fuzz::driver::{self, Limit};
use hysid_fuzz::{TARGETS, Target};

/// Run the fuzz targets on mutated inputs
#[derive(Parser)]
#[command(max_term_width = 100)]
struct CommandLine {
    /// Target; all without
    #[arg(value_parser = PossibleValuesParser::new(TARGETS.map(|target| target.name)))]
    target: Option<String>,
    /// Seconds for each target
    #[arg(long, default_value_t = 60, value_name = "NUMBER")]
    seconds: u64,
    /// So many mutated inputs for each target, whatever time they take
    #[arg(long, conflicts_with = "seconds", value_name = "NUMBER")]
    mutations: Option<usize>,
    /// Seed of the mutations; the same seed gives the same inputs
    #[arg(long, default_value_t = 1, value_name = "NUMBER")]
    seed: u64,
    /// Run this input only
    #[arg(long, value_name = "FILE", requires = "target")]
    input: Option<PathBuf>,
}

fn main() -> Result<()> {
    let arguments = CommandLine::parse();
    let is_wanted = |target: &&Target| arguments.target.as_ref().is_none_or(|name| name == target.name);
    let targets = TARGETS.iter().filter(is_wanted);
    if let Some(path) = &arguments.input {
        let input = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        targets.for_each(|target| (target.run)(&input));
        return Ok(());
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (corpus, artifacts) = (root.join("corpus"), root.join("artifacts"));
    let limit = match arguments.mutations {
        Some(count) => Limit::Mutations(count),
        None => Limit::Time(Duration::from_secs(arguments.seconds)),
    };
    let mut failures = 0;
    for target in targets {
        let outcome = driver::run(target, &corpus, &artifacts, limit, arguments.seed).context(target.name)?;
        println!("{:13} {:8} inputs, {} failed", target.name, outcome.inputs, outcome.failures.len());
        outcome.failures.iter().for_each(|path| println!("  {}", path.display()));
        failures += outcome.failures.len();
    }
    ensure!(failures == 0, "{failures} inputs failed");
    Ok(())
}

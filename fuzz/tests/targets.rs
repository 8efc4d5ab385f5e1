//! Every target on its corpus and on a fixed number of mutations of it; the program `hysid-fuzz` runs for longer.

use std::path::Path;

use hysid_fuzz::driver::{Limit, run};
use hysid_fuzz::target;

/// Mutated inputs of a target; those of `checkpoint` and `differential` fit models.
const MUTATIONS: usize = 200;

fn holds(name: &str) {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let artifacts = tempfile::tempdir().unwrap();
    let target = target(name).unwrap();
    let outcome = run(target, &corpus, artifacts.path(), Limit::Mutations(MUTATIONS), 1).unwrap();
    let failed: Vec<_> = outcome.failures.iter().map(|path| std::fs::read(path).unwrap()).collect();
    assert!(failed.is_empty(), "{failed:?}");
}

macro_rules! targets {
    ($($name:ident)*) => {
        /// The targets that are tested.
        const TESTED: &[&str] = &[$(stringify!($name)),*];

        $(#[test]
        fn $name() {
            holds(stringify!($name));
        })*
    };
}

targets!(table model_file checkpoint container options steps differential);

#[test]
fn every_target_is_tested() {
    assert_eq!(hysid_fuzz::TARGETS.map(|target| target.name), TESTED);
}

/// Files of a few kilobytes ask for no more memory than this. A process that is refused memory aborts.
#[cfg(unix)]
#[test]
fn containers_stay_within_their_memory() {
    const MOST_KILOBYTES: usize = 800_000;
    let line = format!(
        "ulimit -v {MOST_KILOBYTES}; exec '{}' container --mutations {MUTATIONS} --seed 2",
        env!("CARGO_BIN_EXE_hysid-fuzz")
    );
    // An arena of memory for each thread is address space that is not used.
    let output =
        std::process::Command::new("sh").env("MALLOC_ARENA_MAX", "2").args(["-c", &line]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

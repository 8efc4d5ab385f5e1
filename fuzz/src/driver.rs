//! The seeded driver: mutations of a corpus, the same for the same seed.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::Target;
use crate::mutation::mutated;

/// An input that takes longer is one that runs for ever.
const LONGEST: Duration = Duration::from_secs(30);

/// When a run of the driver ends; the corpus is run in any case.
#[derive(Debug, Clone, Copy)]
pub enum Limit {
    /// So long.
    Time(Duration),
    /// So many mutated inputs.
    Mutations(usize),
}

/// What a run of the driver came to.
pub struct Outcome {
    /// Inputs that were run.
    pub inputs: usize,
    /// Where inputs that failed are.
    pub failures: Vec<PathBuf>,
}

/// What the watchdog looks at.
struct Watched {
    began: Instant,
    input: Vec<u8>,
    is_done: bool,
}

/// Runs a target on its corpus, and then on mutations of it up to the limit. An input that fails is stored
/// among the artifacts; one that does not end, ends the process.
pub fn run(
    target: &Target,
    corpus: &Path,
    artifacts: &Path,
    limit: Limit,
    seed: u64,
) -> std::io::Result<Outcome> {
    let mut inputs = stored(&corpus.join(target.name))?;
    inputs.extend((target.seeds)());
    if inputs.is_empty() {
        inputs.push(Vec::new());
    }
    let watched = Arc::new(Mutex::new(Watched { began: Instant::now(), input: Vec::new(), is_done: false }));
    watch(Arc::clone(&watched), artifacts.to_path_buf(), target.name);
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(seed);
    let (began, mut outcome) = (Instant::now(), Outcome { inputs: 0, failures: Vec::new() });
    let goes_on = |run: usize| match limit {
        Limit::Time(time) => run < inputs.len() || began.elapsed() < time,
        Limit::Mutations(count) => run < inputs.len() + count,
    };
    while goes_on(outcome.inputs) {
        let input = match inputs.get(outcome.inputs) {
            Some(stored) => stored.clone(),
            None => mutated(&inputs, target.words, &mut generator),
        };
        {
            let mut watched = watched.lock().unwrap_or_else(PoisonError::into_inner);
            (watched.began, watched.input) = (Instant::now(), input.clone());
        }
        outcome.inputs += 1;
        if catch_unwind(AssertUnwindSafe(|| (target.run)(&input))).is_err() {
            outcome.failures.push(store(artifacts, target.name, &input)?);
        }
    }
    watched.lock().unwrap_or_else(PoisonError::into_inner).is_done = true;
    Ok(outcome)
}

/// The inputs in a folder, in the order of their names.
fn stored(folder: &Path) -> std::io::Result<Vec<Vec<u8>>> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path())).collect::<Result<_, _>>()?;
    paths.sort();
    paths.iter().map(fs::read).collect()
}

fn store(artifacts: &Path, name: &str, input: &[u8]) -> std::io::Result<PathBuf> {
    fs::create_dir_all(artifacts)?;
    let path = artifacts.join(format!("{name}-{:08x}", crc32fast::hash(input)));
    fs::write(&path, input)?;
    Ok(path)
}

fn watch(watched: Arc<Mutex<Watched>>, artifacts: PathBuf, name: &'static str) {
    thread::spawn(move || {
        loop {
            thread::sleep(Duration::from_millis(200));
            let now = watched.lock().unwrap_or_else(PoisonError::into_inner);
            if now.is_done {
                return;
            }
            if now.began.elapsed() > LONGEST {
                match store(&artifacts, name, &now.input) {
                    Ok(path) => eprintln!("{name}: {} does not end", path.display()),
                    Err(error) => eprintln!("{name}: an input that does not end cannot be stored: {error}"),
                }
                std::process::exit(1);
            }
        }
    });
}

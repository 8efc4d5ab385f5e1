//! `verdict-battery`: how often `hysid diagnose` is right. Records of laws with known properties on paths
//! that engineers measure, with the disturbances of a laboratory; the laws share no code with the library. Fixed seeds
//! make the records, and the tables, the same on every run.
//!
//! A verdict is right if it equals the law's answer and wrong if it is the other one; `truth.rs` says which answers
//! count.

mod answer;
mod branches;
mod chance;
mod disturbances;
mod evidence;
mod laws;
mod page;
mod paths;
mod property;
mod request;
mod run;
mod tally;
mod truth;

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::{Path as FilePath, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use anyhow::{Context, Result, anyhow};

use crate::origin::origin;
use crate::{Interrupted, files, program};
use answer::Findings;
use chance::Chance;
use disturbances::Disturbance;
use evidence::Evidence;
use laws::Law;
use page::Names;
use paths::Path;
use property::PROPERTIES;
pub use request::Request;
use request::named;
use run::Run;
use tally::{Outcome, Tally, Verdict};
use truth::truth;

pub fn run(request: &Request) -> Result<()> {
    let laws = named(laws::all(), request.laws.as_deref(), "law", |law| law.name)?;
    let disturbances =
        named(disturbances::all(), request.disturbances.as_deref(), "disturbance", |one| one.name)?;
    for file in request.out.iter().chain(&request.list_wrong) {
        files::check_writable(file)?;
    }
    let program = request.program.clone().map_or_else(program::build, Ok)?;
    let version = program::version(&program)?;
    let battery = Battery {
        laws,
        paths: paths::all(),
        disturbances,
        seed: request.seed,
        records: folder_of_records(request)?,
        keeps_wrong: request.list_wrong.is_some(),
        program,
    };
    // Not before: a build is for cargo to stop.
    program::listen()?;
    let verdicts = battery.verdicts()?;
    let tables = page::tables(&battery.names(), &verdicts);
    let laws = page::laws(&battery.laws);
    if let Some(out) = &request.out {
        let origin = origin(request.program.is_none(), &version);
        files::write(out, &format!("# How often verdicts are right\n\n{origin}\n{tables}\n{laws}"))?;
    }
    if let Some(list) = &request.list_wrong {
        files::write(list, &page::wrong_verdicts(&verdicts))?;
    }
    io::stdout().write_all(tables.as_bytes()).context("cannot write to stdout")
}

/// The folder of the records: beside the list of wrong verdicts, whose records stay; otherwise they go as soon as
/// they are judged.
fn folder_of_records(request: &Request) -> Result<PathBuf> {
    let folder = match &request.list_wrong {
        Some(list) => list.with_extension("records"),
        None => program::target().join("verdict-battery"),
    };
    fs::create_dir_all(&folder).with_context(|| format!("{} cannot be made", folder.display()))?;
    // What an earlier run left; whatever else is there stays.
    for entry in fs::read_dir(&folder).with_context(|| format!("{} cannot be read", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == "csv") {
            fs::remove_file(&path).with_context(|| format!("{} cannot be removed", path.display()))?;
        }
    }
    Ok(folder)
}

/// What is asked about, and of whom.
struct Battery {
    laws: Vec<Law>,
    paths: Vec<Path>,
    disturbances: Vec<Disturbance>,
    seed: u64,
    records: PathBuf,
    keeps_wrong: bool,
    program: PathBuf,
}

impl Battery {
    fn names(&self) -> Names {
        Names {
            laws: self.laws.iter().map(|law| law.name).collect(),
            paths: self.paths.iter().map(|path| path.name).collect(),
            disturbances: self.disturbances.iter().map(|one| one.name).collect(),
        }
    }

    /// The verdicts that count, in the order of laws, paths and disturbances.
    fn verdicts(&self) -> Result<Vec<Verdict>> {
        let runs: Vec<(&Law, &Path)> =
            self.laws.iter().flat_map(|law| self.paths.iter().map(move |path| (law, path))).collect();
        let done: Mutex<Vec<Option<Vec<Verdict>>>> = Mutex::new(runs.iter().map(|_| None).collect());
        let (next, finished) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let stopped = AtomicBool::new(false);
        let failure = Mutex::new(None);
        let work = || {
            while !stopped.load(Ordering::SeqCst) {
                let place = next.fetch_add(1, Ordering::SeqCst);
                let Some((law, path)) = runs.get(place) else { break };
                match self.judge(law, path) {
                    Ok(verdicts) => {
                        report(finished.fetch_add(1, Ordering::SeqCst) + 1, runs.len(), law, path, &verdicts);
                        done.lock().expect("no thread panics")[place] = Some(verdicts);
                    }
                    Err(error) => {
                        stopped.store(true, Ordering::SeqCst);
                        failure.lock().expect("no thread panics").get_or_insert(error);
                    }
                }
            }
        };
        // Twice as many as cores: while one waits for the program, another simulates.
        let threads = 2 * thread::available_parallelism().map_or(1, usize::from);
        thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(work);
            }
        });
        if let Some(error) = failure.into_inner().expect("no thread panics") {
            eprintln!("stopped: {} of {} runs are done", finished.into_inner(), runs.len());
            return Err(error);
        }
        let done = done.into_inner().expect("no thread panics");
        Ok(done.into_iter().flatten().flatten().collect())
    }

    /// All disturbances of one law on one path.
    fn judge(&self, law: &Law, path: &Path) -> Result<Vec<Verdict>> {
        let run = Run::of(law, path);
        // By the step at which a record begins: nearly all begin with the run.
        let mut evidence: BTreeMap<usize, Evidence> = BTreeMap::new();
        let mut verdicts = Vec::new();
        for disturbance in self.disturbances.iter().filter(|one| one.applies_to(path)) {
            let first = disturbance.first_step(&run);
            let evidence = evidence.entry(first).or_insert_with(|| run.evidence(first));
            let answers = truth(law.answers(), evidence, path, disturbance);
            let name = format!("{}.{}.{}", law.name, path.name, disturbance.name);
            let record = disturbance.record(&run, &mut Chance::of(self.seed, &name));
            let file = self.records.join(format!("{name}.csv"));
            files::write(&file, &record.csv())?;
            let findings = self.ask(&file)?;
            let judged = |(place, finding)| {
                let answer = answers[place]?;
                let property = PROPERTIES[place];
                Some(Verdict {
                    law: law.name,
                    path: path.name,
                    disturbance: disturbance.name,
                    property,
                    answer,
                    finding,
                })
            };
            let judged: Vec<Verdict> = findings.into_iter().enumerate().filter_map(judged).collect();
            let keep = self.keeps_wrong && judged.iter().any(|verdict| verdict.outcome() == Outcome::Wrong);
            if !keep {
                fs::remove_file(&file).with_context(|| format!("{} cannot be removed", file.display()))?;
            }
            verdicts.extend(judged);
        }
        Ok(verdicts)
    }

    fn ask(&self, file: &FilePath) -> Result<Findings> {
        let mut command = Command::new(&self.program);
        command.arg("diagnose").arg(file).args(["--json", "--no-report"]);
        match program::ask(&mut command, answer::parse, None) {
            Some(findings) => findings.map_err(|reason| anyhow!("{}: {reason}", file.display())),
            None => Err(Interrupted.into()),
        }
    }
}

fn report(number: usize, all: usize, law: &Law, path: &Path, verdicts: &[Verdict]) {
    let Tally { right, wrong, not_testable } = Tally::of(verdicts.iter());
    eprintln!(
        "{number}/{all} {} on {}: {right} right, {wrong} wrong, {not_testable} not testable",
        law.name, path.name
    );
}

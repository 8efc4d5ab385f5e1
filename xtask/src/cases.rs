//! `cargo xtask cases DIR`: every model on every case. A case is a folder with `train.csv` and `test.csv`; `hysid
//! compare` does the work, one case after the other, and its answers become tables.

mod answer;
mod compare;
mod page;
mod request;
mod table;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};

use crate::{Interrupted, cargo};
use answer::Case;
use page::Page;
pub use request::Request;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// True once Ctrl-C was pressed.
fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}

pub fn run(request: &Request) -> Result<()> {
    let folders = case_folders(&request.folder)?;
    if let Some(out) = &request.out {
        check_writable(out)?;
    }
    let program = match &request.program {
        Some(program) => program.clone(),
        None => build()?,
    };
    let mut page = Page::new(request, compare::version(&program)?, folders.len());
    // Set here and not before: a build is for cargo to stop.
    ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::SeqCst)).context("cannot listen for Ctrl-C")?;
    for (number, folder) in (1..).zip(&folders) {
        let began = Instant::now();
        let Some(outcome) = compare::run(&mut command(&program, folder, request), request.case_limit) else {
            break;
        };
        let case = Case { name: name(folder), outcome };
        eprintln!(
            "{number}/{} {}: {}, {:.1} s",
            folders.len(),
            case.name,
            said(&case),
            began.elapsed().as_secs_f64()
        );
        page.cases.push(case);
        // What is there survives whatever happens to the next.
        if let Some(out) = &request.out {
            write(out, &page.text())?;
        }
    }
    if !page.cases.is_empty() {
        io::stdout().write_all(page.tables().as_bytes()).context("cannot write to stdout")?;
    }
    if page.cases.len() < folders.len() {
        eprintln!("interrupted: {} of {} cases are done", page.cases.len(), folders.len());
        return Err(Interrupted.into());
    }
    Ok(())
}

/// The folders of the cases, in the order of their names.
fn case_folders(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| format!("{} cannot be read", folder.display()))?;
    let mut folders = Vec::new();
    for entry in entries {
        let path = entry.with_context(|| format!("{} cannot be read", folder.display()))?.path();
        match (path.join("train.csv").is_file(), path.join("test.csv").is_file()) {
            (true, true) => folders.push(path),
            (true, false) => eprintln!("{} is left out: it has no test.csv", path.display()),
            (false, true) => eprintln!("{} is left out: it has no train.csv", path.display()),
            (false, false) => {}
        }
    }
    ensure!(!folders.is_empty(), "{}: no subfolder has train.csv and test.csv", folder.display());
    folders.sort();
    Ok(folders)
}

fn name(folder: &Path) -> String {
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The release build of the program.
fn build() -> Result<PathBuf> {
    cargo(&["build", "--release", "--locked", "--package", "hysid-cli"], &[])?;
    // We lie in a folder of cargo's target folder ourselves, wherever that was put.
    let xtask = std::env::current_exe().context("the path of xtask is unknown")?;
    let target = xtask.parent().and_then(Path::parent).context("xtask lies in no target folder")?;
    Ok(target.join("release").join(format!("hysid{}", std::env::consts::EXE_SUFFIX)))
}

/// The command that compares the models on a case.
fn command(program: &Path, folder: &Path, request: &Request) -> Command {
    let mut command = Command::new(program);
    command.arg("compare").arg(folder.join("train.csv")).arg("--test").arg(folder.join("test.csv"));
    if let Some(models) = &request.models {
        command.args(["--models", models]);
    }
    if let Some(seconds) = request.time_limit {
        command.args(["--time-limit", &seconds.to_string()]);
    }
    command.args(["--json", "--no-report"]).args(&request.passed_on);
    command
}

/// What came of a case, in a few words.
fn said(case: &Case) -> String {
    match &case.outcome {
        Err(reason) => format!("failed: {reason}"),
        Ok(answers) => {
            let failed = answers.iter().filter(|answer| answer.figures.is_err()).count();
            format!("{} of {} models worked", answers.len() - failed, answers.len())
        }
    }
}

/// Refuses, before long work, a file that could not be written.
fn check_writable(path: &Path) -> Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if path.is_dir() || !folder.is_dir() {
        bail!("{} cannot be written: name a file in a folder that is there", path.display());
    }
    Ok(())
}

/// Writes a file by way of another beside it: it is there completely or as it was.
fn write(path: &Path, text: &str) -> Result<()> {
    let partial = path.with_file_name(format!(".{}.partial", name(path)));
    fs::write(&partial, text)
        .and_then(|()| fs::rename(&partial, path))
        .with_context(|| format!("{} cannot be written", path.display()))
}

//! The cases of a folder, asked about one after the other.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use super::{Case, CaseRequest};
use crate::Interrupted;
use crate::files::{self, name};
use crate::program::{self, Reading};

/// The cases that are asked for, and the program to ask.
pub struct Cases<'r> {
    /// What the program says of its version.
    pub version: String,
    request: &'r CaseRequest,
    folders: Vec<PathBuf>,
    program: PathBuf,
}

impl<'r> Cases<'r> {
    /// The subfolders that have these files, in the order of their names.
    pub fn find(request: &'r CaseRequest, files: &[&str]) -> Result<Self> {
        let folders = case_folders(&request.folder, files)?;
        if let Some(out) = &request.out {
            files::check_writable(out)?;
        }
        let program = match &request.program {
            Some(program) => program.clone(),
            None => program::build()?,
        };
        Ok(Self { version: program::version(&program)?, request, folders, program })
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.folders.len()
    }

    /// Asks about each case. `keep` takes what came of it and gives the whole page so far, and what of it goes to
    /// stdout at the end.
    pub fn ask<T>(
        &self,
        question: impl Fn(&Path, &mut Command),
        read: Reading<T>,
        said: impl Fn(&T) -> String,
        mut keep: impl FnMut(Case<T>) -> (String, String),
    ) -> Result<()> {
        let all = self.folders.len();
        // Not before: a build is for cargo to stop.
        program::listen()?;
        let mut done = 0;
        let mut result = String::new();
        for folder in &self.folders {
            let began = Instant::now();
            let mut command = Command::new(&self.program);
            question(folder, &mut command);
            command.args(&self.request.passed_on);
            let Some(outcome) = program::ask(&mut command, read, self.request.case_limit) else {
                break;
            };
            done += 1;
            let case = Case { name: name(folder), outcome };
            let words = case.outcome.as_ref().map_or_else(|reason| format!("failed: {reason}"), &said);
            eprintln!("{done}/{all} {}: {words}, {:.1} s", case.name, began.elapsed().as_secs_f64());
            let (page, tables) = keep(case);
            result = tables;
            // What is there survives whatever happens to the next.
            if let Some(out) = &self.request.out {
                files::write(out, &page)?;
            }
        }
        io::stdout().write_all(result.as_bytes()).context("cannot write to stdout")?;
        if done < all {
            eprintln!("interrupted: {done} of {all} cases are done");
            return Err(Interrupted.into());
        }
        Ok(())
    }
}

/// The subfolders that have all these files, in the order of their names.
fn case_folders(folder: &Path, files: &[&str]) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| format!("{} cannot be read", folder.display()))?;
    let mut folders = Vec::new();
    for entry in entries {
        let path = entry.with_context(|| format!("{} cannot be read", folder.display()))?.path();
        let missing: Vec<&str> = files.iter().copied().filter(|file| !path.join(file).is_file()).collect();
        if missing.is_empty() {
            folders.push(path);
        } else if missing.len() < files.len() {
            eprintln!("{} is left out: it has no {}", path.display(), missing.join(", "));
        }
    }
    ensure!(!folders.is_empty(), "{}: no subfolder has {}", folder.display(), files.join(" and "));
    folders.sort();
    Ok(folders)
}

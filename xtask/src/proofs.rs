//! Tests of exported models need programs that a machine may lack. What was therefore not proved is listed at the end.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::cargo::target;

/// The list that the tests add lines to.
pub struct Proofs {
    path: PathBuf,
}

impl Proofs {
    /// An empty list.
    pub fn begin() -> Result<Self> {
        let path = target()?.join("unproved.txt");
        if path.exists() {
            fs::remove_file(&path).context("the list of what was not proved cannot be removed")?;
        }
        Ok(Self { path })
    }

    /// Where the tests find it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Shows what was not proved, and what installs the missing program.
    pub fn show(&self) {
        let Ok(text) = fs::read_to_string(&self.path) else { return };
        println!("==> not proved on this machine");
        for line in text.lines().collect::<BTreeSet<_>>() {
            println!("{line}");
        }
    }
}

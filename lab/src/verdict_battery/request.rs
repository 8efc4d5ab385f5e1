//! What is asked for on the command line of `verdict-battery`.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;

/// Records to diagnose.
#[derive(Debug, Args)]
pub struct Request {
    /// Write the tables to this file too, with their origin
    #[arg(long, value_name = "FILE.md")]
    pub out: Option<PathBuf>,
    /// Seed of the random numbers; the same seed gives the same records
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    pub seed: u64,
    /// Laws, separated by commas; all without
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub laws: Option<Vec<String>>,
    /// Disturbances, separated by commas; all without
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub disturbances: Option<Vec<String>>,
    /// Program in the place of the release build
    #[arg(long, value_name = "HYSID")]
    pub program: Option<PathBuf>,
    /// Write a line of CSV for each wrong verdict; its record goes into the folder beside it that ends with `.records`
    #[arg(long, value_name = "FILE.csv")]
    pub list_wrong: Option<PathBuf>,
}

/// Those of all that are named, in their own order; an error for a name that none has.
pub fn named<T>(all: Vec<T>, names: Option<&[String]>, what: &str, name: fn(&T) -> &str) -> Result<Vec<T>> {
    let Some(names) = names else { return Ok(all) };
    let known: Vec<&str> = all.iter().map(name).collect();
    if let Some(unknown) = names.iter().find(|wanted| !known.contains(&wanted.as_str())) {
        bail!("{what} `{unknown}` is unknown; there are {}", known.join(", "));
    }
    Ok(all.into_iter().filter(|one| names.iter().any(|wanted| wanted == name(one))).collect())
}

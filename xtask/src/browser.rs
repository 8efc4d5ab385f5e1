//! Pages of the program in a real browser.

use std::ffi::OsString;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::cargo::{built_program, workspace_root};
use crate::environment::{Environment, step};
use crate::proofs::Proofs;

/// Names of Chromium, in the order in which they are looked for.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// Names the browser, in place of those.
const NAMED: &str = "HYSID_BROWSER";

/// Without Chromium this is an error if the variable is set.
const PROVE_ALL: &str = "HYSID_PROVE_ALL";

/// The pages of the program, driven as a reader does.
pub fn test(proofs: &Proofs) -> Result<()> {
    let Some(browser) = found() else {
        let missing = "pages in a browser: there is no Chromium (on Debian: apt install chromium), and HYSID_BROWSER names none";
        ensure!(std::env::var_os(PROVE_ALL).is_none(), "{missing}");
        let mut list = OpenOptions::new().append(true).create(true).open(proofs.path())?;
        return writeln!(list, "{missing}").context("the list of what was not proved cannot be written");
    };
    let tests = workspace_root().join("crates").join("hysid-cli").join("tests").join("browser");
    let mut pytest = Environment::of_package()?.python();
    pytest.args(["-m", "pytest", "-q", "-p", "no:cacheprovider"]).arg(tests);
    step("browser", pytest.env(NAMED, browser).env("HYSID_PROGRAM", built_program()?))
}

/// The browser that the environment names, or the first of the known names in the search path.
fn found() -> Option<PathBuf> {
    let in_path = |name: &&str| {
        let folders: OsString = std::env::var_os("PATH")?;
        std::env::split_paths(&folders).map(|folder| folder.join(name)).find(|path| is_file(path))
    };
    std::env::var_os(NAMED).map(PathBuf::from).or_else(|| NAMES.iter().find_map(in_path))
}

fn is_file(path: &Path) -> bool {
    path.metadata().is_ok_and(|found| found.is_file())
}

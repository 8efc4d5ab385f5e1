//! `cargo xtask test`: every test there is, one step after the other. A step that needs something installed
//! installs it first, so that a fresh clone needs nothing but a Rust toolchain, and Python for the package.

use anyhow::{Result, ensure};

use crate::cargo::{EVERYTHING, build_everything, cargo};
use crate::environment::Environment;
use crate::proofs::Proofs;
use crate::{browser, python, site};

pub fn run() -> Result<()> {
    let proofs = Proofs::begin()?;
    build_everything()?;
    // What fails in one step does not hide what fails in the next.
    let results = [rust(&proofs), python::test(), browser::test(&proofs), site::run()];
    proofs.show();
    let failures: Vec<_> =
        results.into_iter().filter_map(Result::err).map(|error| format!("{error:#}")).collect();
    ensure!(failures.is_empty(), "{}", failures.join("\n"));
    Ok(())
}

/// The tests inside the library's crates, and whether the rest still compiles: for after a small change.
pub fn quick() -> Result<()> {
    let library =
        ["hysid-core", "hysid-diagnosis", "hysid-document", "hysid-specimens", "hysid", "hysid-paper"];
    let packages = library.iter().flat_map(|name| ["--package", name]);
    cargo(&["test", "--locked", "--lib"].into_iter().chain(packages).collect::<Vec<_>>(), &[])?;
    cargo(&["check", "--workspace", "--locked"], &[])
}

/// Unit, integration and documentation tests. Those of exported models run the tools of each target. The Python package
/// has its own.
fn rust(proofs: &Proofs) -> Result<()> {
    let python = Environment::of_package()?.python_path();
    let environment =
        [("HYSID_PYTHON", &*python.to_string_lossy()), ("HYSID_UNPROVED", &*proofs.path().to_string_lossy())];
    cargo(&[&["test", "--no-fail-fast"], &EVERYTHING[..]].concat(), &environment)
}

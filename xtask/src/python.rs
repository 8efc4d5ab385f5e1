//! The Python package: built, installed and tested in a virtual environment of its own, `target/python`; and its source
//! distribution.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::cargo::{build_everything, built, built_program, target, workspace_root};
use crate::environment::{Environment, step};

/// Builds what the tests of the package need, and runs them.
pub fn build_and_test() -> Result<()> {
    build_everything()?;
    test()
}

/// Every test of the package, after [`build_everything`].
pub fn test() -> Result<()> {
    let environment = Environment::of_package()?;
    install(&environment)?;
    let program = built_program()?;
    let in_package = |arguments: &[&str]| {
        let mut python = environment.python();
        python.args(arguments).current_dir(package());
        python
    };
    step("pytest", in_package(&["-m", "pytest", "-q", "tests"]).env("HYSID_PROGRAM", program))?;
    step("mypy", &mut in_package(&["-m", "mypy", "--package", "hysid"]))?;
    let stubtest = ["-m", "mypy.stubtest", "hysid", "--concise", "--mypy-config-file", "pyproject.toml"];
    let allowed = ["--allowlist", "tests/stubtest-allowed.txt"];
    step("stubtest", &mut in_package(&[&stubtest[..], &allowed].concat()))
}

/// Builds the source distribution, and installs it in an environment of its own outside of the repository, where it must
/// fit a model. It is compiled from nothing, which takes minutes: the workflow of the wheels does the same for a release.
pub fn source_distribution() -> Result<()> {
    let archives = target()?.join("sdist");
    let archive = built_by_maturin(&archives, &["sdist"])?;
    let folder = std::env::temp_dir().join(format!("hysid-sdist-{}", std::process::id()));
    let outcome = install_alone(&archive, &folder);
    fs::remove_dir_all(&folder).context("step `sdist`: the environment cannot be removed")?;
    outcome
}

/// Installs an archive in a new environment in this folder, and runs the test of an installed package there.
fn install_alone(archive: &Path, folder: &Path) -> Result<()> {
    let environment = Environment::empty(folder)?;
    // The folder of the archive's own build, not that of the workspace.
    let build = folder.join("target");
    environment.install(|pip| pip.arg(archive).env("CARGO_TARGET_DIR", build).current_dir(folder))?;
    let test = package().join("tests").join("installed.py");
    step("installed.py", environment.python().arg(test).current_dir(folder))
}

/// Puts the package where the environment's Python finds it: its files, and the native module of the workspace's build.
/// Wheels are built and tested by the workflow of the wheels, and by [`source_distribution`].
fn install(environment: &Environment) -> Result<()> {
    let place = environment.packages()?.join("hysid");
    if place.exists() {
        fs::remove_dir_all(&place).with_context(|| format!("{} cannot be removed", place.display()))?;
    }
    fs::create_dir_all(&place)?;
    for entry in fs::read_dir(package().join("python").join("hysid"))? {
        let entry = entry?;
        if entry.file_type()?.is_file() {
            fs::copy(entry.path(), place.join(entry.file_name()))?;
        }
    }
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let module = built(&format!("{prefix}_hysid{suffix}"))?;
    let name = if cfg!(windows) { "_hysid.pyd" } else { "_hysid.abi3.so" };
    fs::copy(&module, place.join(name)).with_context(|| module.display().to_string())?;
    Ok(())
}

/// The one file that maturin builds into a folder, which is emptied before.
fn built_by_maturin(folder: &Path, arguments: &[&str]) -> Result<PathBuf> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("{} cannot be removed", folder.display()))?;
    }
    let mut maturin = Environment::of_package()?.python();
    maturin.args(["-m", "maturin"]).args(arguments).arg("--out").arg(folder).current_dir(package());
    step(&format!("maturin {}", arguments[0]), &mut maturin)?;
    Ok(fs::read_dir(folder)?.next().context("maturin built nothing")??.path())
}

fn package() -> PathBuf {
    workspace_root().join("crates").join("hysid-python")
}

//! The Python package: built, installed and tested in a virtual environment of its own, `target/python`; and its source
//! distribution.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use crate::{program, workspace_root};

/// The oldest Python that the package supports.
const OLDEST: (u32, u32) = (3, 10);

/// Every test of the package.
pub fn test() -> Result<()> {
    let python = environment()?;
    install(&python)?;
    let program = program::build()?;
    let package = package();
    let tests: [&OsStr; 4] = ["-m".as_ref(), "pytest".as_ref(), "-q".as_ref(), "tests".as_ref()];
    step("pytest", Command::new(&python).args(tests).env("HYSID_PROGRAM", program).current_dir(&package))?;
    step("mypy", Command::new(&python).args(["-m", "mypy", "--package", "hysid"]).current_dir(&package))?;
    let stubtest = ["-m", "mypy.stubtest", "hysid", "--concise", "--mypy-config-file", "pyproject.toml"];
    let allowed = ["--allowlist", "tests/stubtest-allowed.txt"];
    step("stubtest", Command::new(&python).args(stubtest).args(allowed).current_dir(&package))
}

/// Builds the source distribution, and installs it in an environment of its own outside of the repository, where it must
/// fit a model. It is compiled from nothing, which takes minutes: the workflow of the wheels does the same for a release.
pub fn source_distribution() -> Result<()> {
    let python = environment()?;
    let archives = program::target()?.join("sdist");
    if archives.exists() {
        fs::remove_dir_all(&archives).context("step `sdist`: an old archive cannot be removed")?;
    }
    let build = ["-m", "maturin", "sdist", "--out"];
    step("maturin sdist", Command::new(&python).args(build).arg(&archives).current_dir(package()))?;
    let archive = fs::read_dir(&archives)?.next().context("step `sdist`: maturin made no archive")??.path();

    let folder = std::env::temp_dir().join(format!("hysid-sdist-{}", std::process::id()));
    let outcome = install_alone(&archive, &folder);
    fs::remove_dir_all(&folder).context("step `sdist`: the environment cannot be removed")?;
    outcome
}

/// Installs an archive in a new environment in this folder, and runs the test of an installed package there.
fn install_alone(archive: &Path, folder: &Path) -> Result<()> {
    step("python -m venv", Command::new(interpreter()?).args(["-m", "venv", "--clear"]).arg(folder))?;
    let python = python_of(folder);
    // The folder of the archive's own build, not that of the workspace.
    let build = folder.join("target");
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    let mut pip = Command::new(&python);
    step("pip install", pip.args(install).arg(archive).env("CARGO_TARGET_DIR", build).current_dir(folder))?;
    let test = package().join("tests").join("installed.py");
    step("installed.py", Command::new(&python).arg(test).current_dir(folder))
}

/// The Python of a virtual environment.
fn python_of(environment: &Path) -> PathBuf {
    match cfg!(windows) {
        true => environment.join("Scripts").join("python.exe"),
        false => environment.join("bin").join("python"),
    }
}

fn package() -> PathBuf {
    workspace_root().join("crates").join("hysid-python")
}

/// The Python of the virtual environment, with all that is pinned; made and filled if need be.
pub fn environment() -> Result<PathBuf> {
    let folder = program::target()?.join("python");
    let python = python_of(&folder);
    let requirements = package().join("requirements.txt");
    let wanted = fs::read_to_string(&requirements).context("step `python`: no list of requirements")?;
    let installed = folder.join("installed.txt");
    if fs::read_to_string(&installed).is_ok_and(|found| found == wanted) {
        return Ok(python);
    }
    let make = ["-m", "venv", "--clear"];
    step("python -m venv", Command::new(interpreter()?).args(make).arg(&folder))
        .context("is the module venv installed? (on Debian: apt install python3-venv)")?;
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"];
    step("pip install", Command::new(&python).args(install).arg(&requirements))
        .context("the tests of the Python package need the packages of PyPI once: is there a network?")?;
    fs::write(installed, wanted).context("step `python`: the environment cannot be written to")?;
    Ok(python)
}

/// The machine's Python, that of the environment variable `PYTHON` first.
fn interpreter() -> Result<PathBuf> {
    let named = std::env::var_os("PYTHON").map(PathBuf::from);
    let candidates: Vec<PathBuf> = match named {
        Some(named) => vec![named],
        None => ["python3", "python"].map(PathBuf::from).to_vec(),
    };
    for candidate in &candidates {
        let asked = ["-c", "import sys; print(*sys.version_info[:2])"];
        let Ok(output) = Command::new(candidate).args(asked).stdin(Stdio::null()).output() else { continue };
        let said = String::from_utf8_lossy(&output.stdout);
        let mut numbers = said.split_whitespace().map_while(|number| number.parse().ok());
        if let (Some(major), Some(minor)) = (numbers.next(), numbers.next()) {
            let (oldest_major, oldest_minor) = OLDEST;
            ensure!(
                (major, minor) >= OLDEST,
                "step `python`: {} is Python {major}.{minor}; name one from {oldest_major}.{oldest_minor} on in \
                 the environment variable PYTHON",
                candidate.display()
            );
            return Ok(candidate.clone());
        }
    }
    bail!(
        "step `python`: there is no Python: install Python 3, or name one in the environment variable PYTHON"
    )
}

/// Builds the wheel and installs it: what is tested is what a user gets.
fn install(python: &Path) -> Result<()> {
    let wheels = program::target()?.join("wheels");
    // A wheel of an earlier version would be found beside the new one.
    if wheels.exists() {
        fs::remove_dir_all(&wheels).context("step `python`: an old wheel cannot be removed")?;
    }
    let build = ["-m", "maturin", "build", "--release", "--locked", "--quiet", "--out"];
    step("maturin build", Command::new(python).args(build).arg(&wheels).current_dir(package()))?;
    let wheel = fs::read_dir(&wheels)?.next().context("step `python`: maturin made no wheel")??.path();
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"];
    step("pip install", Command::new(python).args(install).arg("--force-reinstall").arg(wheel))
}

/// Runs a command as one step.
pub fn step(name: &str, command: &mut Command) -> Result<()> {
    println!("==> {name}");
    let status = command.status().with_context(|| format!("step `{name}` could not be started"))?;
    ensure!(status.success(), "step `{name}` failed ({status})");
    Ok(())
}

//! Virtual environments of Python below `target`, each filled from a pinned list of requirements.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use crate::cargo::{target, workspace_root};

/// The oldest Python that the package supports.
const OLDEST: (u32, u32) = (3, 10);

/// A virtual environment.
pub struct Environment {
    folder: PathBuf,
}

impl Environment {
    /// The tools of `check` and `site`.
    pub fn of_tools() -> Result<Self> {
        Self::filled("tools", &workspace_root().join("xtask/requirements.txt"))
    }

    /// Environment with the requirements of the Python package's tests.
    pub fn of_package() -> Result<Self> {
        Self::filled("python", &workspace_root().join("crates/hysid-python/requirements.txt"))
    }

    /// A new and empty one in a folder.
    pub fn empty(folder: &Path) -> Result<Self> {
        let make = ["-m", "venv", "--clear"];
        step("python -m venv", Command::new(interpreter()?).args(make).arg(folder))
            .context("is the module venv installed? (on Debian: apt install python3-venv)")?;
        Ok(Self { folder: folder.into() })
    }

    /// The one of this name with all that is pinned; made and filled if need be.
    fn filled(name: &str, requirements: &Path) -> Result<Self> {
        let folder = target()?.join(name);
        let wanted = fs::read_to_string(requirements).with_context(|| requirements.display().to_string())?;
        let installed = folder.join("installed.txt");
        if fs::read_to_string(&installed).is_ok_and(|found| found == wanted) {
            return Ok(Self { folder });
        }
        let environment = Self::empty(&folder)?;
        environment
            .install(|pip| pip.arg("--requirement").arg(requirements))
            .context("packages of PyPI are needed once: is there a network?")?;
        fs::write(&installed, wanted).with_context(|| installed.display().to_string())?;
        Ok(environment)
    }

    /// The folder of its packages.
    pub fn packages(&self) -> Result<PathBuf> {
        let asked = ["-c", "import sysconfig; print(sysconfig.get_path('platlib'))"];
        let output = self.python().args(asked).output().context("step `packages`")?;
        ensure!(output.status.success(), "step `packages`: Python tells no folder");
        Ok(String::from_utf8(output.stdout)?.trim_end().into())
    }

    /// Runs pip with further arguments.
    pub fn install(&self, with: impl FnOnce(&mut Command) -> &mut Command) -> Result<()> {
        let mut pip = self.python();
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
        step("pip install", with(&mut pip))
    }

    /// Its Python.
    pub fn python(&self) -> Command {
        Command::new(self.python_path())
    }

    /// The path of its Python.
    pub fn python_path(&self) -> PathBuf {
        self.program_path("python")
    }

    /// A program that was installed in it.
    pub fn program(&self, name: &str) -> Command {
        Command::new(self.program_path(name))
    }

    fn program_path(&self, name: &str) -> PathBuf {
        let folder = if cfg!(windows) { "Scripts" } else { "bin" };
        self.folder.join(folder).join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
    }
}

/// The machine's Python, that of the environment variable `PYTHON` first.
fn interpreter() -> Result<PathBuf> {
    let named = std::env::var_os("PYTHON").map(PathBuf::from);
    let candidates =
        named.map_or_else(|| ["python3", "python"].map(PathBuf::from).to_vec(), |named| vec![named]);
    for candidate in &candidates {
        let asked = ["-c", "import sys; print(*sys.version_info[:2])"];
        let Ok(output) = Command::new(candidate).args(asked).stdin(Stdio::null()).output() else { continue };
        let said = String::from_utf8_lossy(&output.stdout);
        let mut numbers = said.split_whitespace().map_while(|number| number.parse().ok());
        if let (Some(major), Some(minor)) = (numbers.next(), numbers.next()) {
            let (oldest_major, oldest_minor) = OLDEST;
            ensure!(
                (major, minor) >= OLDEST,
                "{} is Python {major}.{minor}; name one from {oldest_major}.{oldest_minor} on in the environment \
                 variable PYTHON",
                candidate.display()
            );
            return Ok(candidate.clone());
        }
    }
    bail!("there is no Python: install Python 3, or name one in the environment variable PYTHON")
}

/// Runs a command as one step.
pub fn step(name: &str, command: &mut Command) -> Result<()> {
    println!("==> {name}");
    let status = command.status().with_context(|| format!("step `{name}` could not be started"))?;
    ensure!(status.success(), "step `{name}` failed ({status})");
    Ok(())
}

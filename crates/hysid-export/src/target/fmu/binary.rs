//! The shared library in an FMU, built by the C compiler of this machine.

use std::env::consts::{ARCH, DLL_SUFFIX, OS};
use std::ffi::OsString;
use std::fs;
use std::process::{Command, Stdio};

use crate::error::Error;
use crate::options::FmiVersion;
use crate::subject::ExportFile;

/// The library with its path in the FMU; `None` without a C compiler. `sources` are the C files.
pub(super) fn binary(
    name: &str,
    version: FmiVersion,
    sources: &[ExportFile],
) -> Result<Option<ExportFile>, Error> {
    let Some(compiler) = compiler() else { return Ok(None) };
    let folder = tempfile::tempdir().map_err(|error| Error::Compiler(error.to_string()))?;
    for source in sources {
        fs::write(folder.path().join(&source.path), &source.content)
            .map_err(|error| Error::Compiler(error.to_string()))?;
    }
    let library = format!("{name}{DLL_SUFFIX}");
    let mut command = Command::new(&compiler);
    command.current_dir(folder.path()).args(["-std=c99", "-O3", "-ffp-contract=off", "-shared"]);
    if OS != "windows" {
        command.args(["-fPIC", "-fvisibility=hidden"]);
    }
    command.args(sources.iter().map(|source| &source.path).filter(|path| path.ends_with(".c")));
    let output = command.args(["-o", &library, "-lm"]).stdin(Stdio::null()).output();
    let output = output.map_err(|error| Error::Compiler(error.to_string()))?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        let line = text.lines().find(|line| line.contains("error")).or(text.lines().next());
        let compiler = compiler.to_string_lossy();
        return Err(Error::Compiler(format!("{compiler}: {}", line.unwrap_or("it failed without a word"))));
    }
    let content =
        fs::read(folder.path().join(&library)).map_err(|error| Error::Compiler(error.to_string()))?;
    Ok(Some(ExportFile::new(format!("binaries/{}/{library}", platform(version)), content)))
}

/// The compiler of the environment variable `CC`, or the first that this machine has.
fn compiler() -> Option<OsString> {
    let candidates = match std::env::var_os("CC").filter(|named| !named.is_empty()) {
        Some(named) => vec![named],
        None => ["cc", "gcc", "clang"].map(OsString::from).to_vec(),
    };
    candidates.into_iter().find(|candidate| {
        let mut asked = Command::new(candidate);
        asked.arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        asked.status().is_ok_and(|status| status.success())
    })
}

/// The name of this platform in FMUs.
pub(super) fn platform(version: FmiVersion) -> String {
    let system = if OS == "macos" { "darwin" } else { OS };
    match (version, ARCH) {
        (FmiVersion::Two, "x86_64") => format!("{}64", if system == "windows" { "win" } else { system }),
        _ => format!("{ARCH}-{system}"),
    }
}

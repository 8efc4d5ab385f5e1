//! The programs that the proofs need, where this machine has them.

use std::env;
use std::fs::OpenOptions;
use std::io::Write as _;
use std::process::{Command, Output, Stdio};

/// A program, if it starts. `probe` are arguments with which it does nothing. A test without it has proved nothing: the
/// file of the environment variable `HYSID_UNPROVED` gets a line that says so; with `HYSID_PROVE_ALL` the test fails.
pub fn tool(what: &str, program: &str, probe: &[&str], install: &str) -> Option<String> {
    let starts = Command::new(program)
        .args(probe)
        .stdin(Stdio::null())
        .output()
        .is_ok_and(|output| output.status.success());
    if starts {
        return Some(program.to_string());
    }
    let line = format!("{what}: not proved, because {program} is missing or incomplete; {install}");
    assert!(env::var_os("HYSID_PROVE_ALL").is_none(), "{line}");
    eprintln!("{line}");
    if let Some(path) = env::var_os("HYSID_UNPROVED") {
        let mut file = OpenOptions::new().create(true).append(true).open(path).unwrap();
        writeln!(file, "{line}").unwrap();
    }
    None
}

/// The compiler gcc.
pub fn gcc() -> Option<String> {
    tool("exports to C", "gcc", &["--version"], "run: sudo apt-get install gcc")
}

/// A Python with these modules: that of the environment variable `HYSID_PYTHON`, or the machine's.
pub fn python(what: &str, modules: &[&str]) -> Option<String> {
    let python = env::var("HYSID_PYTHON").unwrap_or_else(|_| "python3".into());
    let imports = modules.iter().map(|module| format!("import {module}")).collect::<Vec<_>>().join("; ");
    let install = format!("run cargo xtask test, or: python3 -m pip install {}", modules.join(" "));
    tool(what, &python, &["-c", &imports], &install)
}

pub fn succeeds(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    let text =
        String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{command:?}\n{}", text.chars().take(3000).collect::<String>());
    output
}

/// True where `attack` of the laboratory runs the tests with all models and names.
pub fn at_length() -> bool {
    env::var_os("HYSID_AT_LENGTH").is_some()
}

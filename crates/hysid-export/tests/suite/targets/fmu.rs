//! Exports as Functional Mock-up Units, run by FMPy.

use std::process::Command;

use hysid_export::{FmiVersion, Options, Target};

use super::case::{MODELS, NAME, StepCase, must_agree, written};
use super::tools::{python, succeeds, tool};

/// Validates a unit, and reads rows of arguments in binary.
pub const OPENED: &str = include_str!("programs/fmu_opened.py.txt");

/// Simulates rows of arguments in binary as an importer does, writes outputs in binary, and tries what importers do
/// besides.
const DRIVER: &str = include_str!("programs/fmu.py.txt");

#[test]
fn importers_find_nothing_wrong_and_outputs_equal_those_of_the_library() {
    const ROWS: usize = 400;
    let Some(_) = tool("binaries of FMUs", "cc", &["--version"], "run: sudo apt-get install gcc") else {
        return;
    };
    let Some(python) = python("exports as FMU", &["numpy", "fmpy"]) else { return };
    // One version for a model, in turns.
    for ((name, model), fmi) in MODELS.iter().zip([FmiVersion::Three, FmiVersion::Two].into_iter().cycle()) {
        let folder = written(model, Target::Fmu, &Options { fmi, ..Options::named(NAME) });
        let output = succeeds(Command::new(&python).current_dir(&folder).arg("actuator_test.py"));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.starts_with("0 of "), "{name}, {fmi:?}: {text}");

        let case = StepCase::of(model, ROWS);
        let driver = format!("{OPENED}{DRIVER}");
        let arguments = ["-c", &driver, &case.arguments.len().to_string(), &case.has_time().to_string()];
        // The importer adds up the time steps, whose roundings reach rates.
        must_agree(&format!("{name}, {fmi:?}"), &case, &folder, Command::new(&python).args(arguments));
    }
}

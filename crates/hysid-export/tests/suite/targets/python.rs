//! Exports to Python.

use std::process::Command;

use hysid_export::{Error, Options, Precision, Target, export};

use super::case::{MODELS, NAME, StepCase, must_agree, written};
use super::tools::{python, succeeds};

/// Simulates rows of arguments in binary, and writes outputs in binary.
const DRIVER: &str = "
import sys
import numpy as np
import actuator
rows = np.fromfile('rows').reshape(-1, int(sys.argv[1]))
model = actuator.Model()
np.array([model.step(*row) for row in rows]).tofile('outputs')
";

#[test]
fn outputs_are_those_of_the_library() {
    const ROWS: usize = 3000;
    let Some(python) = python("exports to Python", &["numpy"]) else { return };
    for (name, model) in MODELS.iter() {
        let folder = written(model, Target::Python, &Options::named(NAME));
        let ran = succeeds(Command::new(&python).current_dir(&folder).arg("actuator_test.py"));
        let text = String::from_utf8(ran.stdout).unwrap();
        assert!(text.starts_with("passed: ") && text.contains("1e-09 is allowed"), "{name}: {text}");
        let case = StepCase::of(model, ROWS);
        let arguments = ["-c", DRIVER, &case.arguments.len().to_string()];
        // Python rounds products and sums one by one, and has its own `exp` and its like.
        must_agree(name, &case, &folder, Command::new(&python).args(arguments));
    }
}

#[test]
fn single_precision_is_refused() {
    let options = Options { precision: Precision::Single, ..Options::named(NAME) };
    assert_eq!(export(&MODELS[0].1, Target::Python, &options), Err(Error::Precision("python")));
}

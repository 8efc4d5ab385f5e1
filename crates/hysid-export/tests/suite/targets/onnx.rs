//! Exports to ONNX, run by onnxruntime.

use std::process::Command;

use hysid_export::{Options, Target};

use super::case::{MODELS, NAME, StepCase, must_agree, written};
use super::tools::{python, succeeds};

/// Checks the models, simulates rows of arguments in binary, and writes outputs in binary.
const DRIVER: &str = "
import sys
import numpy as np
import onnx, onnxruntime
for name in ('actuator', 'actuator_step', 'actuator_tangent'):
    onnx.checker.check_model(onnx.load(name + '.onnx'), full_check=True)
rows = np.fromfile('rows').reshape(-1, int(sys.argv[1]))
session = onnxruntime.InferenceSession('actuator.onnx', providers=['CPUExecutionProvider'])
names = [i.name for i in session.get_inputs()]
y, state = session.run(['y', 'next_state'], {name: rows[:, k].copy() for k, name in enumerate(names)})
y.tofile('outputs')
";

#[test]
fn outputs_are_those_of_the_library() {
    const ROWS: usize = 400;
    let Some(python) = python("exports to ONNX", &["numpy", "onnx", "onnxruntime"]) else { return };
    for (name, model) in MODELS.iter() {
        let folder = written(model, Target::Onnx, &Options::named(NAME));
        let case = StepCase::of(model, ROWS);
        let arguments = ["-c", DRIVER, &case.arguments.len().to_string()];
        must_agree(name, &case, &folder, Command::new(&python).args(arguments));
        succeeds(Command::new(&python).current_dir(&folder).arg("actuator_test.py"));
    }
}

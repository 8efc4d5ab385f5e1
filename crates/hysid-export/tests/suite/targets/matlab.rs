//! Exports to MATLAB, run by GNU Octave.

use std::fs;
use std::process::Command;

use hysid_export::{Options, Target};

use super::case::{MODELS, NAME, StepCase, must_agree, written};
use super::tools::tool;

/// Simulates rows of arguments in binary, and writes outputs in binary.
fn driver(arguments: usize) -> String {
    let given: String = (1..=arguments).map(|index| format!(", row({index})")).collect();
    format!(
        "actuator_test();
file = fopen('rows'); rows = fread(file, [{arguments}, Inf], 'double'); fclose(file);
state = actuator();
outputs = zeros(1, columns(rows));
for k = 1:columns(rows)
    row = rows(:, k);
    [outputs(k), state] = actuator(state{given});
end
file = fopen('outputs', 'w'); fwrite(file, outputs, 'double'); fclose(file);
"
    )
}

#[test]
fn outputs_are_those_of_the_library() {
    const ROWS: usize = 500;
    let install = "run: sudo apt-get install octave";
    let Some(octave) = tool("exports to MATLAB", "octave-cli", &["--version"], install) else { return };
    for (name, model) in MODELS.iter() {
        let folder = written(model, Target::Matlab, &Options::named(NAME));
        let case = StepCase::of(model, ROWS);
        fs::write(folder.path().join("driver.m"), driver(case.arguments.len())).unwrap();
        let arguments = ["--no-gui", "--norc", "--quiet", "driver.m"];
        must_agree(name, &case, &folder, Command::new(&octave).args(arguments));
    }
}

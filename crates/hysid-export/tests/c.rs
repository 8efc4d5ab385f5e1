//! Exports to C: compiled without a warning, and equal to the library to the last bit.

mod models;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use hysid::Model;
use hysid_export::description::{Argument, Description, RateSource};
use hysid_export::program::Precision;
use hysid_export::{Options, Target, export};
use models::{networks, path, time_step};

/// Warnings are errors.
const STRICT: [&str; 8] =
    ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-ffp-contract=off"];

/// The compilers that this machine has, of gcc and clang.
fn compilers() -> Vec<&'static str> {
    let found: Vec<&str> = ["gcc", "clang"]
        .into_iter()
        .filter(|compiler| {
            Command::new(compiler).arg("--version").output().is_ok_and(|out| out.status.success())
        })
        .collect();
    assert!(!found.is_empty(), "a C compiler is needed: apt-get install gcc");
    found
}

fn succeeds(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    let text =
        String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{command:?}\n{}", text.chars().take(3000).collect::<String>());
    output
}

fn written(model: &Model, options: &Options, folder: &Path) {
    for file in export(model, Target::C, options).unwrap() {
        fs::write(folder.join(file.path), file.text).unwrap();
    }
}

#[test]
fn test_vectors_agree_in_both_precisions() {
    for compiler in compilers() {
        for (name, model) in networks() {
            for precision in [Precision::Double, Precision::Single] {
                let folder = tempfile::tempdir().unwrap();
                let options = Options { precision, ..Options::named("actuator") };
                written(&model, &options, folder.path());
                succeeds(Command::new(compiler).current_dir(folder.path()).args(STRICT).args([
                    "actuator.c",
                    "actuator_test.c",
                    "-lm",
                    "-o",
                    "test",
                ]));
                let output = succeeds(&mut Command::new(folder.path().join("test")));
                let text = String::from_utf8_lossy(&output.stdout).into_owned();
                assert!(text.starts_with("0 of "), "{name}, {precision:?}: {text}");
            }
        }
    }
}

#[test]
fn the_header_is_good_for_cpp() {
    let folder = tempfile::tempdir().unwrap();
    let (_, model) = networks().remove(0);
    written(&model, &Options::named("actuator"), folder.path());
    let program = "#include \"actuator.h\"\nint main() { actuator_model m; actuator_reset(&m); return actuator_step(&m, 1.0) > 1e9; }\n";
    fs::write(folder.path().join("main.cpp"), program).unwrap();
    succeeds(Command::new("gcc").current_dir(folder.path()).args(STRICT).args(["-c", "actuator.c"]));
    succeeds(Command::new("g++").current_dir(folder.path()).args([
        "-Wall",
        "-Wextra",
        "-Wpedantic",
        "-Werror",
        "main.cpp",
        "actuator.o",
        "-lm",
        "-o",
        "main",
    ]));
    succeeds(&mut Command::new(folder.path().join("main")));
}

/// Reads rows of arguments in binary, writes outputs in binary.
fn driver(arguments: usize) -> String {
    let given: String = (0..arguments).map(|index| format!(", row[{index}]")).collect();
    format!(
        "#include <stdio.h>
#include \"actuator.h\"
int main(void)
{{
    static actuator_model model;
    double row[{arguments}];
    actuator_reset(&model);
    while (fread(row, sizeof(double), {arguments}, stdin) == {arguments}) {{
        double y = actuator_step(&model{given});
        fwrite(&y, sizeof y, 1, stdout);
    }}
    return 0;
}}
"
    )
}

#[test]
fn outputs_equal_those_of_the_library_to_the_last_bit() {
    const ROWS: usize = 20_000;
    for (name, model) in networks() {
        let description = Description::of(&model, RateSource::Backward, Precision::Double).unwrap();
        let folder = tempfile::tempdir().unwrap();
        written(&model, &Options::named("actuator"), folder.path());
        fs::write(folder.path().join("driver.c"), driver(description.arguments.len())).unwrap();
        succeeds(Command::new("gcc").current_dir(folder.path()).args(STRICT).args([
            "actuator.c",
            "driver.c",
            "-lm",
            "-o",
            "driver",
        ]));
        let mut stepper = model.stepper().portable();
        let (mut time, mut rows, mut expected) = (0.0, Vec::new(), Vec::new());
        for (row, inputs) in path(ROWS, model.names().inputs.len()).iter().enumerate() {
            let before = time;
            time += time_step(row);
            expected.push(stepper.step(inputs, time, None).unwrap());
            for argument in &description.arguments {
                let value: f64 = match argument {
                    Argument::Input(input) => inputs[*input],
                    Argument::TimeStep => time - before,
                    Argument::Rate => unreachable!("rates are differences here"),
                };
                rows.extend(value.to_le_bytes());
            }
        }
        let input = folder.path().join("rows");
        fs::write(&input, rows).unwrap();
        let output =
            succeeds(Command::new(folder.path().join("driver")).stdin(fs::File::open(&input).unwrap()));
        let found: Vec<f64> =
            output.stdout.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        assert_eq!(found.len(), ROWS, "{name}");
        for (row, (found, expected)) in found.iter().zip(&expected).enumerate() {
            assert!(found.to_bits() == expected.to_bits(), "{name}, row {row}: {found:e}, not {expected:e}");
        }
    }
}

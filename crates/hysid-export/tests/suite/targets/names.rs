//! Names that could meet those inside the exported files.

use std::path::Path;
use std::process::Command;

use hysid_export::{Error, Options, Target, export};

use super::case::{MODELS, written};
use super::tools::{at_length, gcc, python, succeeds, tool};

/// Names of models: those that users choose, and parts of names inside the files.
const NAMES: [&str; 8] = ["model", "data", "state", "first", "real", "MODEL", "y", "inverse"];

/// Names that users, libraries and languages have, for tests at length.
const MORE_NAMES: &str = "a abs advance array assert auto bool cell committed double error exp file float \
                          fused index input inverse_sinh len long math max numpy object output self sum \
                          token trial type vector x X1 z9_";

/// Runs the test that an export has. A name is refused, or works.
fn run(target: Target, name: &str, folder: &Path) {
    let compiled = |compiler: &str, arguments: &[&str]| {
        succeeds(Command::new(compiler).current_dir(folder).args(arguments));
        succeeds(Command::new(folder.join("the_test")).current_dir(folder));
    };
    let (c, c_test) = (format!("{name}.c"), format!("{name}_test.c"));
    match target {
        Target::Abaqus | Target::C | Target::OpenSees => {
            let Some(compiler) = gcc() else { return };
            compiled(&compiler, &["-std=c99", "-ffp-contract=off", &c, &c_test, "-lm", "-o", "the_test"]);
        }
        Target::Matlab => {
            let install = "run: sudo apt-get install octave";
            let probe = ["--no-gui", "--eval", "1;"];
            let Some(octave) = tool("exports to MATLAB", "octave-cli", &probe, install) else { return };
            succeeds(Command::new(octave).current_dir(folder).args(["--eval", &format!("{name}_test")]));
        }
        Target::Fmu | Target::Onnx | Target::Python => {
            let Some(python) = python("names of exports", &["numpy", "fmpy", "onnxruntime"]) else { return };
            succeeds(Command::new(python).current_dir(folder).arg(format!("{name}_test.py")));
        }
    }
}

#[test]
fn every_name_that_is_not_refused_works() {
    let (_, model) = MODELS.iter().find(|(label, _)| label.starts_with("auto")).unwrap();
    for target in Target::ALL {
        let more = MORE_NAMES.split(' ').filter(|_| at_length());
        for name in NAMES.into_iter().chain(more) {
            let options = Options::named(name);
            if let Err(Error::Reserved { .. }) = export(model, target, &options) {
                if MORE_NAMES.split(' ').any(|other| other == name) {
                    continue;
                }
                let is_matlab = ["state", "y", "real", "inverse"].contains(&name) && target == Target::Matlab;
                assert!(is_matlab, "{name}: {target:?}");
                continue;
            }
            let folder = written(model, target, &options);
            run(target, name, folder.path());
        }
    }
}

#[test]
fn words_of_the_language_are_refused() {
    let model = &MODELS[0].1;
    for (target, words) in [
        (Target::Matlab, &["end", "function", "tanh", "advance", "disp", "DISP"][..]),
        (Target::Python, &["class", "lambda", "numpy", "re", "os", "list", "max", "math"]),
        (Target::C, &["stddef", "StdDef", "string", "con"]),
        (Target::Fmu, &["fmi3", "stdlib", "aux"]),
        (Target::OpenSees, &["Vector", "Uniaxial", "Steel01", "stddef"]),
        (Target::Abaqus, &["stddef"]),
        (Target::Onnx, &["nul"]),
    ] {
        for &name in words {
            let refused = export(model, target, &Options::named(name));
            let expected = Error::Reserved { name: name.into(), target: target.name() };
            assert_eq!(refused, Err(expected));
        }
    }
}

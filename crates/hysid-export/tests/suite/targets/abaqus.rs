//! Exports to Abaqus: the user material on the test vectors, in a driver that calls it as Abaqus does.

use std::fs;
use std::process::Command;

use hysid::Model;
use hysid_export::{Error, Options, Target, export};

use super::case::{MODELS, NAME, StepCase, has_inertia, written};
use super::tools::{gcc, succeeds};

const DRIVER: &str = include_str!("abaqus/driver.c.txt");

#[test]
fn the_user_material_passes_the_test_vectors() {
    let Some(compiler) = gcc() else { return };
    let is_material =
        |(name, model): &&(String, Model)| model.names().inputs.len() == 1 && !has_inertia(name);
    for (name, model) in MODELS.iter().filter(is_material) {
        let folder = written(model, Target::Abaqus, &Options::named(NAME));
        fs::write(folder.path().join("driver.c"), DRIVER).unwrap();
        let arguments = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off", "-o", "driver"];
        let files = ["driver.c", "actuator_umat.c", "actuator.c", "-lm"];
        succeeds(Command::new(&compiler).current_dir(&folder).args(arguments).args(files));
        let has_time = StepCase::of(model, 1).has_time().to_string();
        let readme = fs::read_to_string(folder.path().join("README.md")).unwrap();
        let states =
            readme.split("*MATERIAL, NAME=actuator\n*DEPVAR\n").nth(1).and_then(|rest| rest.lines().next());
        let states = states.unwrap().to_string();
        // Factors of two change no digits.
        for factors in [["1", "1"], ["0.5", "4"]] {
            let driver = folder.path().join("driver");
            let run =
                Command::new(driver).current_dir(&folder).args([&has_time, &states]).args(factors).output();
            let text = String::from_utf8_lossy(&run.unwrap().stdout).into_owned();
            assert!(text.starts_with("0 of "), "{name} {factors:?}: {text}");
        }
    }
}

#[test]
fn two_inputs_and_inertia_are_refused() {
    for (name, model) in MODELS.iter() {
        let inputs = model.names().inputs.len();
        let target = "a user material of Abaqus";
        let expected = match (inputs, has_inertia(name)) {
            (1, true) => Error::Inertia { target },
            (1, false) => continue,
            _ => Error::Inputs { target, inputs },
        };
        assert_eq!(export(model, Target::Abaqus, &Options::named(NAME)).unwrap_err(), expected, "{name}");
    }
}

//! Exports to OpenSees: the C++ class on the test vectors, and the native commands in OpenSeesPy.

use std::fs;
use std::path::Path;
use std::process::Command;

use hysid::Model;
use hysid_core::elementary::{cos, sin};
use hysid_core::law::bouc_wen::{BoucWen, Degradation};
use hysid_core::law::{Classical, Law as _};
use hysid_core::model::Predictor;
use hysid_export::{Error, Options, Target, export};

use super::case::{MODELS, NAME, StepCase, written};
use super::tools::{python, succeeds, tool};
use crate::models::data;

/// Declarations of OpenSees' interface.
const INTERFACE: [(&str, &str); 7] = [
    ("UniaxialMaterial.h", include_str!("opensees/UniaxialMaterial.h")),
    ("Vector.h", include_str!("opensees/Vector.h")),
    ("Channel.h", include_str!("opensees/Channel.h")),
    ("FEM_ObjectBroker.h", include_str!("opensees/FEM_ObjectBroker.h")),
    ("OPS_Stream.h", include_str!("opensees/OPS_Stream.h")),
    ("OPS_Globals.h", include_str!("opensees/OPS_Globals.h")),
    ("elementAPI.h", include_str!("opensees/elementAPI.h")),
];

/// Runs the test vectors on the class, and prints the number of differences.
const DRIVER: &str = include_str!("opensees/driver.cpp.txt");

/// True for laws with a resonance of their own.
fn has_inertia(name: &str) -> bool {
    name.starts_with("hysteretic-") || name.contains("resonance=true")
}

#[test]
fn the_class_passes_the_test_vectors() {
    let install = "run: sudo apt-get install g++";
    let Some(compiler) = tool("materials of OpenSees", "g++", &["--version"], install) else { return };
    let is_material =
        |(name, model): &&(String, Model)| model.names().inputs.len() == 1 && !has_inertia(name);
    for (name, model) in MODELS.iter().filter(is_material) {
        let folder = written(model, Target::OpenSees, &Options::named(NAME));
        INTERFACE.iter().for_each(|(path, text)| fs::write(folder.path().join(path), text).unwrap());
        fs::write(folder.path().join("driver.cpp"), DRIVER).unwrap();
        let has_time = StepCase::of(model, 1).has_time().to_string();
        let c = ["-x", "c", "-std=c99", "-ffp-contract=off", "-c", "actuator.c"];
        succeeds(Command::new(&compiler).current_dir(&folder).args(c));
        let arguments =
            ["-I.", "-Wall", "-Wextra", "-Werror", "driver.cpp", "actuatorMaterial.cpp", "actuator.o"];
        succeeds(Command::new(&compiler).current_dir(&folder).args(arguments).args(["-lm", "-o", "driver"]));
        let output = succeeds(Command::new(folder.path().join("driver")).arg(has_time).current_dir(&folder));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.starts_with("0 of ") && text.ends_with("tag 7\n"), "{name}: {text}");
    }
}

#[test]
fn two_inputs_are_refused() {
    let (_, model) = MODELS.iter().find(|(_, model)| model.names().inputs.len() == 2).unwrap();
    let error = export(model, Target::OpenSees, &Options::named(NAME)).unwrap_err();
    assert_eq!(error, Error::Inputs { target: "a uniaxialMaterial of OpenSees", inputs: 2 });
}

#[test]
fn inertia_is_refused() {
    for (name, model) in MODELS.iter().filter(|(name, _)| has_inertia(name)) {
        let error = export(model, Target::OpenSees, &Options::named(NAME)).unwrap_err();
        assert_eq!(error, Error::Inertia { target: "a uniaxialMaterial of OpenSees" }, "{name}");
    }
}

/// A model with this law, in the units of the data.
fn model_of(law: BoucWen) -> Model {
    let (_, fitted) = MODELS.iter().find(|(name, _)| name.starts_with("bouc-wen")).unwrap();
    let law = Predictor::Law(Classical::BoucWen(law.validated().unwrap()));
    let found = fitted.provenance().clone().into();
    Model::new(law, fitted.input_transform().clone(), None, &data(1), found).unwrap()
}

/// Drives the native material along a path whose steps are divided into parts, and writes its stress at the rows.
const NATIVE: &str = include_str!("opensees/native.py.txt");

#[test]
fn native_materials_approach_the_model_with_small_steps() {
    let Some(python) = python("native materials of OpenSees", &["numpy", "openseespy.opensees"]) else {
        return;
    };
    let plain = BoucWen { b: 0.6, n: 1.8, offset: 100.0, ..BoucWen::new(2.0, 30.0, 1.5).unwrap() };
    let none = Degradation::from_values([0.0, 0.0, 0.0, 0.0, 1.0, 0.1, 0.4, 0.01, 0.5]);
    let degrading = Degradation { delta_a: 0.002, delta_nu: 0.004, delta_eta: 0.003, ..none };
    let pinched = Degradation { zeta_s: 0.8, p: 0.2, ..none };
    for (command, law) in [
        ("BoucWen", plain),
        ("BoucWen", BoucWen { degradation: Some(degrading), ..plain }),
        ("BWBN", BoucWen { degradation: Some(pinched), ..plain }),
    ] {
        let model = model_of(law);
        let folder = written(&model, Target::OpenSees, &Options::named(NAME));
        let script = fs::read_to_string(folder.path().join("actuator.tcl")).unwrap();
        assert!(script.contains(&format!("uniaxialMaterial {command} $tag ")), "{script}");
        let origin = model.input_transform().origin(0);
        let rows: Vec<f64> =
            (0..200).map(|k| 4.0 * sin(0.13 * f64::from(k)) * cos(0.011 * f64::from(k))).collect();
        let mut stepper = model.stepper();
        let expected: Vec<f64> =
            rows.iter().map(|x| stepper.step(&[x + origin], 0.0, None).unwrap() - law.offset).collect();
        let errors = [4, 32].map(|parts| error_of_native(&python, folder.path(), &rows, &expected, parts));
        let scale = expected.iter().fold(0.0, |scale: f64, y| scale.max(y.abs()));
        // Of first order: an eighth of the step gives an eighth of the error.
        let ratio = errors[0] / errors[1];
        assert!((6.0..10.0).contains(&ratio), "{command}: {errors:?} of {scale}");
        assert!(errors[1] < 0.005 * scale, "{command}: {errors:?} of {scale}");
    }
}

fn error_of_native(python: &str, folder: &Path, rows: &[f64], expected: &[f64], parts: usize) -> f64 {
    let bytes: Vec<u8> = rows.iter().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(folder.join("rows"), bytes).unwrap();
    succeeds(Command::new(python).current_dir(folder).args(["-c", NATIVE, &parts.to_string()]));
    let found = fs::read(folder.join("outputs")).unwrap();
    let found = found.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes));
    found.zip(expected).fold(0.0, |largest: f64, (found, expected)| largest.max((found - expected).abs()))
}

#[test]
fn what_differs_has_no_native_command() {
    let law = BoucWen { damping: 1.0, ..BoucWen::new(2.0, 30.0, 1.5).unwrap() };
    let files = export(&model_of(law), Target::OpenSees, &Options::named(NAME)).unwrap().files;
    assert!(files.iter().all(|file| !file.path.ends_with(".tcl")));
    let readme = files.iter().find(|file| file.path == "README.md").unwrap();
    let text = String::from_utf8(readme.content.clone()).unwrap();
    assert!(text.contains("no native command for this model: its damping (c)"), "{text}");
}

//! Exports to OpenSees: the C++ class on the test vectors, and the native commands in OpenSeesPy.

use std::fs;
use std::process::Command;

use hysid::Model;
use hysid_core::elementary::{cos, sin};
use hysid_core::law::bouc_wen::{BoucWen, Degradation};
use hysid_core::law::masing::{Masing, MasingParts};
use hysid_core::law::menegotto_pinto::{Downwards, MenegottoPinto};
use hysid_core::law::prandtl_ishlinskii::PrandtlIshlinskii;
use hysid_core::law::{Classical, Law as _};
use hysid_core::model::Predictor;
use hysid_export::{Error, Options, Target, export};

use super::case::{MODELS, NAME, StepCase, has_inertia, written};
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
fn model_of(law: Classical) -> Model {
    let (_, fitted) = MODELS.iter().find(|(name, _)| name.starts_with("bouc-wen")).unwrap();
    let found = fitted.provenance().clone().into();
    Model::new(Predictor::Law(law), fitted.input_transform().clone(), None, &data(1), found).unwrap()
}

fn bouc_wen(law: BoucWen) -> Classical {
    Classical::BoucWen(law.validated().unwrap())
}

/// Drives the native material along a path whose steps are divided into parts, and writes its stress at the rows.
const NATIVE: &str = include_str!("opensees/native.py.txt");

/// The modules that the native materials need.
const MODULES: [&str; 2] = ["numpy", "openseespy.opensees"];

#[test]
fn native_bouc_wen_materials_approach_the_model_with_small_steps() {
    let Some(python) = python("native materials of OpenSees", &MODULES) else { return };
    let plain = BoucWen { b: 0.6, n: 1.8, offset: 100.0, ..BoucWen::new(2.0, 30.0, 1.5).unwrap() };
    let none = Degradation::from_values([0.0, 0.0, 0.0, 0.0, 1.0, 0.1, 0.4, 0.01, 0.5]);
    let degrading = Degradation { delta_a: 0.002, delta_nu: 0.004, delta_eta: 0.003, ..none };
    let pinched = Degradation { zeta_s: 0.8, p: 0.2, ..none };
    for (command, law) in [
        ("BoucWen", plain),
        ("BoucWen", BoucWen { degradation: Some(degrading), ..plain }),
        ("BWBN", BoucWen { degradation: Some(pinched), ..plain }),
    ] {
        let rows: Vec<f64> =
            (0..200).map(|k| 4.0 * sin(0.13 * f64::from(k)) * cos(0.011 * f64::from(k))).collect();
        let native = NativeCase::of(bouc_wen(law), command, &rows, law.offset);
        let errors = [4, 32].map(|parts| native.error(&python, parts));
        // Of first order: an eighth of the step gives an eighth of the error.
        let ratio = errors[0] / errors[1];
        assert!((6.0..10.0).contains(&ratio), "{command}: {errors:?} of {}", native.scale());
        assert!(errors[1] < 0.005 * native.scale(), "{command}: {errors:?} of {}", native.scale());
    }
}

#[test]
fn native_stops_and_steel_are_the_model_at_every_step() {
    let Some(python) = python("native materials of OpenSees", &MODULES) else { return };
    let plays = PrandtlIshlinskii::new(5.0, 2.0, vec![0.3, 0.8, 2.0], vec![-0.9, -0.4, 0.2]).unwrap();
    let polygon = Masing::new(MasingParts {
        constant: -3.0,
        thresholds: vec![0.4, 1.1, 1.9],
        slopes: vec![9.0, 4.0, 1.5, -0.2],
    })
    .unwrap();
    let steel = MenegottoPinto {
        isotropic: 0.05,
        offset: 7.0,
        down: Some(Downwards { ratio: 1.0, isotropic: 0.02 }),
        ..MenegottoPinto::steel(200.0, 100.0, 0.02).unwrap()
    };
    // Nested loops for the stops; cycles of growing amplitude for the steel, which joins earlier branches in others.
    let nested = path(&[2.5, -2.5, 2.0, -1.0, 1.5, 0.0, 3.0, -0.5]);
    let growing = path(&[0.6, -0.6, 1.2, -1.2, 2.4, -2.4, 3.0]);
    for (command, law, rows, offset) in [
        ("Parallel", Classical::PrandtlIshlinskii(plays), &nested, 5.0),
        ("Parallel", Classical::Masing(polygon), &nested, -3.0),
        ("Steel02", Classical::MenegottoPinto(steel.validated().unwrap()), &growing, 7.0),
    ] {
        let native = NativeCase::of(law, command, rows, offset);
        for parts in [1, 3] {
            let error = native.error(&python, parts);
            assert!(error < 1e-11 * native.scale(), "{command}: {error} of {}", native.scale());
        }
        // The comparison that the user runs.
        let output = succeeds(Command::new(&python).current_dir(&native.folder).arg("actuator.py"));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(text.matches("largest difference").count(), 2, "{command}: {text}");
    }
}

/// Straight lines of ten rows from 0 over these turning points.
fn path(turns: &[f64]) -> Vec<f64> {
    let from = std::iter::once(&0.0).chain(turns);
    let line =
        |(from, to): (&f64, &f64)| (1..=10).map(|k| from + (to - from) * f64::from(k) / 10.0).collect();
    from.zip(turns).flat_map(|ends| -> Vec<f64> { line(ends) }).collect()
}

/// The exported native material, a path and the stress of the model along it.
struct NativeCase {
    folder: tempfile::TempDir,
    rows: Vec<f64>,
    expected: Vec<f64>,
}

impl NativeCase {
    fn of(law: Classical, command: &str, rows: &[f64], offset: f64) -> Self {
        let model = model_of(law);
        let folder = written(&model, Target::OpenSees, &Options::named(NAME));
        let script = fs::read_to_string(folder.path().join("actuator.tcl")).unwrap();
        assert!(script.contains(&format!("uniaxialMaterial {command} $tag ")), "{script}");
        let origin = model.input_transform().origin(0);
        let mut stepper = model.stepper();
        let mut stress = |x: &f64| stepper.step(&[x + origin], 0.0, None).unwrap() - offset;
        let expected = rows.iter().map(&mut stress).collect();
        Self { folder, rows: rows.to_vec(), expected }
    }

    fn scale(&self) -> f64 {
        self.expected.iter().fold(0.0, |scale: f64, y| scale.max(y.abs()))
    }

    /// The largest difference with this number of steps a row.
    fn error(&self, python: &str, steps: usize) -> f64 {
        let bytes: Vec<u8> = self.rows.iter().flat_map(|x| x.to_le_bytes()).collect();
        fs::write(self.folder.path().join("rows"), bytes).unwrap();
        succeeds(Command::new(python).current_dir(&self.folder).args(["-c", NATIVE, &steps.to_string()]));
        let found = fs::read(self.folder.path().join("outputs")).unwrap();
        let found = found.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes));
        let difference = |(found, expected): (f64, &f64)| (found - expected).abs();
        found.zip(&self.expected).map(difference).fold(0.0, f64::max)
    }
}

/// Runs a short calibration, and the command that it prints, from its text alone.
const CALIBRATION: &str = include_str!("opensees/calibration.py.txt");

#[test]
fn pinching4_is_calibrated_where_there_is_no_native_law() {
    let modules = ["numpy", "scipy", "openseespy.opensees"];
    let Some(python) = python("the calibration of Pinching4", &modules) else { return };
    let (_, model) = MODELS.iter().find(|(name, _)| name.starts_with("peak-oriented")).unwrap();
    let folder = written(model, Target::OpenSees, &Options::named(NAME));
    let output = succeeds(Command::new(python).current_dir(&folder).args(["-c", CALIBRATION]));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.ends_with("the command has the printed difference\n"), "{text}");
}

#[test]
fn what_differs_has_no_native_command() {
    let law = BoucWen { damping: 1.0, ..BoucWen::new(2.0, 30.0, 1.5).unwrap() };
    let files = export(&model_of(bouc_wen(law)), Target::OpenSees, &Options::named(NAME)).unwrap().files;
    assert!(files.iter().all(|file| !file.path.ends_with(".tcl")));
    let readme = files.iter().find(|file| file.path == "README.md").unwrap();
    let text = String::from_utf8(readme.content.clone()).unwrap();
    assert!(text.contains("no native command for this model: its damping (c)"), "{text}");
}

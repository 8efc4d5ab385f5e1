//! Models with paths, and the outputs that the library gives.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use hysid::Model;
use hysid_export::description::{Argument, Description, RateSource};
use hysid_export::program::Precision;
use hysid_export::{Options, Target, export};
use tempfile::TempDir;

use super::tools::succeeds;
use crate::models::{all, path, time_step};

pub static MODELS: LazyLock<Vec<(String, Model)>> = LazyLock::new(all);

pub const NAME: &str = "actuator";

/// The arguments of steps, and the outputs of the library.
pub struct StepCase {
    pub arguments: Vec<Argument>,
    pub rows: Vec<Vec<f64>>,
    pub expected: Vec<f64>,
}

impl StepCase {
    /// A path of `rows` rows, with rates by backward differences.
    pub fn of(model: &Model, rows: usize) -> Self {
        let arguments = Description::of(model, RateSource::Backward, Precision::Double).arguments;
        let mut stepper = model.stepper();
        let mut time = 0.0;
        let mut case = Self { arguments, rows: Vec::new(), expected: Vec::new() };
        for (row, inputs) in path(rows, model.names().inputs.len()).iter().enumerate() {
            let before = time;
            time += time_step(row);
            case.expected.push(stepper.step(inputs, time, None).unwrap());
            let value = |argument: &Argument| match argument {
                Argument::Input(input) => inputs[*input],
                // The stepper takes time stamps, whose difference is rounded.
                Argument::TimeStep => time - before,
                Argument::Rate => unreachable!("rates are differences here"),
            };
            case.rows.push(case.arguments.iter().map(value).collect());
        }
        case
    }

    pub fn has_time(&self) -> bool {
        self.arguments.last() == Some(&Argument::TimeStep)
    }

    /// The arguments, row by row, as bytes.
    pub fn bytes(&self) -> Vec<u8> {
        self.rows.iter().flatten().flat_map(|value| value.to_le_bytes()).collect()
    }

    /// Compares outputs in bytes with the library's, to the last bit.
    pub fn must_equal(&self, name: &str, bytes: &[u8]) {
        let found = numbers(bytes);
        assert_eq!(found.len(), self.expected.len(), "{name}");
        for (row, (found, expected)) in found.iter().zip(&self.expected).enumerate() {
            assert!(found.to_bits() == expected.to_bits(), "{name}, row {row}: {found:e}, not {expected:e}");
        }
    }

    /// The largest difference of outputs in bytes from the library's, as a share of their largest magnitude.
    pub fn difference(&self, name: &str, bytes: &[u8]) -> f64 {
        let found = numbers(bytes);
        assert_eq!(found.len(), self.expected.len(), "{name}");
        let largest = self.expected.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let differences = found.iter().zip(&self.expected).map(|(found, expected)| (found - expected).abs());
        assert!(found.iter().all(|value| value.is_finite()), "{name}");
        differences.fold(0.0, f64::max) / largest
    }
}

/// Runs a program that reads the rows of a case in a folder and writes outputs there, which must be the library's but for
/// roundings.
pub fn must_agree(name: &str, case: &StepCase, folder: &TempDir, program: &mut Command) {
    fs::write(folder.path().join("rows"), case.bytes()).unwrap();
    succeeds(program.current_dir(folder));
    let difference = case.difference(name, &fs::read(folder.path().join("outputs")).unwrap());
    println!("{name}: {difference:.1e}");
    assert!(difference <= 1e-12, "{name}: {difference:e}");
}

fn numbers(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
}

/// A folder with an export.
pub fn written(model: &Model, to: Target, options: &Options) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(model, to, options, folder.path());
    folder
}

/// Writes an export into a folder.
pub fn write(model: &Model, to: Target, options: &Options, folder: &Path) {
    for file in export(model, to, options).unwrap().files {
        let path = folder.join(file.path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, file.content).unwrap();
    }
}

/// True for laws with a resonance of their own.
pub fn has_inertia(name: &str) -> bool {
    name.starts_with("hysteretic-") || name.contains("resonance=true")
}

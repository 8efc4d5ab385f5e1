//! Inverses as Functional Mock-up Units, run by FMPy.

use std::fs;
use std::process::Command;

use hysid_core::model::BandLevel;
use hysid_export::description::Argument;
use hysid_export::{FmiVersion, InverseOptions, Options, Target};

use super::case::{MODELS, NAME, written};
use super::fmu::OPENED;
use super::inverse_case::{InverseCase, code, tight};
use super::tools::{python, succeeds, tool};

/// Runs rows of arguments in binary as an importer does, writes inputs, outputs and reaches in binary, and tries what
/// importers do besides.
const DRIVER: &str = include_str!("programs/inverse_fmu.py.txt");

#[test]
fn importers_find_nothing_wrong_and_units_of_inverses_agree() {
    const ROWS: usize = 300;
    let Some(_) = tool("binaries of FMUs", "cc", &["--version"], "run: sudo apt-get install gcc") else {
        return;
    };
    let Some(python) = python("inverses as FMU", &["numpy", "fmpy"]) else { return };
    // One version for a model, in turns.
    for (number, (name, model)) in MODELS.iter().enumerate() {
        let (fmi, inverse) = match number % 2 {
            0 => (FmiVersion::Three, tight(model)),
            _ => (FmiVersion::Two, InverseOptions::default()),
        };
        // The band, where there is one, is an output more.
        let band = model.band().map(|_| BandLevel { probability: 0.9, of_ten: 8 });
        let options = Options { fmi, band, inverse: Some(inverse), ..Options::named(NAME) };
        let folder = written(model, Target::Fmu, &options);
        let output = succeeds(Command::new(&python).current_dir(&folder).arg("actuator_test.py"));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.starts_with("0 of "), "{name}, {fmi:?}: {text}");

        let case = InverseCase::of(model, inverse, ROWS, false);
        fs::write(folder.path().join("rows"), case.bytes()).unwrap();
        let has_time = case.arguments.last() == Some(&Argument::TimeStep);
        let driver = format!("{OPENED}{DRIVER}");
        let arguments = ["-c", &driver, &(case.arguments.len() + 1).to_string(), &has_time.to_string()];
        succeeds(Command::new(&python).current_dir(&folder).args(arguments));
        let bytes = fs::read(folder.path().join("outputs")).unwrap();
        let numbers: Vec<f64> =
            bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        assert_eq!(numbers.len(), 3 * ROWS);
        let mut different = 0;
        let (low, high) = model.trained_ranges().output;
        for (row, (found, expected)) in numbers.chunks(3).zip(&case.expected).enumerate() {
            let (input, output, reach, _) = expected.unwrap();
            different += usize::from(found[0] != input || found[1] != output);
            assert_eq!(found[2], code(Some(reach)), "{name}, {fmi:?}, row {row}");
            // The importer adds up the time steps, whose roundings reach rates.
            let deviation = (found[1] - output).abs() / (high - low);
            assert!(deviation <= 1e-12, "{name}, {fmi:?}, row {row}: {deviation:e}");
        }
        println!("{name}, {fmi:?}: {different} of {ROWS} rows differ; {}", case.reaches());
    }
}

//! Inverses in C: compiled without a warning, and equal to those of the library to the last bit.

use std::fs;
use std::path::Path;
use std::process::Command;

use hysid::model::MOST_TRIALS;
use hysid::model::Reach;
use hysid_export::description::{Argument, RateSource};
use hysid_export::{Error, InverseOptions, Options, Precision, Target, export};

use super::c::{STRICT, UNIT, compilers, must_survive, random_others};
use super::case::{MODELS, NAME, written};
use super::inverse_case::{InverseCase, code, tight};
use super::tools::{gcc, succeeds};

fn with_inverse(inverse: InverseOptions) -> Options {
    Options { inverse: Some(inverse), ..Options::named(NAME) }
}

fn compiled(compiler: &str, folder: &Path, program: &str) {
    let files = ["actuator.c", "actuator_inverse.c", program, "-lm", "-o", "program"];
    succeeds(Command::new(compiler).current_dir(folder).args(STRICT).args(files));
}

/// Reads rows of arguments in binary, writes inputs, outputs, reaches and numbers of trials. Every 97 rows it saves the
/// state, goes elsewhere, and returns.
fn driver(arguments: usize) -> String {
    let given: String = (1..arguments).map(|index| format!(", row[{index}]")).collect();
    include_str!("programs/inverse.c.txt")
        .replace("@arguments@", &arguments.to_string())
        .replace("@given@", &given)
}

/// `HYSID_ROWS=100000 cargo test --release -p hysid-export --test targets inverses_equal -- --nocapture` is the long
/// one.
#[test]
fn inverses_equal_those_of_the_library_to_the_last_bit() {
    let rows = std::env::var("HYSID_ROWS").map_or(1000, |rows| rows.parse().unwrap());
    let Some(compiler) = compilers().into_iter().next() else { return };
    for (number, (name, model)) in MODELS.iter().enumerate() {
        let options = if number % 2 == 0 { InverseOptions::default() } else { tight(model) };
        let case = InverseCase::of(model, options, rows, true);
        let folder = written(model, Target::C, &with_inverse(options));
        fs::write(folder.path().join("driver.c"), driver(case.arguments.len() + 1)).unwrap();
        compiled(&compiler, folder.path(), "driver.c");
        let input = folder.path().join("rows");
        fs::write(&input, case.bytes()).unwrap();
        let input = fs::File::open(&input).unwrap();
        let output = succeeds(Command::new(folder.path().join("program")).stdin(input)).stdout;
        let numbers: Vec<f64> =
            output.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        assert_eq!(numbers.len(), 4 * rows, "{name}");
        for (row, (found, expected)) in numbers.chunks(4).zip(&case.expected).enumerate() {
            let expected = match *expected {
                Some((input, output, reach, trials)) => [input, output, code(Some(reach)), trials as f64],
                None => [0.0, 0.0, code(None), found[3]],
            };
            let same = found.iter().zip(&expected).all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(same, "{name}, {options:?}, row {row}: {found:?}, not {expected:?}");
            assert!(found[3] <= MOST_TRIALS as f64);
        }
        println!("{name}: {rows} rows are equal: {}", case.reaches());
    }
}

#[test]
fn test_vectors_of_inverses_agree_in_both_precisions() {
    // One compiler for a model, in turns.
    for ((name, model), compiler) in MODELS.iter().zip(compilers().iter().cycle()) {
        for (precision, inverse) in
            [(Precision::Double, InverseOptions::default()), (Precision::Single, tight(model))]
        {
            let folder = written(model, Target::C, &Options { precision, ..with_inverse(inverse) });
            compiled(compiler, folder.path(), "actuator_test.c");
            let output = succeeds(&mut Command::new(folder.path().join("program")));
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            println!("{name}, {precision:?}: {}", text.lines().nth(1).unwrap());
            let agrees = text.lines().all(|line| line.starts_with("0 of "));
            assert!(precision == Precision::Single || agrees, "{name}, {precision:?}: {text}");
        }
    }
}

/// A program of random wanted outputs of all sizes; it fails where a result is not finite or not within its bounds.
fn soak(kinds: &[Argument], (low, high): (f64, f64)) -> String {
    let given: String = (1..=kinds.len()).map(|index| format!(", a[{index}]")).collect();
    let others = random_others(kinds);
    include_str!("programs/inverse_soak.c.txt")
        .replace("@UNIT@", UNIT)
        .replace("@arguments@", &(kinds.len() + 1).to_string())
        .replace("@low@", &format!("{low:?}"))
        .replace("@high@", &format!("{high:?}"))
        .replace("@others@", &others)
        .replace("@given@", &given)
}

/// `HYSID_SOAK_STEPS=1000000 cargo test --release -p hysid-export --test targets inverses_survive` is the long one.
#[test]
fn inverses_survive_the_sanitizers() {
    let Some(compiler) = gcc() else { return };
    let steps = std::env::var("HYSID_SOAK_STEPS").unwrap_or_else(|_| "1000".into());
    for (name, model) in MODELS.iter() {
        let inverse = tight(model);
        let folder = written(model, Target::C, &with_inverse(inverse));
        let kinds = InverseCase::of(model, inverse, 1, false).arguments;
        fs::write(folder.path().join("soak.c"), soak(&kinds, model.trained_ranges().output)).unwrap();
        must_survive(name, &compiler, &folder, &["actuator.c", "actuator_inverse.c", "soak.c"], &steps);
    }
}

/// Names that could meet those inside the files of an inverse.
#[test]
fn names_do_not_meet_those_of_an_inverse() {
    let model = &MODELS.iter().find(|(name, _)| name.starts_with("pnn")).unwrap().1;
    let compilers = compilers();
    for name in ["inverse", "at", "found", "point", "search", "unit", "REACH", "MODEL", "model", "x_inverse"]
    {
        for target in [Target::C, Target::Fmu] {
            let options = Options { name: name.into(), ..with_inverse(tight(model)) };
            // The binary of a unit is built here too.
            let folder = written(model, target, &options);
            if target == Target::C
                && let Some(compiler) = compilers.first()
            {
                let files = ["", "_inverse", "_test"].map(|part| format!("{name}{part}.c"));
                let mut command = Command::new(compiler);
                succeeds(
                    command.current_dir(&folder).args(STRICT).args(files).args(["-lm", "-o", "program"]),
                );
                succeeds(&mut Command::new(folder.path().join("program")));
            }
        }
    }
}

#[test]
fn what_cannot_be_inverted_is_refused() {
    let model = |beginning: &str| &MODELS.iter().find(|(name, _)| name.starts_with(beginning)).unwrap().1;
    let pnn = model("pnn");
    let refused = |limits: Option<(f64, f64)>, slew: Option<f64>| {
        export(pnn, Target::C, &with_inverse(InverseOptions { limits, slew })).unwrap_err()
    };
    for limits in [(1.0, 1.0), (3.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        assert!(matches!(refused(Some(limits), None), Error::Limits(_)), "{limits:?}");
    }
    for slew in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refused(None, Some(slew)), Error::Slew(_)), "{slew}");
    }
    // Two limits that are one number in single precision.
    let inverse = InverseOptions { limits: Some((1.0, 1.0 + 1e-12)), slew: None };
    export(pnn, Target::C, &with_inverse(inverse)).unwrap();
    let single = Options { precision: Precision::Single, ..with_inverse(inverse) };
    assert!(matches!(export(pnn, Target::C, &single), Err(Error::Limits(_))));

    let options = with_inverse(InverseOptions::default());
    let with_rate = Options { rate: RateSource::Argument, ..options.clone() };
    assert_eq!(export(model("xpnn "), Target::C, &with_rate), Err(Error::InverseRate));
    export(pnn, Target::C, &with_rate).unwrap();
    for target in Target::ALL.into_iter().filter(|target| ![Target::C, Target::Fmu].contains(target)) {
        assert_eq!(export(pnn, target, &options), Err(Error::NoInverse(target.name())));
    }
    assert_eq!(Reach::ALL.map(|reach| code(Some(reach))), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
}

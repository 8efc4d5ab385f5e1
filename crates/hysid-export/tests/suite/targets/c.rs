//! Exports to C: compiled without a warning, and equal to the library to the last bit.

use std::fs;
use std::process::Command;

use hysid::Fit;
use hysid_core::data::record::Excitation;
use hysid_core::model::BandLevel;
use hysid_export::description::{Argument, Description, RateSource};
use hysid_export::{Error, InverseOptions, Options, Precision, Target, export};
use serde_json::json;
use tempfile::TempDir;

use super::case::{MODELS, NAME, StepCase, written};
use super::tools::{gcc, succeeds, tool};
use crate::models::{data, path, time_step};

pub const STRICT: [&str; 8] =
    ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-ffp-contract=off"];

/// The compilers that this machine has, of gcc and clang.
pub fn compilers() -> Vec<String> {
    ["gcc", "clang"]
        .into_iter()
        .filter_map(|compiler| {
            let install = format!("run: sudo apt-get install {compiler}");
            tool("exports to C", compiler, &["--version"], &install)
        })
        .collect()
}

#[test]
fn test_vectors_agree_in_both_precisions() {
    // One compiler for a model, in turns.
    for ((name, model), compiler) in MODELS.iter().zip(compilers().iter().cycle()) {
        for precision in [Precision::Double, Precision::Single] {
            let folder = written(model, Target::C, &Options { precision, ..Options::named(NAME) });
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

#[test]
fn the_header_is_good_for_cpp() {
    let Some(compiler) = tool("headers in C++", "g++", &["--version"], "run: sudo apt-get install g++")
    else {
        return;
    };
    let options = Options { inverse: Some(InverseOptions::default()), ..Options::named(NAME) };
    let folder = written(&MODELS[0].1, Target::C, &options);
    let program = "#include \"actuator_inverse.h\"\nint main() { actuator_model m; actuator_reset(&m); return actuator_step(&m, 1.0) > 1e9; }\n";
    fs::write(folder.path().join("main.cpp"), program).unwrap();
    succeeds(Command::new("gcc").current_dir(folder.path()).args(STRICT).args(["-c", "actuator.c"]));
    succeeds(Command::new(compiler).current_dir(folder.path()).args([
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

/// Reads rows of arguments in binary, and does with each what `step` says; ARGUMENTS stands for them.
pub fn driver(arguments: usize, step: &str) -> String {
    let given: String = (0..arguments).map(|index| format!(", row[{index}]")).collect();
    let step = step.replace("ARGUMENTS", &given);
    format!(
        "#include <stdio.h>
#include \"actuator.h\"
int main(void)
{{
    static actuator_model model;
    double row[{arguments}];
    actuator_reset(&model);
    while (fread(row, sizeof(double), {arguments}, stdin) == {arguments}) {{
{step}
    }}
    return 0;
}}
"
    )
}

pub const OUTPUTS: &str = "double y = actuator_step(&modelARGUMENTS); fwrite(&y, sizeof y, 1, stdout);";

const BAND: &str = "double pair[2];
        pair[0] = actuator_trial(&modelARGUMENTS);
        pair[1] = actuator_half_width(&model);
        actuator_commit(&model);
        if (pair[1] != actuator_half_width(&model))
            return 1;
        fwrite(pair, sizeof pair, 1, stdout);";

/// `HYSID_ROWS=1000000 cargo test --release -p hysid-export --test targets last_bit` is the long one.
#[test]
fn outputs_equal_those_of_the_library_to_the_last_bit() {
    let rows = std::env::var("HYSID_ROWS").map_or(5_000, |rows| rows.parse().unwrap());
    let Some(compiler) = compilers().into_iter().next() else { return };
    for (name, model) in MODELS.iter() {
        let case = StepCase::of(model, rows);
        let folder = written(model, Target::C, &Options::named(NAME));
        fs::write(folder.path().join("driver.c"), driver(case.arguments.len(), OUTPUTS)).unwrap();
        let files = ["actuator.c", "driver.c", "-lm", "-o", "driver"];
        succeeds(Command::new(&compiler).current_dir(folder.path()).args(STRICT).args(files));
        let input = folder.path().join("rows");
        fs::write(&input, case.bytes()).unwrap();
        let output =
            succeeds(Command::new(folder.path().join("driver")).stdin(fs::File::open(&input).unwrap()));
        case.must_equal(name, &output.stdout);
        println!("{name}: {rows} rows are equal");
    }
}

/// Random numbers from 0 to 1, in C.
pub const UNIT: &str = "static uint64_t bits = 7;
static double unit(void)
{
    bits = bits * 6364136223846793005u + 1442695040888963407u;
    return (double)(bits >> 11) / 9007199254740992.0;
}
";

/// Assignments, in C, of random values to the arguments behind the first.
pub fn random_others(kinds: &[Argument]) -> String {
    let assignment = |(place, kind): (usize, &Argument)| match kind {
        Argument::TimeStep => format!("a[{}] = 0.001 + 0.01 * unit();", place + 1),
        _ => format!("a[{}] = 10.0 * unit();", place + 1),
    };
    kinds.iter().enumerate().map(assignment).collect()
}

/// A program of random steps of all sizes, trials and commits; it fails at a value that is not finite.
fn soak(kinds: &[Argument]) -> String {
    let arguments = kinds.len();
    let given: String = (0..arguments).map(|index| format!(", a[{index}]")).collect();
    let others = random_others(&kinds[1..]);
    include_str!("programs/soak.c.txt")
        .replace("@UNIT@", UNIT)
        .replace("@arguments@", &arguments.to_string())
        .replace("@others@", &others)
        .replace("@given@", &given)
}

/// Runs a number of steps of a program with all sanitizers.
pub fn must_survive(name: &str, compiler: &str, folder: &TempDir, sources: &[&str], steps: &str) {
    let sanitizers = ["-O1", "-fsanitize=undefined,address", "-fno-sanitize-recover=all"];
    let mut command = Command::new(compiler);
    succeeds(
        command.current_dir(folder).args(STRICT).args(sanitizers).args(sources).args(["-lm", "-o", "soak"]),
    );
    let output = succeeds(Command::new(folder.path().join("soak")).arg(steps));
    assert!(output.stderr.is_empty(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
}

/// `HYSID_SOAK_STEPS=100000000 cargo test --release -p hysid-export --test targets survive` is the long one.
#[test]
fn random_steps_survive_the_sanitizers() {
    let Some(compiler) = gcc() else { return };
    let steps = std::env::var("HYSID_SOAK_STEPS").unwrap_or_else(|_| "20000".into());
    for (name, model) in MODELS.iter() {
        let folder = written(model, Target::C, &Options::named(NAME));
        fs::write(folder.path().join("soak.c"), soak(&StepCase::of(model, 1).arguments)).unwrap();
        must_survive(name, &compiler, &folder, &["actuator.c", "soak.c"], &steps);
        println!("{name}: {steps} steps");
    }
}

#[test]
fn the_band_is_that_of_the_library() {
    const ROWS: usize = 600;
    let Some(compiler) = compilers().into_iter().next() else { return };
    // Without the rate, which the library forms by another method than backward differences.
    let fit =
        Fit::new().model("auto").seed(3).rate(None).option("starts", json!(1)).option("epochs", json!(2));
    let model = &fit.run(&data(1)).unwrap();
    let level = BandLevel { probability: 0.9, of_ten: 8 };
    let inputs: Vec<f64> = path(ROWS, 1).into_iter().map(|row| row[0]).collect();
    let mut time = 0.0;
    let times: Vec<f64> = (0..ROWS)
        .map(|row| {
            time += time_step(row);
            time
        })
        .collect();
    let excitation = Excitation::new("path", vec![&inputs]).unwrap();
    let excitation = excitation.with_time(&times).unwrap();
    let expected = model.predict(&excitation, level).unwrap();

    let options = Options { band: Some(level), ..Options::named(NAME) };
    let folder = written(model, Target::C, &options);
    let arguments = Description::of(model, RateSource::Backward, Precision::Double).arguments;
    let mut rows: Vec<u8> = Vec::new();
    for row in 0..ROWS {
        let before = if row > 0 { times[row - 1] } else { 0.0 };
        for argument in &arguments {
            let value = match argument {
                Argument::Input(_) => inputs[row],
                Argument::TimeStep => times[row] - before,
                Argument::Rate => unreachable!("no rate"),
            };
            rows.extend(value.to_le_bytes());
        }
    }
    fs::write(folder.path().join("rows"), rows).unwrap();
    fs::write(folder.path().join("driver.c"), driver(arguments.len(), BAND)).unwrap();
    let files = ["actuator.c", "driver.c", "-lm", "-o", "driver"];
    succeeds(Command::new(&compiler).current_dir(folder.path()).args(STRICT).args(files));
    let input = fs::File::open(folder.path().join("rows")).unwrap();
    let output = succeeds(Command::new(folder.path().join("driver")).stdin(input));
    let found: Vec<f64> =
        output.stdout.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    let pairs: Vec<&[f64]> = found.chunks(2).collect();
    assert_eq!(pairs.len(), ROWS);
    let scale = expected.output.iter().fold(0.0, |largest: f64, y| largest.max(y.abs()));
    for (row, pair) in pairs.iter().enumerate() {
        let half = 0.5 * (expected.high[row] - expected.low[row]);
        assert!((pair[0] - expected.output[row]).abs() < 1e-9 * scale, "row {row}: {pair:?}");
        assert!((pair[1] - half).abs() < 1e-9 * scale, "row {row}: {pair:?}, not {half}");
    }
    let without = MODELS.iter().find(|(_, model)| model.band().is_none()).unwrap();
    assert_eq!(export(&without.1, Target::C, &options), Err(Error::NoBand));
    let options = Options { band: Some(0.2.into()), ..options };
    assert!(matches!(export(model, Target::C, &options), Err(Error::Band(_))));
}

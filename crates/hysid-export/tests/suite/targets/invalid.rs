//! Arguments that are no finite numbers, and time steps next to 0.

use std::fs;
use std::process::Command;

use hysid_export::{Options, Target};

use super::c::compilers;
use super::case::{MODELS, NAME, StepCase, written};
use super::tools::{gcc, python, succeeds};

/// A program that makes steps with NaN and infinite arguments between others, which must not notice them, and trials after
/// time steps next to 0, whose slopes must be finite.
fn program(arguments: usize) -> String {
    let call = |first: &str, argument: usize, value: &str| {
        let of = |place: usize| match place {
            _ if place == argument => value.to_string(),
            0 => first.to_string(),
            _ => "0.01".into(),
        };
        (0..arguments).map(|place| format!(", {}", of(place))).collect::<String>()
    };
    let plain = call("sin(0.1 * i)", usize::MAX, "");
    let invalid: String = (0..arguments)
        .flat_map(|argument| ["NAN", "INFINITY", "-INFINITY"].map(|value| call("0.3", argument, value)))
        .map(|given| {
            format!(
                "            if (actuator_step(&model{given}) == actuator_step(&model{given}) ||
                actuator_trial(&model{given}) == 0 || !isnan(actuator_trial_tangent(&model{given}, &slope)) ||
                !isnan(slope))
                return puts(\"an invalid argument has an output\"), 1;
            actuator_commit(&model);
"
            )
        })
        .collect();
    let soon: String = ["5e-324", "1e-310", "1e-300", "1e-200"]
        .map(|step| {
            let given = call("x", arguments - 1, step);
            format!(
                "    if (!isfinite(actuator_trial_tangent(&model{given}, &slope)) || !isfinite(slope))
        return printf(\"after {step} the slope is %g\\n\", slope), 1;
"
            )
        })
        .concat();
    let soon = if arguments > 1 { soon } else { String::new() };
    include_str!("programs/invalid.c.txt")
        .replace("@invalid@", &invalid)
        .replace("@plain@", &plain)
        .replace("@soon@", &soon)
}

#[test]
fn invalid_arguments_change_nothing_and_slopes_after_short_steps_are_finite() {
    let Some(compiler) = gcc() else { return };
    for (label, model) in MODELS.iter() {
        let arguments = StepCase::of(model, 1).arguments.len();
        let folder = written(model, Target::C, &Options::named(NAME));
        fs::write(folder.path().join("main.c"), program(arguments)).unwrap();
        println!("{label}");
        let flags = ["-std=c99", "-O1", "actuator.c", "main.c", "-lm", "-o", "invalid"];
        succeeds(Command::new(&compiler).current_dir(folder.path()).args(flags));
        succeeds(Command::new(folder.path().join("invalid")).current_dir(folder.path()));
    }
}

#[test]
fn invalid_arguments_change_nothing_in_python() {
    let Some(python) = python("exports to Python", &["numpy"]) else { return };
    for (label, model) in MODELS.iter() {
        let more = ", 0.01".repeat(StepCase::of(model, 1).arguments.len() - 1);
        let folder = written(model, Target::Python, &Options::named(NAME));
        let program = format!(
            "import math, actuator
a, b = actuator.Model(), actuator.Model()
for row in range(40):
    x = math.sin(0.1 * row)
    if row == 20:
        assert math.isnan(a.step(math.nan{more})) and math.isnan(a.trial_tangent(math.inf{more})[1])
        a.commit()
    assert a.step(x{more}) == b.step(x{more}), row
"
        );
        println!("{label}");
        succeeds(Command::new(&python).current_dir(folder.path()).args(["-c", &program]));
    }
}

/// Only those that the model fuses, which are then in software here. gcc 12 fused alternating sums and differences in spite of `-ffp-contract=off`.
#[test]
fn optimised_code_fuses_no_products_and_sums_and_fast_arithmetic_is_refused() {
    let Some(compiler) = gcc() else { return };
    let gcc = |folder: &std::path::Path, flags: &[&str]| {
        let flags = ["-std=c99", "-S", "-o", "-"].iter().chain(flags).chain(&["actuator.c"]);
        Command::new(&compiler).current_dir(folder).args(flags).output().unwrap()
    };
    for (label, model) in MODELS.iter() {
        let folder = written(model, Target::C, &Options::named(NAME));
        if cfg!(target_arch = "x86_64") {
            let code = gcc(folder.path(), &["-O3", "-mfma", "-ffp-contract=off", "-DHYSID_SOFTWARE_FMA"]);
            let text = String::from_utf8(code.stdout).unwrap();
            assert!(code.status.success() && !text.contains("vfm"), "{label}");
        }
        // gcc takes the last by itself as if it was not there, but not behind a pragma of its own.
        let unsafe_options = [
            "-Ofast",
            "-funsafe-math-optimizations",
            "-ffinite-math-only",
            "-freciprocal-math",
            "-fassociative-math",
        ];
        for flag in unsafe_options {
            assert!(!gcc(folder.path(), &["-O2", flag]).status.success(), "{label}: {flag}");
        }
    }
}

/// Clang tells a file of few of these options. What it may not reorder differs by rounding at most.
#[test]
fn clang_reorders_nothing_whatever_it_is_told() {
    for compiler in compilers().iter().filter(|compiler| compiler.contains("clang")) {
        for ((label, model), flag) in
            MODELS.iter().zip(["-funsafe-math-optimizations", "-freciprocal-math"].iter().cycle())
        {
            let folder = written(model, Target::C, &Options::named(NAME));
            let files = ["-O2", flag, "actuator.c", "actuator_test.c", "-lm", "-o", "test"];
            succeeds(Command::new(compiler).current_dir(folder.path()).args(files));
            let output = succeeds(&mut Command::new(folder.path().join("test")));
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            let largest = text.split_once("at most ").and_then(|(_, rest)| rest.split_once(' '));
            let largest: f64 = largest.unwrap().0.parse().unwrap();
            assert!(largest < 1e-12, "{label} {flag}: {text}");
        }
    }
}

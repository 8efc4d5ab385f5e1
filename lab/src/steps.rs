//! Time of a step of exported C code beside the library's stepper, and time of exports.

#[path = "../../crates/hysid-export/tests/suite/models/mod.rs"]
mod models;

use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use hysid::{Fit, Model};
use hysid_core::elementary::{cos, sin};
use hysid_export::description::{Argument, Description, RateSource};
use hysid_export::{InverseOptions, Options, Precision, Target, export};
use serde_json::json;

const ROWS: usize = 10_000;
const REPEATS: usize = 7;

/// Ways of products and sums in one rounding on x86-64 Linux, with the option of the compiler for each.
const WAYS: [(&str, &str); 3] =
    [("the instruction", "-mfma"), ("the C library", "-O3"), ("software", "-DHYSID_SOFTWARE_FMA")];

/// Runs the command.
pub fn run() {
    let small = [("stops", json!(10)), ("hidden", json!(10)), ("starts", json!(1)), ("epochs", json!(20))];
    let mut xpnn = Fit::new().model("xpnn").seed(1);
    for (name, value) in small {
        xpnn = xpnn.option(name, value);
    }
    let measured =
        [("xpnn of 10 stops and 10 tanh neurons", xpnn), ("auto with its defaults", Fit::new().seed(1))];
    for (name, fit) in measured {
        let model = fit.run(&models::data(1)).unwrap();
        let library = of_stepper(&model);
        for (way, option) in WAYS {
            let c = of_c(&model, option);
            println!("{name}: Stepper::step {library:.1} ns, C by {way} {c:.1} ns, ratio {:.2}", c / library);
        }
        let wanted = wanted(&model);
        let (library, trials) = of_inverse(&model, &wanted);
        println!("{name}: {trials:.1} model steps in a step of the inverse on average");
        for (way, option) in WAYS {
            let c = of_c_inverse(&model, &wanted, option);
            println!("{name}: Inverse::step {library:.0} ns, C by {way} {c:.0} ns, ratio {:.2}", c / library);
        }
    }
    println!("time of exports in ms, the C compiler left out:");
    for (name, model) in models::all() {
        let of = |target: Target| {
            let begin = Instant::now();
            export(&model, target, &Options::named("a")).ok()?;
            Some(format!("{} {:.0}", target.name(), 1e3 * begin.elapsed().as_secs_f64()))
        };
        let times: Vec<String> =
            Target::ALL.into_iter().filter(|to| *to != Target::Fmu).filter_map(of).collect();
        println!("{name}: {}", times.join(", "));
    }
}

/// Nanoseconds of a step, the least of several runs.
fn of_stepper(model: &Model) -> f64 {
    let rows = models::path(ROWS, 1);
    let times = (0..REPEATS).map(|_| {
        let mut stepper = model.stepper();
        let begin = Instant::now();
        let mut time = 0.0;
        for (row, inputs) in rows.iter().enumerate() {
            time += models::time_step(row);
            black_box(stepper.step(inputs, time, None).unwrap());
        }
        begin.elapsed().as_secs_f64()
    });
    1e9 * times.fold(f64::INFINITY, f64::min) / ROWS as f64
}

/// The outputs along a path in the trained range, each with its time step.
fn wanted(model: &Model) -> Vec<(f64, f64)> {
    let (low, high) = model.trained_ranges().inputs[0];
    let mut stepper = model.stepper();
    let mut time = 0.0;
    let output = |row: usize| {
        let t = row as f64;
        let place = 0.5 + 0.45 * sin(0.031 * t) * cos(0.0017 * t);
        time += models::time_step(row);
        (stepper.step(&[low + place * (high - low)], time, None).unwrap(), models::time_step(row))
    };
    (0..ROWS).map(output).collect()
}

/// Nanoseconds of a step of the inverse, the least of several runs, and model steps in it on average.
fn of_inverse(model: &Model, wanted: &[(f64, f64)]) -> (f64, f64) {
    let mut trials = 0;
    let times = (0..REPEATS).map(|_| {
        let mut inverse = model.inverse();
        let begin = Instant::now();
        let mut time = 0.0;
        trials = 0;
        for (wanted, step) in wanted {
            time += step;
            trials += black_box(inverse.step(*wanted, &[], time).unwrap()).trials;
        }
        begin.elapsed().as_secs_f64()
    });
    let least = times.fold(f64::INFINITY, f64::min);
    (1e9 * least / ROWS as f64, trials as f64 / ROWS as f64)
}

/// Nanoseconds of a step of the exported C code.
fn of_c(model: &Model, option: &str) -> f64 {
    let arguments = arguments(model);
    let rows: Vec<f64> = models::path(ROWS, 1)
        .iter()
        .enumerate()
        .flat_map(|(row, inputs)| {
            let of = |argument: &Argument| match argument {
                Argument::Input(input) => inputs[*input],
                Argument::TimeStep => models::time_step(row),
                Argument::Rate => 0.0,
            };
            arguments.iter().map(of).collect::<Vec<f64>>()
        })
        .collect();
    let step = Step { of: "model", prepare: "", call: "sum += actuator_step(&model", behind: "" };
    timed(model, &rows, arguments.len(), &step, option)
}

/// The same of the exported inverse.
fn of_c_inverse(model: &Model, wanted: &[(f64, f64)], option: &str) -> f64 {
    let count = arguments(model).len();
    let rows: Vec<f64> =
        wanted.iter().flat_map(|(wanted, step)| [*wanted, *step].into_iter().take(count)).collect();
    let step = Step {
        of: "inverse",
        prepare: "double input = 0, output = 0;",
        call: "sum += actuator_inverse_step(&model",
        behind: ", &input, &output",
    };
    timed(model, &rows, count, &step, option)
}

fn arguments(model: &Model) -> Vec<Argument> {
    Description::of(model, RateSource::Backward, Precision::Double).arguments
}

/// How the C program makes a step.
struct Step {
    of: &'static str,
    prepare: &'static str,
    call: &'static str,
    behind: &'static str,
}

/// Nanoseconds of a row in a C program.
fn timed(model: &Model, rows: &[f64], arguments: usize, step: &Step, option: &str) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let options = Options { inverse: Some(InverseOptions::default()), ..Options::named("actuator") };
    for file in export(model, Target::C, &options).unwrap().files {
        fs::write(folder.path().join(file.path), file.content).unwrap();
    }
    let rows: Vec<u8> = rows.iter().flat_map(|value| value.to_le_bytes()).collect();
    fs::write(folder.path().join("rows"), rows).unwrap();
    fs::write(folder.path().join("driver.c"), driver(arguments, step)).unwrap();
    let compiler = ["-std=gnu99", "-O3", "-ffp-contract=off", "driver.c", "actuator.c", "actuator_inverse.c"];
    let mut command = Command::new("cc");
    let compiled =
        command.current_dir(&folder).args(compiler).args([option, "-lm", "-o", "driver"]).status().unwrap();
    assert!(compiled.success());
    let output = Command::new(Path::new(folder.path()).join("driver")).current_dir(&folder).output().unwrap();
    String::from_utf8(output.stdout).unwrap().trim().parse().unwrap()
}

fn driver(arguments: usize, step: &Step) -> String {
    let Step { of, prepare, call, behind } = step;
    let reset = if *of == "model" { "actuator_reset" } else { "actuator_inverse_reset" };
    let given: String = (0..arguments).map(|index| format!(", row[{index}]")).collect();
    format!(
        "#include <stdio.h>
#include <time.h>
#include \"actuator_inverse.h\"
static double rows[{ROWS}][{arguments}];
int main(void)
{{
    static actuator_{of} model;
    {prepare}
    double least = 1e30, sum = 0;
    FILE *file = fopen(\"rows\", \"rb\");
    if (!file || fread(rows, sizeof rows, 1, file) != 1)
        return 1;
    for (int repeat = 0; repeat < {REPEATS}; repeat++) {{
        struct timespec begin, end;
        {reset}(&model);
        clock_gettime(CLOCK_MONOTONIC, &begin);
        for (int k = 0; k < {ROWS}; k++) {{
            const double *row = rows[k];
            {call}{given}{behind});
        }}
        clock_gettime(CLOCK_MONOTONIC, &end);
        const double taken = (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
        if (taken < least)
            least = taken;
    }}
    printf(\"%.3f\\n\", sum == 1e300 ? 0 : 1e9 * least / {ROWS});
    return 0;
}}
"
    )
}

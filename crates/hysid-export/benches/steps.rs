//! Time of a step of exported C code beside the library's stepper, and time of exports: `cargo bench -p hysid-export`.

#[path = "../tests/models/mod.rs"]
mod models;

use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use hysid::{Fit, Model};
use hysid_export::description::{Argument, Description, RateSource};
use hysid_export::{Options, Precision, Target, export};
use serde_json::json;

const ROWS: usize = 10_000;
const REPEATS: usize = 7;

fn main() {
    let small = [("stops", json!(10)), ("hidden", json!(10)), ("starts", json!(1)), ("epochs", json!(20))];
    let mut xpnn = Fit::new().model("xpnn").seed(1);
    for (name, value) in small {
        xpnn = xpnn.option(name, value);
    }
    let measured =
        [("xpnn of 10 stops and 10 tanh neurons", xpnn), ("auto with its defaults", Fit::new().seed(1))];
    for (name, fit) in measured {
        let model = fit.run(&models::data(1)).unwrap();
        let (library, c) = (of_stepper(&model), of_c(&model));
        println!("{name}: Stepper::step {library:.1} ns, C {c:.1} ns, ratio {:.2}", c / library);
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

/// The same of the exported C code.
fn of_c(model: &Model) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    for file in export(model, Target::C, &Options::named("actuator")).unwrap().files {
        fs::write(folder.path().join(file.path), file.content).unwrap();
    }
    let arguments = Description::of(model, RateSource::Backward, Precision::Double).arguments;
    let rows: Vec<u8> = models::path(ROWS, 1)
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
        .flat_map(f64::to_le_bytes)
        .collect();
    fs::write(folder.path().join("rows"), rows).unwrap();
    fs::write(folder.path().join("driver.c"), driver(arguments.len())).unwrap();
    let compiler =
        ["-std=gnu99", "-O3", "-ffp-contract=off", "driver.c", "actuator.c", "-lm", "-o", "driver"];
    let compiled = Command::new("cc").current_dir(&folder).args(compiler).status().unwrap();
    assert!(compiled.success());
    let output = Command::new(Path::new(folder.path()).join("driver")).current_dir(&folder).output().unwrap();
    String::from_utf8(output.stdout).unwrap().trim().parse().unwrap()
}

fn driver(arguments: usize) -> String {
    let given: String = (0..arguments).map(|index| format!(", row[{index}]")).collect();
    format!(
        "#include <stdio.h>
#include <time.h>
#include \"actuator.h\"
static double rows[{ROWS}][{arguments}];
int main(void)
{{
    static actuator_model model;
    double least = 1e30, sum = 0;
    FILE *file = fopen(\"rows\", \"rb\");
    if (!file || fread(rows, sizeof rows, 1, file) != 1)
        return 1;
    for (int repeat = 0; repeat < {REPEATS}; repeat++) {{
        struct timespec begin, end;
        actuator_reset(&model);
        clock_gettime(CLOCK_MONOTONIC, &begin);
        for (int k = 0; k < {ROWS}; k++) {{
            const double *row = rows[k];
            sum += actuator_step(&model{given});
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

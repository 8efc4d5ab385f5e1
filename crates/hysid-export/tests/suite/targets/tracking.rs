//! Corrections by measured outputs in C: compiled without a warning, and those of the library's stepper.

use std::fs;
use std::process::Command;

use hysid_core::random::uniform;
use hysid_export::{Options, Precision, Target};

use super::c::{STRICT, compilers};
use super::case::{MODELS, NAME, StepCase, written};
use super::tools::succeeds;
use crate::models::time_step;

const ROWS: usize = 3000;

/// Reads rows of arguments and of a measured output in binary, and writes the corrected outputs.
fn driver(arguments: usize) -> String {
    let given: String = (0..arguments).map(|index| format!(", (actuator_real)row[{index}]")).collect();
    let count = arguments + 1;
    format!(
        "#include <stdio.h>
#include \"actuator_tracking.h\"
int main(void)
{{
    static actuator_model model;
    actuator_tracker tracker;
    double row[{count}];
    actuator_reset(&model);
    actuator_tracker_reset(&tracker);
    if (actuator_correct(&tracker, 1) || actuator_adapt(&tracker, 1, 100))
        return 1;
    while (fread(row, sizeof(double), {count}, stdin) == {count}) {{
        const double y = actuator_tracked(&tracker, actuator_step(&model{given}));
        const actuator_real measured = (actuator_real)row[{arguments}];
        if (actuator_adapt(&tracker, measured, 300) != actuator_correct(&tracker, measured) ||
            actuator_adapt(&tracker, measured, ACTUATOR_FEWEST_ADAPTATION_ROWS - 1))
            return 1;
        fwrite(&y, sizeof y, 1, stdout);
    }}
    return 0;
}}
"
    )
}

/// Outputs of a plant whose gain falls, with a disturbance and noise; some are missing, and the last are absurd.
fn measured(case: &StepCase, (low, high): (f64, f64), absurd: f64) -> Vec<f64> {
    let noise = |seed: u64| (high - low) * (uniform(seed) - 0.5);
    let mut disturbance = 0.0;
    let rows = case.expected.iter().enumerate();
    let measured = rows.map(|(row, output)| {
        disturbance = 0.97 * disturbance + 0.02 * noise(2 * row as u64);
        match row {
            _ if row + 50 > ROWS => absurd * noise(row as u64),
            _ if row % 50 == 20 => f64::NAN,
            _ => (1.0 - 1e-4 * row as f64) * output + disturbance + 0.02 * noise(2 * row as u64 + 1),
        }
    });
    measured.collect()
}

#[test]
fn corrected_outputs_equal_those_of_the_stepper() {
    let compilers = compilers();
    for ((number, (name, model)), compiler) in MODELS.iter().enumerate().zip(compilers.iter().cycle()) {
        // Of each kind of predictor some, all in double precision.
        for precision in
            [Precision::Double, Precision::Single].into_iter().take(1 + usize::from(number % 4 == 0))
        {
            let is_double = precision == Precision::Double;
            let mut case = StepCase::of(model, ROWS);
            let ranges = model.trained_ranges();
            let measured = measured(&case, ranges.output, if is_double { 1e300 } else { 100.0 });
            let (mut stepper, mut time) = (model.stepper(), 0.0);
            let inputs = ranges.inputs.len();
            for (row, (arguments, y)) in case.rows.iter().zip(&measured).enumerate() {
                time += time_step(row);
                case.expected[row] = stepper.step(&arguments[..inputs], time, None).unwrap();
                assert_eq!(stepper.adapt(*y, 300).is_ok(), y.is_finite());
                assert_eq!(stepper.correct(*y).is_ok(), y.is_finite());
                if row == ROWS / 2 {
                    let found = stepper.tracking();
                    assert!(found.kalman_gain > 0.0 && found.gain != 1.0, "{name}: {found:?}");
                }
            }
            case.rows.iter_mut().zip(&measured).for_each(|(row, y)| row.push(*y));
            let folder = written(model, Target::C, &Options { precision, ..Options::named(NAME) });
            fs::write(folder.path().join("driver.c"), driver(case.arguments.len())).unwrap();
            fs::write(folder.path().join("rows"), case.bytes()).unwrap();
            let files = ["actuator.c", "actuator_tracking.c", "driver.c", "-lm", "-o", "driver"];
            succeeds(Command::new(compiler).current_dir(folder.path()).args(STRICT).args(files));
            let input = fs::File::open(folder.path().join("rows")).unwrap();
            let output = succeeds(Command::new(folder.path().join("driver")).stdin(input)).stdout;
            if is_double {
                case.must_equal(name, &output);
            } else {
                // Single precision rounds the outputs of the model and the sums of a thousand products.
                let difference = case.difference(name, &output);
                println!("{name}: {difference:.1e} in single precision");
                assert!(difference < 1e-4, "{name}: {difference:e}");
            }
        }
    }
}

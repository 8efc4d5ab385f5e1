//! The functions of the Functional Mock-up Interface around the exported C code.
//!
//! A row of the model is the inputs at a communication point. `doStep` commits the row at the point where it begins.
//! Inputs that are set at a point give the output of a trial there; without new inputs the output stays that of the row
//! before.

use crate::description::Argument;
use crate::inverse::ExportedInverse;
use crate::options::FmiVersion;
use crate::subject::ExportSubject;
use crate::target::fmu::description::{FIRST_INPUT, HALF_WIDTH, MODEL_OUTPUT, OUTPUT, REACH, start_values};
use crate::target::template::filled;

/// The text of `fmi3.c` or `fmi2.c`.
pub(super) fn wrapper(subject: &ExportSubject<'_>, version: FmiVersion, token: &str) -> String {
    let functions = match version {
        FmiVersion::Three => include_str!("fmi3.c.txt"),
        FmiVersion::Two => include_str!("fmi2.c.txt"),
    };
    let name = subject.name();
    let (header, unit) = match subject.inverse() {
        None => (format!("{name}.h"), of_model(subject)),
        Some(inverse) => (format!("{name}_inverse.h"), of_inverse(subject, inverse)),
    };
    let start = start_values(subject);
    let values = start.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ");
    let head = filled(
        include_str!("head.c.txt"),
        &[
            ("@file@", version.source()),
            ("@number@", version.number()),
            ("NAME", name),
            ("@header@", &header),
            ("@token@", token),
            ("@FIRST_INPUT@", &FIRST_INPUT.to_string()),
            ("@inputs@", &start.len().to_string()),
            ("@OUTPUT@", &OUTPUT.to_string()),
            ("@start@", &values),
        ],
    );
    head + &unit + include_str!("instance.c.txt") + functions
}

/// The model as `instance.c.txt` uses it.
fn of_model(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let half_width = match subject.half_width() {
        None => String::new(),
        Some(_) => format!("#define HALF_WIDTH {HALF_WIDTH}\n#define READ_HALF_WIDTH {name}_half_width\n"),
    };
    filled(
        include_str!("model.c.txt"),
        &[
            ("@half_width@", &half_width),
            ("NAME", name),
            ("@given@", &given(&subject.description().arguments, 0)),
        ],
    )
}

/// The inverse of the model as `instance.c.txt` uses it.
fn of_inverse(subject: &ExportSubject<'_>, inverse: &ExportedInverse) -> String {
    let name = subject.name();
    let half_width = match subject.half_width() {
        None => String::new(),
        Some(_) => format!(
            "#define HALF_WIDTH {HALF_WIDTH}
#define READ_HALF_WIDTH(unit) \\
    {name}_half_width((unit)->has_trial ? &(unit)->trial.model : &(unit)->committed.model)
"
        ),
    };
    let (low, high) = inverse.limits;
    let values = [
        ("NAME", name),
        ("@start_input@", &format!("{:?}", 0f64.clamp(low, high))),
        ("@given@", &(", inputs[0]".to_string() + &given(&inverse.arguments, 1))),
    ];
    format!(
        "#define MODEL_OUTPUT {MODEL_OUTPUT}
#define REACH {REACH}
{half_width}#define model_type unit_type
#define RESET reset_unit
#define COMMIT commit_unit

"
    ) + &filled(include_str!("inverse.c.txt"), &values)
}

/// The arguments of a step behind the model, of which the first have been given.
fn given(arguments: &[Argument], first: usize) -> String {
    let mut next = first;
    let one = |argument: &Argument| match argument {
        Argument::TimeStep => ", time_step".to_string(),
        Argument::Input(_) | Argument::Rate => {
            next += 1;
            format!(", inputs[{}]", next - 1)
        }
    };
    arguments.iter().map(one).collect()
}

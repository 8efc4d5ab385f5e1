//! The functions of the Functional Mock-up Interface around the exported C code.
//!
//! A row of the model is the inputs at a communication point. `doStep` commits the row at the point where it begins.
//! Inputs that are set at a point give the output of a trial there; without new inputs the output stays that of the row
//! before.

use crate::description::Argument;
use crate::options::FmiVersion;
use crate::subject::Subject;
use crate::target::fmu::description::{FIRST_INPUT, HALF_WIDTH, OUTPUT, start_values};

/// The text of `fmi3.c` or `fmi2.c`.
pub(super) fn wrapper(subject: &Subject<'_>, version: FmiVersion, token: &str) -> String {
    let functions = match version {
        FmiVersion::Three => include_str!("fmi3.c.txt"),
        FmiVersion::Two => include_str!("fmi2.c.txt"),
    };
    let head = format!(
        "/* {file}: the Functional Mock-up Interface {number} around {name}.c. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include \"{name}.h\"

#define MODEL_TOKEN \"{token}\"
#define FIRST_INPUT {FIRST_INPUT}
#define INPUTS {inputs}
#define OUTPUT {OUTPUT}
{half_width}
typedef {name}_model model_type;
#define RESET {name}_reset
#define COMMIT {name}_commit

static const double start_values[INPUTS] = {{ {start} }};

/* A trial step with the inputs at a point, and its slope. */
static double trial_of_inputs(model_type *model, const double *inputs, double time_step, double *slope)
{{
{unused}    return {name}_trial_tangent(model{given}, slope);
}}

",
        file = version.source(),
        number = version.number(),
        name = subject.name(),
        inputs = start_values(subject).len(),
        half_width = match subject.half_width() {
            None => String::new(),
            Some(_) => format!(
                "#define HALF_WIDTH {HALF_WIDTH}\n#define READ_HALF_WIDTH {}_half_width\n",
                subject.name()
            ),
        },
        start = start_values(subject).iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", "),
        unused = match subject.description().arguments.contains(&Argument::TimeStep) {
            true => "",
            false => "    (void)time_step;\n",
        },
        given = given(subject),
    );
    head + include_str!("instance.c.txt") + functions
}

fn given(subject: &Subject<'_>) -> String {
    let mut next = 0;
    let one = |argument: &Argument| match argument {
        Argument::TimeStep => ", time_step".to_string(),
        Argument::Input(_) | Argument::Rate => {
            next += 1;
            format!(", inputs[{}]", next - 1)
        }
    };
    subject.description().arguments.iter().map(one).collect()
}

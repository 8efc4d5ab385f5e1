//! The header and the source file of the inverse of a model: `inverse.h.txt` and `inverse.c.txt` with names filled in.

use hysid_core::model::MOST_TRIALS;

use crate::description::Argument;
use crate::inverse::ExportedInverse;
use crate::manifest::token_of;
use crate::program::Precision;
use crate::subject::ExportSubject;
use crate::target::c::source::EXACT;
use crate::target::template::filled;

/// Of an inverse with a bound of the rate.
const NARROWED: &str = "/* The inputs within a way from the last one. */
static void narrowed(const NAME_inverse *inverse, real way, real *low, real *high)
{
    if (inverse->has_last) {
        const real least = inverse->last_input - way;
        const real most = inverse->last_input + way;
        *low = least > *low ? least : *low;
        *high = most < *high ? most : *high;
    }
}

";

/// The texts of both files.
pub(super) fn header_and_source(subject: &ExportSubject<'_>, inverse: &ExportedInverse) -> [String; 2] {
    let name = subject.name();
    let upper = name.to_uppercase();
    let names = inverse.argument_names();
    let number = |value: f64| literal(subject.precision(), value);
    let each = |write: &dyn Fn(&str) -> String| names.iter().map(|name| write(name)).collect::<String>();

    let facts: String = subject.facts().iter().map(|(fact, text)| format!(" * {fact}: {text}\n")).collect();
    let slew = inverse.slew.map_or(String::new(), |slew| {
        format!(
            "/* Largest change of the input in a unit of time. The first sample is free. */\n\
             #define {upper}_INVERSE_SLEW {}\n\n",
            number(slew)
        )
    });
    let trained_rate = inverse.trained_rate.map_or(String::new(), |rate| {
        format!(
            "/* Largest rate of the input in training: inputs within it are searched first, then all others. */\n\
             #define {upper}_INVERSE_TRAINED_RATE {}\n\n",
            number(rate)
        )
    });
    let narrowed = match inverse.slew.is_some() || inverse.trained_rate.is_some() {
        true => NARROWED.replace("NAME", name),
        false => String::new(),
    };
    let [low, high] = [inverse.limits.0, inverse.limits.1].map(number);
    let header = filled(
        include_str!("inverse.h.txt"),
        &[
            ("NAME", name),
            ("UPPER", &upper),
            ("@facts@", &facts),
            ("@low@", &low),
            ("@high@", &high),
            ("@slew@", &slew),
            ("@trained_rate@", &trained_rate),
            ("@tolerance@", &number(inverse.tolerance)),
            ("@accepted@", &number(inverse.accepted)),
            ("@most_trials@", &MOST_TRIALS.to_string()),
            ("@parameters@", &each(&|argument| format!(", {name}_real {argument}"))),
        ],
    );

    // The time step may be for the slew limit alone.
    let given: Vec<String> = subject.argument_names().split_off(1);
    let of_model = |write: &dyn Fn(&str) -> String| given.iter().map(|name| write(name)).collect::<String>();
    let is_invalid = |argument: &Argument| match argument {
        Argument::TimeStep => {
            " ||\n        (inverse->has_last && !(time_step > 0 && isfinite(time_step)))".to_string()
        }
        other => format!(" || !isfinite({})", other.name()),
    };
    let functions = ["fabs(", "sqrt("].map(|function| match subject.precision() {
        Precision::Double => function.to_string(),
        Precision::Single => function.replace('(', "f("),
    });
    let source = filled(
        include_str!("inverse.c.txt"),
        &[
            ("@exact@", EXACT),
            ("@token@", &token_of(&header).to_string()),
            ("NAME", name),
            ("UPPER", &upper),
            ("fabs(", &functions[0]),
            ("sqrt(", &functions[1]),
            ("@narrowed@", &narrowed),
            ("@fields@", &of_model(&|argument| format!("    real {argument};\n"))),
            ("@given@", &of_model(&|argument| format!(", s->{argument}"))),
            ("@parameters@", &each(&|argument| format!(", real {argument}"))),
            ("@invalid@", &inverse.arguments.iter().map(is_invalid).collect::<String>()),
            ("@assignments@", &of_model(&|argument| format!("    s.{argument} = {argument};\n"))),
        ],
    );
    [header, source]
}

/// A number, in parentheses if it has a sign.
pub(super) fn literal(precision: Precision, value: f64) -> String {
    let text = match precision {
        Precision::Double => format!("{value:?}"),
        Precision::Single => format!("{:?}f", Precision::single(value)),
    };
    if value.is_sign_negative() { format!("({text})") } else { text }
}

/// How to use it.
pub(super) fn usage(name: &str, inverse: &ExportedInverse) -> String {
    let further: String = inverse.argument_names().iter().map(|name| format!(", {name}")).collect();
    filled(include_str!("inverse_usage.md.txt"), &[("NAME", name), ("@further@", &further)])
}

//! C99: one header, one source file, and a program that tests both.

mod header;
mod self_test;
mod source;

use crate::export::{File, Subject};

/// The files of an export to C.
pub(crate) fn files(subject: &Subject<'_>) -> Vec<File> {
    let name = subject.name();
    vec![
        File::new(format!("{name}.h"), header::header(subject)),
        File::new(format!("{name}.c"), source::source(subject)),
        File::new(format!("{name}_test.c"), self_test::self_test(subject)),
    ]
}

/// Name of an argument of the step.
pub(crate) fn argument_names(subject: &Subject<'_>) -> Vec<String> {
    use crate::description::Argument;
    let name = |argument: &Argument| match argument {
        Argument::Input(0) => "x".to_string(),
        Argument::Input(input) => format!("x{}", input + 1),
        Argument::TimeStep => "time_step".to_string(),
        Argument::Rate => "rate".to_string(),
    };
    subject.description().arguments.iter().map(name).collect()
}

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

//! The C++ class.

use crate::description::Argument;
use crate::subject::ExportSubject;
use crate::target::template::filled;

/// The header file.
pub(super) fn header(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let upper = name.to_uppercase();
    filled(include_str!("material.h.txt"), &[("NAME", name), ("UPPER", &upper)])
}

/// The source file.
pub(super) fn source(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let upper = name.to_uppercase();
    let given = |zero: bool| -> String {
        let one = |argument: &Argument| match (argument, zero) {
            (Argument::TimeStep, true) | (Argument::Rate, true) | (Argument::Input(_), true) => ", 0.0",
            (Argument::TimeStep, false) => ", ops_Dt",
            (Argument::Rate, false) => ", strainRate",
            (Argument::Input(_), false) => ", strain",
        };
        subject.description().arguments.iter().map(one).collect()
    };
    filled(
        include_str!("material.cpp.txt"),
        &[
            ("NAME", name),
            ("@class_tag@", &class_tag(name).to_string()),
            ("UPPER", &upper),
            ("@given@", &given(false)),
            ("@at_zero@", &given(true)),
        ],
    )
}

/// A class tag from the name, between those of OpenSees and the largest number.
fn class_tag(name: &str) -> u32 {
    let hash = name.bytes().fold(5381_u32, |hash, byte| hash.wrapping_mul(33) ^ u32::from(byte));
    1_000_000 + hash % 1_000_000_000
}

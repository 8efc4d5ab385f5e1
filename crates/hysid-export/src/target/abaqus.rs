//! Abaqus: a user material (UMAT) of trusses around the C code.

use crate::description::Argument;
use crate::error::Error;
use crate::reserved;
use crate::subject::{ExportFile, ExportSubject};
use crate::target::template::filled;
use crate::target::{BackEnd, TargetFiles, c};
use crate::text::in_markdown;

pub(super) const BACK_END: BackEnd = BackEnd {
    name: "abaqus",
    has_single_precision: false,
    has_inverse: false,
    reserved: &[reserved::C],
    write,
    usage,
};

/// Kind of thing that a model is exported as.
const MATERIAL: &str = "a user material of Abaqus";

fn write(subject: &ExportSubject<'_>) -> Result<TargetFiles, Error> {
    let mut files = c::of_material(subject, MATERIAL)?;
    files.push(ExportFile::new(format!("{}_umat.c", subject.name()), material(subject)));
    Ok(files.into())
}

fn material(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let given = |argument: &Argument| match argument {
        Argument::TimeStep => ", *time_step",
        Argument::Rate => ", *time_step > 0.0 ? by_strain * increment[0] / *time_step : 0.0",
        Argument::Input(_) => ", x",
    };
    let given: String = subject.description().arguments.iter().map(given).collect();
    filled(
        include_str!("abaqus/umat.c.txt"),
        &[("NAME", name), ("UPPER", &name.to_uppercase()), ("@given@", &given)],
    )
}

fn usage(subject: &ExportSubject<'_>) -> String {
    let (name, names) = (subject.name(), subject.names());
    let (x, y) = (in_markdown(&names.inputs[0]), in_markdown(&names.output));
    // A saved state is the numbers of the state, what tells it from others, and a checksum.
    let states = (subject.program().state_len() + 2).to_string();
    let words =
        [("@x@", &*x), ("@y@", &y), ("@state_variables@", &states), ("@keyword@", "NAME"), ("NAME", name)];
    filled(include_str!("abaqus/usage.md.txt"), &words)
}

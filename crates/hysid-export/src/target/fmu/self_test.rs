//! A program that runs the test vectors with FMPy.

use crate::description::Argument;
use crate::inverse::ExportedInverse;
use crate::subject::ExportSubject;
use crate::target::template::filled;

pub(super) fn self_test(subject: &ExportSubject<'_>) -> String {
    let arguments = &subject.description().arguments;
    let time_step = arguments.iter().position(|argument| *argument == Argument::TimeStep);
    let inputs: Vec<String> = (0..arguments.len())
        .filter(|index| Some(*index) != time_step)
        .map(|index| index.to_string())
        .collect();
    let (low, high) = subject.model().trained_ranges().output;
    filled(
        include_str!("test.py.txt"),
        &[
            ("NAME", subject.name()),
            ("@scale@", &format!("{:?}", 0.5 * (high - low))),
            ("@inputs@", &inputs.join(", ")),
            ("@count@", &subject.argument_names().len().to_string()),
            ("@time_step@", &time_step.map_or("None".into(), |index| index.to_string())),
        ],
    )
}

/// The text of the program for a unit of an inverse.
pub(super) fn of_inverse(subject: &ExportSubject<'_>, inverse: &ExportedInverse) -> String {
    let time_step = inverse.arguments.iter().position(|argument| *argument == Argument::TimeStep);
    let (low, high) = subject.model().trained_ranges().output;
    filled(
        include_str!("inverse_test.py.txt"),
        &[
            ("NAME", subject.name()),
            ("@scale@", &format!("{:?}", 0.5 * (high - low))),
            ("@inputs@", &(1 + inverse.arguments.len() - usize::from(time_step.is_some())).to_string()),
            ("@time_step@", &time_step.map_or("None".into(), |place| (place + 1).to_string())),
        ],
    )
}

//! A program that runs the test vectors.

use crate::program::Precision;
use crate::subject::ExportSubject;
use crate::target::c::inverse_test::inverse_test;
use crate::target::template::filled;
use crate::vectors::Action;

/// The text of the program.
pub(super) fn self_test(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let upper = name.to_uppercase();
    let count = subject.argument_names().len();
    let (suffix, tolerance) = match subject.precision() {
        Precision::Double => ("", "1e-9"),
        Precision::Single => ("f", "1e-4"),
    };
    let number = |value: f64| match subject.precision() {
        Precision::Double => format!("{value:?}"),
        Precision::Single => format!("{:?}f", value as f32),
    };
    let rows: String = subject
        .vectors()
        .iter()
        .map(|vector| {
            let mut arguments: Vec<String> = vector.arguments.iter().map(|value| number(*value)).collect();
            arguments.resize(count, format!("0.0{suffix}"));
            let (output, tangent) = (number(vector.output), number(vector.tangent));
            let action = vector.action.name().to_uppercase();
            format!("    {{ {action}, {{ {} }}, {output}, {tangent} }},\n", arguments.join(", "))
        })
        .collect();
    let actions = [
        Action::Reset,
        Action::Trial,
        Action::Commit,
        Action::Revert,
        Action::Step,
        Action::Save,
        Action::Restore,
    ];
    let names = actions.map(|action| action.name().to_uppercase()).join(", ");
    let given: String = (0..count).map(|index| format!(", v->arguments[{index}]")).collect();
    let (low, high) = subject.model().trained_ranges().output;
    let scale = number(0.5 * (high - low));
    let (include, test, and_inverse) = match subject.inverse() {
        Some(inverse) => (
            format!("#include \"{name}_inverse.h\"\n"),
            inverse_test(subject, inverse),
            "    is_good = test_inverse() && is_good;\n",
        ),
        None => Default::default(),
    };
    filled(
        include_str!("test.c.txt"),
        &[
            ("NAME", name),
            ("@include@", &include),
            ("@names@", &names),
            ("@count@", &count.to_string()),
            ("@rows@", &rows),
            ("@test@", &test),
            ("UPPER", &upper),
            ("@scale@", &scale),
            ("@given@", &given),
            ("@tolerance@", tolerance),
            ("@and_inverse@", and_inverse),
        ],
    )
}

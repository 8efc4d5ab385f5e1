//! The header file: types, functions, and what the model is.

use crate::program::Precision;
use crate::subject::ExportSubject;
use crate::target::template::filled;

/// The text of the header file.
pub(super) fn header(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let upper = name.to_uppercase();
    let real = match subject.precision() {
        Precision::Double => "double",
        Precision::Single => "float",
    };
    let facts: String = subject.facts().iter().map(|(fact, text)| format!(" * {fact}: {text}\n")).collect();
    let state: String = subject
        .program()
        .states()
        .map(|(_, array, values)| format!("    {name}_real {array}[{}];\n", values.len()))
        .collect();
    let parameters: String =
        subject.argument_names().iter().map(|argument| format!(", {name}_real {argument}")).collect();
    let half_width = match subject.half_width() {
        Some(_) => format!(
            "/* Half the width of the prediction band at the last trial or step, in the unit of the output. */
{name}_real {name}_half_width(const {name}_model *model);

"
        ),
        None => String::new(),
    };
    filled(
        include_str!("model.h.txt"),
        &[
            ("NAME", name),
            ("@facts@", &facts),
            ("UPPER", &upper),
            ("@real@", real),
            ("@state@", &state),
            ("@parameters@", &parameters),
            ("@half_width@", &half_width),
        ],
    )
}

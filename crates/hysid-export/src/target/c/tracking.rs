//! The files that correct outputs by measured ones: `tracking.h.txt` and `tracking.c.txt` with names filled in.

use hysid_core::error::FEWEST_ADAPTATION_ROWS;
use hysid_core::model::ADAPTATION_ROWS;

use crate::program::Precision;
use crate::subject::{ExportFile, ExportSubject};
use crate::target::c::inverse::literal;
use crate::target::c::source::EXACT;
use crate::target::template::filled;

/// The header and the source file.
pub(super) fn files(subject: &ExportSubject<'_>) -> [ExportFile; 2] {
    let name = subject.name();
    let [origin, scale] = subject
        .model()
        .trained_ranges()
        .middle_and_half_width()
        .map(|value| literal(subject.precision(), value));
    let facts: String = subject.facts().iter().map(|(fact, text)| format!(" * {fact}: {text}\n")).collect();
    // Products of largest residuals must not overflow.
    let (root, largest) = match subject.precision() {
        Precision::Double => ("sqrt(", "1e100"),
        Precision::Single => ("sqrtf(", "1e15f"),
    };
    let words = [
        ("NAME", name),
        ("UPPER", &name.to_uppercase()),
        ("@facts@", &facts),
        ("@fewest@", &FEWEST_ADAPTATION_ROWS.to_string()),
        ("@rows@", &ADAPTATION_ROWS.to_string()),
        ("@exact@", EXACT),
        ("@origin@", &origin),
        ("@scale@", &scale),
        ("@largest@", largest),
        ("sqrt(", root),
    ];
    [("h", include_str!("tracking.h.txt")), ("c", include_str!("tracking.c.txt"))].map(
        |(ending, template)| ExportFile::new(format!("{name}_tracking.{ending}"), filled(template, &words)),
    )
}

//! C99: a header and a source file of the model, the same of its corrections and of its inverse, and a program that tests
//! them.

pub(crate) mod elementary;
mod header;
mod inverse;
mod inverse_test;
mod self_test;
mod source;
mod tracking;

use crate::error::Error;
use crate::reserved;
use crate::subject::{ExportFile, ExportSubject};
use crate::target::template::filled;
use crate::target::{BackEnd, TargetFiles};

pub(super) const BACK_END: BackEnd = BackEnd {
    name: "c",
    has_single_precision: true,
    has_inverse: true,
    reserved: &[reserved::C],
    write,
    usage,
};

fn write(subject: &ExportSubject<'_>) -> Result<TargetFiles, Error> {
    let mut files = sources(subject);
    files.extend(tracking::files(subject));
    files.push(test(subject));
    Ok(files.into())
}

/// The program that runs the test vectors.
pub(super) fn test(subject: &ExportSubject<'_>) -> ExportFile {
    ExportFile::new(format!("{}_test.c", subject.name()), self_test::self_test(subject))
}

/// The same files around which a material of a structural analysis is written: a force that follows from one displacement.
pub(super) fn of_material(
    subject: &ExportSubject<'_>,
    target: &'static str,
) -> Result<Vec<ExportFile>, Error> {
    let inputs = subject.names().inputs.len();
    if inputs > 1 {
        return Err(Error::Inputs { target, inputs });
    }
    if subject.model().has_inertia() {
        return Err(Error::Inertia { target });
    }
    let mut files = sources(subject);
    files.push(test(subject));
    Ok(files)
}

pub(super) fn sources(subject: &ExportSubject<'_>) -> Vec<ExportFile> {
    let name = subject.name();
    let mut files = vec![
        ExportFile::new(format!("{name}.h"), header::header(subject)),
        ExportFile::new(format!("{name}.c"), source::source(subject)),
    ];
    if let Some(inverse) = subject.inverse() {
        let [header, source] = inverse::header_and_source(subject, inverse);
        files.push(ExportFile::new(format!("{name}_inverse.h"), header));
        files.push(ExportFile::new(format!("{name}_inverse.c"), source));
    }
    files
}

fn usage(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let (inverse, more) = match subject.inverse() {
        Some(inverse) => (inverse::usage(name, inverse), format!(" {name}_inverse.c")),
        None => Default::default(),
    };
    let fast = match source::is_fused(subject) {
        true => {
            " On x86-64, `-mfma` makes the code several times faster, for processors that have this instruction. Without
one, `-DHYSID_TWO_ROUNDINGS` makes it as fast; the outputs then differ from those of Hysid by rounding."
        }
        false => "",
    };
    filled(
        include_str!("c/usage.md.txt"),
        &[
            ("NAME", name),
            ("UPPER", &name.to_uppercase()),
            ("@inverse@", &inverse),
            ("@fast@", fast),
            ("@more@", &more),
        ],
    )
}

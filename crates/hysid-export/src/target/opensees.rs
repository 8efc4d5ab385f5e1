//! OpenSees: a C++ material around the C code, and the native command where the native law is the same law.

mod material;
mod native;

use crate::error::Error;
use crate::reserved;
use crate::subject::{ExportFile, ExportSubject};
use crate::target::template::filled;
use crate::target::{BackEnd, TargetFiles, c};
use crate::text::in_markdown;

pub(super) const BACK_END: BackEnd = BackEnd {
    name: "opensees",
    has_single_precision: false,
    has_inverse: false,
    reserved: &[reserved::C, reserved::OPENSEES],
    write,
    usage,
};

/// Kind of thing that a model is exported as.
const MATERIAL: &str = "a uniaxialMaterial of OpenSees";

fn write(subject: &ExportSubject<'_>) -> Result<TargetFiles, Error> {
    let inputs = subject.names().inputs.len();
    if inputs > 1 {
        return Err(Error::Inputs { target: MATERIAL, inputs });
    }
    if subject.model().has_inertia() {
        return Err(Error::Inertia { target: MATERIAL });
    }
    let name = subject.name();
    let mut files = c::sources(subject);
    files.push(c::test(subject));
    files.push(ExportFile::new(format!("{name}Material.h"), material::header(subject)));
    files.push(ExportFile::new(format!("{name}Material.cpp"), material::source(subject)));
    if let Ok(native) = native::Native::of(subject.model()) {
        files.push(ExportFile::new(format!("{name}.tcl"), native.tcl()));
        files.push(ExportFile::new(format!("{name}.py"), native.python()));
    }
    Ok(files.into())
}

fn usage(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let model = subject.model();
    let names = subject.names();
    let (x, y) = (in_markdown(&names.inputs[0]), in_markdown(&names.output));
    let native = match native::Native::of(model) {
        Ok(native) => format!(
            "`{name}.tcl` and `{name}.py` define the material with OpenSees' own `{}`, for any OpenSees. Its law is the \
             same; it {}.\n\n{}",
            native.command(),
            "advances it by one implicit step for each change of strain, so its stress approaches that of this model as \
             the steps become small",
            native.constants()
        ),
        Err(reason) => format!("There is no native command for this model: {reason}."),
    };
    filled(
        include_str!("opensees/usage.md.txt"),
        &[("@x@", &x), ("@y@", &y), ("@native@", &native), ("NAME", name)],
    )
}

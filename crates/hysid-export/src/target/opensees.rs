//! OpenSees: a C++ material around the C code, and the native command where the native law is the same law.

mod material;
mod native;

use hysid_core::model::Model;

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

/// Turning points of the cycles that a material is compared over, as shares of half the trained range.
const TURNS: [f64; 11] = [0.25, -0.25, 0.5, -0.5, 0.5, -0.5, 1.0, -1.0, 1.0, 0.5, 1.0];

const ROWS_OF_BRANCH: usize = 50;

/// Kind of thing that a model is exported as.
const MATERIAL: &str = "a uniaxialMaterial of OpenSees";

fn write(subject: &ExportSubject<'_>) -> Result<TargetFiles, Error> {
    let name = subject.name();
    let mut files = c::of_material(subject, MATERIAL)?;
    files.push(ExportFile::new(format!("{name}Material.h"), material::header(subject)));
    files.push(ExportFile::new(format!("{name}Material.cpp"), material::source(subject)));
    let model = subject.model();
    if let Ok(native) = native::Native::of(model) {
        files.push(ExportFile::new(format!("{name}.tcl"), native.tcl()));
        files.push(ExportFile::new(format!("{name}.py"), native.python(name)));
    } else if model.rate().is_none() {
        let calibration = filled(include_str!("opensees/pinching4.py.txt"), &[("NAME", name)]);
        files.push(ExportFile::new(format!("{name}_pinching4.py"), calibration));
    }
    if model.rate().is_none() {
        files.push(ExportFile::new(format!("{name}_cycles.csv"), cycles(model)));
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
            "`{name}.tcl` and `{name}.py` define the material with OpenSees' own `{}`, for any OpenSees. {}.\n\n{}\n\n\
             `python {name}.py` drives it in OpenSeesPy along `{name}_cycles.csv`, cycles of this model over its trained \
             range, and prints how much it differs, at these steps and at a fiftieth of them. `python {name}.py TABLE.csv X \
             Y` does the same for a table that `hysid simulate` wrote.",
            native.materials().join("`, `"),
            native.agreement(),
            native.constants()
        ),
        Err(reason) if model.rate().is_some() => {
            format!("There is no native command for this model: {reason}.")
        }
        Err(reason) => format!(
            "There is no native command for this model: {reason}.\n\n\
             `python {name}_pinching4.py` (with openseespy and scipy) calibrates OpenSees' `Pinching4`, for members that \
             pinch and degrade, to `{name}_cycles.csv`, cycles of this model over its trained range. It prints the command \
             and how much it differs. `python {name}_pinching4.py TABLE.csv X Y` does the same for a table that `hysid \
             simulate` wrote."
        ),
    };
    filled(
        include_str!("opensees/usage.md.txt"),
        &[("@x@", &x), ("@y@", &y), ("@native@", &native), ("NAME", name)],
    )
}

/// Cycles of the model over its trained range, as a table: of growing amplitude, with a smaller loop at the end.
fn cycles(model: &Model) -> String {
    let (low, high) = model.trained_ranges().inputs[0];
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let mut from = model.input_transform().origin(0);
    let mut path = Vec::new();
    for turn in TURNS {
        let to = middle + turn * half;
        path.extend((1..=ROWS_OF_BRANCH).map(|row| from + (to - from) * row as f64 / ROWS_OF_BRANCH as f64));
        from = to;
    }
    let mut stepper = model.stepper();
    let row = |x: f64| Some(format!("{x:?},{:?}\n", stepper.step(&[x], 0.0, None).ok()?));
    std::iter::once("x,y\n".to_string()).chain(path.into_iter().map_while(row)).collect()
}

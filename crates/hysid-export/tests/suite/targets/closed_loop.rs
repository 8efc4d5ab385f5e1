//! The example of a control loop in C: compiled without a warning against an export, and run.

use std::path::Path;
use std::process::Command;

use hysid::Fit;
use hysid::specimens::Specimen;
use hysid_export::{InverseOptions, Options, Target};

use super::c::{STRICT, compilers};
use super::case::{NAME, written};
use super::tools::succeeds;

/// The number after a label at the beginning of a line.
fn error(printed: &str, label: &str) -> f64 {
    let line = printed.lines().find_map(|line| line.strip_prefix(label));
    line.unwrap_or_else(|| panic!("no {label} in {printed}")).trim().parse().unwrap()
}

#[test]
fn the_example_tracks_five_times_as_well_with_the_inverse() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/closed_loop.c");
    let train = Specimen::named("terfenol-actuator").unwrap().train();
    let model = Fit::new().model("modified-prandtl-ishlinskii").seed(1).run(&train).unwrap();
    let options = Options { inverse: Some(InverseOptions::default()), ..Options::named(NAME) };
    let folder = written(&model, Target::C, &options);
    for compiler in compilers() {
        let files = ["actuator.c", "actuator_inverse.c", "-lm", "-o", "loop"];
        let mut compile = Command::new(&compiler);
        succeeds(compile.current_dir(folder.path()).args(STRICT).arg("-I.").arg(&example).args(files));
        let output = succeeds(&mut Command::new(folder.path().join("loop")));
        let printed = String::from_utf8(output.stdout).unwrap();
        let (alone, both) = (error(&printed, "PI "), error(&printed, "inverse and PI "));
        assert!(both > 0.0 && both <= alone / 5.0, "{compiler}: {printed}");
    }
}

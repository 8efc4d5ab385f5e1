//! The examples of the repository: each prints what its Python twin prints, which is in the text file of its name.
//! `HYSID_WRITE=1` writes these files anew.

use std::path::Path;

#[allow(dead_code)]
#[path = "../../../../examples/classical_law.rs"]
mod classical_law;
#[allow(dead_code)]
#[path = "../../../../examples/closed_loop.rs"]
mod closed_loop;
#[allow(dead_code)]
#[path = "../../../../examples/compare.rs"]
mod compare;
#[allow(dead_code)]
#[path = "../../../../examples/diagnose.rs"]
mod diagnose;
#[allow(dead_code)]
#[path = "../../../../examples/drift.rs"]
mod drift;
#[allow(dead_code)]
#[path = "../../../../examples/identify.rs"]
mod identify;
#[allow(dead_code)]
#[path = "../../../../examples/step.rs"]
mod step;
#[allow(dead_code)]
#[path = "../../../../examples/validate.rs"]
mod validate;

fn assert_prints(name: &str, printed: hysid::Result<String>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let (text, printed) = (folder.join(name).with_extension("txt"), printed.unwrap());
    if std::env::var_os("HYSID_WRITE").is_some() {
        std::fs::write(&text, &printed).unwrap();
    }
    assert_eq!(std::fs::read_to_string(&text).unwrap(), printed);
    assert!(folder.join(name).with_extension("py").exists(), "{name} has no Python twin");
}

macro_rules! prints {
    ($($test:ident: $example:ident),*) => {
        $(#[test]
        fn $test() {
            assert_prints(stringify!($example), $example::report());
        })*
    };
}

prints!(
    a_law_with_known_parameters: classical_law, a_closed_loop: closed_loop, a_comparison: compare,
    a_diagnosis: diagnose, a_drifting_gain: drift, from_columns_to_a_file: identify, sample_by_sample: step, a_cross_validation: validate
);

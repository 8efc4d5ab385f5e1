//! One target under libFuzzer: the environment variable `HYSID_FUZZ_TARGET` names it, `HYSID_FUZZ_SEEDS` the folder
//! that its seeds are written to.
#![no_main]

use std::path::Path;
use std::sync::LazyLock;

use hysid_fuzz::{Target, target};
use libfuzzer_sys::fuzz_target;

static TARGET: LazyLock<&'static Target> = LazyLock::new(|| {
    let name = std::env::var("HYSID_FUZZ_TARGET").expect("HYSID_FUZZ_TARGET names a target");
    target(&name).expect("HYSID_FUZZ_TARGET names a target")
});

/// Writes the inputs that are made rather than stored to the folder that libFuzzer reads first.
fn write_seeds() {
    let Some(folder) = std::env::var_os("HYSID_FUZZ_SEEDS") else { return };
    for (number, seed) in (TARGET.seeds)().iter().enumerate() {
        let path = Path::new(&folder).join(format!("seed-{number:03}"));
        std::fs::write(path, seed).expect("the folder of the seeds can be written");
    }
}

fuzz_target!(
    init: write_seeds(),
    |data: &[u8]| {
        (TARGET.run)(data);
    }
);

//! One target under libFuzzer: the environment variable `HYSID_FUZZ_TARGET` names it.
#![no_main]

use std::sync::LazyLock;

use hysid_fuzz::{Target, target};
use libfuzzer_sys::fuzz_target;

static TARGET: LazyLock<&'static Target> = LazyLock::new(|| {
    let name = std::env::var("HYSID_FUZZ_TARGET").expect("HYSID_FUZZ_TARGET names a target");
    target(&name).expect("HYSID_FUZZ_TARGET names a target")
});

fuzz_target!(|data: &[u8]| {
    (TARGET.run)(data);
});

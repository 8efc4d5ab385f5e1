//! Fuzz targets: functions of any bytes that must neither panic nor run for ever, and what holds of their results.
//!
//! One set of targets serves two drivers: the seeded one of this crate (`cargo run --profile fuzz -p hysid-fuzz`, stable
//! toolchain, repeatable), and libFuzzer with coverage (`fuzz/coverage/run TARGET`).

mod bytes;
mod checkpoint;
mod container;
mod differential;
pub mod driver;
mod fixtures;
mod model_file;
pub mod mutation;
mod options;
mod scalar;
mod steps;
mod table;

/// A function of any bytes, and bytes to begin with.
pub struct Target {
    /// Its name, also of its folder in `fuzz/corpus`.
    pub name: &'static str,
    /// Panics where something does not hold.
    pub run: fn(&[u8]),
    /// Inputs that are made rather than stored.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Words that inputs are made of.
    pub words: &'static [&'static str],
}

/// All targets.
pub const TARGETS: [Target; 7] = [
    Target { name: "table", run: table::run, seeds: table::seeds, words: &table::WORDS },
    Target { name: "model_file", run: model_file::run, seeds: model_file::seeds, words: &NUMBERS },
    Target { name: "checkpoint", run: checkpoint::run, seeds: checkpoint::seeds, words: &[] },
    Target { name: "container", run: container::run, seeds: container::seeds, words: &[] },
    Target { name: "options", run: options::run, seeds: options::seeds, words: &NUMBERS },
    Target { name: "steps", run: steps::run, seeds: steps::seeds, words: &[] },
    Target { name: "differential", run: differential::run, seeds: differential::seeds, words: &[] },
];

/// Numbers at which arithmetic is likely to fail.
pub const NUMBERS: [&str; 20] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "0.5",
    "1e308",
    "-1e308",
    "1e-308",
    "5e-324",
    "1e100",
    "1e101",
    "1e50",
    "1e-150",
    "4294967296",
    "18446744073709551615",
    "null",
    "true",
    "[]",
    "\"\"",
];

/// The target of a name.
pub fn target(name: &str) -> Option<&'static Target> {
    TARGETS.iter().find(|target| target.name == name)
}

/// An error is one line that says something.
fn assert_is_one_line(error: &str) {
    assert!(!error.trim().is_empty() && !error.contains('\n'), "no line of text: {error:?}");
}

//! Products and sums in one rounding in C: by the instruction, by the C library and in software, which are equal to the
//! last bit.

use std::fs;
use std::process::Command;

use hysid_export::{Options, Target};

use super::c::{OUTPUTS, STRICT, compilers, driver};
use super::case::{MODELS, NAME, StepCase, written};
use super::tools::succeeds;

/// Kinds of models whose kernels fuse, and one that has some of them as members.
const FUSING: [&str; 6] =
    ["gpnn", "xpnn ", "xpnn+", "duhem-nn", "hysteretic-oscillator starts=1 epochs=3", "auto"];

fn has_instruction() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

/// Options of compilers, each with the way that products and sums then go.
fn ways() -> Vec<&'static [&'static str]> {
    let in_software: &[&str] = &["-DHYSID_SOFTWARE_FMA"];
    let with_instruction: [&[&str]; 3] = [
        &["-mfma"],
        &["-O3", "-march=native", "-ffp-contract=off"],
        &["-O3", "-mfma", "-DHYSID_SOFTWARE_FMA"],
    ];
    let with_instruction = with_instruction.into_iter().filter(|_| has_instruction());
    [&[], in_software].into_iter().chain(with_instruction).collect()
}

#[test]
fn outputs_do_not_depend_on_the_instruction() {
    for kind in FUSING {
        let (name, model) = MODELS.iter().find(|(name, _)| name.starts_with(kind)).unwrap();
        let case = StepCase::of(model, 2000);
        let folder = written(model, Target::C, &Options::named(NAME));
        fs::write(folder.path().join("driver.c"), driver(case.arguments.len(), OUTPUTS)).unwrap();
        let input = folder.path().join("rows");
        fs::write(&input, case.bytes()).unwrap();
        let outputs = |compiler: &str, way: &[&str]| -> Vec<u8> {
            let mut command = Command::new(compiler);
            command.current_dir(folder.path()).args(STRICT).args(way);
            succeeds(command.args(["actuator.c", "driver.c", "-lm", "-o", "driver"]));
            let mut run = Command::new(folder.path().join("driver"));
            succeeds(run.stdin(fs::File::open(&input).unwrap())).stdout
        };
        for compiler in compilers() {
            for way in ways() {
                case.must_equal(&format!("{name}, {compiler} {way:?}"), &outputs(&compiler, way));
            }
        }
        println!("{name}: {} ways are equal", compilers().len() * ways().len());
        let difference = case.difference(name, &outputs("gcc", &["-DHYSID_TWO_ROUNDINGS"]));
        println!("{name}: {difference:.1e} with two roundings");
        assert!(difference > 0.0 && difference < 1e-12, "{name}: {difference:e}");
    }
}

/// Compares with the function of the C library over numbers of random bits, terms that nearly cancel, ties, small results
/// and special numbers.
const COMPARED: &str = include_str!("programs/fused.c.txt");

#[test]
fn products_and_sums_in_software_are_rounded_once() {
    if !cfg!(all(target_os = "linux", target_env = "gnu")) {
        return;
    }
    let model = &MODELS.iter().find(|(name, _)| name.starts_with("pnn")).unwrap().1;
    let folder = written(model, Target::C, &Options::named(NAME));
    fs::write(folder.path().join("compared.c"), COMPARED).unwrap();
    for compiler in compilers() {
        for level in ["-O0", "-O2", "-O3"] {
            let files = ["-std=gnu99", level, "compared.c", "-lm", "-o", "compared"];
            succeeds(Command::new(&compiler).current_dir(folder.path()).args(files));
            succeeds(&mut Command::new(folder.path().join("compared")));
        }
    }
}

//! States of exported models that came from elsewhere: damaged, forged, or of another model.

use std::fs;
use std::path::Path;
use std::process::Command;

use hysid::Model;
use hysid_export::{InverseOptions, Options, Target};

use super::case::{MODELS, NAME, StepCase, write, written};
use super::tools::{at_length, gcc, succeeds};

/// Models whose states have counters, and those whose loops depend on the state.
const WITH_COUNTERS: [&str; 7] =
    ["masing", "preisach of", "neuro-madelung", "peak-oriented", "menegotto-pinto", "jiles-atherton", "auto"];

/// Those, or all kinds where the laboratory tests at length.
fn models() -> impl Iterator<Item = &'static (String, Model)> {
    let all = at_length();
    MODELS.iter().filter(move |(label, _)| all || WITH_COUNTERS.iter().any(|name| label.starts_with(name)))
}

fn run(folder: &Path, sources: &[&str]) {
    let Some(compiler) = gcc() else { return };
    let flags = ["-std=c99", "-O1", "-g", "-fsanitize=undefined,address", "-fno-sanitize-recover=all"];
    let command = &mut Command::new(compiler);
    succeeds(command.current_dir(folder).args(flags).args(sources).args(["-lm", "-o", "states"]));
    succeeds(Command::new(folder.join("states")).current_dir(folder));
}

/// A program that restores a saved state with each of its bytes changed, which must be refused, and then makes steps from
/// states that have any numbers.
fn program(arguments: usize) -> String {
    let given = ", 0.5".repeat(arguments.saturating_sub(1));
    include_str!("programs/states.c.txt").replace("@given@", &given)
}

#[test]
fn damaged_states_are_refused_and_forged_ones_write_nowhere_else() {
    let mut count = 0;
    for (label, model) in models() {
        let folder = written(model, Target::C, &Options::named(NAME));
        fs::write(folder.path().join("main.c"), program(StepCase::of(model, 1).arguments.len())).unwrap();
        run(folder.path(), &["actuator.c", "main.c"]);
        println!("{label}");
        count += 1;
    }
    assert!(count >= WITH_COUNTERS.len(), "{count} models");
}

#[test]
fn a_state_of_another_model_is_refused_and_an_inverse_keeps_its_limits() {
    let [first, second] = [0, 1].map(|place| models().nth(place).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let inverse = InverseOptions { limits: Some((-1.0, 1.0)), slew: Some(0.1) };
    for (name, model) in [("one", &first.1), ("two", &second.1)] {
        let options = Options { inverse: Some(inverse), ..Options::named(name) };
        write(model, Target::C, &options, folder.path());
    }
    let main = include_str!("programs/other_model.c.txt");
    fs::write(folder.path().join("main.c"), main).unwrap();
    run(folder.path(), &["one.c", "one_inverse.c", "two.c", "two_inverse.c", "main.c"]);

    // Inverses of the same model under the same name, with other limits or another slew.
    let main = include_str!("programs/other_limits.c.txt");
    let others = [
        (inverse, 1),
        (InverseOptions { limits: Some((-1.0, 3.0)), ..inverse }, 0),
        (InverseOptions { slew: Some(0.2), ..inverse }, 0),
    ];
    for (other, is_same) in others {
        let options = Options { inverse: Some(other), ..Options::named("one") };
        let sibling = written(&first.1, Target::C, &options);
        fs::write(sibling.path().join("main.c"), format!("#define IS_SAME {is_same}\n{main}")).unwrap();
        fs::copy(folder.path().join("state.bin"), sibling.path().join("state.bin")).unwrap();
        run(sibling.path(), &["one.c", "one_inverse.c", "main.c"]);
    }
}

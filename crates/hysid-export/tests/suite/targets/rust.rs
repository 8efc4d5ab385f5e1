//! Exports to Rust.

use std::fs;
use std::process::Command;

use hysid_export::{Options, Precision, Target};

use super::case::{Case, MODELS, NAME, written};
use super::tools::{succeeds, tool};

/// Reads rows of arguments in binary, writes outputs in binary.
fn driver(arguments: usize) -> String {
    let given = (0..arguments).map(|index| format!("a[{index}]")).collect::<Vec<_>>().join(", ");
    format!(
        "use std::io::{{Read, Write}};
fn main() {{
    let mut model = exported::actuator::Model::new();
    let (mut rows, mut outputs) = (Vec::new(), Vec::new());
    std::io::stdin().read_to_end(&mut rows).unwrap();
    for row in rows.chunks_exact(8 * {arguments}) {{
        let a: Vec<f64> = row.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
        outputs.extend(model.step({given}).to_le_bytes());
    }}
    std::io::stdout().write_all(&outputs).unwrap();
}}
"
    )
}

#[test]
fn outputs_equal_those_of_the_library_without_the_standard_library() {
    const ROWS: usize = 20_000;
    let Some(compiler) = tool("exports to Rust", "rustc", &["--version"], "see https://rustup.rs") else {
        return;
    };
    for (name, model) in MODELS.iter() {
        let folder = tempfile::tempdir().unwrap();
        written(model, Target::Rust, &Options::named(NAME), folder.path());
        let case = Case::of(model, ROWS);
        fs::write(folder.path().join("exported.rs"), "#![no_std]\npub mod actuator;\n").unwrap();
        fs::write(folder.path().join("driver.rs"), driver(case.arguments.len())).unwrap();
        let rustc = || {
            let mut command = Command::new(&compiler);
            command.current_dir(&folder).args(["--edition=2021", "-O", "-D", "warnings"]);
            command
        };
        succeeds(rustc().args(["--crate-type=rlib", "exported.rs"]));
        succeeds(rustc().args(["--extern", "exported=libexported.rlib", "driver.rs"]));
        let input = folder.path().join("rows");
        fs::write(&input, case.bytes()).unwrap();
        let output =
            succeeds(Command::new(folder.path().join("driver")).stdin(fs::File::open(&input).unwrap()));
        case.must_equal(name, &output.stdout);
    }
}

#[test]
fn test_vectors_agree_in_both_precisions() {
    let Some(compiler) = tool("exports to Rust", "rustc", &["--version"], "see https://rustup.rs") else {
        return;
    };
    for (name, model) in MODELS.iter() {
        for precision in [Precision::Double, Precision::Single] {
            let folder = tempfile::tempdir().unwrap();
            let options = Options { precision, ..Options::named(NAME) };
            written(model, Target::Rust, &options, folder.path());
            let arguments = ["--edition=2021", "-D", "warnings", "actuator_test.rs"];
            succeeds(Command::new(&compiler).current_dir(&folder).args(arguments));
            let output = succeeds(&mut Command::new(folder.path().join("actuator_test")));
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            assert!(text.starts_with("0 of "), "{name}, {precision:?}: {text}");
        }
    }
}

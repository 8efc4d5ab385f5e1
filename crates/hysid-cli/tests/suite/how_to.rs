//! Pages of `docs` as a reader follows them: every line of a `sh` block that calls `hysid`, a compiler, or a program of the
//! folder is run, in order, in a folder of the page's own. Each page is a test of its own.

use std::fs;
use std::path::{Path, PathBuf};

use crate::workbench::Workbench;

/// How the lines begin that are run.
const PROGRAMS: [&str; 3] = ["hysid ", "cc ", "./"];

/// The commands of a page.
fn commands(page: &str) -> Vec<&str> {
    let mut inside = false;
    let mut commands = Vec::new();
    for line in page.lines() {
        if line.starts_with("```") {
            inside = line == "```sh";
        } else if inside && PROGRAMS.iter().any(|program| line.starts_with(program)) {
            commands.push(line);
        }
    }
    commands
}

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

/// Runs the commands of a page, with the files that it tells its reader to copy.
fn follow(path: &str) {
    let bench = Workbench::new();
    bench.put("testing-machine.csv", include_str!("../files/testing-machine.csv"));
    bench.put("closed_loop.c", include_str!("../../../../examples/closed_loop.c"));
    if path.starts_with("tutorials/") {
        for entry in fs::read_dir(docs().join("tutorials/data")).unwrap() {
            let file = entry.unwrap().path();
            bench.put(&file.file_name().unwrap().to_string_lossy(), fs::read(&file).unwrap());
        }
    }
    let page = fs::read_to_string(docs().join(path)).unwrap();
    let commands = commands(&page);
    assert!(!commands.is_empty(), "{path} has no command");
    for command in commands {
        let ran = bench.shell(command);
        assert_eq!(ran.status, Some(0), "{path}: `{command}`: {}", ran.stderr);
    }
}

macro_rules! pages {
    ($($test:ident: $path:literal),* $(,)?) => {
        /// The pages that are followed.
        const PAGES: &[&str] = &[$($path),*];

        $(#[test]
        fn $test() {
            follow($path);
        })*
    };
}

pages! {
    closed_loop: "how-to/closed-loop.md",
    compensate_hysteresis: "how-to/compensate-hysteresis.md",
    cycles: "cycles.md",
    diagnose: "how-to/diagnose.md",
    export_as_fmu: "how-to/export-as-fmu.md",
    export_to_c: "how-to/export-to-c.md",
    export_to_matlab: "how-to/export-to-matlab.md",
    export_to_onnx: "how-to/export-to-onnx.md",
    export_to_opensees: "how-to/export-to-opensees.md",
    export_to_python: "how-to/export-to-python.md",
    figures_for_a_paper: "how-to/figures-for-a-paper.md",
    how_far_to_trust: "how-to/how-far-to-trust.md",
    initial_state: "how-to/initial-state.md",
    magnetics: "tutorials/magnetics.md",
    piezo_control: "tutorials/piezo-control.md",
    plan: "plan.md",
    questions: "questions.md",
    read_files: "how-to/read-files.md",
    reproduce_the_paper: "how-to/reproduce-the-paper.md",
    restoring_force: "how-to/restoring-force.md",
    structures: "tutorials/structures.md",
    synthetic_specimen: "how-to/synthetic-specimen.md",
}

#[test]
fn every_page_with_commands_is_followed() {
    for folder in ["how-to", "tutorials"] {
        for entry in fs::read_dir(docs().join(folder)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            let path = format!("{folder}/{name}");
            if name.ends_with(".md") && !commands(&fs::read_to_string(docs().join(&path)).unwrap()).is_empty()
            {
                assert!(PAGES.contains(&path.as_str()), "{path} is not among the pages");
            }
        }
    }
}

#[test]
fn only_lines_of_shell_blocks_are_commands() {
    let page = "hysid a\n```sh\nhysid b\ncargo c\n  hysid d\n```\nhysid e\n```json\nhysid f\n```\n```sh\nhysid g # h\n```\n";
    assert_eq!(commands(page), ["hysid b", "hysid g # h"]);
}

//! Pages of `docs` as a reader follows them: every line of a `sh` block that calls `hysid`, a compiler, or a program of the
//! folder is run, in order, in a folder of the page's own. Each page is a test of its own. Every line of a `text` block must
//! be among the lines that these commands print: the same words, and numbers that are near enough.

use std::fs;
use std::path::{Path, PathBuf};

use crate::workbench::Workbench;

/// How the lines begin that are run.
const PROGRAMS: [&str; 3] = ["hysid ", "cc ", "./"];

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

/// How far a number on a page may be from the printed one, as a share of the larger: fits end elsewhere on another processor.
const NEAR: f64 = 0.25;

/// The lines of the `text` blocks of a page, without those that say that something is left out.
fn shown(page: &str) -> Vec<&str> {
    let blocks = page.split("\n```text\n").skip(1).filter_map(|rest| rest.split_once("\n```"));
    let lines = blocks.flat_map(|(block, _)| block.lines());
    lines.filter(|line| !line.trim().is_empty() && !line.trim().starts_with("...")).collect()
}

/// True for lines of the same words, with numbers that are near each other.
fn is_alike(shown: &str, printed: &str) -> bool {
    let number = |word: &str| {
        let bare = word.trim_matches(|c: char| "(),.;:%".contains(c)).replace('−', "-");
        bare.parse::<f64>().ok()
    };
    let are_alike = |(shown, printed): (&str, &str)| match (number(shown), number(printed)) {
        (Some(a), Some(b)) => (a - b).abs() <= NEAR * a.abs().max(b.abs()),
        _ => shown == printed,
    };
    let (shown, printed): (Vec<_>, Vec<_>) =
        (shown.split_whitespace().collect(), printed.split_whitespace().collect());
    shown.len() == printed.len() && shown.into_iter().zip(printed).all(are_alike)
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
    let mut printed = String::new();
    for command in commands {
        let ran = bench.shell(command);
        assert_eq!(ran.status, Some(0), "{path}: `{command}`: {}", ran.stderr);
        printed += &format!("{}\n{}\n", ran.stdout, ran.stderr);
    }
    let is_printed = |line: &&str| printed.lines().any(|printed| is_alike(line, printed));
    let others: Vec<&str> = shown(&page).into_iter().filter(|line| !is_printed(line)).collect();
    assert!(
        others.is_empty(),
        "{path} shows what no command prints:\n{}\n--- printed:\n{printed}",
        others.join("\n")
    );
}

macro_rules! pages {
    ($($test:ident: $path:literal),* $(,)?) => {
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
fn lines_are_alike_whose_words_are_equal_and_whose_numbers_are_near() {
    assert!(is_alike("loss  at 5 Hz: 97.2 J/m3", "loss at 5 Hz: 97.18   J/m3"));
    for other in
        ["loss at 5 Hz: 150 J/m3", "loss at 5 Hz: 97.18 W/m3", "loss at 5 Hz: 97.18", "loss at 5 Hz: no J/m3"]
    {
        assert!(!is_alike("loss at 5 Hz: 97.2 J/m3", other), "{other}");
    }
    assert_eq!(shown("a\n```text\nb 1\n...\n\nc\n```\nd\n```sh\ne\n```\n"), ["b 1", "c"]);
}

#[test]
fn only_lines_of_shell_blocks_are_commands() {
    let page = "hysid a\n```sh\nhysid b\ncargo c\n  hysid d\n```\nhysid e\n```json\nhysid f\n```\n```sh\nhysid g # h\n```\n";
    assert_eq!(commands(page), ["hysid b", "hysid g # h"]);
}

//! The pages of `docs/how-to` and `docs/tutorials`, `docs/cycles.md`, `docs/plan.md` and `docs/questions.md` as a reader
//! follows them: every line of a `sh` block that calls `hysid`, a compiler, or a program of the folder is run, in order,
//! in a folder of the page's own.
#![cfg(unix)]

mod workbench;

use std::fs;
use std::path::{Path, PathBuf};

use workbench::Workbench;

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

/// Pages in Markdown of a folder of `docs`.
fn pages(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(docs().join(folder)).unwrap().map(|entry| entry.unwrap().path());
    let pages: Vec<_> = entries.filter(|path| path.extension().is_some_and(|end| end == "md")).collect();
    assert!(!pages.is_empty(), "{folder}");
    pages
}

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

/// Runs the commands of a page in this folder.
fn follow(path: &Path, bench: &Workbench) {
    let page = fs::read_to_string(path).unwrap();
    let commands = commands(&page);
    assert!(!commands.is_empty(), "{} has no command", path.display());
    for command in commands {
        let ran = bench.shell(command);
        assert_eq!(ran.status, Some(0), "{}: `{command}`: {}", path.display(), ran.stderr);
    }
}

#[test]
fn every_command_of_every_page_works() {
    let single = ["cycles.md", "plan.md", "questions.md"].map(|page| docs().join(page));
    for path in pages("how-to").into_iter().chain(single) {
        let bench = Workbench::new();
        bench.put("testing-machine.csv", include_str!("files/testing-machine.csv"));
        // A page tells its reader to copy it.
        bench.put("closed_loop.c", include_str!("../../../examples/closed_loop.c"));
        follow(&path, &bench);
    }
}

/// A page of Python alone has no command; a test of the Python package runs it.
#[test]
fn every_command_of_every_tutorial_works() {
    for path in pages("tutorials") {
        let page = fs::read_to_string(&path).unwrap();
        if page.contains("```python") && commands(&page).is_empty() {
            continue;
        }
        let bench = Workbench::new();
        // A page tells its reader to copy the data.
        for entry in fs::read_dir(docs().join("tutorials/data")).unwrap() {
            let file = entry.unwrap().path();
            bench.put(&file.file_name().unwrap().to_string_lossy(), fs::read(&file).unwrap());
        }
        follow(&path, &bench);
    }
}

#[test]
fn only_lines_of_shell_blocks_are_commands() {
    let page = "hysid a\n```sh\nhysid b\ncargo c\n  hysid d\n```\nhysid e\n```json\nhysid f\n```\n```sh\nhysid g # h\n```\n";
    assert_eq!(commands(page), ["hysid b", "hysid g # h"]);
}

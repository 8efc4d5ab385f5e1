//! The pages of `docs/how-to`, `docs/cycles.md` and `docs/plan.md` as a reader follows them: every line of a `sh` block that calls `hysid`, a compiler, or a
//! program of the folder is run, in order, in a folder of the page's own.
#![cfg(unix)]

mod workbench;

use std::fs;
use std::path::Path;

use workbench::Workbench;

/// How the lines begin that are run.
const PROGRAMS: [&str; 4] = ["hysid ", "cc ", "rustc ", "./"];

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

#[test]
fn every_command_of_every_page_works() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/how-to");
    let pages = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let pages = pages.chain(["../cycles.md", "../plan.md"].map(|page| folder.join(page)));
    let pages: Vec<_> = pages.filter(|path| path.extension().is_some_and(|end| end == "md")).collect();
    assert!(!pages.is_empty());
    for path in pages {
        let page = fs::read_to_string(&path).unwrap();
        let commands = commands(&page);
        assert!(!commands.is_empty(), "{} has no command", path.display());
        let bench = Workbench::new();
        bench.put("testing-machine.csv", include_str!("files/testing-machine.csv"));
        // A page tells its reader to copy it.
        bench.put("closed_loop.c", include_str!("../../../examples/closed_loop.c"));
        for command in commands {
            let ran = bench.shell(command);
            assert_eq!(ran.status, Some(0), "{}: `{command}`: {}", path.display(), ran.stderr);
        }
    }
}

#[test]
fn only_lines_of_shell_blocks_are_commands() {
    let page = "hysid a\n```sh\nhysid b\ncargo c\n  hysid d\n```\nhysid e\n```json\nhysid f\n```\n```sh\nhysid g # h\n```\n";
    assert_eq!(commands(page), ["hysid b", "hysid g # h"]);
}

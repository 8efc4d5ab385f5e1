//! Each rule fires on a made-up bad example, and only on what is bad in it.

use super::*;

const SOURCE: &str = "crates/hysid-core/src/operator/stop.rs";

/// The lines of the violations.
fn lines(violations: Vec<Violation>) -> Vec<usize> {
    violations.into_iter().map(|v| v.line).collect()
}

fn set<const N: usize>(names: [&str; N]) -> BTreeSet<String> {
    names.map(str::to_owned).into()
}

#[test]
fn a_violation_reads_path_line_what() {
    let found = clean_whitespace("a/b.rs", "fine\nbad ");
    assert_eq!(found[0].to_string(), "a/b.rs:2: whitespace at the end of the line");
}

#[test]
fn tabs_and_trailing_whitespace_are_refused() {
    let text = "fine\n\ttab\nspace \nboth\t\ncarriage return\r\n";
    assert_eq!(lines(clean_whitespace("a.md", text)), [2, 3, 4, 4, 5]);
    assert_eq!(clean_whitespace("a.md", "fine\n\n  fine\n"), []);
}

#[test]
fn tables_elsewhere_are_refused() {
    assert!(table_in_its_place("out.csv").is_some());
    assert!(table_in_its_place("crates/hysid/src/loops.mat").is_some());
    assert!(table_in_its_place("docs/tutorials/data/sheet.csv").is_none());
    assert!(table_in_its_place("docs/files.md").is_none());
}

#[test]
fn marks_of_unfinished_work_are_refused() {
    for mark in LEFT_TO_DO {
        let text = format!("fine\n// {mark}: later\n{mark}S_IN_WORDS = 1");
        assert_eq!(lines(nothing_left_to_do("a.toml", &text)), [2], "{mark}");
    }
}

#[test]
fn long_sources_are_refused() {
    let longest = "x\n".repeat(LONGEST_SOURCE);
    let too_long = "x\n".repeat(LONGEST_SOURCE + 1);
    assert_eq!(length("a.rs", &longest), []);
    assert_eq!(lines(length("a.rs", &too_long)), [LONGEST_SOURCE + 1]);
    assert_eq!(length("a.md", &too_long), []);
}

#[test]
fn empty_names_of_files_and_folders_are_refused() {
    for name in EMPTY_NAMES {
        assert_eq!(lines(telling_name(&format!("src/{name}.rs"))), [1]);
        assert_eq!(lines(telling_name(&format!("tests/{name}/mod.rs"))), [1]);
    }
    assert_eq!(telling_name("src/utility.rs"), []);
}

#[test]
fn empty_names_of_modules_are_refused() {
    for name in EMPTY_NAMES {
        let text = format!("// mod {name};\npub mod {name};\nmod {name}_of_sine {{}}\n");
        assert_eq!(lines(telling_module_names("a.rs", &text)), [2], "{name}");
    }
}

#[test]
fn impure_library_code_is_refused() {
    let bad = [
        "unsafe { x.get_unchecked(0) }",
        r#"println!("{x}");"#,
        r#"eprintln!("{x}");"#,
        r#"print!("{x}");"#,
        r#"eprint!("{x}");"#,
        "dbg!(x);",
        "use std::fs;",
        "fs::write(path, x)",
        "use std::time::{Duration, Instant};",
        "std::time::SystemTime::now()",
    ];
    for ((pattern, _), line) in EFFECTS.iter().zip(bad) {
        let text = format!("fn a() {{}}\n{line}\n");
        let found = pure_library(SOURCE, &text);
        let what = format!("`{pattern}`");
        assert!(found.iter().all(|v| v.line == 2), "{line}");
        assert!(found.iter().any(|v| v.what.starts_with(&what)), "{line}");
        assert_eq!(pure_library("crates/hysid-cli/src/main.rs", &text), []);
    }
}

#[test]
fn a_place_of_the_library_may_have_the_effects_that_are_listed() {
    let text = "use std::fs;\nlet now = Instant::now();\nprintln!();\n";
    assert_eq!(lines(pure_library("crates/hysid-files/src/lock.rs", text)), [2, 3]);
    assert_eq!(lines(pure_library("crates/hysid-studio/src/view.rs", text)), [3]);
    assert_eq!(lines(pure_library("crates/hysid/src/builder.rs", text)), [1, 3]);
}

#[test]
fn comments_strings_and_longer_words_do_not_make_the_library_impure() {
    let text =
        "//! println!(\"{}\", x);\n#![forbid(unsafe_code)]\nlet s = \"unsafe\"; /* dbg! */\nlet fs = 1.0;\n";
    assert_eq!(pure_library(SOURCE, text), []);
}

#[test]
fn citations_of_absent_equations_are_refused() {
    let equations = set(["1.2", "1.3"]);
    // Filled in here, or these lines would be citations themselves.
    let text = "fine {} (1.2)\nbad {} (1.4).\n`docs/{}` (1.3), (1.5)\n{} has others (7.7)\n"
        .replace("{}", "theory.md");
    assert_eq!(lines(equations_exist(SOURCE, &text, &equations)), [2, 3]);
}

#[test]
fn citations_may_list_several_equations() {
    let line = "// {} (1.2), (1.3) and (2.10); see (9.9)".replace("{}", "theory.md");
    assert_eq!(cited_equations(&line), ["1.2", "1.3", "2.10"]);
}

#[test]
fn only_lines_of_code_blocks_that_end_with_a_number_define_equations() {
    let text = "By (1.1)\n```\np = x - ε    (1.2)\nthe same as (1.3) says\nf(x)\n```\n(1.4)\n";
    assert_eq!(equations(text), set(["1.2"]));
}

#[test]
fn an_equation_number_is_given_once() {
    let text = "```\na = b (1.1)\n```\nand\n```\nc = d (1.1)\n```\n";
    assert_eq!(lines(equations_unique(THEORY, text)), [6]);
}

#[test]
fn broken_links_are_refused() {
    let paths = set(["README.md", "docs/theory.md", "docs/how-to/fit.md"]);
    let text = "\
[good](../theory.md#operators) and [bad](theory.md)
[good](https://example.org/a.md), [good](#here), [good](mailto:a@example.org)
![bad](fit.svg \"a title\")
`[code](nowhere.md)`
```
[code](nowhere.md)
```
[bad]: nowhere.md
[good folder](../) [bad, outside](../../../elsewhere)
";
    let found = links_lead_somewhere("docs/how-to/fit.md", text, &paths);
    assert_eq!(lines(found), [1, 3, 8, 9]);
    let found = links_lead_somewhere("README.md", "[bad](docs/nothing.md)", &paths);
    assert_eq!(lines(found), [1]);
    assert_eq!(links_lead_somewhere("benchmarks/notes.md", "[bad](nowhere.md)", &paths), []);
}

#[test]
fn a_version_unknown_to_the_changelog_is_refused() {
    let manifest = "[workspace.package]\nversion = \"0.2.0\"\n[dependencies]\nversion = \"9\"\n";
    let found = version_in_changelog(manifest, "# Changelog\n\n## 0.1.0\n");
    assert_eq!(found[0].path, "CHANGELOG.md");
    assert_eq!(version_in_changelog(manifest, "## 0.2.0 (2026-03-01)\n"), []);
    assert_eq!(version_in_changelog(manifest, "## [0.2.0]\n"), []);
    assert_eq!(version_in_changelog(manifest, "## Unreleased\n"), []);
    assert_eq!(lines(version_in_changelog("", "## Unreleased\n")), [1]);
}

//! `cases` and `verdicts` with a stub in the place of `hysid`: a shell script that answers by the name of the case.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};
use std::thread;
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// `hysid compare CASE/train.csv --test CASE/test.csv ...` and `hysid diagnose CASE/train.csv ...`
const STUB: &str = r#"#!/bin/sh
if [ "$1" = --version ]; then echo "hysid 1.2.3"; exit; fi
echo "$@" >> "${0%/*}/asked"
case "$1 $2" in
diagnose*/fine/*) echo '{"properties": [{"name": "masing", "verdict": "no", "index": 0.4}], "doctor": [{"statement": "it drifts"}]}'; exit;;
diagnose*) echo "error: train.csv, line 3: is no number" >&2; exit 1;;
esac
[ -f "$2" ] && [ -f "$4" ] || exit 1
case "$2" in
*/fine/*) echo '[{"model": "pnn", "train": {"nrmse_std_percent": 1.0}, "test": {"nrmse_std_percent": 2.0}, "fit_seconds": 0.1},
    {"model": "xpnn", "train": {"nrmse_std_percent": 0.5}, "test": {"nrmse_std_percent": 3.0}, "fit_seconds": 2}]';;
*/half/*) echo '[{"model": "pnn", "error": "takes one input, not 2"},
    {"model": "xpnn", "train": {"nrmse_std_percent": 2.0}, "test": {"nrmse_std_percent": 12.0}, "fit_seconds": 8}]';;
*/bad/*) echo "reading" >&2; echo "error: train.csv, line 3: is no number" >&2; exit 1;;
*/slow/*) exec sleep 60;;
esac
"#;

const TEST_TABLE: &str = "\
| case           |         xpnn |      pnn |
| -------------- | -----------: | -------: |
| bad            |        – (1) |    – (1) |
| fine           |         3.00 | **2.00** |
| half           |     **12.0** |    – (2) |
| geometric mean | **6.00** (2) | 2.00 (1) |
";

struct Bench {
    folder: TempDir,
}

impl Bench {
    fn new(cases: &[&str]) -> Self {
        let bench = Self { folder: TempDir::new().unwrap() };
        for case in cases {
            let folder = bench.path().join("data").join(case);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("train.csv"), "").unwrap();
            fs::write(folder.join("test.csv"), "").unwrap();
        }
        let stub = bench.path().join("stub");
        fs::write(&stub, STUB).unwrap();
        fs::set_permissions(stub, fs::Permissions::from_mode(0o755)).unwrap();
        bench
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    fn command(&self, arguments: &str) -> Command {
        self.command_of("cases", arguments)
    }

    fn command_of(&self, name: &str, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hysid-lab"));
        command.current_dir(self.path()).arg(name).args(arguments.split_whitespace());
        command
    }

    fn run(&self, arguments: &str) -> Output {
        self.command(arguments).output().unwrap()
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path().join(name)).unwrap()
    }
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn every_case_is_asked_and_failures_are_cells() {
    let bench = Bench::new(&["half", "fine", "bad"]);
    fs::create_dir(bench.path().join("data/notes")).unwrap();
    fs::create_dir(bench.path().join("data/trained-only")).unwrap();
    fs::write(bench.path().join("data/trained-only/train.csv"), "").unwrap();
    let ran = bench.run("data --models pnn,xpnn --time-limit 9 --out cases.md --program ./stub -- --seed 2");
    assert_eq!(ran.status.code(), Some(0), "{}", stderr(&ran));
    let asked: Vec<String> = ["bad", "fine", "half"]
        .map(|case| {
            format!(
                "compare data/{case}/train.csv --test data/{case}/test.csv --models pnn,xpnn --time-limit 9 --json \
                 --no-report --seed 2"
            )
        })
        .to_vec();
    assert_eq!(bench.text("asked").lines().collect::<Vec<_>>(), asked);
    assert!(stderr(&ran).contains("data/trained-only is left out: it has no test.csv"), "{}", stderr(&ran));
    assert!(stderr(&ran).contains("3/3 half: 1 of 2 models worked, "), "{}", stderr(&ran));

    let tables = stdout(&ran);
    assert!(tables.contains(TEST_TABLE), "{tables}");
    assert!(tables.contains("1. train.csv, line 3: is no number\n2. takes one input, not 2\n"), "{tables}");
    let page = bench.text("cases.md");
    assert!(page.ends_with(&tables), "{page}");
    for said in [
        "hysid 1.2.3:\n",
        "cargo run --release -- cases data --models pnn,xpnn --time-limit 9 --out cases.md --program ./stub -- --seed 2\n",
        "The data are not in this\nrepository.",
    ] {
        assert!(page.contains(said), "{said}: {page}");
    }
    assert_eq!(fs::read_dir(bench.path()).unwrap().count(), 4, "nothing else is left behind");
}

#[test]
fn a_slow_case_is_given_up() {
    let bench = Bench::new(&["fine", "slow"]);
    let began = Instant::now();
    let ran = bench.run("data --program ./stub --case-limit 0.5");
    assert!(began.elapsed() < Duration::from_secs(30));
    assert_eq!(ran.status.code(), Some(0), "{}", stderr(&ran));
    assert!(stdout(&ran).contains("1. not done after 0.5 s\n"), "{}", stdout(&ran));
}

#[test]
fn ctrl_c_leaves_what_is_there() {
    let bench = Bench::new(&["fine", "slow", "then"]);
    let out = bench.path().join("cases.md");
    let mut command = bench.command("data --program ./stub --out cases.md");
    let running =
        command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped()).spawn().unwrap();
    // The slow case is running once it was asked for.
    let asked = || fs::read_to_string(bench.path().join("asked")).unwrap_or_default().contains("slow");
    let began = Instant::now();
    while !asked() && began.elapsed() < Duration::from_secs(20) {
        thread::sleep(Duration::from_millis(10));
    }
    let before = fs::read_to_string(&out).unwrap();
    assert!(Command::new("kill").args(["-INT", &running.id().to_string()]).status().unwrap().success());
    let ran = running.wait_with_output().unwrap();
    assert!(began.elapsed() < Duration::from_secs(30));
    assert_eq!(ran.status.code(), Some(130), "{}", stderr(&ran));
    assert!(stderr(&ran).ends_with("interrupted: 1 of 3 cases are done\n"), "{}", stderr(&ran));
    assert!(stdout(&ran).contains("| fine           | **2.00** | 3.00 |\n"), "{}", stdout(&ran));
    assert_eq!(fs::read_to_string(&out).unwrap(), before);
    assert!(before.contains("1 of 3 cases (not finished)"), "{before}");
    assert!(!bench.text("asked").contains("then"));
}

#[test]
fn a_program_without_the_command_is_a_failure_of_every_case() {
    let bench = Bench::new(&["none"]);
    let ran = bench.run("data --program ./stub");
    assert_eq!(ran.status.code(), Some(0), "{}", stderr(&ran));
    assert!(stdout(&ran).contains("| none           |     – (1) |\n"), "{}", stdout(&ran));
    assert!(stdout(&ran).contains("1. the answer is not JSON: "), "{}", stdout(&ran));
}

#[test]
fn what_cannot_be_done_is_said_before_any_work() {
    let bench = Bench::new(&["fine"]);
    fs::create_dir(bench.path().join("empty")).unwrap();
    assert_eq!(bench.run("").status.code(), Some(2));
    assert_eq!(bench.run("data --time-limit soon").status.code(), Some(2));
    for (arguments, expected) in [
        ("nowhere --program ./stub", "nowhere cannot be read: No such file or directory (os error 2)"),
        ("empty --program ./stub", "empty: no subfolder has train.csv and test.csv"),
        (
            "data --program ./stub --out nowhere/a.md",
            "nowhere/a.md cannot be written: name a file in a folder that is there",
        ),
        (
            "data --program ./no-stub",
            "./no-stub could not be started: No such file or directory (os error 2)",
        ),
    ] {
        let ran = bench.run(arguments);
        assert_eq!(stderr(&ran), format!("error: {expected}\n"), "{arguments}");
        assert_eq!((ran.status.code(), stdout(&ran)), (Some(1), String::new()), "{arguments}");
    }
    assert!(!bench.path().join("asked").exists());
}

#[test]
fn verdicts_need_no_test_data() {
    let bench = Bench::new(&["fine", "bad"]);
    fs::remove_file(bench.path().join("data/fine/test.csv")).unwrap();
    let ran = bench.command_of("verdicts", "data --program ./stub --out verdicts.md").output().unwrap();
    assert_eq!(ran.status.code(), Some(0), "{}", stderr(&ran));
    assert!(stderr(&ran).contains("2/2 fine: 1 of 1 properties told, "), "{}", stderr(&ran));
    assert_eq!(bench.text("asked").lines().last(), Some("diagnose data/fine/train.csv --json --no-report"));
    let tables = stdout(&ran);
    for line in [
        "| fine |  no 40 |",
        "| bad  |  – (1) |",
        "1. train.csv, line 3: is no number",
        "- **fine**: it drifts",
    ] {
        assert!(tables.contains(line), "{line}: {tables}");
    }
    assert!(bench.text("verdicts.md").ends_with(&tables), "{tables}");
    let refused = bench.command_of("verdicts", "data --models pnn").output().unwrap();
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
}

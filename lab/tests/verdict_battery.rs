//! `verdict-battery` with a stub in the place of `hysid`: a shell script that always says yes.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// Says yes to every property of `hysid diagnose FILE ...`, if the file is there.
const STUB: &str = r#"#!/bin/sh
if [ "$1" = --version ]; then echo "hysid 1.2.3"; exit; fi
[ -f "$2" ] || exit 1
echo '{"properties": ['
for name in static-hysteresis orientation rate-dependence wiping-out congruency masing odd-symmetry saturation \
    deterioration; do
    echo "{\"name\": \"$name\", \"verdict\": \"yes\", \"index\": 0.5},"
done
echo '{"name": "loop-closure", "verdict": "not testable", "index": null}]}'
"#;

fn battery(folder: &Path, arguments: &str) -> Output {
    let stub = folder.join("stub");
    fs::write(&stub, STUB).unwrap();
    fs::set_permissions(stub, fs::Permissions::from_mode(0o755)).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_hysid-lab"));
    command.current_dir(folder).arg("verdict-battery").args(arguments.split_whitespace());
    command.output().unwrap()
}

#[test]
fn verdicts_are_judged_and_the_records_of_wrong_ones_stay() {
    let folder = TempDir::new().unwrap();
    let arguments = "--program ./stub --laws linear,play --disturbances none,white-1 --out page.md --list-wrong wrong.csv";
    let output = battery(folder.path(), arguments);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{stderr}");
    let text = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();

    // Fifteen paths and two disturbances. A line has no loops, so no orientation; a play lags behind.
    let page = text("page.md");
    assert!(page.contains("hysid 1.2.3"), "{page}");
    assert!(
        page.contains("| orientation       |     0 |    30 |            0 |              100.00 |\n"),
        "{page}"
    );
    assert!(
        page.contains("| wiping-out        |    60 |     0 |            0 |                0.00 |\n"),
        "{page}"
    );
    assert!(
        page.contains("| loop-closure      |     0 |     0 |           60 |                   – |\n"),
        "{page}"
    );
    let stdout = String::from_utf8(output.stdout).unwrap();
    assert!(page.contains(&stdout), "{stdout}");

    let wrong = text("wrong.csv");
    assert_eq!(wrong.matches(",orientation,yes,no,0.500000,,").count(), 30, "{wrong}");
    assert!(!wrong.contains(",wiping-out,") && !wrong.contains(",loop-closure,"), "{wrong}");
    let record = text("wrong.records/play.decaying.white-1.csv");
    assert!(record.starts_with("t_s,x,y\n0,"), "{record}");
    assert!(text("wrong.records/play.nested-untimed.none.csv").starts_with("x,y\n"));
}

#[test]
fn a_program_without_an_answer_stops_the_battery_with_one_line() {
    let folder = TempDir::new().unwrap();
    let output =
        battery(folder.path(), "--program /bin/false --laws play --disturbances none --list-wrong wrong.csv");
    assert_eq!(output.status.code(), Some(1));
    let stderr = String::from_utf8(output.stderr).unwrap();
    let last = stderr.lines().last().unwrap();
    assert!(last.starts_with("error: ") && last.ends_with("none.csv: exit status: 1"), "{stderr}");
}
